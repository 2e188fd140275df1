// SPDX-License-Identifier: Zlib
// Planted bugs of engine adapters: the checks of engines must tell them from the correct adapters.
#pragma once

#include <string>

#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Starts a simulation under test: an engine, or an adapter with a planted bug.
template <int D>
using Start = std::function<std::unique_ptr<Simulation<D>>(const WorldSettings<D>&)>;

/// Inverts gravity.
template <int D>
Start<D> upsideDown(Start<D> start) {
  return [start](WorldSettings<D> settings) {
    settings.gravity *= -1;
    return start(settings);
  };
}

/// What a planted bug changes in the calls that it passes on. Members left out change nothing.
template <int D>
struct Changes {
  std::function<void(BodyDef<D>&)> body = [](BodyDef<D>&) {};
  std::function<void(JointDef<D>&)> joint = [](JointDef<D>&) {};
  std::function<void(Pose<D>&)> pose = [](Pose<D>&) {};
  std::function<void(Motion<D>&)> motion = [](Motion<D>&) {};
  std::function<void(Vec<D>& force, Vec<D>& point)> force = [](Vec<D>&, Vec<D>&) {};
  std::function<void(Ang<D>&)> torque = [](Ang<D>&) {};
  std::function<void(Wrench<D>&)> impulse = [](Wrench<D>&) {};
  std::function<void(Vec<D>&)> gravity = [](Vec<D>&) {};
};

/// Forwards everything to the inner simulation, with `changes`.
template <int D>
class Twin final : public Simulation<D>, public ChangesGravity<D> {
 public:
  Twin(std::unique_ptr<Simulation<D>> inner, Changes<D> changes)
      : m_inner(std::move(inner)), m_changes(std::move(changes)) {}

  BodyHandle add(const BodyDef<D>& def) override {
    BodyDef<D> changed = def;
    m_changes.body(changed);
    return m_inner->add(changed);
  }
  JointHandle add(const JointDef<D>& def) override {
    JointDef<D> changed = def;
    m_changes.joint(changed);
    return m_inner->add(changed);
  }
  void setPose(BodyHandle body, const Pose<D>& X_WB) override {
    Pose<D> changed = X_WB;
    m_changes.pose(changed);
    m_inner->setPose(body, changed);
  }
  void setMotion(BodyHandle body, const Motion<D>& motion) override {
    Motion<D> changed = motion;
    m_changes.motion(changed);
    m_inner->setMotion(body, changed);
  }
  void applyForce(BodyHandle body, const Vec<D>& force, const Vec<D>& point) override {
    Vec<D> changedForce = force, changedPoint = point;
    m_changes.force(changedForce, changedPoint);
    m_inner->applyForce(body, changedForce, changedPoint);
  }
  void applyTorque(BodyHandle body, const Ang<D>& torque) override {
    Ang<D> changed = torque;
    m_changes.torque(changed);
    m_inner->applyTorque(body, changed);
  }
  void applyImpulse(BodyHandle body, const Wrench<D>& impulse) override {
    Wrench<D> changed = impulse;
    m_changes.impulse(changed);
    m_inner->applyImpulse(body, changed);
  }
  void setGravity(const Vec<D>& gravity) override {
    Vec<D> changed = gravity;
    m_changes.gravity(changed);
    changeGravity(*m_inner, changed);
  }
  ForceHandle add(const ForceDef<D>& def) override { return m_inner->add(def); }
  void remove(ForceHandle force) override { m_inner->remove(force); }
  void add(std::shared_ptr<const ForceGenerator<D>> generator) override { m_inner->add(std::move(generator)); }
  void remove(BodyHandle body) override { m_inner->remove(body); }
  void remove(JointHandle joint) override { m_inner->remove(joint); }
  void step(Real dt) override { m_inner->step(dt); }
  long stepCount() const override { return m_inner->stepCount(); }
  Real time() const override { return m_inner->time(); }
  Real lastDt() const override { return m_inner->lastDt(); }
  const Bodies<D>& bodies() const override { return m_inner->bodies(); }
  std::span<const ShapeRecord<D>> shapes() const override { return m_inner->shapes(); }
  std::span<const JointRecord<D>> joints() const override { return m_inner->joints(); }
  std::span<const ForceRecord<D>> forces() const override { return m_inner->forces(); }
  std::optional<std::span<const Manifold<D>>> contacts() const override { return m_inner->contacts(); }
  const WorldSettings<D>& settings() const override { return m_inner->settings(); }
  int bodyCount() const override { return m_inner->bodyCount(); }
  bool valid(BodyHandle body) const override { return m_inner->valid(body); }
  Pose<D> pose(BodyHandle body) const override { return m_inner->pose(body); }
  Profiler& profiler() override { return m_inner->profiler(); }
  std::uint64_t hash() const override { return m_inner->hash(); }

