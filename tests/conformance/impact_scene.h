// SPDX-License-Identifier: Zlib
// Bodies, contacts and joints made by hand or drawn at random, without a world: a solver's duties do not depend on the
// origin of its contacts.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/math/tolerances.h"
#include "framework/stage/profiler.h"
#include "framework/stage/stage_solver.h"
#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// A constant acceleration, a spring to the origin, and mutual attraction, on every body with mass.
template <int D>
struct Field final : Forces<D> {
  Vec<D> gravity = Vec<D>::Zero();  // m/s^2
  Real spring = 0;                  // 1/s^2
  Real pull = 0;  // 1/s^2, to the common centre of mass: between each pair equal, opposite and along their line
  void eval(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    const std::vector<Real>& mass = state.bodies.mass;
    Vec<D> moment = Vec<D>::Zero();
    Real sum = 0;
    for (std::size_t i = 0; i < out.size() && pull > 0; ++i) moment += mass[i] * state.pose[i].p, sum += mass[i];
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = {};
      out[i].force = mass[i] * (gravity - spring * state.pose[i].p);
      if (pull > 0) out[i].force += pull * mass[i] * (moment / sum - state.pose[i].p);
    }
  }
};

struct NoDetection final : DetectAgain {
  void again() override { std::abort(); }
};

template <int D>
struct ImpactScene {
  Bodies<D> bodies;
  IndexedVector<Manifold<D>> manifolds;
  IndexedVector<int> active;
  std::vector<JointRecord<D>> joints;
  PhysicsModel model;
  Field<D> field;
  Real dt = Real(1) / 60, lastDt = 0, time = 0;
  WorkDone work;
  Profiler profiler;
  ContactGraph<D> graph;

  /// Mass 0: a static body. `inertia` holds the principal moments.
  int add(Real mass, const Ang<D>& inertia, const Pose<D>& pose, const Motion<D>& motion = {}) {
    Bodies<D>& b = bodies;
    const bool dynamic = mass > 0;
    Inertia<D> inverse = Inertia<D>::Zero();
    for (int k = 0; k < kAngDim<D>; ++k) {
      if (dynamic && inertia[k] > 0) inverse(k, k) = 1 / inertia[k];
    }
    b.pose.push_back(pose), b.motion.push_back(motion);
    b.mass.push_back(mass), b.invMass.push_back(dynamic ? 1 / mass : Real(0));
    b.invInertiaBody.push_back(inverse), b.invInertia.push_back(rotateInertia(pose.q, inverse));
    b.center.push_back(Vec<D>::Zero());
    b.type.push_back(dynamic ? BodyType::dynamic : BodyType::fixed);
    b.used.push_back(1), b.awake.push_back(1), b.canSleep.push_back(1), b.pinned.push_back(0);
    b.sleep.push_back({}), b.solver.push_back({}), b.generation.push_back(0);
    return b.size() - 1;
  }

  /// One contact point at world point p; the anchors are `separation` apart along the normal.
  void touch(int a, int b, const Vec<D>& n_AB, const Vec<D>& p, Real separation, Real friction, Real restitution) {
    Manifold<D> m;
    m.bodyA = a, m.bodyB = b, m.shapeA = a, m.shapeB = b;
    m.normal = n_AB, m.friction = friction, m.restitution = restitution;
    m.partA = static_cast<std::int32_t>(manifolds.size());
    manifolds.push_back(m);
    active.push_back(static_cast<int>(active.size()));
    addPoint(manifolds.back(), p, separation);
  }
  void addPoint(Manifold<D>& m, const Vec<D>& p, Real separation) {
    ContactPoint<D>& c = m.points[static_cast<std::size_t>(m.count)];
    c.localA = pose(m.bodyA).inverse() * Vec<D>(p - separation / 2 * m.normal);
    c.localB = pose(m.bodyB).inverse() * Vec<D>(p + separation / 2 * m.normal);
    c.separation = separation, c.feature = static_cast<std::uint32_t>(m.count);
    ++m.count;
  }
  /// A pivot with its two ends `error` apart.
  void join(int a, int b, const Vec<D>& p, const Vec<D>& error) { join("pivot", a, b, {p, {}}, {p + error, {}}); }
  /// A joint with its frames at X_WJa and X_WJb, without error; a = -1: the world.
  void join(const std::string& kind, int a, int b, const Pose<D>& X_WJa, const Pose<D>& X_WJb) {
    JointDef<D> def{.kind = kind, .X_WJ = X_WJa, .X_WJb = X_WJb};
    def.bodyA.slot = a, def.bodyB.slot = b;
    joints.push_back(makeJoint(def, poseOf(bodies, a), pose(b)));
    joints.back().kind->weigh(joints.back(), massBetween(bodies, a, b));
  }

