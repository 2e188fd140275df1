// SPDX-License-Identifier: Zlib
// A plain velocity resolver with one planted bug at a time, and wrong integrators and position resolvers. The
// conformance tests must catch each bug and must find no fault with Bug::none.
#pragma once

#include <algorithm>

#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

enum class Bug {
  none,
  oneBodyOnly,        // the other body gets no impulse
  twoPoints,          // each body gets the impulse at its own place, not at a shared point
  addsEnergy,         // leaves faster than it arrived
  pulls,              // contacts pull
  frictionUnbounded,  // sticks at any normal impulse
  frictionForward,    // pushes along the sliding direction
  squareFriction,     // clamps along world axes instead of to a disc: depends on the frame
  keepsFirstImpulse,  // never reduces an impulse
  stopsEarly,         // does not solve joints
  hastens,            // accelerates bodies that already separate
  slowsInTheWorld,    // removes speed from bodies, not from contacts
  movesFixed,         // treats infinite mass as large mass
  armsOfTheWorld,     // computes torques about the world's origin
  turnsLeft,          // every impulse adds a little spin to the left
  yields,             // slightly too much response: a compliance in absolute units
  givesUp,            // stops after ten sweeps
  dividesByNothing    // no guard for immovable bodies
};

template <int D>
class TwinResolver final : public VelocityResolver<D> {
 public:
  TwinResolver(Bug bug, int iterations)
      : m_bug(bug), m_iterations(bug == Bug::givesUp ? std::min(iterations, 10) : iterations) {}

  void solve(const VelocityInput<D>& in) override {
    std::vector<Real> targets;
    for (int k : in.order) {
      Manifold<D>& m = in.manifolds[static_cast<std::size_t>(k)];
      for (int i = 0; i < m.count; ++i) {
        ContactPoint<D>& c = m.points[static_cast<std::size_t>(i)];
        c.impulse.fill(0);
        const Real v = relative(in.bodies, m, c).dot(m.normal);
        Real target = c.separation > 0 ? -c.separation / in.dt : Real(0);
        if (v < -in.restitutionThreshold && c.separation + v * in.dt <= 0) {
          target = std::max(target, -m.restitution * v);
          if (m_bug == Bug::addsEnergy) target = Real(-1.1) * v;
        }
        if (m_bug == Bug::hastens && v > 0) target = Real(1.5) * v;
        targets.push_back(target);
      }
    }
    for (int iteration = 0; iteration < m_iterations; ++iteration) {
      std::size_t t = 0;
      for (int k : in.order) {
        Manifold<D>& m = in.manifolds[static_cast<std::size_t>(k)];
        for (int i = 0; i < m.count; ++i) one(in, m, m.points[static_cast<std::size_t>(i)], targets[t++]);
      }
      for (JointRecord<D>& j : in.joints) {  // only the point, for any kind
        const Vec<D> p = (in.bodies.pose[slot(j.bodyA)] * j.X_CaJ.p + in.bodies.pose[slot(j.bodyB)] * j.X_CbJ.p) / 2;
        const Vec<D> v = velocity(in.bodies, j.bodyA, j.bodyB, p);
        if (m_bug == Bug::stopsEarly || !(v.norm() > 0)) continue;
        const Vec<D> along = v.normalized();  // steepest descent: independent of the world's axes
        const Vec<D> impulse = -mass(in.bodies, j.bodyA, j.bodyB, p, along) * v;
        apply(in.bodies, j.bodyA, j.bodyB, p, impulse);
        for (std::size_t i = 0; i < D; ++i) j.impulse[i] += impulse[static_cast<int>(i)];
      }
    }
  }

 private:
  static std::size_t slot(int body) { return static_cast<std::size_t>(body); }

