// SPDX-License-Identifier: Zlib
// The search of gjk_epa, shared by the answers (gjk_epa.cpp) and the traced search (traced.cpp).
#pragma once

#include <utility>

#include "algorithms/pair_query/core/plane_pair.h"
#include "algorithms/pair_query/gjk/curved_polish.h"
#include "algorithms/pair_query/gjk/epa3.h"
#include "algorithms/pair_query/gjk/gjk_cache.h"
#include "algorithms/pair_query/gjk/gjk_johnson.h"
#include "algorithms/pair_query/gjk/gjk_signed_volumes.h"
#include "algorithms/pair_query/gjk/local_features.h"
#include "framework/stage/pair_trace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D>
struct GjkEpaParams {
  enum class SimplexRule { voronoi, johnson, signedVolumes };
  enum class Accelerate { none, nesterov };
  enum class Gap { best, last };
  enum class Measure { size, distance };
  enum class Support { scan, climb };
  SimplexRule simplex = SimplexRule::voronoi;
  Accelerate accelerate = Accelerate::none;
  Gap gap = Gap::best;
  Measure measure = Measure::size;
  Support support = Support::scan;
  Real tolerance = 0;
  Real depthTolerance = 0;
  int iterations = 64;
  int expansions = 100000;
  int faces = 1024;
  void visit(ParamVisitor& v) {
    v.choice("simplex", simplex, {"voronoi", "johnson", "signed_volumes"},
             "how GJK finds the closest point of its simplex: Voronoi regions (Ericson 2004), cofactors (Gilbert et "
             "al. 1988) or signed volumes (Montanari et al. 2017)");
    v.choice("accelerate", accelerate, {"none", "nesterov"},
             "Nesterov momentum for the search directions (Montaut et al. 2022), until they stop improving");
    v.choice("gap", gap, {"best", "last"},
             "lower bound in GJK's stopping test: the best bound so far (van den Bergen 2003), or that of the last "
             "direction, the Frank-Wolfe duality gap (Montaut et al. 2022)");
    v.choice("measure", measure, {"size", "distance"},
             "what the tolerances are relative to: the pair's largest coordinate, or the distance or depth itself");
    if constexpr (D == 3) {
      v.choice("support", support, {"scan", "climb"},
               "search for a 3D hull's support point: scan of all vertices, or hill climbing along edges (Cameron "
               "1997); same result");
    }
    v.real("tolerance", tolerance, 0, Real(0.1), "1",
           "allowed gap of the distance or depth, relative to `measure`; at least eight roundings of the largest "
           "coordinate",
           ParamRole::tolerance);
    v.real("depth_tolerance", depthTolerance, 0, Real(0.1), "1",
           "allowed gap of EPA's depth, relative to `measure`; at least `tolerance`", ParamRole::tolerance);
    v.integer("iterations", iterations, 1, 10000, "support points of GJK", ParamRole::effort);
    v.integer("expansions", expansions, 0, 100000, "support points that EPA adds", ParamRole::effort);
    v.integer("faces", faces, 8, 100000, "largest number of EPA faces");
  }
};

/// PairQuery::trace.
template <int D>
void traceGjkEpa(const GjkEpaParams<D>& params, const PairView<D>& pair, PairTrace<D>& out);

// Internal linkage; otherwise it is not inlined (+4 % instructions).
namespace {

// Distance of the cores by GJK (Gilbert, Johnson, Keerthi 1988), depth by EPA (van den Bergen 2001), radii by
// subtraction. Both only propose directions: the result is the bound that the best of them proves (core_pair.h), and
// the difference to the length of GJK's vector decides when to stop. If GJK cannot close that difference because its
// vector is mostly rounding, EPA continues from its simplex, whichever side of the surface the origin is on.
template <int D, class Watch>
class GjkEpaSearch {
 public:
  using Params = GjkEpaParams<D>;

  explicit GjkEpaSearch(const Params& params, const Watch& watch = {})
      : m_params(params), m_watch(watch), m_epa(watch) {}

