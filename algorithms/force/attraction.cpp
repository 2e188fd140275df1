// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Below `floor` the force falls to zero in proportion to the distance, as gravity does inside a ball of constant
// density. Otherwise one step's force would fling a touching pair apart.
template <int D>
class Attraction final : public ForceKind<D> {
 public:
  struct Params {
    Real strength = 1, floor = Real(0.01), mass = 1;
    int exponent = 2;
    void visit(ParamVisitor& v) {
      v.real("strength", strength, Real(-1e12), Real(1e12), "N m^exponent/kg^2",
             "G of G m M / r^exponent; < 0: repels");
      v.integer("exponent", exponent, 0, 8, "of the distance");
      v.real("floor", floor, Real(1e-6), Real(1e6), "m", "nearer than this the force falls in proportion to r");
      v.real("mass", mass, 0, Real(1e12), "kg",
             "M where that end has none: the world, or a body that forces do not move");
    }
  };
  explicit Attraction(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "attraction",
            .summary = "gravity of a body, or of a point of the world, on another one or on all",
            .paper = "lpc2009",
            .complexity = "1, or the number of bodies"};
  }

  ForceEnds ends() const override { return {.from = true, .all = true, .anchors = true}; }

  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    const ForceEnd<D> a(state, force.bodyA, force.localA);
    const Real massA = massOf(state.bodies, force.bodyA);
    const auto pull = [&](std::int32_t other) {
      if (other == force.bodyA) return;
      const ForceEnd<D> b(state, other, force.localB);
      const Vec<D> apart = b.p - a.p;
      if (!(apart.norm() > 0)) return;  // no direction
      const Real r = std::max(apart.norm(), m_params.floor);
      Real share = m_params.strength * massA * massOf(state.bodies, other) / r;
      for (int i = 0; i < m_params.exponent; ++i) share /= r;
      const Vec<D> onA = share * apart;
      a.push(onA, state.bodies, out);
      b.push(-onA, state.bodies, out);
    };
    if (force.bodyB >= 0) return pull(force.bodyB);  // A may be fixed; B attracts it
    forEachActedOn(force, state.bodies, [&](std::size_t i) { pull(static_cast<std::int32_t>(i)); });
  }

 private:
  Real massOf(const Bodies<D>& bodies, std::int32_t body) const {
    if (body < 0 || !movedByForces(bodies, body)) return m_params.mass;
    return bodies.mass[body];
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(ForceKind, Attraction, 2, 3);

}}  // namespace lpc::LPC_PRECISION
