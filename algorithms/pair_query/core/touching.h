// SPDX-License-Identifier: Zlib
// Closest points from a separating or deepest direction: where the two supporting features, brought together along n,
// share a point. All regimes and methods use this one rule, so that two faces in contact meet in the middle of their
// overlap instead of in the vertex that an iteration met last.
#pragma once

#include <optional>
#include <vector>

#include "algorithms/pair_query/core/touching_boxes.h"
#include "framework/shape/support_gap.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// The vertices of a core within `band` (m) of its support vertex along unit n (all in the core's frame); for a curved
/// core the corners of its support face within the band, or its support point. `climb`: as in CorePair. A search for
/// all of them counts as one support point, and a support face as another.
template <int D>
void supportingVertices(const ShapeView<D>& shape, const Vec<D>& n, Real band, std::vector<Vec<D>>& out, WorkDone& work,
                        const int* climb = nullptr) {
  out.clear();
  ++work[WorkCount::supportCalls];
  switch (shape.core()) {
    case CoreClass::hull: {
      if constexpr (D == 3) {
        HullPeak peak;
        if (climb && shape.hull->vertices.size() >= kClimbVertices && climbToPeak(*shape.hull, n, *climb, band, peak)) {
          const Real farthest = shape.hull->vertices[peak.vertices[0]].dot(n);
          std::sort(peak.vertices.begin(), peak.vertices.begin() + peak.count);
          for (std::size_t k = 0; k < peak.count; ++k) {
            const Vec<D>& v = shape.hull->vertices[peak.vertices[k]];
            if (v.dot(n) >= farthest - band) out.push_back(v);
          }
          return;
        }
      }
      if constexpr (D == 3) return verticesWithin(shape.hull->vertices, n, band, out);
      Real farthest = -std::numeric_limits<Real>::infinity();
      for (const Vec<D>& v : shape.hull->vertices) farthest = std::max(farthest, v.dot(n));
      for (const Vec<D>& v : shape.hull->vertices) {
        if (v.dot(n) >= farthest - band) out.push_back(v);
      }
      return;
    }
    case CoreClass::curved: {
      const Vec<D> farthest = coreSupport(shape, n);
      ++work[WorkCount::supportCalls];
      shape.curved->supportFace(n, out);
      std::erase_if(out, [&](const Vec<D>& v) { return v.dot(n) < farthest.dot(n) - band; });
      if (out.size() < 2) out.assign(1, farthest);
      return;
    }
    case CoreClass::plane:
      LPC_ASSERT(false);  // plane_pair.h answers these
      return;
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
      break;
  }
  out.push_back(coreSupport(shape, n));
  for (int k = 0; k < D; ++k) {
    if (!(shape.half[k] > 0) || 2 * std::abs(n[k]) * shape.half[k] > band) continue;
    const std::size_t count = out.size();
    for (std::size_t i = 0; i < count; ++i) {
      Vec<D> mirrored = out[i];
      mirrored[k] = -mirrored[k];
      out.push_back(mirrored);
    }
  }
}

using Planar = Vec<2>;

/// Convex polygon of planar points, counter-clockwise; points and segments are kept.
inline void planarHull(std::vector<Planar>& points, std::vector<Planar>& scratch) {
  std::sort(points.begin(), points.end(),
            [](const Planar& u, const Planar& v) { return u[0] < v[0] || (u[0] == v[0] && u[1] < v[1]); });
  points.erase(std::unique(points.begin(), points.end(), [](const Planar& u, const Planar& v) { return u == v; }),
               points.end());
  if (points.size() < 3) return;
  scratch.clear();
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = scratch.size();
    for (const Planar& q : points) {
      while (scratch.size() >= start + 2) {
        const Planar e = scratch.back() - scratch[scratch.size() - 2], f = q - scratch.back();
        if (e[0] * f[1] - e[1] * f[0] > 0) break;
        scratch.pop_back();
      }
      scratch.push_back(q);
    }
    scratch.pop_back();
    std::reverse(points.begin(), points.end());
  }
  points.swap(scratch);
}

