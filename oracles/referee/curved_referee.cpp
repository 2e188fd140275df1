// SPDX-License-Identifier: Zlib
// The referee of cores known only by support functions: curved cores against anything bounded, and planes. Bounds from
// both sides, as in certificate.cpp. A polytope inside a curved M never becomes M, so the width of the interval depends
// on the search. It is about 1e-14 s in general, and wider only where the minima form a ring (coaxial cylinders), which
// no finite polytope follows.
#include <queue>

#include "oracles/referee/posed_support.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// An accepted interval is narrower than this, times s: separated, and overlapping.
constexpr Real80 kApart = 1e-13L, kOverlapping = 1e-6L;
// Target of the searches, times s.
constexpr Real80 kAim = 1e-16L;
constexpr int kMostSteps = 200, kMostFacets = 4000;

// M = B - A, rounded by `rounding`, as points known within `error` of it.
template <int D>
class Sampled {
 public:
  using Vertex = typename Difference<Real80, D>::Vertex;

  Sampled(const PosedSupport<D>& a, const PosedSupport<D>& b, Real80 rounding) : m_a(a), m_b(b), m_rounding(rounding) {}

  // Support point of the rounded M along d. Keeps its bound on phi of the cores when it is the best one.
  Vertex support(const Point<Real80, D>& d) {
    const auto onB = m_b.farthest(d);
    const auto onA = m_a.farthest(negative(d));
    const Point<Bounded, D> along = exactly<D>(d);
    const Bounded length = sqrt(boundedDot(along, along));
    const Real80 separation = (-(onA.value + onB.value) / length).lo();
    if (separation > m_lower) m_lower = separation, m_direction = negative(d);
    Vertex w;
    w.ia = w.ib = m_count++;  // all vertices are distinct
    for (std::size_t k = 0; k < D; ++k) {
      const Bounded x = onB.point[k] - onA.point[k] + Bounded::make(m_rounding, 0) * along[k] / length;
      w.m[k] = x.v, m_error = std::max(m_error, x.e * D);
    }
    return w;
  }

  Real80 lower() const { return m_lower; }  // proved: phi of the cores is at least this
  const Point<Real80, D>& direction() const { return m_direction; }
  Real80 error() const { return m_error; }

 private:
  const PosedSupport<D>&m_a, &m_b;
  Real80 m_rounding, m_lower = -std::numeric_limits<Real80>::infinity(), m_error = 0;
  Point<Real80, D> m_direction{1};
  int m_count = 0;
};

// Length of a point of M: an upper bound of phi when phi is positive.
template <int D>
Real80 lengthOfNearest(const Simplex<Real80, D>& s) {
  const auto w = weights<D>(s);
  Point<Bounded, D> sum;
  Bounded total;
  for (int i = 0; i < s.count; ++i) {
    const Bounded weight = Bounded::make(w[static_cast<std::size_t>(i)], 0);
    for (std::size_t k = 0; k < D; ++k) sum[k] = sum[k] + weight * Bounded::make(s.at(i)[k], 0);
    total = total + weight;
  }
  return (sqrt(boundedDot(sum, sum)) / total).hi();
}

// GJK (Gilbert, Johnson, Keerthi): `upper` is the length of the nearest point of M found; returns true when the simplex
// contains the origin.
template <int D>
bool walk(Sampled<D>& m, Simplex<Real80, D>& s, Real80 aim, Real80& upper) {
  s.count = 0;
  s.add(m.support(transversal(s)));
  for (int i = 0; i < kMostSteps; ++i) {
    const NearestFace<Real80, D> face = nearestFace(s);
    if (face.mask == 0) return false;
    s.keep(face.mask);
    if (face.origin) return true;
    upper = std::min(upper, lengthOfNearest<D>(s) + m.error());
    if (upper - m.lower() <= aim) return false;
    const auto w = m.support(negative(face.direction));
    if (!(dot(face.direction, w.m) < dot(face.direction, s.at(0)))) return false;
    s.add(w);
  }
  return false;
}