  const Pose<D>& pose(int i) const { return bodies.pose[static_cast<std::size_t>(i)]; }
  const Motion<D>& motion(int i) const { return bodies.motion[static_cast<std::size_t>(i)]; }

  void solve(VelocityResolver<D>& resolver, const PositionResolver<D>& position) {
    resolver.solve(
        {dt, lastDt, bodies, manifolds, active, joints, position, model, kRestitutionThreshold, work, profiler});
  }
  /// One step; then contacts follow their anchors.
  void step(Solver<D>& solver) {
    NoDetection detect;
    graph.reset(bodies, manifolds, joints, work);
    for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
      bodies.invInertia[i] = rotateInertia(bodies.pose[i].q, bodies.invInertiaBody[i]);
    }
    solver.step({dt, lastDt, time, bodies, manifolds, active, joints, field, detect, model, kRestitutionThreshold, work,
                 profiler, graph});
    lastDt = dt, time += dt;
    for (Manifold<D>& m : manifolds) {
      for (int k = 0; k < m.count; ++k) {
        ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
        c.separation = separationNow(m, c, pose(m.bodyA), pose(m.bodyB));
      }
    }
  }

  // --- measured quantities ---
  Vec<D> momentum() const {
    Vec<D> sum = Vec<D>::Zero();
    for (int i = 0; i < bodies.size(); ++i) sum += bodies.mass[static_cast<std::size_t>(i)] * motion(i).v;
    return sum;
  }
  Inertia<D> inertia(int i) const {
    const Inertia<D>& inverse = bodies.invInertia[static_cast<std::size_t>(i)];
    return inverse.trace() > 0 ? Inertia<D>(inverse.inverse()) : Inertia<D>(Inertia<D>::Zero());
  }
  /// About the world's origin.
  Ang<D> angularMomentum() const {
    Ang<D> sum = Ang<D>::Zero();
    for (int i = 0; i < bodies.size(); ++i) {
      sum +=
          cross(pose(i).p, (bodies.mass[static_cast<std::size_t>(i)] * motion(i).v).eval()) + inertia(i) * motion(i).w;
    }
    return sum;
  }
  Real energy() const {
    Real sum = 0;
    for (int i = 0; i < bodies.size(); ++i) {
      sum += bodies.mass[static_cast<std::size_t>(i)] * motion(i).v.squaredNorm() / 2 +
             motion(i).w.dot(inertia(i) * motion(i).w) / 2;
    }
    return sum;
  }
  /// Velocity of B relative to A, midway between the anchors.
  Vec<D> contactVelocity(const Manifold<D>& m, const ContactPoint<D>& c) const {
    const Vec<D> p = (pose(m.bodyA) * c.localA + pose(m.bodyB) * c.localB) / 2;
    const auto at = [&](int i) -> Vec<D> { return motion(i).v + cross(motion(i).w, (p - pose(i).p).eval()); };
    return at(m.bodyB) - at(m.bodyA);
  }
  JointRows<D> rows(const JointRecord<D>& j) const {
    JointRows<D> out;
    jointRows(j, bodies, out);
    return out;
  }
  JointError jointError(const JointRecord<D>& j) const { return lpc::jointError(rows(j).all()); }
  Real rowVelocity(const JointRecord<D>& j, const ConstraintRow<D>& row) const {
    const Motion<D> a = j.bodyA < 0 ? Motion<D>{} : motion(j.bodyA);
    return rowSpeed(row, a.v, a.w, motion(j.bodyB).v, motion(j.bodyB).w);
  }
  /// Largest velocity (m/s, rad/s) along a rigid row.
  Real jointVelocity(const JointRecord<D>& j) const {
    Real worst = 0;
    const JointRows<D> now = rows(j);  // named: a loop over a part of a temporary would outlive it
    for (const ConstraintRow<D>& row : now.all()) {
      if (row.block == RowBlock::equality) worst = std::max(worst, std::abs(rowVelocity(j, row)));
    }
    return worst;
  }
  bool finite() const {
    for (int i = 0; i < bodies.size(); ++i) {
      const Pose<D>& x = pose(i);
      if (!x.p.allFinite() || !x.q.matrix().allFinite() || !motion(i).v.allFinite() || !motion(i).w.allFinite()) {
        return false;
      }
    }
    for (const Manifold<D>& m : manifolds) {
      for (int k = 0; k < m.count; ++k) {
        for (Real x : m.points[static_cast<std::size_t>(k)].impulse) {
          if (!std::isfinite(x)) return false;
        }
      }
    }
    for (const JointRecord<D>& j : joints) {
      for (Real x : j.impulse) {
        if (!std::isfinite(x)) return false;
      }
    }
    return true;
  }
  /// Scale to which speeds, momenta and energies of this scene are compared.
  Real speed() const {
    Real s = 1;
    for (int i = 0; i < bodies.size(); ++i) s = std::max({s, motion(i).v.norm(), motion(i).w.norm()});
    return s;
  }
};

