// SPDX-License-Identifier: Zlib
// A velocity problem copied out of its world with all of a resolver's input, so that any resolver can solve it
// repeatedly. All vectors are in world axes, and bodies have no orientations: anchors and rows are already rotated.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/problem/given_problem.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A kind of joint with constant rows, copied from a joint of any kind.
template <int D>
class FrozenRows final : public JointKind<D> {
 public:
  explicit FrozenRows(const JointRows<D>& rows) : m_rows(rows) {}
  void rows(const JointRecord<D>&, const Pose<D>&, const Pose<D>&, JointRows<D>& out) const override { out = m_rows; }
  const JointRows<D>& stored() const { return m_rows; }

 private:
  JointRows<D> m_rows;
};

/// A position resolver with stored target velocities. The separation alone determines a target.
template <int D>
class FrozenTargets final : public PositionResolver<D> {
 public:
  Real bias(Real separation, Real) const override {
    const auto it = std::lower_bound(m_targets.begin(), m_targets.end(), std::pair(separation, Real(0)), before);
    return it != m_targets.end() && it->first == separation ? it->second : Real(0);
  }
  Real jointBias(Real) const override { return rate; }
  void add(Real separation, Real target) {
    const std::pair entry(separation, target);
    const auto it = std::lower_bound(m_targets.begin(), m_targets.end(), entry, before);
    if (it == m_targets.end() || it->first != separation) m_targets.insert(it, entry);
  }

  Real rate = 0;  // of joints, 1/s

 private:
  static bool before(const std::pair<Real, Real>& a, const std::pair<Real, Real>& b) { return a.first < b.first; }
  IndexedVector<std::pair<Real, Real>> m_targets;  // m, m/s; sorted
};

template <int D>
struct FrozenProblem {
  Real dt = 0, lastDt = 0, restitutionThreshold = 0;
  Vec<D> gravity = Vec<D>::Zero();  // m/s^2; no resolver uses it: errors are divided by g dt
  PhysicsModel model;
  Bodies<D> bodies;                  // only bodies with contacts or joints
  IndexedVector<Motion<D>> arrival;  // as in VelocityInput; may be empty
  IndexedVector<Manifold<D>> manifolds;
  IndexedVector<int> order, colours;
  IndexedVector<JointRecord<D>> joints;
  FrozenTargets<D> position;
  std::optional<GivenProblem> given;  // replaces bodies, contacts and joints

  /// Adds a body with this velocity. `invInertia` is in world axes; both inverses may be zero.
  void addBody(BodyType type, bool awake, const Vec<D>& at, Real invMass, const Inertia<D>& invInertia,
               const Motion<D>& motion) {
    bodies.pose.push_back({at, {}}), bodies.motion.push_back(motion);
    bodies.invMass.push_back(invMass), bodies.invInertia.push_back(invInertia);
    bodies.mass.push_back(invMass > 0 ? 1 / invMass : Real(0)), bodies.invInertiaBody.push_back(invInertia);
    bodies.center.push_back(Vec<D>::Zero()), bodies.type.push_back(type);
    bodies.used.push_back(1), bodies.awake.push_back(awake), bodies.canSleep.push_back(0), bodies.pinned.push_back(0);
    bodies.sleep.push_back({}), bodies.solver.push_back({}), bodies.generation.push_back(0);
    bodies.userData.push_back(0);
  }
  void addJoint(std::int32_t a, std::int32_t b, const JointRows<D>& rows,
                const IndexedArray<Real, kJointRows>& impulse) {
    JointRecord<D>& joint = joints.emplace_back();
    joint.kind = std::make_shared<FrozenRows<D>>(rows);
    joint.bodyA = a, joint.bodyB = b, joint.impulse = impulse;
  }

  /// The input for a resolver. Solving changes this problem, so solve a copy.
  VelocityInput<D> input(WorkDone& work, Profiler& profiler) {
    return {dt,
            lastDt,
            bodies,
            manifolds,
            order,
            joints,
            position,
            model,
            restitutionThreshold,
            work,
            profiler,
            arrival,
            colours,
            given ? &*given : nullptr};
  }
  int points() const {
    int count = 0;
    for (const Manifold<D>& m : manifolds) count += m.count;
    return count;
  }
};

/// Copies a problem before it is solved. Bodies, contacts and joints keep their order. Bodies without contacts and
/// joints, and free or broken joints, are left out.
template <int D>
FrozenProblem<D> freeze(const VelocityInput<D>& in, const Vec<D>& gravity) {
  FrozenProblem<D> out;
  out.dt = in.dt, out.lastDt = in.lastDt, out.restitutionThreshold = in.restitutionThreshold, out.gravity = gravity;
  out.model = in.model, out.position.rate = in.position.jointBias(in.dt);
  if (in.given) out.given = *in.given;
  const Bodies<D>& bodies = in.bodies;
  IndexedVector<std::int32_t> slot(bodies.pose.size(), 0);  // first 1 for a used body; then its new slot + 1
  const auto name = [&](std::int32_t body) {
    if (body >= 0) slot[body] = 1;
  };
  const auto number = [&](std::int32_t body) { return body < 0 ? -1 : slot[body] - 1; };
  IndexedVector<int> kept(in.order.begin(), in.order.end());
  std::sort(kept.begin(), kept.end());
  for (const int i : kept) {
    name(in.manifolds[i].bodyA), name(in.manifolds[i].bodyB);
  }
  const IndexedSpan<JointRecord<D>> joints = in.model.joints ? in.joints : IndexedSpan<JointRecord<D>>();
  for (const JointRecord<D>& j : joints) {
    if (j.active()) name(j.bodyA), name(j.bodyB);
  }
  for (std::size_t i = 0; i < slot.size(); ++i) {
    if (!slot[i]) continue;
    out.addBody(bodies.type[i], bodies.awake[i], bodies.pose[i].p, bodies.invMass[i], bodies.invInertia[i],
                bodies.motion[i]);
    if (!in.arrival.empty()) out.arrival.push_back(in.arrival[i]);
    slot[i] = out.bodies.size();
  }
  for (const int i : kept) {
    const Manifold<D>& from = in.manifolds[i];
    const auto turned = [&](std::int32_t body, const Vec<D>& local) { return Vec<D>(bodies.pose[body].q * local); };
    Manifold<D>& m = out.manifolds.emplace_back();
    m.bodyA = number(from.bodyA), m.bodyB = number(from.bodyB), m.count = from.count, m.normal = from.normal;
    m.friction = from.friction, m.restitution = from.restitution;
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& point = from.points[k];
      ContactPoint<D>& to = m.points[k];
      to.localA = turned(from.bodyA, point.localA), to.localB = turned(from.bodyB, point.localB);
      to.separation = point.separation, to.impulse = point.impulse;
      if (point.separation <= 0) out.position.add(point.separation, in.position.bias(point.separation, in.dt));
    }
  }
  for (const int i : in.order) {
    out.order.push_back(static_cast<int>(std::lower_bound(kept.begin(), kept.end(), i) - kept.begin()));
  }
  out.colours.assign(in.colours.begin(), in.colours.end());
  JointRows<D> rows;
  for (const JointRecord<D>& j : joints) {
    if (!j.active()) continue;
    jointRows(j, bodies, rows);
    out.addJoint(number(j.bodyA), number(j.bodyB), rows, j.impulse);
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
