// SPDX-License-Identifier: Zlib
// The fast referee. The searches of the exact referee run in long double, where they may err; running error bounds then
// prove their results. Separated: phi >= the separation along any direction, and phi <= the length of any convex
// combination of vertices of M. Overlapping: the depth is <= M's extent along any direction, and >= the radius of a
// ball inside any closed surface spanned by points of M.
#include <algorithm>
#include <cmath>

#include "oracles/referee/proof.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kMaxIterations = 64;
// A proof is accepted when its interval is narrower than this, times s.
constexpr double kOpen = 1e-16;

template <int D>
using Posed = std::vector<Point<Bounded, D>>;

template <int D>
std::vector<Point<Real80, D>> values(const Posed<D>& posed) {
  std::vector<Point<Real80, D>> out(posed.size());
  for (std::size_t i = 0; i < posed.size(); ++i) {
    for (std::size_t k = 0; k < D; ++k) out[i][k] = posed[i][k].v;
  }
  return out;
}

template <int D>
Point<Bounded, D> vertexOf(const Posed<D>& a, const Posed<D>& b, const typename Difference<Real80, D>::Vertex& v) {
  Point<Bounded, D> m;
  for (std::size_t k = 0; k < D; ++k) {
    m[k] = b[static_cast<std::size_t>(v.ib)][k] - a[static_cast<std::size_t>(v.ia)][k];
  }
  return m;
}

// min over M of m . d / |d|: a lower bound of phi.
template <int D>
Bounded leastAlong(const Posed<D>& a, const Posed<D>& b, const Point<Real80, D>& direction) {
  const Point<Bounded, D> d = exactly<D>(direction);
  Bounded low, high;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Bounded x = boundedDot(b[i], d);
    low = i == 0 ? x : lesser(low, x);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Bounded x = -boundedDot(a[i], d);
    high = i == 0 ? x : lesser(high, x);
  }
  return (low + high) / sqrt(boundedDot(d, d));
}

// Length of a point of M: an upper bound of phi when phi is positive.
template <int D>
Bounded combinationLength(const Posed<D>& a, const Posed<D>& b, const Simplex<Real80, D>& s) {
  const auto w = weights<D>(s);
  Point<Bounded, D> sum;
  Bounded total;
  for (int i = 0; i < s.count; ++i) {
    Bounded weight;
    weight.v = w[static_cast<std::size_t>(i)];
    const auto m = vertexOf<D>(a, b, s.v[static_cast<std::size_t>(i)]);
    for (std::size_t k = 0; k < D; ++k) sum[k] = sum[k] + weight * m[k];
    total = total + weight;
  }
  return sqrt(boundedDot(sum, sum)) / total;
}

// Radius of a ball around the origin inside M, or a negative number. The surface is closed and each facet is oriented
// around the origin, so the surface winds around the origin. Each facet's plane is at least this far away.
template <int D>
Real80 innerRadius(const Posed<D>& a, const Posed<D>& b, const InnerPolytope<Real80, D>& p) {
  if (!isClosed(p)) return -1;
  std::vector<Point<Bounded, D>> at;
  for (const auto& v : p.vertices) at.push_back(vertexOf<D>(a, b, v));
  Real80 radius = std::numeric_limits<Real80>::infinity();
  for (const auto& f : p.facets) {
    if (!f.alive) continue;
    std::array<Point<Bounded, D>, static_cast<std::size_t>(D)> v;
    for (std::size_t i = 0; i < D; ++i) v[i] = at[static_cast<std::size_t>(f.v[i])];
    const Point<Bounded, D> n = facetNormal(v);
    const Bounded distance = boundedDot(n, v[0]) / sqrt(boundedDot(n, n));
    if (!(distance.lo() > 0)) return -1;
    radius = std::min(radius, distance.lo());
  }
  return radius;
}

}  // namespace

template <int D>
RefereeAnswer<D> refereeByCertificate(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                      const Pose<D>& X_WB) {
  RefereeAnswer<D> answer;
  std::vector<Vec<D>> core;
  Posed<D> posedA, posedB;
  coreVertices(a, core);
  poseVertices<Bounded, D>(core, X_WA, posedA);
  coreVertices(b, core);
  poseVertices<Bounded, D>(core, X_WB, posedB);
  Difference<Real80, D> m{values<D>(posedA), values<D>(posedB)};

  Simplex<Real80, D> simplex;
  SearchEnd<Real80, D> end = walkToOrigin(m, simplex, kMaxIterations);
  Bounded lower;     // phi of the cores is at least lower.lo()
  Real80 upper = 0;  // and at most this
  Point<Real80, D> normal;
  if (end.kind == end.separated) {
    normal = end.direction;
    upper = combinationLength<D>(posedA, posedB, simplex).hi();
  } else {
    if (end.kind != end.inside) return answer;
    end = completeSimplex(m, simplex);
    if (end.kind != end.inside) return answer;
    InnerPolytope<Real80, D> polytope;
    // Beyond this, rounding defeats the expansion, and exact integers are faster.
    const int maxFacets = 64 + 8 * static_cast<int>(m.a.size() + m.b.size());
    end = expand(m, simplex, polytope, maxFacets);
    if (end.kind != end.inside) return answer;
    normal = negative(end.direction);
    upper = -innerRadius<D>(posedA, posedB, polytope);
    if (!(upper < 0)) return answer;
  }
  lower = leastAlong<D>(posedA, posedB, normal);
  const Bounded radii = Bounded(static_cast<double>(a.radius)) + Bounded(static_cast<double>(b.radius));
  const Real80 lo = lower.lo() - radii.hi(), hi = upper - radii.lo();
  const Real80 slack = 4 * Bounded::kUlp * (std::abs(lo) + std::abs(hi));
  const double s = errorScale(a, X_WA, b, X_WB, static_cast<double>(hi));
  // Any NaN or infinity fails this comparison.
  if (!(hi - lo + slack <= static_cast<Real80>(kOpen * s)) || !(lo - slack > 0 || hi + slack < 0)) return answer;
  answer.lo = roundDown(lo - slack), answer.hi = roundUp(hi + slack);
  const Real80 length = std::sqrt(dot(normal, normal));
  for (std::size_t k = 0; k < D; ++k) answer.normal[static_cast<int>(k)] = static_cast<double>(normal[k] / length);
  answer.decided = true, answer.method = "certificate";
  return answer;
}

template <int D>
RefereeAnswer<D> referee(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB) {
  const auto is = [&](CoreClass c) { return a.core() == c || b.core() == c; };
  if (is(CoreClass::plane)) return refereeOfPlane(a, X_WA, b, X_WB);
  if (is(CoreClass::curved)) return refereeOfCurved(a, X_WA, b, X_WB);
  const RefereeAnswer<D> quick = refereeByCertificate(a, X_WA, b, X_WB);
  return quick.decided ? quick : refereeExactly(a, X_WA, b, X_WB);
}

template RefereeAnswer<2> refereeByCertificate(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&,
                                               const Pose<2>&);
template RefereeAnswer<3> refereeByCertificate(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&,
                                               const Pose<3>&);
template RefereeAnswer<2> referee(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&);
template RefereeAnswer<3> referee(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&);

}}  // namespace lpc::LPC_PRECISION
