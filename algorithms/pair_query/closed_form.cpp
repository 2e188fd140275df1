// SPDX-License-Identifier: Zlib
#include <array>

#include "algorithms/pair_query/core/plane_pair.h"
#include "algorithms/pair_query/core/point_round.h"
#include "algorithms/pair_query/core/thin_triangle.h"
#include "algorithms/pair_query/lanes/pair_lanes.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace pair_query;

// Closed forms for points, segments and boxes (except box against box), points and segments against triangles, and
// points against cylinders and cones: the closest points directly, the deepest axis from the few candidates. Near
// contact the difference of the closest points, and so its direction, is mostly rounding. Only then are the axes tested
// too, and the best proved bound wins (core_pair.h).
template <int D>
class ClosedForm final : public PairQuery<D> {
 public:
  struct Params {
    LaneUse lanes = LaneUse::automatic;
    void visit(ParamVisitor& v) { visitLanes(v, lanes); }
  };
  explicit ClosedForm(const Params& params) : m_lanes(params.lanes) {}

  static AlgorithmInfo info() {
    return {.name = "closed_form",
            .summary =
                "formulas for rounded points and segments with each other, boxes and triangles, points with cylinders "
                "and cones, and for planes",
            .paper = "ericson2004",
            .complexity = "O(1)"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    if (hasPlane(a, b)) return supportsPlane(a, b);
    const CoreClass first = coreClass(a), second = coreClass(b);
    const bool thin = first == CoreClass::point || first == CoreClass::segment;
    if (b == ShapeKind::triangle) return thin;
    if (b == ShapeKind::cylinder || b == ShapeKind::cone) return first == CoreClass::point;
    return thin && (second == CoreClass::point || second == CoreClass::segment || second == CoreClass::box);
  }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory>, WorkDone& work) override {
    work[WorkCount::pairQueries] += pairs.size();
    if (pairs.empty()) return;
    forMostInLanes<D>(
        m_lanes, pairs, answers,
        [&](std::span<const PairView<3>> some, std::span<PairAnswer<3>> out) { return inLanes(some, need, out, work); },
        [&](std::span<const PairView<D>> some, std::span<PairAnswer<D>> out) { oneByOne(some, need, out, work); });
  }

