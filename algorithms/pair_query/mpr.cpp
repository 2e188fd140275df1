// SPDX-License-Identifier: Zlib
#include <utility>

#include "algorithms/pair_query/core/plane_pair.h"
#include "algorithms/pair_query/gjk/gjk_simplex3.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace pair_query;

Real turnOf(const Vec<2>& u, const Vec<2>& v) { return u[0] * v[1] - u[1] * v[0]; }

// Portal refinement of one pair. M is the difference of the whole shapes with their rounding radii: the cores alone do
// not decide the side if they are apart by less than the radii. A ray goes from a point inside M through the origin; a
// portal is a triangle of points of M's surface through which the ray passes. Each support point along the portal's
// normal makes it smaller and farther out, until it lies in the surface, where the ray leaves M.
//
// Claims are proved: that the shapes are apart by the bound of a direction (core_pair.h), that they overlap by D + 1
// points of M around the origin. If rounding leaves the ray beside its portal, neither is proved, and steps to M's
// nearest point (gjk_epa) decide.
template <int D>
class Refinement {
 public:
  Refinement(const CorePair<D>& pair, QueryNeed need, int iterations, Real tolerance, WorkDone& work)
      : m_pair(pair), m_work(work), m_left(iterations), m_sideAlone(need == QueryNeed::boolean) {
    const bool round = pair.a.curved || pair.b.curved || pair.radii() > 0;
    const Real size = pair.scale + pair.radii();
    m_rounding = kBoundRounding * size;
    const Real least = kBoundRounding * (round ? kCurvedTolerance : Real(1));
    m_least = least * size, m_tolerance = std::max(tolerance * size, m_least);
    m_near = std::max(least, kAttainedRounding) * size;  // the side must be right whatever the tolerance
    m_center = (pair.p + pair.r * middle(pair.b)) - middle(pair.a);
    m_ray = -m_center;
    if (!makeUnit<D>(m_ray)) m_ray = Vec<D>::Unit(0);  // any direction out is used
  }

  QueryStatus run() {
    m_portal[0] = support(m_ray);
    if (isApart()) return QueryStatus::converged;
    m_exit = -m_ray;
    if (isOnRay(m_portal[0])) return m_exitAtOnce = true, overlapOrDecide();
    return discover();
  }

  /// For shapes apart the best tested direction, else that of the portal.
  BestAxis<D> axis() const {
    BestAxis<D> exit;
    if (!isApart() && !m_sideAlone) exit.take(m_exit, m_pair.bound(m_exit)), ++m_work[WorkCount::axisTests];
    return exit.n.isZero(0) ? m_best : exit;
  }

 private:
  static Vec<D> middle(const ShapeView<D>& shape) {
    Vec<D> sum = Vec<D>::Zero();
    if (!shape.hull) return sum;  // other shapes have it at their frame's origin
    for (const Vec<D>& v : shape.hull->vertices) sum += v;
    return sum / static_cast<Real>(shape.hull->vertices.size());
  }

  // Support of the core, along n as in core_pair.h.
  Vec<D> coreSupport(const Vec<D>& n) {
    m_work[WorkCount::supportCalls] += 2;
    const Vec<D> w = m_pair.support(n);
    m_best.take(n, n.dot(w));
    return w;
  }
  // The support point of M along the unit vector.
  Vec<D> support(const Vec<D>& outward) { return coreSupport(Vec<D>(-outward)) + m_pair.radii() * outward; }
  bool isApart() const { return m_best.bound > m_pair.radii(); }

  bool isOnRay(const Vec<D>& v) const {
    Vec<D> beside = v - m_center;
    removeAlong<D>(beside, m_ray);
    return beside.norm() <= m_rounding;
  }