 private:
  std::unique_ptr<Simulation<D>> m_inner;
  Changes<D> m_changes;
};

template <int D>
Start<D> twin(Start<D> start, Changes<D> changes) {
  return [=](const WorldSettings<D>& settings) { return std::make_unique<Twin<D>>(start(settings), changes); };
}

/// Ignores changes of gravity.
template <int D>
Start<D> deafToGravity(Start<D> start) {
  return [start](const WorldSettings<D>& settings) {
    Changes<D> changes;
    changes.gravity = [began = settings.gravity](Vec<D>& gravity) { gravity = began; };
    return std::make_unique<Twin<D>>(start(settings), changes);
  };
}

/// Leaves every body at the engine's default density of 1.
template <int D>
Start<D> ownMass(Start<D> start) {
  return twin<D>(start, {.body = [](BodyDef<D>& def) {
                   for (ShapeDef<D>& s : def.shapes) s.density = 1;
                 }});
}

/// Leaves friction to the engine, as if pairs multiplied the coefficients.
template <int D>
Start<D> productOfFriction(Start<D> start) {
  return twin<D>(start, {.body = [](BodyDef<D>& def) {
                   for (ShapeDef<D>& s : def.shapes) s.friction *= s.friction;
                 }});
}

/// Caps friction at 10, as Bullet does by default.
template <int D>
Start<D> cappedFriction(Start<D> start) {
  return twin<D>(start, {.body = [](BodyDef<D>& def) {
                   for (ShapeDef<D>& s : def.shapes) s.friction = std::min(s.friction, Real(10));
                 }});
}

/// Mixes friction, or restitution, by the first rule, whatever the scene says.
template <int D>
Start<D> oneRuleOfFriction(Start<D> start) {
  return [start](WorldSettings<D> settings) {
    settings.mixing.friction = {};
    return start(settings);
  };
}
template <int D>
Start<D> oneRuleOfRestitution(Start<D> start) {
  return [start](WorldSettings<D> settings) {
    settings.mixing.restitution = {};
    return start(settings);
  };
}

/// Takes the larger restitution of a pair, as if the engine's own rule applied.
template <int D>
Start<D> largerRestitution(Start<D> start) {
  return twin<D>(start, {.body = [](BodyDef<D>& def) {
                   for (ShapeDef<D>& s : def.shapes) s.restitution = 1;
                 }});
}

/// Passes a joint's kind on with one parameter changed, if it is set.
template <int D>
Start<D> parameterOfJoints(Start<D> start, std::string parameter, std::function<std::string(const Spec&)> value) {
  return twin<D>(start, {.joint = [=](JointDef<D>& def) {
                   Spec spec = Spec::parse(def.kind);
                   if (!spec.find(parameter)) return;
                   spec.set(parameter, {value(spec), {}});
                   def.kind = spec.text();
                 }});
}
inline std::string negative(const std::string& number) {
  return number.starts_with('-') ? number.substr(1) : "-" + number;
}

