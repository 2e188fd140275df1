// SPDX-License-Identifier: Zlib
// What two moving shapes can do along a direction n, the whole step long. With S_n(t) their separation along n (S_n <=
// phi, and equal for the n of phi),
//
//   S_n(t + h) >= S_n(t) - closingSpeed(n) h                                   n still in the world (Mirtich 1996)
//   S_n(s) >= chord of S_n from t to u - bend / 2 (s - t)(u - s)          t <= s <= u, n still in a frame
//
// since the place of each point along n is a function with that slope, or that second derivative, at most, and S_n is
// the least of such functions. A frame may be the world or one of the bodies: the normal of a face turns with its body.
#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/time_of_impact/tolerances.h"
#include "framework/shape/support_map.h"
#include "framework/stage/stage_time_of_impact.h"

namespace lpc { inline namespace LPC_PRECISION { namespace continuous {

enum class AxisFrame { world, bodyA, bodyB };

template <int D>
class MotionBounds {
 public:
  explicit MotionBounds(const MovingPair<D>& pair)
      : m_pair(pair),
        m_reachA(reach(pair.a, pair.A)),
        m_reachB(reach(pair.b, pair.B)),
        m_turnA(pair.A.motion.w.norm()),
        m_turnB(pair.B.motion.w.norm()),
        m_speed((pair.A.motion.v - pair.B.motion.v).norm()) {}

  /// The largest rate (m/s) at which S_n can fall, n a unit vector fixed in the world; negative if it certainly rises.
  Real closingSpeed(const Vec<D>& n) const {
    return (m_pair.A.motion.v - m_pair.B.motion.v).dot(n) + cross(m_pair.A.motion.w, n).norm() * m_reachA +
           cross(m_pair.B.motion.w, n).norm() * m_reachB;
  }

  /// Whether an axis may be fixed in this body's frame as an alternative to the world's. A plane separates along its
  /// own normal alone, which does not turn with the other body.
  bool turns(AxisFrame frame) const {
    if (m_pair.a.core() == CoreClass::plane || m_pair.b.core() == CoreClass::plane) return false;
    return frame == AxisFrame::bodyA ? m_turnA > 0 : frame == AxisFrame::bodyB ? m_turnB > 0 : false;
  }

  /// The largest second derivative (m/s^2) of a point along any n fixed in this frame, from t to `end`. In a frame that
  /// turns by w, for a point at d from its centre: w^2 d + 2 w d' + d''.
  Real bend(AxisFrame frame, Real t, Real end) const {
    const Real ofA = m_turnA * m_turnA * m_reachA, ofB = m_turnB * m_turnB * m_reachB;
    const Real apart = (m_pair.B.bodyAt(t).p - m_pair.A.bodyAt(t).p).norm() + m_speed * (end - t);
    switch (frame) {
      case AxisFrame::world:
        break;
      case AxisFrame::bodyA:
        return m_turnA * m_turnA * (apart + m_reachB) + 2 * m_turnA * (m_speed + m_turnB * m_reachB) + ofB;
      case AxisFrame::bodyB:
        return m_turnB * m_turnB * (apart + m_reachA) + 2 * m_turnB * (m_speed + m_turnA * m_reachA) + ofA;
    }
    return ofA + ofB;
  }

  /// S at time t (m) along an axis of this frame that was n, a unit vector, in the world at time t0.
  Real separation(AxisFrame frame, const Vec<D>& n, Real t0, Real t) const {
    const Pose<D> X_WA = m_pair.A.bodyAt(t), X_WB = m_pair.B.bodyAt(t);
    Vec<D> now = n;
    if (frame == AxisFrame::bodyA) now = X_WA.q * (m_pair.A.bodyAt(t0).q.inverse() * n);
    if (frame == AxisFrame::bodyB) now = X_WB.q * (m_pair.B.bodyAt(t0).q.inverse() * n);
    const Rot<D> R_WA = X_WA.q * m_pair.A.X_CS.q, R_WB = X_WB.q * m_pair.B.X_CS.q;
    const Vec<D> centers = (X_WB.p - X_WA.p) + (X_WB.q * m_pair.B.X_CS.p - X_WA.q * m_pair.A.X_CS.p);
    return now.dot(centers) - along(m_pair.a, R_WA, now) - along(m_pair.b, R_WB, -now);
  }