  void one(const VelocityInput<D>& in, Manifold<D>& m, ContactPoint<D>& c, Real target) const {
    const Vec<D> p = middle(in.bodies, m, c);
    const Real k = mass(in.bodies, m.bodyA, m.bodyB, p, m.normal);
    const Real wanted = k * (target - relative(in.bodies, m, c).dot(m.normal));
    if (m_bug == Bug::slowsInTheWorld) in.bodies.motion[slot(m.bodyB)].v *= Real(0.99);
    const Real old = c.impulse[0];
    if (m_bug == Bug::keepsFirstImpulse) {
      c.impulse[0] = old + std::max(wanted, Real(0));
    } else {
      c.impulse[0] = m_bug == Bug::pulls ? old + wanted : std::max(old + wanted, Real(0));
    }
    apply(in.bodies, m.bodyA, m.bodyB, p, m.normal * (c.impulse[0] - old));
    if (!(m.friction > 0) || !in.model.friction) return;
    RealMatrix<D, D - 1> t = tangents(m.normal);
    RealMatrix<D - 1, 1> before, after;
    const Real step = leastMass(in.bodies, m.bodyA, m.bodyB, p);
    for (int d = 0; d < D - 1; ++d) before[d] = c.impulse[static_cast<std::size_t>(d) + 1];
    const Vec<D> v = relative(in.bodies, m, c);
    for (int d = 0; d < D - 1; ++d) {
      after[d] = before[d] - step * v.dot(t.col(d)) * (m_bug == Bug::frictionForward ? Real(-1) : Real(1));
    }
    const Real limit = m.friction * c.impulse[0];
    if (m_bug == Bug::squareFriction) {
      for (int d = 0; d < D - 1; ++d) after[d] = std::clamp(after[d], -limit, limit);
    } else if (m_bug != Bug::frictionUnbounded && after.norm() > limit) {
      after *= limit / after.norm();
    }
    for (int d = 0; d < D - 1; ++d) c.impulse[static_cast<std::size_t>(d) + 1] = after[d];
    apply(in.bodies, m.bodyA, m.bodyB, p, t * (after - before));
  }

  static Vec<D> middle(const Bodies<D>& bodies, const Manifold<D>& m, const ContactPoint<D>& c) {
    return (bodies.pose[slot(m.bodyA)] * c.localA + bodies.pose[slot(m.bodyB)] * c.localB) / 2;
  }
  static Vec<D> velocity(const Bodies<D>& bodies, int a, int b, const Vec<D>& p) {
    const auto at = [&](int i) -> Vec<D> {
      return bodies.motion[slot(i)].v + cross(bodies.motion[slot(i)].w, (p - bodies.pose[slot(i)].p).eval());
    };
    return at(b) - at(a);
  }
  static Vec<D> relative(const Bodies<D>& bodies, const Manifold<D>& m, const ContactPoint<D>& c) {
    return velocity(bodies, m.bodyA, m.bodyB, middle(bodies, m, c));
  }
  Real invMass(const Bodies<D>& bodies, int i) const {
    const Real w = bodies.invMass[slot(i)];
    return m_bug == Bug::movesFixed && !(w > 0) ? Real(1e-3) : w;
  }
  Real mass(const Bodies<D>& bodies, int a, int b, const Vec<D>& p, const Vec<D>& n) const {
    Real k = invMass(bodies, a) + invMass(bodies, b) + (m_bug == Bug::yields ? Real(0.01) : Real(0));
    for (int i : {a, b}) {
      const Ang<D> arm = cross((p - bodies.pose[slot(i)].p).eval(), n);
      k += arm.dot(bodies.invInertia[slot(i)] * arm);
    }
    return k > 0 || m_bug == Bug::dividesByNothing ? 1 / k : Real(0);
  }
  /// Less than the mass in every direction.
  Real leastMass(const Bodies<D>& bodies, int a, int b, const Vec<D>& p) const {
    Real k = invMass(bodies, a) + invMass(bodies, b);
    for (int i : {a, b}) k += (p - bodies.pose[slot(i)].p).squaredNorm() * bodies.invInertia[slot(i)].trace();
    return k > 0 || m_bug == Bug::dividesByNothing ? 1 / k : Real(0);
  }
  void apply(Bodies<D>& bodies, int a, int b, const Vec<D>& p, const Vec<D>& impulse) const {
    const Real sign[] = {-1, 1};
    const int body[] = {a, b};
    for (int s = 0; s < 2; ++s) {
      const auto i = slot(body[s]);
      if (s == 0 && m_bug == Bug::oneBodyOnly) continue;
      Vec<D> r = p - bodies.pose[i].p;
      if (m_bug == Bug::twoPoints) r *= Real(0.99);
      if (m_bug == Bug::armsOfTheWorld) r = p;
      if (m_bug == Bug::turnsLeft) bodies.motion[i].w[kAngDim<D> - 1] += Real(0.01) * impulse.norm();
      bodies.motion[i].v += sign[s] * invMass(bodies, body[s]) * impulse;
      bodies.motion[i].w += sign[s] * (bodies.invInertia[i] * cross(r, impulse));
    }
  }