inline Planar nearestOnSegment(const Planar& u, const Planar& v, const Planar& q) {
  const Planar e = v - u;
  const Real length2 = e.squaredNorm();
  const Real t = length2 > 0 ? std::clamp((q - u).dot(e) / length2, Real(0), Real(1)) : Real(0);
  return u + t * e;
}

class TouchingPoint {
 public:
  /// Fills the answer's closest points from its normal; answer.distance already includes the radii. For cores that are
  /// apart, the nearest features, now known, may give a better direction, which is then taken. `left`: the error (m)
  /// that the search for the normal was allowed; closest points may leave their shapes by as much. 0: rounding only.
  template <int D>
  void find(const CorePair<D>& pair, Real left, BestAxis<D>& best, PairAnswer<D>& answer, WorkDone& work) {
    Vec<D> common = Vec<D>::Zero();
    const bool boxes = pair.a.core() <= CoreClass::box && pair.b.core() <= CoreClass::box;
    if (boxes && TouchingBoxes<D>(pair, best.n, kFeatureBand * pair.scale).find(common)) {
      m_met = true;
      return place(pair, best, common, answer, work);
    }
    const Real first = std::max(kFeatureBand * pair.scale, left), last = std::max(kLastBand * pair.scale, left);
    for (int round = 0; round < kTouchRounds; ++round) {
      // A normal that is off by a rounding lifts the far end of a feature by more than a rounding: the band grows until
      // the features meet. If they do not meet within the largest band, the search stops.
      Real least = kInf;
      Vec<D> miss = Vec<D>::Zero();
      Seen<D> seen;
      const Real far = best.bound > 0 ? kInf : last;  // the miss distance counts for a better direction only
      const auto meetWithin = [&](Real band) {
        Vec<D> offset = Vec<D>::Zero();
        const Vec<D> q = nearestPlace(pair, best.n, band, left, far, seen, offset, work);
        if (offset.norm() + band < least) least = offset.norm() + band, common = q, miss = offset;
        return !(offset.norm() > band);
      };
      m_met = meetWithin(first);
      if (!m_met && first < last && meetWithin(last)) {
        m_met = true;
        for (Real band = kBandGrowth * first; band < last && !meetWithin(band); band *= kBandGrowth) continue;
      }
      // The common point belongs to this normal: the last round must not change it.
      if (round == kTouchRounds - 1 || !(best.bound > 0) || miss.squaredNorm() == 0) break;
      if (left > 0 && m_met) break;
      Vec<D> direct = best.bound * best.n + miss;
      const Real before = best.bound;
      if (makeUnit<D>(direct)) best.take(direct, pair.bound(direct)), ++work[WorkCount::axisTests];
      if (!(best.bound > before)) break;
    }
    place(pair, best, common, answer, work);
  }
  /// Whether the features of the last pair met within the largest band.
  bool met() const { return m_met; }

 private:
  // Data of curved cores along one normal, independent of the band: the support points towards the other core, each in
  // its own frame; and where a position on the features, displaced by `miss`, was moved on the cores.
  template <int D>
  struct Seen {
    std::optional<Vec<D>> topA, topB;
    Vec<D> missed = Vec<D>::Constant(kInf), by = missed, place = missed, offset = missed;
  };
  template <int D>
  static Vec<D> top(const ShapeView<D>& shape, const Vec<D>& n, std::optional<Vec<D>>& known, WorkDone& work) {
    if (!known) known = supportOf(shape, n, work);
    return *known;
  }
  template <int D>
  static Vec<D> supportOf(const ShapeView<D>& shape, const Vec<D>& d, WorkDone& work) {
    ++work[WorkCount::supportCalls];
    return coreSupport(shape, d);
  }

