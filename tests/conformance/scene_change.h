// SPDX-License-Identifier: Zlib
// The same scene for another observer: displaced, moving past, in a mirror, or with another unit of mass. Physics is
// invariant; an algorithm that is not contains something absolute.
#pragma once

#include "tests/check_property.h"
#include "tests/conformance/impact_scene.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Fails the property and shows both scenes if the error exceeds the limit.
template <int D>
void require(Real error, Real limit, const ImpactScene<D>& expected, const ImpactScene<D>& found) {
  if (!(error <= limit)) RC_LOG() << "error " << error << "\nexpected\n" << expected << "found\n" << found;
  RC_ASSERT(error <= limit);
}

/// The same for a condition; `value` is the compared quantity.
template <int D>
void require(bool holds, const ImpactScene<D>& before, const ImpactScene<D>& after, Real value) {
  if (!holds) RC_LOG() << "value " << value << "\nbefore\n" << before << "after\n" << after;
  RC_ASSERT(holds);
}

/// Seen from a frame in which the old one has pose X, moving with -boost (m/s, old axes). Static bodies then move, too.
template <int D>
ImpactScene<D> moved(ImpactScene<D> s, const Pose<D>& X, const Vec<D>& boost) {
  for (std::size_t i = 0; i < s.bodies.pose.size(); ++i) {
    Motion<D>& motion = s.bodies.motion[i];
    s.bodies.pose[i] = X * s.bodies.pose[i];
    motion.v = X.q * (motion.v + boost);
    if constexpr (D == 3) motion.w = X.q * motion.w;
    s.bodies.invInertia[i] = rotateInertia(s.bodies.pose[i].q, s.bodies.invInertiaBody[i]);
    if (s.bodies.type[i] == BodyType::fixed && !boost.isZero(0)) s.bodies.type[i] = BodyType::kinematic;
  }
  for (Manifold<D>& m : s.manifolds) m.normal = X.q * m.normal;
  for (JointRecord<D>& j : s.joints) {  // of a cold joint, or a pivot: its rows lie along the world's axes
    for (auto* kept : {&j.impulse, &j.memory}) {
      Eigen::Map<Vec<D>> rows(kept->data());
      rows = (X.q * Vec<D>(rows)).eval();
    }
  }
  s.field.gravity = X.q * s.field.gravity;
  return s;
}

inline void mirror(Vec<2>& v) { v[0] = -v[0]; }
inline void mirror(Vec<3>& v) { v[0] = -v[0]; }
inline void mirrorTurn(Ang<2>& w) { w = -w; }
inline void mirrorTurn(Ang<3>& w) { w[1] = -w[1], w[2] = -w[2]; }
inline void mirror(Rot<2>& q) { q.s = -q.s; }
inline void mirror(Rot<3>& q) { q.y = -q.y, q.z = -q.z; }

/// x becomes -x, in the world and in every body. Inertias along the axes stay.
template <int D>
ImpactScene<D> mirrored(ImpactScene<D> s) {
  for (std::size_t i = 0; i < s.bodies.pose.size(); ++i) {
    mirror(s.bodies.pose[i].p), mirror(s.bodies.pose[i].q);
    mirror(s.bodies.motion[i].v), mirrorTurn(s.bodies.motion[i].w);
    s.bodies.invInertia[i] = rotateInertia(s.bodies.pose[i].q, s.bodies.invInertiaBody[i]);
  }
  for (Manifold<D>& m : s.manifolds) {
    mirror(m.normal);
    for (ContactPoint<D>& c : m.points) mirror(c.localA), mirror(c.localB);
  }
  for (JointRecord<D>& j : s.joints) {  // of a cold joint, or a pivot
    for (Pose<D>* X : {&j.X_CaJ, &j.X_CbJ}) mirror(X->p), mirror(X->q);
    j.impulse[0] = -j.impulse[0];
  }
  mirror(s.field.gravity);
  return s;
}

/// All masses k times as large.
template <int D>
ImpactScene<D> heavier(ImpactScene<D> s, Real k) {
  for (std::size_t i = 0; i < s.bodies.pose.size(); ++i) {
    s.bodies.mass[i] *= k, s.bodies.invMass[i] /= k;
    s.bodies.invInertiaBody[i] /= k, s.bodies.invInertia[i] /= k;
  }
  for (JointRecord<D>& j : s.joints) j.kind->weigh(j, massBetween(s.bodies, j.bodyA, j.bodyB));
  return s;
}

/// Differences of position (m), attitude, speed (m/s) and angular speed (rad/s), summed over the bodies from `first`
/// on. NaN stays NaN.
template <int D>
Real difference(const ImpactScene<D>& a, const ImpactScene<D>& b, int first = 0) {
  Real d = 0;
  for (int i = first; i < a.bodies.size(); ++i) {
    d += (a.pose(i).p - b.pose(i).p).norm() + (a.pose(i).q.matrix() - b.pose(i).q.matrix()).norm() +
         (a.motion(i).v - b.motion(i).v).norm() + (a.motion(i).w - b.motion(i).w).norm();
  }
  return d;
}

}}}  // namespace lpc::LPC_PRECISION::test