  Bug m_bug;
  int m_iterations;
};

/// Applies forces and the planted resolver, and moves with the new velocity. Positions are not corrected.
template <int D>
class TwinSolver final : public Solver<D> {
 public:
  TwinSolver(Bug bug, int iterations) : m_resolver(bug, iterations) {}

  void step(const StepInput<D>& in) override {
    Bodies<D>& bodies = in.bodies;
    std::vector<Wrench<D>> wrenches(bodies.pose.size());
    in.forces.eval({bodies, bodies.pose, bodies.motion}, in.time, wrenches);
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      bodies.motion[i].v += (in.dt * bodies.invMass[i]) * wrenches[i].force;
    }
    const struct : PositionResolver<D> {
    } none;
    m_resolver.solve({in.dt, in.lastDt, bodies, in.manifolds, in.active, in.joints, none, in.model,
                      in.restitutionThreshold, in.work, in.profiler});
    for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
      if (bodies.type[i] == BodyType::fixed) continue;
      bodies.pose[i].p += in.dt * bodies.motion[i].v;
      bodies.pose[i].q = integrateRotation(bodies.pose[i].q, Ang<D>(in.dt * bodies.motion[i].w));
    }
  }

 private:
  TwinResolver<D> m_resolver;
};

/// Moves only one of two bodies apart, even a static one.
template <int D>
class PushesTheWrongBody final : public PositionResolver<D> {
 public:
  void correct(const PositionInput<D>& in) override {
    for (int k : in.order) {
      const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(k)];
      for (int i = 0; i < m.count; ++i) {
        const Real s = m.points[static_cast<std::size_t>(i)].separation;
        if (s < 0) in.bodies.pose[static_cast<std::size_t>(m.bodyA)].p += s * m.normal;
      }
    }
  }
};

/// Pulls separated bodies together and deepens penetration.
template <int D>
class WrongSign final : public PositionResolver<D> {
 public:
  void correct(const PositionInput<D>& in) override {
    for (int k : in.order) {
      const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(k)];
      const auto a = static_cast<std::size_t>(m.bodyA), b = static_cast<std::size_t>(m.bodyB);
      in.bodies.pose[a].p += Real(0.001) * in.bodies.invMass[a] * m.normal;
      in.bodies.pose[b].p -= Real(0.001) * in.bodies.invMass[b] * m.normal;
    }
    for (const JointRecord<D>& j : in.joints) {
      const auto a = static_cast<std::size_t>(j.bodyA), b = static_cast<std::size_t>(j.bodyB);
      const Vec<D> error = in.bodies.pose[b] * j.X_CbJ.p - in.bodies.pose[a] * j.X_CaJ.p;
      in.bodies.pose[b].p += Real(0.1) * error;
    }
  }
};

}}}  // namespace lpc::LPC_PRECISION::test