  // Like commonPoint, for the features within the band.
  template <int D>
  Vec<D> nearestPlace(const CorePair<D>& pair, const Vec<D>& n, Real band, Real left, Real far, Seen<D>& seen,
                      Vec<D>& offset, WorkDone& work) {
    gather(pair, n, band, work);
    Vec<D> q = commonPoint(n, offset);
    for (int more = 0; more < kMostRimPoints && offset.norm() > band; ++more) {
      if (!reachOut(pair, n, offset, band, seen, work)) break;
      const Vec<D> before = offset;
      offset = Vec<D>::Zero();
      q = commonPoint(n, offset);
      if (offset == before || (left > 0 && 2 * offset.norm() > before.norm())) break;  // further steps gain nothing
    }
    if (!(offset.norm() > band) || (!pair.a.curved && !pair.b.curved)) return q;
    if (q != seen.missed || offset != seen.by) {
      seen.missed = q, seen.by = offset;
      standOnCurved(pair, n, left, far, seen, q, offset, work);
      seen.place = q, seen.offset = offset;
    }
    offset = seen.offset;
    return seen.place;
  }

  template <int D>
  static void place(const CorePair<D>& pair, const BestAxis<D>& best, const Vec<D>& common, PairAnswer<D>& answer,
                    WorkDone& work) {
    answer.normal = best.n;
    answer.distance = best.bound - pair.radii();
    if constexpr (D == 3) {
      if (pair.a.core() == CoreClass::box) {  // number by number: triple.h
        const Triple n(best.n), corner = BoxPair3::foremost(Triple(pair.a.half), n);
        const Triple pA = Triple(common) + (dot(corner, n) + pair.a.radius) * n;
        pA.store(answer.pA), (pA + answer.distance * n).store(answer.pB);
        return;
      }
    }
    if (pair.a.core() > CoreClass::box) ++work[WorkCount::supportCalls];  // for other boxes signs alone decide
    const Real height = farthest(pair.a, best.n, nullptr, pair.climbOnA()).dot(best.n) + pair.a.radius;
    answer.pA = common + height * answer.normal;
    answer.pB = answer.pA + answer.distance * answer.normal;
  }

  static constexpr Real kInf = std::numeric_limits<Real>::infinity();

  template <int D>
  void gather(const CorePair<D>& pair, const Vec<D>& n, Real band, WorkDone& work) {
    auto& a = vertices<D>(m_a2, m_a3);
    auto& b = vertices<D>(m_b2, m_b3);
    supportingVertices<D>(pair.a, n, band, a, work, pair.climbOnA());
    supportingVertices<D>(pair.b, Vec<D>(-(pair.r.transpose() * n)), band, b, work, pair.climbOnB());
    for (Vec<D>& v : b) v = pair.p + pair.r * v;
  }
  // The corners of a curved face are a few of its rim: adds the one that lies towards the other feature, if there is.
  template <int D>
  bool reachOut(const CorePair<D>& pair, const Vec<D>& n, const Vec<D>& offset, Real band, Seen<D>& seen,
                WorkDone& work) {
    if (!pair.a.curved && !pair.b.curved) return false;
    const Vec<D> aside = kTilt / offset.norm() * offset;
    bool found = false;
    if (pair.a.curved) {
      const Vec<D> v = supportOf(pair.a, Vec<D>(n + aside), work);
      if (v.dot(n) >= top(pair.a, n, seen.topA, work).dot(n) - band) vertices<D>(m_a2, m_a3).push_back(v), found = true;
    }
    if (pair.b.curved) {
      const Vec<D> back = -(pair.r.transpose() * n);
      const Vec<D> v = supportOf(pair.b, Vec<D>(back - pair.r.transpose() * aside), work);
      if (v.dot(back) >= top(pair.b, back, seen.topB, work).dot(back) - band) {
        vertices<D>(m_b2, m_b3).push_back(pair.p + pair.r * v), found = true;
      }
    }
    return found;
  }
  // More of the face lies between the corners of a curved face and its rim: tests whether the other feature's point is
  // on the core itself.
  template <int D>
  void standOnCurved(const CorePair<D>& pair, const Vec<D>& n, Real left, Real far, Seen<D>& seen, Vec<D>& q,
                     Vec<D>& offset, WorkDone& work) {
    const Vec<D> onA = q - offset / 2, onB = q + offset / 2;
    const Real length = offset.norm();
    const auto take = [&](const Vec<D>& point, Real gap) {
      if (gap < offset.norm()) q = point, offset *= std::max(gap, Real(0)) / length;
    };
    if (pair.a.curved) {
      const Vec<D> at = onB + top(pair.a, n, seen.topA, work).dot(n) * n;
      const auto difference = [&](const Vec<D>& d) { return Vec<D>(supportOf(pair.a, d, work) - at); };
      take(onB, gapToOrigin<D>(difference, -at, left, far).gap);
    }
    if (pair.b.curved) {
      const Vec<D> back = -(pair.r.transpose() * n);
      const Vec<D> across = pair.r.transpose() * (onA - pair.p);
      const Vec<D> at = across + (top(pair.b, back, seen.topB, work) - across).dot(back) * back;
      const auto difference = [&](const Vec<D>& d) { return Vec<D>(supportOf(pair.b, d, work) - at); };
      take(onA, gapToOrigin<D>(difference, -at, left, far).gap);
    }
  }
  template <int D>
  static auto& vertices(std::vector<Vec<2>>& two, std::vector<Vec<3>>& three) {
    if constexpr (D == 2) {
      return two;
    } else {
      return three;
    }
  }