// A proved lower bound of a facet's distance from the origin, even for a thin facet. The facet's lowest corner along
// any direction bounds its distance. The best direction points to the facet's nearest point. The normal of a needle is
// made of rounding, its edges are not.
template <int D>
Real80 facetDistance(const InnerPolytope<Real80, D>& p, const InnerFacet<Real80, D>& f) {
  Real80 best = -std::numeric_limits<Real80>::infinity();
  const auto along = [&](const Point<Real80, D>& d) {
    const Point<Bounded, D> n = exactly<D>(d);
    const Bounded length = sqrt(boundedDot(n, n));
    Real80 least = std::numeric_limits<Real80>::infinity();
    for (const int v : f.v) least = std::min(least, (boundedDot(n, exactly<D>(p.at(v))) / length).lo());
    best = std::max(best, least);  // a NaN is skipped
  };
  along(f.normal);
  for (std::size_t i = 0; i < D; ++i) {
    const Point<Real80, D>&u = p.at(f.v[i]), &v = p.at(f.v[(i + 1) % D]);
    const Point<Real80, D> e = minus(v, u);
    const Real80 square = dot(e, e), t = square > 0 ? std::clamp(-dot(u, e) / square, Real80(0), Real80(1)) : 0;
    Point<Real80, D> nearest = u;
    for (std::size_t k = 0; k < D; ++k) nearest[k] += t * e[k];
    along(nearest);
  }
  return best;
}

// The same from the facet's own normal only, at a tenth of the work; subtracts all rounding errors. -infinity for a
// facet without a normal.
template <int D>
Real80 planeDistance(const InnerPolytope<Real80, D>& p, const InnerFacet<Real80, D>& f) {
  Real80 least = std::numeric_limits<Real80>::infinity(), reach = 0;
  for (const int v : f.v) {
    Real80 size = 0;
    for (const Real80 x : p.at(v)) size += std::abs(x);
    least = std::min(least, dot(f.normal, p.at(v))), reach = std::max(reach, size);
  }
  if (!(f.square > 0)) return -std::numeric_limits<Real80>::infinity();
  // D products and sums, the square, its root and the quotient: ten errors of kUlp / 2, each of at most `reach`.
  const Real80 distance = least / std::sqrt(f.square) - 16 * Bounded::kUlp * reach;
  return std::isfinite(distance) ? distance : -std::numeric_limits<Real80>::infinity();
}

// True when the closed surface winds around the origin. The solid angle of the surface is a multiple of the full angle.
// Facets of proved orientation add to it; the others are too small to cancel their sum.
template <int D>
bool windsAround(const InnerPolytope<Real80, D>& p, const std::vector<Real80>& distance) {
  Real80 sure = 0, unsure = 0, farthest = 0;
  for (const auto& v : p.vertices) farthest = std::max(farthest, std::sqrt(dot(v.m, v.m)));
  for (std::size_t i = 0; i < p.facets.size(); ++i) {
    const auto& f = p.facets[i];
    if (!f.alive) continue;
    if (!(distance[i] > 0)) return false;
    std::array<Point<Bounded, D>, static_cast<std::size_t>(D)> v;
    for (std::size_t k = 0; k < D; ++k) v[k] = exactly<D>(p.at(f.v[k]));
    const Point<Bounded, D> n = facetNormal(v);
    const Bounded area = sqrt(boundedDot(n, n));
    if (boundedDot(n, v[0]).lo() > 0) {
      sure += area.lo() / std::pow(farthest, Real80(D)) * distance[i];
    } else {
      unsure += area.hi() / std::pow(distance[i], Real80(D - 1));
    }
  }
  return unsure < sure;
}