  /// `memory` may be null.
  PairAnswer<D> answer(const PairView<D>& view, QueryNeed need, PairMemory* memory, WorkDone& work) {
    CorePair<D> pair(view);
    if (hasPlane(pair.a.kind, pair.b.kind)) return m_plane.answer(pair, need, work);
    std::array<int, 2> climb{};
    if (m_params.support == Support::climb) pair.climb = &climb;
    if constexpr (D == 3) {
      if (!pair.climb && pair.a.core() == CoreClass::hull && pair.b.core() == CoreClass::hull) {
        m_hulls.begin(pair.a.hull->vertices, pair.b.hull->vertices);
        pair.hulls = &m_hulls;
      }
    }
    BestAxis<D> best;
    const QueryStatus status = search(pair, need, memory, best, work);
    if (memory) m_cache.remember(best.n, m_last, *memory);
    const Real left = allowedToLeave(pair, best.bound);
    const bool settles = (pair.a.curved || pair.b.curved) && need == QueryNeed::closestPoints;
    const bool first = left <= kShallow * pair.scale;  // Newton's steps are cheaper than expanding for so little
    if (settles && first) m_polish.settle(pair, best, work);
    m_watch([&](auto& t) { t.refined(pair, best, "final refinement on features and curved cores"); });
    PairAnswer<D> out = answerFrom<D>(pair, best, status, need, m_touching, work, left);
    if (settles && !first && !m_touching.met()) {
      m_polish.settle(pair, best, work);
      out = answerFrom<D>(pair, best, status, need, m_touching, work, left);
    }
    m_watch([&](auto& t) { t.refined(pair, best, "between the touching features"); });
    return out;
  }

 private:
  using SimplexRule = typename Params::SimplexRule;
  using Accelerate = typename Params::Accelerate;
  using Gap = typename Params::Gap;
  using Measure = typename Params::Measure;
  using Support = typename Params::Support;

  // The error (m) of a distance or depth that the tolerances allow; 0: rounding only.
  Real allowedToLeave(const CorePair<D>& pair, Real bound) const {
    const Real part = bound > 0 ? m_params.tolerance : std::max(m_params.tolerance, m_params.depthTolerance);
    const Real whole = m_params.measure == Measure::size ? pair.scale : std::abs(bound);
    return std::isfinite(whole) ? part * whole : 0;
  }

  // The normals of flat caps: across them the bound has a crease, which steps approach without reaching it.
  static void tryCaps(const CorePair<3>& pair, BestAxis<3>& best, WorkDone& work) {
    const auto hasCap = [](ShapeKind kind) { return kind == ShapeKind::cylinder || kind == ShapeKind::cone; };
    const Vec<3> axes[2] = {Vec<3>::Unit(0), pair.r.col(0)};
    for (int i = 0; i < 2; ++i) {
      if (!hasCap((i == 0 ? pair.a : pair.b).kind)) continue;
      best.tryDirection(pair, axes[i], work);
      best.tryDirection(pair, -axes[i], work);
    }
  }

  Vec<D> firstDirection(const CorePair<D>& pair) const {
    Vec<D> n = m_cache.direction();
    if (makeUnit<D>(n)) return n;
    n = pair.p;
    if (!makeUnit<D>(n)) n = Vec<D>::Unit(0);
    return n;
  }

  bool nearestPoint(const Simplex<D>& simplex, NearestFeature<D>& best) const {
    switch (m_params.simplex) {
      case SimplexRule::voronoi:
        break;
      case SimplexRule::johnson:
        return nearestByJohnson(simplex, best);
      case SimplexRule::signedVolumes:
        return nearestByVolumes(simplex, best);
    }
    return nearestOfSimplex(simplex, best);
  }

