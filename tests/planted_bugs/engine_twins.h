// SPDX-License-Identifier: Zlib
// Adapters that forget something: the checks of engines must tell them from the true ones.
#pragma once

#include "framework/stage_engine.h"

namespace lpc::inline LPC_PRECISION::test {

/// Starts a simulation under check: a true engine, or a twin with a bug.
template <int D>
using Start = std::function<std::unique_ptr<Simulation<D>>(const WorldSettings<D>&)>;

/// Forgets the sign of gravity.
template <int D>
Start<D> upsideDown(Start<D> start) {
  return [start](WorldSettings<D> settings) {
    settings.gravity *= -1;
    return start(settings);
  };
}

/// Hands definitions on after `change`; all else is the inner simulation's.
template <int D>
class Twin final : public Simulation<D> {
 public:
  using Change = std::function<void(BodyDef<D>&)>;
  Twin(std::unique_ptr<Simulation<D>> inner, Change change) : m_inner(std::move(inner)), m_change(std::move(change)) {}

  Handle add(const BodyDef<D>& def) override {
    BodyDef<D> changed = def;
    m_change(changed);
    return m_inner->add(changed);
  }
  Handle add(const JointDef<D>& def) override { return m_inner->add(def); }
  void add(std::shared_ptr<const ForceGenerator<D>> generator) override { m_inner->add(std::move(generator)); }
  void remove(Handle body) override { m_inner->remove(body); }
  void removeJoint(Handle joint) override { m_inner->removeJoint(joint); }
  void step(Real dt) override { m_inner->step(dt); }
  long stepCount() const override { return m_inner->stepCount(); }
  Real time() const override { return m_inner->time(); }
  Real lastDt() const override { return m_inner->lastDt(); }
  const Bodies<D>& bodies() const override { return m_inner->bodies(); }
  std::span<const ShapeRecord<D>> shapes() const override { return m_inner->shapes(); }
  std::span<const JointRecord<D>> joints() const override { return m_inner->joints(); }
  std::optional<std::span<const Manifold<D>>> contacts() const override { return m_inner->contacts(); }
  const WorldSettings<D>& settings() const override { return m_inner->settings(); }
  int bodyCount() const override { return m_inner->bodyCount(); }
  bool valid(Handle body) const override { return m_inner->valid(body); }
  Pose<D> pose(Handle body) const override { return m_inner->pose(body); }
  Profiler& profiler() override { return m_inner->profiler(); }
  std::uint64_t hash() const override { return m_inner->hash(); }

 private:
  std::unique_ptr<Simulation<D>> m_inner;
  Change m_change;
};

template <int D>
Start<D> twin(Start<D> start, typename Twin<D>::Change change) {
  return [=](const WorldSettings<D>& settings) { return std::make_unique<Twin<D>>(start(settings), change); };
}

/// Leaves every body at the mass that the engine gives by itself, of density 1.
template <int D>
Start<D> ownMass(Start<D> start) {
  return twin<D>(start, [](BodyDef<D>& def) {
    for (ShapeDef<D>& s : def.shapes) s.density = 1;
  });
}

/// Leaves friction to the engine: as if pairs took the product.
template <int D>
Start<D> productOfFriction(Start<D> start) {
  return twin<D>(start, [](BodyDef<D>& def) {
    for (ShapeDef<D>& s : def.shapes) s.friction *= s.friction;
  });
}

/// Takes the larger restitution of a pair: as if the rule of the pair were the engine's own.
template <int D>
Start<D> largerRestitution(Start<D> start) {
  return twin<D>(start, [](BodyDef<D>& def) {
    for (ShapeDef<D>& s : def.shapes) s.restitution = 1;
  });
}

}  // namespace lpc::inline LPC_PRECISION::test