  QueryStatus discover() {
    if constexpr (D == 2) {
      const bool left = turnOf(m_ray, m_portal[0] - m_center) > 0;
      const Vec<2> across(-m_ray[1], m_ray[0]);
      m_portal[1] = support(left ? Vec<2>(-across) : across);
      if (isApart()) return QueryStatus::converged;
      if (left) std::swap(m_portal[0], m_portal[1]);  // right of the ray, then left
    } else {
      Vec<3> out = (m_portal[0] - m_center).cross(m_ray);
      if (!makeUnit<3>(out)) return decide();
      m_portal[1] = support(out);
      if (isApart()) return QueryStatus::converged;
      if (Vec<3>(m_portal[0] - m_center).cross(m_portal[1] - m_center).dot(m_ray) < 0) {
        std::swap(m_portal[0], m_portal[1]);
      }
      // Finds a third corner on the ray's side of the plane of two corners and the centre, until the ray is between all
      // three.
      for (;;) {
        const Vec<3> a0 = m_portal[0] - m_center, a1 = m_portal[1] - m_center;
        out = a0.cross(a1);
        if (!makeUnit<3>(out)) return decide();
        if (m_left-- <= 0) return QueryStatus::iterationLimit;
        m_portal[2] = support(out);
        if (isApart()) return QueryStatus::converged;
        const Vec<3> a2 = m_portal[2] - m_center;
        if (m_ray.dot(a1.cross(a2)) < 0) {
          m_portal[0] = m_portal[2];
        } else if (m_ray.dot(a2.cross(a0)) < 0) {
          m_portal[1] = m_portal[2];
        } else {
          break;
        }
      }
    }
    return refine();
  }

  QueryStatus refine() {
    for (Vec<D> out; portalNormal(out);) {
      m_exit = -out;
      Real height = out.dot(m_portal[0]);
      for (const Vec<D>& v : m_portal) height = std::max(height, out.dot(v));
      if (m_sideAlone && height >= 0 && holdsOrigin()) return QueryStatus::converged;
      if (m_left-- <= 0) return QueryStatus::iterationLimit;
      const Vec<D> w = support(out);
      if (isApart()) return QueryStatus::converged;
      // A tolerance applies to the depth: while the portal does not contain the origin, the search continues.
      const Real rise = out.dot(w) - height;
      if (rise <= m_least || (rise <= m_tolerance && holdsOrigin()) || !replace(w)) break;
    }
    return overlapOrDecide();
  }

  // Away from the centre; false when the portal has no area.
  bool portalNormal(Vec<D>& out) const {
    if constexpr (D == 2) {
      const Vec<2> e = m_portal[1] - m_portal[0];
      out = {e[1], -e[0]};
    } else {
      out = Vec<3>(m_portal[1] - m_portal[0]).cross(m_portal[2] - m_portal[0]);
    }
    if (out.dot(m_ray) < 0) out = -out;
    return makeUnit<D>(out);
  }

  // The part of the portal, seen from the new point, through which the ray passes. False if rounding finds none.
  bool replace(const Vec<D>& w) {
    if constexpr (D == 2) {
      m_portal[turnOf(m_ray, w - m_center) > 0 ? 1 : 0] = w;
      return true;
    } else {
      const Vec<3> across = Vec<3>(w - m_center).cross(m_ray);
      std::array<Real, 3> side;
      for (std::size_t i = 0; i < 3; ++i) side[i] = across.dot(m_portal[i] - m_center);
      for (std::size_t i = 0; i < 3; ++i) {
        if (!(side[i] <= 0 && side[(i + 1) % 3] >= 0)) continue;
        m_portal[(i + 2) % 3] = w;
        return true;
      }
      return false;
    }
  }

  // Whether the origin is in the hull of the centre and the portal, or within rounding of it.
  bool holdsOrigin() const {
    Simplex<D> simplex;
    simplex.push(m_center);
    for (const Vec<D>& v : m_portal) {
      simplex.push(v);
      if (m_exitAtOnce) break;
    }
    NearestFeature<D> nearest;
    return nearestOfSimplex(simplex, nearest) || nearest.length2 <= m_near * m_near;
  }

  QueryStatus overlapOrDecide() { return holdsOrigin() ? QueryStatus::converged : decide(); }