  // The common point without its component along n. If the features miss each other, it is half-way, and `miss` is the
  // vector from A's to B's nearest point, across n.
  Vec<2> commonPoint(const Vec<2>& n, Vec<2>& miss) {
    const Vec<2> t(-n[1], n[0]);
    Real loA = kInf, hiA = -kInf, loB = kInf, hiB = -kInf;
    for (const Vec<2>& v : m_a2) loA = std::min(loA, t.dot(v)), hiA = std::max(hiA, t.dot(v));
    for (const Vec<2>& v : m_b2) loB = std::min(loB, t.dot(v)), hiB = std::max(hiB, t.dot(v));
    const Real lo = std::max(loA, loB), hi = std::min(hiA, hiB);
    if (lo > hi) miss = (loB > hiA ? loB - hiA : hiB - loA) * t;
    return (lo + hi) / 2 * t;
  }
  Vec<3> commonPoint(const Vec<3>& n, Vec<3>& miss) {
    const RealMatrix<3, 2> basis = tangents(n);
    project(m_a3, basis, m_polygonA);
    project(m_b3, basis, m_polygonB);
    Planar offset = Planar::Zero();
    const Planar q = ofPolygons(offset);
    miss = basis * offset;
    return basis * q;
  }

  void project(const std::vector<Vec<3>>& points, const RealMatrix<3, 2>& basis, std::vector<Planar>& out) {
    out.clear();
    for (const Vec<3>& v : points) out.push_back(basis.transpose() * v);
    planarHull(out, m_scratch);
  }

  Planar ofPolygons(Planar& miss) {
    if (m_polygonA.size() < 3 && m_polygonB.size() < 3) {
      return m_polygonA.size() == 2 && m_polygonB.size() == 2 ? ofSegments(miss) : nearest(miss);
    }
    const bool clipB = m_polygonA.size() >= 3;
    const std::vector<Planar>& fixed = clipB ? m_polygonA : m_polygonB;
    m_clip = clipB ? m_polygonB : m_polygonA;
    for (std::size_t i = 0; i < fixed.size() && !m_clip.empty(); ++i) {
      clip(fixed[i], fixed[(i + 1) % fixed.size()]);
    }
    return m_clip.empty() ? nearest(miss) : boxMiddle();
  }

  // Keeps the part to the left of the line u v (Sutherland and Hodgman 1974).
  void clip(const Planar& u, const Planar& v) {
    const Planar e = v - u;
    const auto side = [&](const Planar& q) { return e[0] * (q[1] - u[1]) - e[1] * (q[0] - u[0]); };
    m_scratch.clear();
    for (std::size_t i = 0; i < m_clip.size(); ++i) {
      const Planar &q0 = m_clip[i], &q1 = m_clip[(i + 1) % m_clip.size()];
      const Real s0 = side(q0), s1 = side(q1);
      if (s0 >= 0) m_scratch.push_back(q0);
      if ((s0 > 0 && s1 < 0) || (s0 < 0 && s1 > 0)) m_scratch.push_back(q0 + s0 / (s0 - s1) * (q1 - q0));
    }
    m_clip.swap(m_scratch);
  }