  /// The pair's largest coordinate at this answer (m): the scale of rounding and tolerances.
  Real size(const PairView<D>& view) const {
    const auto extent = [](const ShapeView<D>& s) {
      return s.core() == CoreClass::plane ? Real(0) : s.half.maxCoeff() + s.radius;
    };
    return std::max({extent(view.a), extent(view.b), view.X_AB.p.cwiseAbs().maxCoeff()});
  }

 private:
  // Largest distance (m) of a point of the core from the centre of rotation. A rounding turns with its core and is the
  // same all around.
  static Real reach(const ShapeView<D>& shape, const ShapeMotion<D>& motion) {
    if (shape.core() == CoreClass::plane) return 0;  // its body is fixed
    return motion.X_CS.p.norm() + (boundingRadius(shape) - shape.radius);
  }
  // Support value h(n) of a shape in world directions; of a plane along its own normal, since a plane is unbounded in
  // all other directions.
  static Real along(const ShapeView<D>& shape, const Rot<D>& R_WS, const Vec<D>& n) {
    return shape.core() == CoreClass::plane ? Real(0) : supportValue(shape, Vec<D>(R_WS.inverse() * n));
  }

  const MovingPair<D>& m_pair;
  Real m_reachA, m_reachB;         // m
  Real m_turnA, m_turnB, m_speed;  // rad/s, m/s
};

/// State from which a method continues: the gap at a time, less half of the contact band, its normal in the world, and
/// how fast the gap can close along the normal.
template <int D>
struct GapSeen {
  Real gap, band;  // m
  Vec<D> n;
  Real speed;  // m/s
};

/// Queries the gap at out.t and writes the resulting state. Returns false if the method cannot continue: contact, a
/// failed query, or a gap without a number, a direction or a speed.
template <int D>
bool look(PairQuery<D>& query, const MovingPair<D>& pair, const MotionBounds<D>& bounds, Real tolerance,
          PairMemory& memory, TimeOfImpactAnswer<D>& out, GapSeen<D>& seen, WorkDone& work) {
  LPC_ASSERT(pair.a.core() != CoreClass::plane || pair.A.motion.w.isZero(0));
  LPC_ASSERT(pair.b.core() != CoreClass::plane || pair.B.motion.w.isZero(0));
  const PairView<D> view = pair.at(out.t);
  const auto ask = [&](QueryNeed need) { query.query({&view, 1}, need, {&out.there, 1}, {&memory, 1}, work); };
  ask(QueryNeed::distance);
  out.status = out.there.status;
  if (out.status == QueryStatus::failed || out.status == QueryStatus::refused) return false;
  seen.band = tolerance * bounds.size(view);
  out.hit = std::isfinite(out.there.distance) && out.there.distance <= seen.band;
  if (out.hit) {
    ask(QueryNeed::closestPoints);
    return false;
  }
  seen.gap = out.there.distance - seen.band / 2;  // so that rounding does not cross contact
  seen.n = pair.A.bodyAt(out.t).q * (pair.A.X_CS.q * out.there.normal);
  seen.speed = bounds.closingSpeed(seen.n);
  const bool directed = std::abs(seen.n.squaredNorm() - 1) < kUnitTolerance * 16;
  if (!std::isfinite(seen.gap) || !directed || !std::isfinite(seen.speed)) {
    out.status = QueryStatus::failed;
    return false;
  }
  return true;
}

}}}  // namespace lpc::LPC_PRECISION::continuous