// The facets that are alive, in order, rounded to double: almost all facets can be skipped by these. With all facets
// ever created, in long double, this took half of the referee's time.
template <int D>
struct AliveFacets {
  struct Facet {
    std::array<double, static_cast<std::size_t>(D)> normal;
    double offset, size;  // size: sum of the absolute coordinates of the normal
    int index;
  };
  std::vector<Facet> facets;
  std::size_t known = 0;  // number of the polytope's facets copied so far

  void follow(const InnerPolytope<Real80, D>& p) {
    for (; known < p.facets.size(); ++known) {
      const InnerFacet<Real80, D>& f = p.facets[known];
      Facet g{.normal = {}, .offset = static_cast<double>(f.offset), .size = 0, .index = static_cast<int>(known)};
      for (std::size_t k = 0; k < D; ++k) {
        g.normal[k] = static_cast<double>(f.normal[k]), g.size += std::abs(g.normal[k]);
      }
      facets.push_back(g);
    }
  }

  /// True when `w` is certainly below the plane; its coordinates are at most `reach`. Each product and sum here has an
  /// error of a few roundings of the largest term, within kDoubt. NaN is not certain.
  static bool isBelow(const Facet& f, const std::array<double, static_cast<std::size_t>(D)>& w, double reach) {
    constexpr double kDoubt = 32 * std::numeric_limits<double>::epsilon();
    double height = -f.offset;
    for (std::size_t k = 0; k < D; ++k) height += f.normal[k] * w[k];
    const double most = f.size * reach + std::abs(f.offset);
    return height < -kDoubt * most && f.size > kSafe && most > kSafe && most < 1 / kSafe;
  }
  static constexpr double kSafe = 1e-200;  // lengths within this range lose no digit by underflow or overflow
};

// As in expansion3.h, but for points known within `error`. A facet stays when the new vertex is in its plane within
// that error, and a new facet may be arbitrarily thin. The surface stays closed: each open edge gets a facet.
void growWithin(InnerPolytope<Real80, 3>& p, AliveFacets<3>& alive, const Difference<Real80, 3>::Vertex& w, int seen,
                Real80 error) {
  alive.follow(p);
  std::array<double, 3> at;
  double reach = 0;
  for (std::size_t k = 0; k < 3; ++k) at[k] = static_cast<double>(w.m[k]), reach = std::max(reach, std::abs(at[k]));
  std::vector<std::pair<int, int>> edges;
  std::erase_if(alive.facets, [&](const AliveFacets<3>::Facet& g) {
    if (g.index != seen && AliveFacets<3>::isBelow(g, at, reach)) return false;
    InnerFacet<Real80, 3>& f = p.facets[static_cast<std::size_t>(g.index)];
    if (g.index != seen && !(dot(f.normal, w.m) - f.offset > 8 * error * std::sqrt(f.square))) return false;
    f.alive = false;
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(f.v[k], f.v[(k + 1) % 3]);
    return true;
  });
  const int last = static_cast<int>(p.vertices.size());
  p.vertices.push_back(w);
  for (const auto& [i, j] : edges) {
    if (std::find(edges.begin(), edges.end(), std::pair(j, i)) == edges.end()) addFacet(p, i, j, last);
  }
}
void growWithin(InnerPolytope<Real80, 2>& p, AliveFacets<2>&, const Difference<Real80, 2>::Vertex& w, int seen,
                Real80) {
  grow(p, w, seen);
}

// Radius of a ball around the origin inside M, or a negative number.
template <int D>
Real80 ballInside(const InnerPolytope<Real80, D>& p, const std::vector<Real80>& distance, Real80 error) {
  if (!windsAround<D>(p, distance)) return -1;
  Real80 radius = std::numeric_limits<Real80>::infinity();
  for (std::size_t i = 0; i < p.facets.size(); ++i) {
    if (p.facets[i].alive) radius = std::min(radius, distance[i]);
  }
  return radius - error;
}