  // The i-th direction: between the last one and the vector to the nearest point and the last support point, both
  // normalised, which is best for polytopes. The plain vector if that has no length.
  static Vec<D> withMomentum(int i, const Vec<D>& nearest, const Vec<D>& last, const Vec<D>& plain, Vec<D>& heading) {
    const Real share = Real(i + 1) / Real(i + 3);
    Vec<D> point = share * nearest + (1 - share) * last;
    if (!makeUnit<D>(heading) || !makeUnit<D>(point)) return heading = plain;
    heading = share * heading + (1 - share) * point;
    Vec<D> n = heading;
    return makeUnit<D>(n) ? n : plain;
  }

  QueryStatus search(const CorePair<D>& pair, QueryNeed need, const PairMemory* memory, BestAxis<D>& best,
                     WorkDone& work) {
    const bool curved = pair.a.curved || pair.b.curved;
    const Real rounding = kBoundRounding * pair.scale * (curved ? kCurvedTolerance : Real(1));
    // The allowed error of a distance or depth of about this length.
    const auto allowed = [&](Real length) {
      const Real whole = m_params.measure == Measure::size ? pair.scale : std::abs(length);
      return std::isfinite(whole) ? std::max(m_params.tolerance * whole, rounding) : rounding;
    };
    // Whether the search for a distance may end. `last` is the bound of the last direction.
    Real last = -std::numeric_limits<Real>::infinity();
    const auto isClosed = [&](Real length) {
      return length - (m_params.gap == Gap::best ? best.bound : last) <= allowed(length);
    };
    NearestFeature<D> nearest, next;
    const auto support = [&](const Vec<D>& n) {
      work[WorkCount::supportCalls] += 2;
      const Vec<D> w = m_cache.support(pair, n);
      last = along<D>(n, w);
      best.take(n, last);
      m_watch([&](auto& t) { t.support(pair, nearest, n, w, last, best); });
      return w;
    };
    m_cache.recall(pair, memory);
    Simplex<D> simplex = m_cache.simplex();
    // Boolean query: first retry the last separating axis.
    const bool began = simplex.count == D + 1 || (simplex.count > 0 && need != QueryNeed::boolean);
    if (!began) simplex.count = 0, simplex.push(support(firstDirection(pair)));
    bool inside = nearestPoint(simplex, nearest), capped = !inside;
    bool momentum = m_params.accelerate == Accelerate::nesterov;
    Vec<D> heading = nearest.v, newest = nearest.v;
    for (int i = 0; i < m_params.iterations && !inside; ++i) {
      const Real length = std::sqrt(nearest.length2);
      if (need == QueryNeed::boolean && (best.bound > pair.radii() || length < pair.radii())) {
        if (length < pair.radii()) best.bound = length;  // certainly less than the radii: only the sign matters
        m_last = nearest.feature;
        return QueryStatus::converged;
      }
      // Three stopping rules, each of which rounding can defeat: the gap is closed, no new point, no descent. The
      // length shows only the square of a direction's error: an improving bound is a descent, too.
      Vec<D> n;
      if (isClosed(length) || !featureDirection(nearest, n)) capped = false;
      if (!capped) break;
      if (momentum) n = withMomentum(i, nearest.v, newest, n, heading);
      const Real before = best.bound;
      const Vec<D> w = newest = support(n);
      if (isClosed(length) || nearest.feature.contains(w)) {
        if (std::exchange(momentum, false) && !isClosed(length)) continue;
        capped = false;
        break;
      }
      simplex = nearest.feature;
      simplex.push(w);
      next.length2 = std::numeric_limits<Real>::infinity();
      inside = nearestPoint(simplex, next);
      if (inside || (!(next.length2 < nearest.length2) && !(best.bound > before))) {
        if (!inside && std::exchange(momentum, false)) continue;
        capped = false;
        break;
      }
      nearest = next;
    }
    m_last = inside ? simplex : nearest.feature;
    m_watch([&](auto& t) { t.nearest(m_last, inside, nearest.v, best); });
    const bool apart = !inside && std::isfinite(nearest.length2);
    const Real tolerance = allowed(apart ? std::sqrt(nearest.length2) : best.bound);  // as in the loop
    if (!inside && std::sqrt(nearest.length2) - best.bound <= tolerance) return QueryStatus::converged;
    if (inside && need == QueryNeed::boolean) {
      if (best.n.isZero(0)) best.bound = -pair.scale;  // no direction was tried: only the sign matters
      return QueryStatus::converged;
    }
    if (capped) return QueryStatus::iterationLimit;
    // From outside, EPA continues the search for a distance.
    const Real depthPart = inside ? std::max(m_params.tolerance, m_params.depthTolerance) : m_params.tolerance;
    const bool ofSize = m_params.measure == Measure::size;
    const EpaLimits limits{m_params.faces,
                           m_params.expansions,
                           curved ? kLocalFaces : kNotLocal,
                           ofSize ? std::max(depthPart * pair.scale, rounding) : rounding,
                           ofSize ? Real(0) : depthPart,
                           inside};
    const auto finish = [&](const Vec<D>& n) {
      const Vec<D> end = m_polish.improveFrom(pair, n, best, work);
      m_watch([&](auto& t) { t.refined(pair, best, "Newton's steps on the curved cores"); });
      return end;
    };
    const QueryStatus status = m_epa.run(pair, simplex, limits, best, work, finish);
    if constexpr (D == 3) {  // nearly coaxial cores of revolution: the other end of the ring may be as deep
      if (m_epa.finished()) {
        const Vec<3> axes[2] = {Vec<3>::Unit(0), pair.r.col(0)};
        for (const Vec<3>& axis : axes) finish(2 * best.n.dot(axis) * axis - best.n);
      }
    }
    // If a tolerance was asked for and met, the last steps are skipped.
    const bool enough = allowedToLeave(pair, best.bound) > 0 && status == QueryStatus::converged;
    if constexpr (D == 3) {
      if (curved && inside && !enough) tryCaps(pair, best, work);
    }
    if (curved && !enough) m_polish.improve(pair, best, work);
    // Near contact rounding decides the side of GJK's origin; the bound is more reliable.
    const bool overlaps = best.bound < -tolerance || (inside && best.bound <= tolerance);
    // A needle-shaped face: its edges, which are not rounded sums, give its normal.
    if (overlaps && m_epa.doubt() > kLeaning * tolerance) m_local.improve(pair, best.n, m_epa.doubt(), best, work);
    if constexpr (D == 3) {
      if (overlaps && best.bound > -kShallow * pair.scale) m_local.improveAcrossEdges(pair, best, work);
    }
    const Real length = std::sqrt(nearest.length2);
    // No distance if the first simplex holds the origin.
    const auto isShort = [&] { return !overlaps && std::isfinite(length) && length - best.bound > tolerance; };
    if (isShort()) m_local.improve(pair, best.n, length - best.bound, best, work);
    // The best direction may be an early one; a later direction, spoilt by rounding, may be nearer.
    if (Vec<D> n; isShort() && featureDirection(nearest, n)) {
      ++work[WorkCount::axisTests];
      m_local.improve(pair, n, length - pair.bound(n), best, work);
    }
    // A bound that is short by a relative error means a direction that is off by the square root of twice that error.
    // If the length is near rounding, the vertices to try lie far from the plane reached.
    if (isShort())
      m_local.improve(pair, best.n, std::sqrt(2 * (length - best.bound) / length) * pair.scale, best, work);
    return status;
  }

  Params m_params;
  [[no_unique_address]] Watch m_watch;
  HullPair m_hulls;
  GjkCache<D> m_cache;
  Simplex<D> m_last;  // of GJK: the feature of the nearest point, or the simplex around the origin
  Epa<D, Watch> m_epa;
  LocalFeatures<D> m_local;
  PlanePair<D> m_plane;
  CurvedPolish<D> m_polish;
  TouchingPoint m_touching;
};

}  // namespace

}}}  // namespace lpc::LPC_PRECISION::pair_query