/// The scene after one solve of velocities, without position correction.
template <int D>
ImpactScene<D> solved(ImpactScene<D> scene, VelocityResolver<D>& resolver) {
  const struct : PositionResolver<D> {
  } none;
  scene.solve(resolver, none);
  return scene;
}

template <int D>
std::ostream& operator<<(std::ostream& out, const ImpactScene<D>& s) {
  for (int i = 0; i < s.bodies.size(); ++i) {
    out << "body " << i << ": mass " << s.bodies.mass[static_cast<std::size_t>(i)] << ' ' << s.pose(i) << " v=("
        << s.motion(i).v.transpose() << ") w=(" << s.motion(i).w.transpose() << ")\n";
  }
  for (const Manifold<D>& m : s.manifolds) {
    out << m.bodyA << '-' << m.bodyB << " n=(" << m.normal.transpose() << ") mu=" << m.friction
        << " e=" << m.restitution;
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      out << " [separation " << c.separation << " impulse " << c.impulse[0] << ']';
    }
    out << '\n';
  }
  for (const JointRecord<D>& j : s.joints) {
    const JointError error = s.jointError(j);
    out << j.spec << ' ' << j.bodyA << '-' << j.bodyB << " error " << error.linear << " m " << error.angular
        << " rad\n";
  }
  return out;
}

struct Drawn {
  bool fixed = false;  // one body of infinite mass
  bool friction = false;
  Real restitution = 0;
  Real gap = 0;              // separations are drawn from [-gap, gap]
  bool approaching = false;  // turn normals so that every contact starts by closing
  int joints = 0;
  int contacts = 5;  // at most
};

/// Two to five bodies with contacts anywhere between them. The places of shapes do not matter.
template <int D>
ImpactScene<D> drawImpact(Draw& draw, const Drawn& wanted) {
  ImpactScene<D> s;
  const int n = 2 + draw.below(4);
  for (int i = 0; i < n; ++i) {
    Ang<D> inertia;
    for (int k = 0; k < kAngDim<D>; ++k) inertia[k] = draw.real(0.5, 2);
    Motion<D> motion;
    motion.v = 3 * drawVector<D>(draw);
    for (int k = 0; k < kAngDim<D>; ++k) motion.w[k] = 3 * draw.signedUnit();
    const Real mass = wanted.fixed && i == 0 ? Real(0) : draw.real(1, 5);
    s.add(mass, inertia, drawPose<D>(draw, 2), mass > 0 ? motion : Motion<D>{});
  }
  const auto pair = [&] {
    const int a = draw.below(n - 1);
    return std::pair(a, a + 1 + draw.below(n - 1 - a));
  };
  const int contacts = wanted.contacts > 0 ? 1 + draw.below(wanted.contacts) : 0;
  for (int k = 0; k < contacts; ++k) {
    const auto [a, b] = pair();
    const Vec<D> p = (s.pose(a).p + s.pose(b).p) / 2 + Real(0.7) * drawVector<D>(draw);
    const Real mu = wanted.friction ? draw.real(0, 1) : Real(0);
    s.touch(a, b, drawDirection<D>(draw), p, wanted.gap * draw.signedUnit(), mu, wanted.restitution);
    Manifold<D>& m = s.manifolds.back();
    if (wanted.approaching && s.contactVelocity(m, m.points[0]).dot(m.normal) > 0) m.normal = -m.normal;
  }
  for (int k = 0; k < wanted.joints; ++k) {
    const auto [a, b] = pair();
    s.join(a, b, (s.pose(a).p + s.pose(b).p) / 2 + Real(0.7) * drawVector<D>(draw), Vec<D>::Zero());
  }
  return s;
}

/// One step of the tested method.
template <int D>
using Step = std::function<void(ImpactScene<D>&)>;

}}}  // namespace lpc::LPC_PRECISION::test
