// SPDX-License-Identifier: Zlib
#include "framework/world/invariants.h"

#include <algorithm>
#include <cmath>

#include "framework/math/inverse_inertia.h"
#include "framework/math/worse.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <class Numbers>
bool areFinite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers), [](Real x) { return std::isfinite(x); });
}

template <int D>
bool bodyIsFinite(const Bodies<D>& b, std::size_t i) {
  return b.pose[i].p.allFinite() && b.motion[i].v.allFinite() && b.motion[i].w.allFinite() &&
         b.pose[i].q.matrix().allFinite();
}

template <int D>
bool jointIsFinite(const JointRecord<D>& joint, const JointError& error) {
  return std::isfinite(error.linear) && std::isfinite(error.angular) && areFinite(joint.impulse);
}

template <int D>
bool contactsAreFinite(const Simulation<D>& world) {
  for (const Manifold<D>& m : world.contacts().value_or(std::span<const Manifold<D>>())) {
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      if (!std::isfinite(c.separation) || !areFinite(c.impulse)) return false;
    }
  }
  return true;
}

}  // namespace

template <int D>
bool stateIsFinite(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (b.used[i] && !bodyIsFinite(b, i)) return false;
  }
  JointRows<D> rows;
  for (const JointRecord<D>& j : world.joints()) {
    jointRows(j, b, rows);
    if (!jointIsFinite(j, jointError(rows.all()))) return false;
  }
  return contactsAreFinite(world);
}

template <int D>
StateInvariants<D> stateInvariants(const Simulation<D>& world) {
  StateInvariants<D> out;
  const Bodies<D>& b = world.bodies();
  const Eigen::Matrix<double, D, 1> gravity = world.settings().gravity.template cast<double>();
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (!b.used[i]) continue;
    const Eigen::Matrix<double, D, 1> p = b.pose[i].p.template cast<double>();
    const Eigen::Matrix<double, D, 1> v = b.motion[i].v.template cast<double>();
    const Eigen::Matrix<double, kAngDim<D>, 1> w = b.motion[i].w.template cast<double>();
    out.finite = out.finite && bodyIsFinite(b, i);
    if (b.type[i] != BodyType::dynamic) continue;
    const double mass = b.mass[i];
    out.kinetic += 0.5 * mass * v.squaredNorm();
    out.potential -= mass * double(b.gravityScale[i]) * gravity.dot(p);
    out.momentum += mass * v;
    if constexpr (D == 2) {
      out.angularMomentum[0] += mass * (p[0] * v[1] - p[1] * v[0]);
    } else {
      out.angularMomentum += mass * p.cross(v);
    }
    if (b.invInertiaBody[i].trace() > 0) {
      using Turn = Eigen::Matrix<double, kAngDim<D>, kAngDim<D>>;
      const Turn inverse = rotateInertia(b.pose[i].q, b.invInertiaBody[i]).template cast<double>();
      const Eigen::Matrix<double, kAngDim<D>, 1> spin = inverseAtItsScale(inverse) * w;
      out.kinetic += 0.5 * w.dot(spin);
      out.angularMomentum += spin;
    }
    out.maxSpeed = worse(out.maxSpeed, v.norm());
  }
  JointRows<D> rows;
  for (const JointRecord<D>& j : world.joints()) {
    jointRows(j, b, rows);
    const JointError error = jointError(rows.all());
    out.jointError = worse(out.jointError, error.linear);
    out.jointTurn = worse(out.jointTurn, error.angular);
    out.finite = out.finite && jointIsFinite(j, error);
  }
  out.finite = out.finite && contactsAreFinite(world);
  return out;
}

template <int D>
ContactInvariants contactInvariants(const Simulation<D>& world) {
  ContactInvariants out;
  const auto manifolds = world.contacts();
  if (!manifolds) return out;
  out.maxPenetration = out.complementarity = out.coneExcess = 0;
  const Bodies<D>& b = world.bodies();
  const double dt = std::max<double>(world.lastDt(), 1e-300);
  double sum = 0;
  int points = 0;
  for (const Manifold<D>& m : *manifolds) {
    if (m.ignored) continue;
    const auto i = static_cast<std::size_t>(m.bodyA), j = static_cast<std::size_t>(m.bodyB);
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      const double depth = worse(0, -separationNow(m, c, b.pose[i], b.pose[j]));
      out.maxPenetration = worse(out.maxPenetration, depth);
      sum += depth;
      ++points;
      const Vec<D> vA = b.motion[i].v + cross(b.motion[i].w, b.pose[i].q * c.localA);
      const Vec<D> vB = b.motion[j].v + cross(b.motion[j].w, b.pose[j].q * c.localB);
      const double normal = c.impulse[0];
      double tangent = 0;
      for (std::size_t d = 1; d < D; ++d) tangent += double(c.impulse[d]) * double(c.impulse[d]);
      out.coneExcess = worse(out.coneExcess, std::sqrt(tangent) - m.friction * normal);
      if (m.restitution == 0) {  // a bouncing contact separates with an impulse
        const double closing = (vB - vA).dot(m.normal) + worse(0, c.separation) / dt;
        out.complementarity = worse(out.complementarity, std::abs(closing * normal));
      }
    }
  }
  out.meanPenetration = points ? sum / points : 0;
  return out;
}

template StateInvariants<2> stateInvariants(const Simulation<2>&);
template StateInvariants<3> stateInvariants(const Simulation<3>&);
template bool stateIsFinite(const Simulation<2>&);
template bool stateIsFinite(const Simulation<3>&);
template ContactInvariants contactInvariants(const Simulation<2>&);
template ContactInvariants contactInvariants(const Simulation<3>&);

}}  // namespace lpc::LPC_PRECISION