  // The mean of the corners would depend on how often rounding repeats a corner. The mean of the extremes along the
  // longest extent does not, and lies in the convex overlap.
  Planar boxMiddle() const {
    const Planar* lo = &m_clip[0];
    const Planar* hi = &m_clip[0];
    Real longest = -1;
    for (std::size_t i = 0; i < m_clip.size(); ++i) {
      for (std::size_t j = i; j < m_clip.size(); ++j) {
        const Real length = (m_clip[i] - m_clip[j]).squaredNorm();
        if (length > longest * (1 + kSameLength)) longest = length, lo = &m_clip[i], hi = &m_clip[j];
      }
    }
    return (*lo + *hi) / 2;
  }

  Planar ofSegments(Planar& miss) const {
    const Planar e = m_polygonA[1] - m_polygonA[0], f = m_polygonB[1] - m_polygonB[0],
                 w = m_polygonB[0] - m_polygonA[0];
    const Real area = e[0] * f[1] - e[1] * f[0], length2 = e.squaredNorm();
    Real t = 0;
    // Crossing lines meet in one point; (nearly) parallel ones share an interval; its middle is taken.
    if (std::abs(area) > kSharedStretchSine * e.norm() * f.norm()) {
      t = (w[0] * f[1] - w[1] * f[0]) / area;
    } else {
      const Real t0 = w.dot(e) / length2, t1 = (m_polygonB[1] - m_polygonA[0]).dot(e) / length2;
      t = (std::max(Real(0), std::min(t0, t1)) + std::min(Real(1), std::max(t0, t1))) / 2;
    }
    const Planar onA = m_polygonA[0] + std::clamp(t, Real(0), Real(1)) * e;
    const Planar onB = nearestOnSegment(m_polygonB[0], m_polygonB[1], onA);
    miss = onB - onA;
    return (onA + onB) / 2;
  }

  Planar nearest(Planar& miss) const {
    Real least = kInf;
    Planar middle = m_polygonA[0];
    const auto offer = [&](const Planar& onA, const Planar& onB) {
      const Real gap = (onB - onA).squaredNorm();
      if (gap < least) least = gap, middle = (onA + onB) / 2, miss = onB - onA;
    };
    const auto onEdge = [](const std::vector<Planar>& polygon, std::size_t i, const Planar& q) {
      return nearestOnSegment(polygon[i], polygon[(i + 1) % polygon.size()], q);
    };
    for (const Planar& q : m_polygonA) {
      for (std::size_t i = 0; i < m_polygonB.size(); ++i) offer(q, onEdge(m_polygonB, i, q));
    }
    for (const Planar& q : m_polygonB) {
      for (std::size_t i = 0; i < m_polygonA.size(); ++i) offer(onEdge(m_polygonA, i, q), q);
    }
    return middle;
  }

  bool m_met = false;
  std::vector<Vec<2>> m_a2, m_b2;
  std::vector<Vec<3>> m_a3, m_b3;
  std::vector<Planar> m_polygonA, m_polygonB, m_clip, m_scratch;
};

/// Finishes an answer in place from its best axis: radii, normal, closest points if wanted. `left`: see
/// TouchingPoint::find.
template <int D>
void finishAnswer(const CorePair<D>& pair, BestAxis<D>& best, QueryStatus status, QueryNeed need,
                  TouchingPoint& touching, PairAnswer<D>& answer, WorkDone& work, Real left = 0) {
  answer.status = status;
  answer.normal = best.n;
  answer.distance = best.bound - pair.radii();
  if (!std::isfinite(answer.distance))
    answer.status = QueryStatus::failed;  // no direction was finite: the input had a NaN
  if (need == QueryNeed::closestPoints) {
    touching.find(pair, left, best, answer, work);
  } else {
    answer.pA = answer.pB = Vec<D>::Zero();
  }
}

template <int D>
PairAnswer<D> answerFrom(const CorePair<D>& pair, BestAxis<D>& best, QueryStatus status, QueryNeed need,
                         TouchingPoint& touching, WorkDone& work, Real left = 0) {
  PairAnswer<D> answer;
  finishAnswer(pair, best, status, need, touching, answer, work, left);
  return answer;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