// Expands from a simplex around the origin until the nearest facet is as near as M. Returns a proved lower bound of the
// rounded M's depth, or a negative number.
template <int D>
Real80 depth(Sampled<D>& m, const Simplex<Real80, D>& s, Real80 rounding, Real80 aim) {
  InnerPolytope<Real80, D> p;
  startPolytope(s, p);
  AliveFacets<D> alive;
  std::vector<Real80> distance;  // lower bounds; by planeDistance for facets that were never the nearest
  std::vector<bool> settled;     // computed by facetDistance
  using Entry = std::pair<Real80, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> nearest;
  // Measures new facets and puts the nearest on top, settled; false when no facet is left.
  const auto findNearest = [&] {
    for (std::size_t i = distance.size(); i < p.facets.size(); ++i) {
      distance.push_back(planeDistance<D>(p, p.facets[i])), settled.push_back(false);
      nearest.emplace(distance.back(), static_cast<int>(i));
    }
    while (!nearest.empty()) {
      const auto i = static_cast<std::size_t>(nearest.top().second);
      if (p.facets[i].alive && settled[i]) return true;
      nearest.pop();
      if (!p.facets[i].alive) continue;
      settled[i] = true, distance[i] = std::max(distance[i], facetDistance<D>(p, p.facets[i]));
      nearest.emplace(distance[i], static_cast<int>(i));
    }
    return false;
  };
  Real80 proved = -1;
  for (int round = 0; static_cast<int>(p.facets.size()) < kMostFacets && findNearest(); ++round) {
    const auto [least, next] = nearest.top();
    // Prove intermediate results: a later facet may be one for which nothing can be proved.
    const bool done = (rounding - least) - m.lower() <= aim;
    if (done || round % 128 == 127) proved = std::max(proved, ballInside<D>(p, distance, m.error()));
    if (done) return proved;
    nearest.pop();
    const InnerFacet<Real80, D> f = p.facets[static_cast<std::size_t>(next)];
    const auto w = m.support(f.normal);
    if (!(dot(f.normal, w.m) > f.offset)) continue;  // a facet of M, within these numbers
    growWithin(p, alive, w, next, m.error());
  }
  findNearest();
  return std::max(proved, ballInside<D>(p, distance, m.error()));
}

template <int D>
Real80 depthOf(Sampled<D>& m, Simplex<Real80, D>& s, Real80 rounding, Real80 aim) {
  while (s.count <= D) {
    const Point<Real80, D> d = transversal(s);
    auto w = m.support(d);
    if (!(dot(d, w.m) > 0)) w = m.support(negative(d));
    if (!(std::abs(dot(d, w.m)) > 0)) return -1;
    s.add(w);
  }
  return depth<D>(m, s, rounding, aim);
}

}  // namespace

template <int D>
RefereeAnswer<D> refereeOfPlane(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                const Pose<D>& X_WB) {
  RefereeAnswer<D> answer;
  const bool planeA = a.core() == CoreClass::plane;
  if (planeA && b.core() == CoreClass::plane) return answer;
  const Pose<D>& X_WP = planeA ? X_WA : X_WB;
  const PosedSupport<D> body(planeA ? b : a, planeA ? X_WB : X_WA);
  const auto rotation = rotationOf<Bounded>(X_WP.q);
  Point<Bounded, D> up, origin;
  Point<Real80, D> down;
  Real80 lean = 0;
  for (std::size_t k = 0; k < D; ++k) {
    up[k] = rotation[k][1], origin[k] = Bounded(static_cast<double>(X_WP.p[static_cast<int>(k)]));
    down[k] = -up[k].v, lean += up[k].e;
  }
  // The lowest point along `up`; its own rounding tilts it by `lean`.
  const auto lowest = body.farthest(down);
  Real80 reach = 0;
  for (std::size_t k = 0; k < D; ++k) reach += std::abs(lowest.point[k].v) + std::abs(origin[k].v);
  const ShapeView<D>& shape = planeA ? b : a;
  reach += 4 * static_cast<Real80>(boundingRadius(shape));
  const Bounded height = (-lowest.value - boundedDot(up, origin)) / sqrt(boundedDot(up, up));
  const Bounded phi = height - Bounded(static_cast<double>(a.radius)) - Bounded(static_cast<double>(b.radius));
  const Real80 slack = lean * reach;
  if (!std::isfinite(phi.lo()) || !std::isfinite(phi.hi())) return answer;
  answer.lo = roundDown(phi.lo() - slack), answer.hi = roundUp(phi.hi() + slack);
  const Real80 length = std::sqrt(dot(down, down));
  for (std::size_t k = 0; k < D; ++k) {
    answer.normal[static_cast<int>(k)] = static_cast<double>((planeA ? -down[k] : down[k]) / length);
  }
  answer.decided = true, answer.method = "support";
  return answer;
}

