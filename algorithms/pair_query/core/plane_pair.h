// SPDX-License-Identifier: Zlib
// A plane and a bounded shape: the plane's normal is the only candidate direction, so one support point answers
// exactly.
#pragma once

#include "algorithms/pair_query/core/touching.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// True when one of the kinds is unbounded. Then every method uses PlanePair.
inline bool hasPlane(ShapeKind a, ShapeKind b) {
  return coreClass(a) == CoreClass::plane || coreClass(b) == CoreClass::plane;
}

/// Plane against plane has no depth: no method supports it.
inline bool supportsPlane(ShapeKind a, ShapeKind b) {
  return (coreClass(a) == CoreClass::plane) != (coreClass(b) == CoreClass::plane);
}

template <int D>
class PlanePair {
 public:
  /// The pair's answer; if closest points are wanted, the middle of the feature that faces the plane. Exact except for
  /// rounding.
  PairAnswer<D> answer(const CorePair<D>& pair, QueryNeed need, WorkDone& work) {
    const bool planeB = pair.b.core() == CoreClass::plane;
    const ShapeView<D>& body = planeB ? pair.a : pair.b;
    // Out of the half-space, and the height of the frame's origin, in the body's frame.
    Vec<D> up = planeB ? Vec<D>(pair.r.col(1)) : Vec<D>(pair.r.row(1).transpose());
    makeUnit<D>(up);
    const Real origin = planeB ? -up.dot(pair.p) : pair.p[1];
    ++work[WorkCount::supportCalls];
    const Real lowest = coreSupport(body, Vec<D>(-up)).dot(up) - body.radius;
    PairAnswer<D> answer;
    answer.status = QueryStatus::converged;
    answer.distance = lowest + origin;
    answer.normal = planeB ? Vec<D>(-up) : Vec<D>(pair.r * up);
    if (need != QueryNeed::closestPoints) return answer;
    supportingVertices<D>(body, -up, kFeatureBand * pair.scale, m_vertices, work);
    Vec<D> middle = Vec<D>::Zero();
    for (const Vec<D>& v : m_vertices) middle += v / static_cast<Real>(m_vertices.size());
    const Vec<D> onBody = middle + (lowest - middle.dot(up)) * up, onPlane = onBody - answer.distance * up;
    if (planeB) {
      answer.pA = onBody, answer.pB = onPlane;
    } else {  // A is the plane: back into A's frame
      answer.pA = pair.p + pair.r * onPlane, answer.pB = pair.p + pair.r * onBody;
    }
    return answer;
  }

 private:
  std::vector<Vec<D>> m_vertices;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