  // Decides the side by the nearest point of the cores' difference.
  QueryStatus decide() {
    Simplex<D> simplex;
    simplex.push(coreSupport(m_best.n));
    NearestFeature<D> nearest;
    bool inside = nearestOfSimplex(simplex, nearest);
    while (!inside) {
      const Real length = std::sqrt(nearest.length2);
      Vec<D> n;
      if (isApart() || length <= m_pair.radii() + m_near || !featureDirection(nearest, n)) break;
      if (m_left-- <= 0) return QueryStatus::iterationLimit;
      const Vec<D> w = coreSupport(n);
      if (isApart()) break;
      if (nearest.feature.contains(w)) return QueryStatus::degenerate;
      simplex = nearest.feature, simplex.push(w);
      NearestFeature<D> next;
      inside = nearestOfSimplex(simplex, next);
      if (!inside && !(next.length2 < nearest.length2)) return QueryStatus::degenerate;
      nearest = next;
    }
    return QueryStatus::converged;
  }

  const CorePair<D>& m_pair;
  WorkDone& m_work;
  int m_left;
  bool m_sideAlone, m_exitAtOnce = false;
  Real m_rounding = 0, m_least = 0, m_tolerance = 0, m_near = 0;  // m
  Vec<D> m_center, m_ray, m_exit = Vec<D>::Zero();                // m_exit as in core_pair.h
  IndexedArray<Vec<D>, D> m_portal;
  BestAxis<D> m_best;
};

// Portal refinement (Snethen 2008), known as XenoCollide. The overlap test is exact. The depth is that along the normal
// of the portal through which the ray from centre to centre leaves, which suffices to separate but need not be the
// least. For shapes apart the first separating direction ends the search, and the distance is what it proves, a lower
// bound.
template <int D>
class Mpr final : public PairQuery<D> {
 public:
  struct Params {
    int iterations = 256;
    Real tolerance = 0;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 1, 10000, "support points", ParamRole::effort);
      v.real("tolerance", tolerance, 0, Real(0.1), "1",
             "how far the last portal lies below the surface, against the largest coordinate; eight roundings at "
             "least",
             ParamRole::tolerance);
    }
  };
  explicit Mpr(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out{
        .name = "mpr",
        .summary = "portal refinement: overlap or not, and the depth where the line of centres leaves",
        .paper = "snethen2008",
        .complexity = "1 to 8 support points apart, 3 to 12 when penetrating; for the depth of what is round up to 80",
        .guarantee = Guarantee::approximate};
    const auto fails = [&](const char* when, const char* symptom, std::initializer_list<const char*> properties) {
      for (const char* property : properties) out.failures.push_back({when, symptom, property});
    };
    fails("shapes that overlap", "the depth is the one where the line of centres leaves, up to several times the least",
          {"N5 depth is minimal", "N5 depth suffices", "N6 Lipschitz", "N11 rounding", "N12 superset", "N13 halves",
           "N15 polygon and circle", "N18 prisms"});
    fails("shapes that overlap", "the features along that normal need not share a point: a witness is half-way",
          {"N7 witnesses"});
    fails("shapes that are apart", "the distance is what the first axis that separates them proves",
          {"N6 convex along lines"});
    fails("the line of centres leaves by an edge, or by a curved face",
          "rounding chooses the portal, and so the normal",
          {"N1 swap", "N2 motion of both", "N3 scale", "N4 mirror", "N14 box as hull", "N16 vertex order"});
    return out;
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return !hasPlane(a, b) || supportsPlane(a, b); }

  /// The first separating axis ends the search; against a plane there is no search.
  bool claimsGap(ShapeKind a, ShapeKind b) const override { return hasPlane(a, b); }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory>, WorkDone& work) override {
    work[WorkCount::pairQueries] += pairs.size();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const CorePair<D> pair(pairs[i]);
      if (hasPlane(pair.a.kind, pair.b.kind)) {
        answers[i] = m_plane.answer(pair, need, work);
        continue;
      }
      Refinement<D> refinement(pair, need, m_params.iterations, m_params.tolerance, work);
      const QueryStatus status = refinement.run();
      BestAxis<D> axis = refinement.axis();
      const Real left = m_params.tolerance * (pair.scale + pair.radii());
      answers[i] = answerFrom<D>(pair, axis, status, need, m_touching, work, left);
    }
  }

 private:
  Params m_params;
  PlanePair<D> m_plane;
  TouchingPoint m_touching;
};

}  // namespace

LPC_REGISTER(PairQuery, Mpr, 2, 3);

}}  // namespace lpc::LPC_PRECISION