template <int D>
RefereeAnswer<D> refereeOfCurved(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                 const Pose<D>& X_WB) {
  RefereeAnswer<D> answer;
  const PosedSupport<D> posedA(a, X_WA), posedB(b, X_WB);
  const Real80 s = errorScale(a, X_WA, b, X_WB, 0.0), aim = kAim * s;
  if (!std::isfinite(s)) return answer;
  Real80 lower = -std::numeric_limits<Real80>::infinity(), upper = -lower;
  Point<Real80, D> normal{1};
  const auto know = [&](const Sampled<D>& m) {
    if (m.lower() > lower) lower = m.lower(), normal = m.direction();
  };
  Sampled<D> m(posedA, posedB, 0);
  Simplex<Real80, D> simplex;
  if (walk<D>(m, simplex, aim, upper)) {
    const Real80 inside = depthOf<D>(m, simplex, 0, aim);
    if (inside > 0) upper = std::min(upper, -inside);
  }
  know(m);
  // Near contact, rounding decides the directions of both searches. A ball added to M moves the origin into it, while
  // the bounds still apply to the cores. If one ball leaves needles for which nothing can be proved, another may not.
  for (const Real80 share : {1 / 16.0L, 1 / 3.0L, 1.0L}) {
    if (upper - lower <= 10 * aim || lower > s / 100) break;
    const Real80 rounding = std::max(Real80(0), std::isfinite(upper) ? upper : Real80(0)) + share * s;
    Sampled<D> rounded(posedA, posedB, rounding);
    Real80 unused = upper;
    if (walk<D>(rounded, simplex, -1, unused)) {
      const Real80 inside = depthOf<D>(rounded, simplex, rounding, aim);
      if (inside > 0) upper = std::min(upper, rounding - inside);
    }
    know(rounded);
    if (upper - lower <= (upper > 0 ? kApart : kOverlapping) * s / 10) break;
  }
  const Bounded radii = Bounded(static_cast<double>(a.radius)) + Bounded(static_cast<double>(b.radius));
  const Real80 lo = lower - radii.hi(), hi = upper - radii.lo(),
               slack = 4 * Bounded::kUlp * (std::abs(lo) + std::abs(hi));
  if (!(hi - lo + 2 * slack <= (upper > 0 ? kApart : kOverlapping) * s)) return answer;
  answer.lo = roundDown(lo - slack), answer.hi = roundUp(hi + slack);
  const Real80 length = std::sqrt(dot(normal, normal));
  for (std::size_t k = 0; k < D; ++k) answer.normal[static_cast<int>(k)] = static_cast<double>(normal[k] / length);
  answer.decided = true, answer.method = "bounds";
  return answer;
}

template RefereeAnswer<2> refereeOfPlane(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&);
template RefereeAnswer<3> refereeOfPlane(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&);
template RefereeAnswer<2> refereeOfCurved(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&);
template RefereeAnswer<3> refereeOfCurved(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&);

}}  // namespace lpc::LPC_PRECISION
