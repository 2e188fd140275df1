// SPDX-License-Identifier: Zlib
// Shared by all engines: a World beside the engine holds the scene's data (slots, masses, shapes, joints) and displays
// the engine's poses. It never steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "framework/world/stage_engine.h"
#include "framework/world/world.h"
#include "oracles/engines/joint_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class EngineWorld : public Simulation<D>, public ChangesGravity<D> {
 public:
  BodyHandle add(const BodyDef<D>& def) final {
    refresh();
    checkBody(def);
    const BodyHandle body = m_scene.add(def);
    try {
      addBody(static_cast<std::size_t>(body.slot), def);
    } catch (...) {
      m_scene.remove(body);
      throw;
    }
    fit();
    m_pushes.resize(m_pose.size());
    m_pushes[static_cast<std::size_t>(body.slot)] = {};
    return body;
  }
  JointHandle add(const JointDef<D>& def) final {
    refresh();
    const JointHandle joint = m_scene.add(def);
    const JointRecord<D>& record = m_scene.joints()[static_cast<std::size_t>(joint.slot)];
    try {
      if (holds(record)) addJoint(static_cast<std::size_t>(joint.slot), record);
    } catch (...) {
      m_scene.remove(joint);
      throw;
    }
    return joint;
  }
  ForceHandle add(const ForceDef<D>& def) final {
    refresh();
    const ForceHandle force = m_scene.add(def);
    if (m_scene.forces()[static_cast<std::size_t>(force.slot)].kind->readsContacts()) {
      m_scene.remove(force);
      throw UserError("force '" + def.kind +
                      "' needs the contact loads, which an engine does not report; valid: a pipeline");
    }
    return force;
  }
  void remove(ForceHandle force) final { m_scene.remove(force); }
  void add(std::shared_ptr<const ForceGenerator<D>> generator) final { m_generators.push_back(std::move(generator)); }
  void remove(BodyHandle body) final {
    refresh();
    if (m_scene.valid(body)) {  // otherwise m_scene.remove() throws
      for (std::size_t j = 0; j < m_scene.joints().size(); ++j) {
        const JointRecord<D>& joint = m_scene.joints()[j];
        if (holds(joint) && (joint.bodyA == body.slot || joint.bodyB == body.slot)) dropJoint(j);
      }
      dropBody(static_cast<std::size_t>(body.slot));
    }
    m_scene.remove(body);
  }
  void remove(JointHandle joint) final {
    refresh();
    const auto j = static_cast<std::size_t>(joint.slot);
    const bool held = j < m_scene.joints().size() && holds(m_scene.joints()[j]);
    m_scene.remove(joint);
    if (held) dropJoint(j);
  }

  void setGravity(const Vec<D>& gravity) final {
    refresh();
    m_scene.setGravity(gravity);
    putGravity();
  }
  void setPose(BodyHandle body, const Pose<D>& X_WB) final {
    refresh();
    m_scene.setPose(body, X_WB);
    const auto i = static_cast<std::size_t>(body.slot);
    putPose(i, m_scene.bodies().pose[i]);
  }
  void setMotion(BodyHandle body, const Motion<D>& motion) final {
    refresh();
    m_scene.setMotion(body, motion);
    const auto i = static_cast<std::size_t>(body.slot);
    putMotion(i, motionOf(i));
  }
  void applyForce(BodyHandle body, const Vec<D>& force, const Vec<D>& point) final {
    if (!force.allFinite() || !point.allFinite()) throw UserError("applyForce: force or point is not finite");
    Wrench<D>& w = pushOf(body);
    w.force += force;
    w.torque += cross(point - m_scene.bodies().pose[static_cast<std::size_t>(body.slot)].p, force);
  }
  void applyTorque(BodyHandle body, const Ang<D>& torque) final {
    if (!torque.allFinite()) throw UserError("applyTorque: the torque is not finite");
    pushOf(body).torque += torque;
  }
  void applyImpulse(BodyHandle body, const Wrench<D>& impulse) final {
    refresh();
    m_scene.applyImpulse(body, impulse);
    const auto i = static_cast<std::size_t>(body.slot);
    if (m_scene.bodies().type[i] == BodyType::dynamic) putMotion(i, motionOf(i));
  }

  void step(Real dt) final {
    if (!(dt >= 0) || !std::isfinite(dt)) {
      throw UserError("step: dt is " + std::to_string(dt) + "; valid: a finite number of seconds >= 0");
    }
    if (dt == 0) return;
    if (!m_scene.joints().empty()) refresh();  // a hinge's whole turns are counted from step to step
    m_profiler.beginFrame(m_steps);
    pushForces(dt);
    advance(dt);
    ++m_steps, m_time += dt, m_lastDt = dt, m_stale = true;
    breakJoints(dt);
  }
  long stepCount() const final { return m_steps; }
  Real time() const final { return m_time; }
  Real lastDt() const final { return m_lastDt; }

  const Bodies<D>& bodies() const final { return refresh().bodies(); }
  std::span<const ShapeRecord<D>> shapes() const final { return m_scene.shapes(); }
  std::span<const JointRecord<D>> joints() const final { return m_scene.joints(); }
  std::span<const ForceRecord<D>> forces() const final { return m_scene.forces(); }
  std::optional<std::span<const Manifold<D>>> contacts() const final { return std::nullopt; }
  const WorldSettings<D>& settings() const final { return m_scene.settings(); }
  int bodyCount() const final { return m_scene.bodyCount(); }
  bool valid(BodyHandle body) const final { return m_scene.valid(body); }
  Pose<D> pose(BodyHandle body) const final { return refresh().pose(body); }
  Profiler& profiler() final {
    refresh();
    return m_profiler;
  }
  std::uint64_t hash() const final { return refresh().hash(); }

 protected:
  explicit EngineWorld(const WorldSettings<D>& settings) : m_scene(Pipeline::parse("contacts=query_clip"), settings) {}

  // --- implemented by each engine. The origin of bodies is the centre of mass; `scene()` has mass, inertia, pose and
  // shapes.
  virtual void checkBody(const BodyDef<D>& def) const = 0;  // throws UserError for what the engine does not support
  virtual void addBody(std::size_t slot, const BodyDef<D>& def) = 0;
  virtual void dropBody(std::size_t slot) = 0;
  virtual void addJoint(std::size_t slot, const JointRecord<D>& joint) = 0;  // throws UserError for what the engine
                                                                             // does not support
  virtual void dropJoint(std::size_t slot) = 0;
  /// Load on B of the joint in the last step, of dt (s). Called for joints that may break.
  virtual JointLoad load(std::size_t slot, Real dt) const = 0;
  virtual void putGravity() = 0;  // sets the gravity of the settings
  virtual void putPose(std::size_t slot, const Pose<D>& X_WC) = 0;
  virtual void putMotion(std::size_t slot, const Motion<D>& motion) = 0;
  virtual void push(std::size_t slot, const Wrench<D>& wrench) = 0;  // for the next step
  virtual void advance(Real dt) = 0;
  virtual void read(std::size_t slot, Pose<D>& X_WC, Motion<D>& motion) const = 0;
  /// Of the last step: pairs of the engine's broadphase, and contact points.
  virtual void count(int& pairs, int& points) const = 0;

  const World<D>& scene() const { return m_scene; }
  /// Calls f(view, X_CP, record) for each convex part of the body's shapes.
  void forBodyParts(std::size_t slot,
                    const std::function<void(const ShapeView<D>&, const Pose<D>&, const ShapeRecord<D>&)>& f) const {
    for (const std::int32_t shape : m_scene.shapesOf(slot)) {
      const ShapeRecord<D>& s = m_scene.shapes()[static_cast<std::size_t>(shape)];
      forParts(s.shape, s.X_CS, [&](const ShapeView<D>& part, const Pose<D>& X_CP) { f(part, X_CP, s); });
    }
  }
  // Parts of the model that a scene disables are disabled for engines too.
  Real frictionOf(const ShapeRecord<D>& s) const { return settings().model.friction ? s.friction : Real(0); }
  Real restitutionOf(const ShapeRecord<D>& s) const { return settings().model.restitution ? s.restitution : Real(0); }
  bool turns(std::size_t slot) const {
    return settings().model.rotation && m_scene.bodies().invInertiaBody[slot].trace() > 0;
  }
  /// The scene's motion, without the parts that our worlds ignore for bodies that are pinned or may not rotate.
  Motion<D> motionOf(std::size_t slot) const {
    const Bodies<D>& b = m_scene.bodies();
    const bool dynamic = b.type[slot] == BodyType::dynamic;
    Motion<D> motion = b.motion[slot];
    if (dynamic && b.pinned[slot]) motion.v.setZero();
    if (dynamic ? !turns(slot) : !settings().model.rotation) motion.w.setZero();
    return motion;
  }

 private:
  void fit() const {
    const Bodies<D>& b = m_scene.bodies();
    m_pose.resize(b.pose.size()), m_motion.resize(b.pose.size());
  }
  // Joints that are broken, or disabled by the scene, are not in the engine.
  bool holds(const JointRecord<D>& joint) const { return settings().model.joints && joint.active(); }
  // Poses are read within the timed step only when a force needs them.
  const World<D>& refresh() const {
    if (!m_stale) return m_scene;
    m_stale = false;
    fit();
    const Bodies<D>& b = m_scene.bodies();
    Profiler::Frame& f = m_profiler.frame();
    f.bodies = m_scene.bodyCount(), f.awake = 0;
    for (std::size_t i = 0; i < m_pose.size(); ++i) {
      m_pose[i] = b.pose[i], m_motion[i] = b.motion[i];
      if (!b.used[i] || b.type[i] == BodyType::fixed) continue;
      read(i, m_pose[i], m_motion[i]);
      f.awake += b.type[i] == BodyType::dynamic;
    }
    m_scene.follow(m_pose, m_motion);
    count(f.pairs, f.points);
    f.manifolds = f.pairs;
    m_profiler.endFrame(0);
    return m_scene;
  }
  Wrench<D>& pushOf(BodyHandle body) {
    refresh().pose(body);  // throws for an invalid handle
    m_pushed = true;
    return m_pushes[static_cast<std::size_t>(body.slot)];
  }
  // Applies a script's forces and torques, plus the scene's forces.
  void pushForces(Real dt) {
    const auto records = m_scene.forces();
    const bool acting = !m_generators.empty() ||
                        std::any_of(records.begin(), records.end(), [](const auto& f) { return f.kind != nullptr; });
    if (!acting && !m_pushed) return;
    const Bodies<D>& b = acting ? refresh().bodies() : m_scene.bodies();
    m_pushes.resize(b.pose.size());
    m_wrenches = m_pushes;  // a copy: a force that throws must not change the script's forces
    const ForceState<D> state{b, b.pose, b.motion, dt};
    applyForces(records, state, m_time, std::span<Wrench<D>>(m_wrenches));
    for (const auto& f : m_generators) f->apply(state, m_time, m_wrenches);
    for (std::size_t i = 0; i < m_wrenches.size(); ++i) {
      if (b.used[i] && b.type[i] == BodyType::dynamic) push(i, m_wrenches[i]);
      m_pushes[i] = {};
    }
    m_pushed = false;
  }
  void breakJoints(Real dt) {
    for (std::size_t i = 0; i < m_scene.joints().size(); ++i) {
      const JointRecord<D>& j = m_scene.joints()[i];
      if (!holds(j) || (!std::isfinite(j.breakForce) && !std::isfinite(j.breakTorque))) continue;
      const JointLoad l = load(i, dt);
      if (l.force <= j.breakForce && l.torque <= j.breakTorque) continue;
      dropJoint(i);
      m_scene.breakJoint(i);
    }
  }

  mutable World<D> m_scene;
  mutable std::vector<Pose<D>> m_pose;  // scratch
  mutable std::vector<Motion<D>> m_motion;
  mutable Profiler m_profiler;
  mutable bool m_stale = false;
  bool m_pushed = false;
  std::vector<std::shared_ptr<const ForceGenerator<D>>> m_generators;
  std::vector<Wrench<D>> m_pushes;    // for the next step, by body slot
  std::vector<Wrench<D>> m_wrenches;  // scratch
  Real m_time = 0, m_lastDt = 0;
  long m_steps = 0;
};

}}  // namespace lpc::LPC_PRECISION