/// Takes the angle of a hinge as that of A relative to B: its stops are on the other side.
template <int D>
Start<D> otherSideOfHinges(Start<D> start) {
  return twin<D>(start, {.joint = [](JointDef<D>& def) {
                   Spec spec = Spec::parse(def.kind);
                   const Spec *lower = spec.find("lower"), *upper = spec.find("upper");
                   if (!lower || !upper) return;
                   const std::string low = negative(upper->name), high = negative(lower->name);
                   spec.set("lower", {low, {}}), spec.set("upper", {high, {}});
                   def.kind = spec.text();
                 }});
}
/// Motors turn the other way.
template <int D>
Start<D> backwardMotors(Start<D> start) {
  return parameterOfJoints<D>(start, "motor_speed",
                              [](const Spec& s) { return negative(s.find("motor_speed")->name); });
}
/// Takes a motor's torque for the impulse per step.
template <int D>
Start<D> impulsiveMotors(Start<D> start) {
  return parameterOfJoints<D>(start, "motor_torque", [](const Spec& s) {
    return std::to_string(60 * std::stod(s.find("motor_torque")->name));
  });
}
/// Measures the angle of a hinge from where the bodies' frames agree, not the joint's.
template <int D>
Start<D> anglesOfBodies(Start<D> start) {
  return twin<D>(start, {.joint = [](JointDef<D>& def) { def.X_WJb.reset(); }});
}
/// Treats ropes as rods.
template <int D>
Start<D> stiffRopes(Start<D> start) {
  return parameterOfJoints<D>(
      start, "mode", [](const Spec& s) { return s.find("mode")->name == "rope" ? "rod" : s.find("mode")->name; });
}
/// Drops the damping of springs.
template <int D>
Start<D> undamped(Start<D> start) {
  return parameterOfJoints<D>(start, "damping", [](const Spec&) { return std::string("0"); });
}
/// Turns welds into pivots.
template <int D>
Start<D> looseWelds(Start<D> start) {
  return twin<D>(start, {.joint = [](JointDef<D>& def) {
                   if (def.kind == "weld") def.kind = "pivot";
                 }});
}
/// Joints do not break.
template <int D>
Start<D> unbreakable(Start<D> start) {
  return twin<D>(start, {.joint = [](JointDef<D>& def) {
                   def.breakForce = def.breakTorque = std::numeric_limits<Real>::infinity();
                 }});
}
/// Joints are active although the settings switch them off.
template <int D>
Start<D> alwaysJoined(Start<D> start) {
  return [start](WorldSettings<D> settings) {
    settings.model.joints = true;
    return start(settings);
  };
}
/// Jointed bodies collide, or not, whatever the scene says.
template <int D>
Start<D> jointedCollide(Start<D> start, bool collide) {
  return twin<D>(start, {.joint = [=](JointDef<D>& def) { def.collide = collide; }});
}

/// A script's forces act at the centre of mass.
template <int D>
Start<D> centralForces(Start<D> start) {
  return twin<D>(start, {.force = [](Vec<D>&, Vec<D>& point) { point.setZero(); }});
}
/// Takes an impulse for a force that acts for one step.
template <int D>
Start<D> softBlows(Start<D> start) {
  return twin<D>(start, {.impulse = [](Wrench<D>& blow) { blow.force /= 60, blow.torque /= 60; }});
}
/// Drops torques, angular velocities, rotations.
template <int D>
Start<D> noTorques(Start<D> start) {
  return twin<D>(start, {.torque = [](Ang<D>& torque) { torque.setZero(); }});
}
template <int D>
Start<D> noTurning(Start<D> start) {
  return twin<D>(start, {.motion = [](Motion<D>& motion) { motion.w.setZero(); }});
}
template <int D>
Start<D> noRotation(Start<D> start) {
  return twin<D>(start, {.pose = [](Pose<D>& X) { X.q = {}; }});
}

}}}  // namespace lpc::LPC_PRECISION::test