 private:
  static std::uint64_t inLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
                               WorkDone& work) {
    const CoreClass classA = pairs[0].a.core(), classB = pairs[0].b.core();
    if (classB == CoreClass::point) return ballsInLanes(pairs, answers);
    if (classA == CoreClass::segment && classB == CoreClass::segment)
      return segmentsInLanes(pairs, need, answers, work);
    return ~std::uint64_t{0};
  }

  void oneByOne(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers, WorkDone& work) {
    const CoreClass classA = pairs[0].a.core(), classB = pairs[0].b.core();
    const bool pointA = classA == CoreClass::point;
    if (classB == CoreClass::point) return balls(pairs, answers);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const CorePair<D> pair(pairs[i]);
      if (hasPlane(pair.a.kind, pair.b.kind)) {
        answers[i] = m_plane.answer(pair, need, work);
        continue;
      }
      BestAxis<D> best;
      if (classB == CoreClass::box) {
        pointA ? pointBox(pair, best) : segmentBox(pair, best, work);
      } else if (classB == CoreClass::curved || classB == CoreClass::hull) {
        if constexpr (D == 3) classB == CoreClass::hull ? thinTriangle(pair, best, work) : pointRound(pair, best, work);
      } else {
        pointA ? pointSegment(pair, best, work) : segmentSegment(pair, need, best, work);
      }
      answers[i] = answerFrom<D>(pair, best, QueryStatus::converged, need, m_touching, work);
    }
  }

  // Takes the direction of v = pB - pA if it proves the distance |v| as far as rounding lets it.
  static bool proves(const CorePair<D>& pair, const Vec<D>& v, BestAxis<D>& best, WorkDone& work) {
    Vec<D> n = v;
    if (!makeUnit<D>(n)) return false;
    ++work[WorkCount::axisTests];
    best.take(n, pair.bound(n));
    return best.bound >= v.norm() - kBoundRounding * pair.scale;
  }

  // Tries directions perpendicular to the unit vector u, and the component of v perpendicular to u.
  static void tryPerpendicular(const CorePair<D>& pair, const Vec<D>& u, Vec<D> v, BestAxis<D>& best, WorkDone& work) {
    removeAlong<D>(v, u);
    best.tryDirection(pair, v, work);
    const auto t = tangents(u);
    for (int k = 0; k < D - 1; ++k) {
      best.tryDirection(pair, t.col(k), work);
      best.tryDirection(pair, -t.col(k), work);
    }
  }

  static void balls(std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Vec<D>& p = pairs[i].X_AB.p;
      PairAnswer<D>& out = answers[i];
      out.normal = p;
      if (!makeUnit<D>(out.normal)) out.normal = Vec<D>::Unit(0);  // concentric: every direction is correct
      out.distance = out.normal.dot(p) - pairs[i].a.radius - pairs[i].b.radius;
      out.status = std::isfinite(out.distance) ? QueryStatus::converged : QueryStatus::failed;
      out.pA = pairs[i].a.radius * out.normal;
      out.pB = p - pairs[i].b.radius * out.normal;
    }
  }

  static void pointSegment(const CorePair<D>& pair, BestAxis<D>& best, WorkDone& work) {
    const Vec<D> u = pair.r.col(0);
    const Vec<D> v = pair.p + std::clamp(-pair.p.dot(u), -pair.b.half[0], pair.b.half[0]) * u;
    if (!proves(pair, v, best, work)) tryPerpendicular(pair, u, v, best, work);
  }

  static void pointBox(const CorePair<D>& pair, BestAxis<D>& best) {
    const Vec<D> q = -(pair.r.transpose() * pair.p);  // the point in the box's frame
    const Vec<D> excess = q - q.cwiseMax(-pair.b.half).cwiseMin(pair.b.half);
    Vec<D> n = -excess;  // exactly zero along the slabs that contain the point: no component is noise
    if (makeUnit<D>(n)) return best.take(pair.r * n, excess.norm());
    int k = 0;
    for (int d = 1; d < D; ++d) {
      if (std::abs(q[d]) - pair.b.half[d] > std::abs(q[k]) - pair.b.half[k]) k = d;
    }
    best.take(q[k] > 0 ? Vec<D>(-pair.r.col(k)) : Vec<D>(pair.r.col(k)), std::abs(q[k]) - pair.b.half[k]);
  }

  static void segmentSegment(const CorePair<D>& pair, QueryNeed need, BestAxis<D>& best, WorkDone& work) {
    const Vec<D>&p = pair.p, u = pair.r.col(0);
    const Real lA = pair.a.half[0], lB = pair.b.half[0];
    const Vec<D> v = segmentGap<D>(p, u, lA, lB);
    if (proves(pair, v, best, work)) return;
    // A boolean query is decided where the difference is clearly shorter than the radii.
    if (need == QueryNeed::boolean && best.bound > -std::numeric_limits<Real>::infinity() &&
        (best.bound > pair.radii() || v.norm() + kBoundRounding * pair.scale < pair.radii())) {
      return;
    }
    tryPerpendicular(pair, Vec<D>::Unit(0), v, best, work);
    tryPerpendicular(pair, u, v, best, work);
    if constexpr (D == 3) {
      const Vec<D> common(0, -u[2], u[1]);
      best.tryDirection(pair, common, work);
      best.tryDirection(pair, -common, work);
    }
    for (const Real end : {-lB, lB}) {
      Vec<D> toEnd = p + end * u;
      toEnd[0] -= std::clamp(toEnd[0], -lA, lA);
      best.tryDirection(pair, toEnd, work);
    }
    for (const Real end : {-lA, lA}) {
      const Vec<D> toB = p - end * Vec<D>::Unit(0);
      best.tryDirection(pair, toB + std::clamp(-toB.dot(u), -lB, lB) * u, work);
    }
  }

  // The squared distance of a point of the segment from the box is convex and piecewise quadratic along the segment.
  // Its slope is piecewise linear, with breaks only where the segment's line crosses a plane of a face.
  static void segmentBox(const CorePair<D>& pair, BestAxis<D>& best, WorkDone& work) {
    const Vec<D> c = -(pair.r.transpose() * pair.p), u = pair.r.row(0).transpose(), &h = pair.b.half;
    const Real l = pair.a.half[0];
    const auto excess = [&](Real t) {
      const Vec<D> q = c + t * u;
      return Vec<D>(q - q.cwiseMax(-h).cwiseMin(h));
    };
    const auto slope = [&](Real t) { return excess(t).dot(u); };
    Real lo = -l, hi = l, slopeLo = slope(lo), slopeHi = slope(hi);
    for (int k = 0; k < D; ++k) {
      for (const Real face : {-h[k], h[k]}) {
        const Real t = (face - c[k]) / u[k];  // not finite or far away when the segment runs along the face
        if (!(t > lo && t < hi)) continue;
        const Real s = slope(t);
        s < 0 ? (lo = t, slopeLo = s) : (hi = t, slopeHi = s);
      }
    }
    Real t = lo;
    if (slopeLo < 0) t = slopeHi > 0 ? lo + (hi - lo) * (slopeLo / (slopeLo - slopeHi)) : hi;
    const Vec<D> v = -(pair.r * excess(t));
    if (proves(pair, v, best, work)) return;
    const Vec<D> inBox = -excess(t);
    tryPerpendicularWithinBox(pair, inBox, u, best, work);
    for (int k = 0; k < D; ++k) {
      best.tryDirection(pair, pair.r.col(k), work);
      best.tryDirection(pair, -pair.r.col(k), work);
      if constexpr (D == 3) {
        const Vec<D> common = Vec<D>::Unit(0).cross(pair.r.col(k));
        best.tryDirection(pair, common, work);
        best.tryDirection(pair, -common, work);
      }
    }
    if constexpr (D == 2) {
      best.tryDirection(pair, Vec<D>(0, 1), work);
      best.tryDirection(pair, Vec<D>(0, -1), work);
    }
    for (const Real end : {-l, l}) best.tryDirection(pair, -(pair.r * excess(end)), work);
  }

  // The component of v perpendicular to u, with exact zeros kept: it stays in the cone of the box's feature.
  static void tryPerpendicularWithinBox(const CorePair<D>& pair, Vec<D> v, Vec<D> u, BestAxis<D>& best,
                                        WorkDone& work) {
    for (int k = 0; k < D; ++k) u[k] = v[k] == 0 ? 0 : u[k];
    if (!makeUnit<D>(u)) return;
    removeAlong<D>(v, u);
    best.tryDirection(pair, pair.r * v, work);
  }

  LaneUse m_lanes;
  PlanePair<D> m_plane;
  TouchingPoint m_touching;
};

}  // namespace

LPC_REGISTER(PairQuery, ClosedForm, 2, 3);

}}  // namespace lpc::LPC_PRECISION
