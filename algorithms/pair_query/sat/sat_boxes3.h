// SPDX-License-Identifier: Zlib
// Separating axes of two 3D cores that are boxes, flat ones included: a point is a box of zero size, a segment has one
// extent. All numbers are in registers (triple.h): the arithmetic is half of the time that reading vectors back from
// memory took.
#pragma once

#include "algorithms/pair_query/core/touching_boxes3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// All candidate directions of the pair and the best bound: the signed distance of the cores.
template <class Watch = NoWatch>
class SatBoxes3 {
 public:
  SatBoxes3(const CorePair<3>& pair, QueryNeed need, BestAxis<3>& best, WorkDone& work, const Watch& watch = {})
      : m_watch(watch), m_pair(pair), m_boxes(pair), m_need(need), m_out(best), m_work(work) {}

  void run() {
    LPC_ASSERT(m_pair.a.core() <= CoreClass::box && m_pair.b.core() <= CoreClass::box);
    find();
    m_n.store(m_out.n), m_out.bound = m_bound;
  }

 private:
  static constexpr int kCorners = 8;

  // Axes by number: A's, B's, then the common normals of edge i of A and j of B.
  struct Widest {
    Real gap = -std::numeric_limits<Real>::infinity();
    Real square = 0;  // of the gap, with its sign: an axis that is clearly worse is rejected without a root
    int axis = 0;

    void offer(Real offered, int number) {
      if (offered > gap) gap = offered, axis = number;
    }
    void settle() { square = gap * std::abs(gap) * (gap > 0 ? 1 - kSameLength : Real(1)); }
  };

  void find() {
    const BoxPair3& in = m_boxes;
    const Triple flat[3] = {sizes(in.row(0)), sizes(in.row(1)), sizes(in.row(2))};
    const Triple flatBack[3] = {sizes(in.r[0]), sizes(in.r[1]), sizes(in.r[2])};
    Widest widest;
    offerFaces<0>(flat, flatBack, widest), offerFaces<1>(flat, flatBack, widest), offerFaces<2>(flat, flatBack, widest);
    m_tests += 6;
    widest.settle();
    offerAllEdges(flatBack, widest, std::make_integer_sequence<int, 9>());
    takeWidest(widest.axis);
    m_work[WorkCount::axisTests] += static_cast<std::uint64_t>(m_tests);
    // For cores that are apart, an axis proves the distance only if the nearest features are vertex and face, or edge
    // and edge: pairs of vertices, and of a vertex and an edge, remain. Flat cores in one plane are apart at a bound of
    // zero, except for rounding.
    if (m_need == QueryNeed::boolean && m_bound > m_pair.radii()) return;  // any axis decides the side
    if (m_bound > -kBoundRounding * m_pair.scale && (m_short || !isAttained(widest.axis))) tryCorners();
  }

  void offer(Widest& widest, Real gap, int number) const {
    widest.offer(gap, number);
    m_watch([&](auto& t) { show(t, widest, gap, number); });
  }
  template <int k>
  void offerFaces(const Triple* flat, const Triple* flatBack, Widest& widest) const {
    const BoxPair3& in = m_boxes;
    const Triple& f = flat[k];
    offer(widest, std::abs(in.p[k]) - (in.hA[k] + (f.x * in.hB.x + (f.y * in.hB.y + f.z * in.hB.z))), k);
    offer(widest, std::abs(dot(in.r[k], in.p)) - (in.hB[k] + dot(flatBack[k], in.hA)), 3 + k);
  }
  // Edges parallel within rounding have a common normal of noise. Their axes are skipped only to save time: by
  // core_pair.h no direction can claim more than is true, and the optimum is then a face normal. The common normal e_i
  // x r_j has no component along e_i: with (i, k, l) in cyclic order it is -r(l, j) along k and r(k, j) along l.
  // Indices are compile-time constants: in a loop, the nine take twice as long.
  template <int e>
  void offerEdges(const Triple* flat, Widest& widest) {
    constexpr int i = e / 3, j = e % 3, k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
    const BoxPair3& in = m_boxes;
    const Triple& u = in.r[j];
    const Real length2 = u[k] * u[k] + u[l] * u[l];
    if (!(in.hA[i] > 0 && in.hB[j] > 0)) return;
    if (!(length2 >= kShortNormal * kShortNormal)) return offerShort(e, u, length2, widest);
    ++m_tests;
    const Real along = std::abs(u[k] * in.p[l] - u[l] * in.p[k]);
    const Real reach = in.hA[k] * flat[j][l] + in.hA[l] * flat[j][k] + in.hB[m] * flat[n][i] + in.hB[n] * flat[m][i];
    const Real gap = along - reach;
    if (gap * std::abs(gap) < widest.square * length2) {
      m_watch([&](auto& t) { show(t, widest, gap / std::sqrt(length2), 6 + e); });
      return;
    }
    offer(widest, gap / std::sqrt(length2), 6 + e);
    widest.settle();
  }
  void offerShort(int e, const Triple& u, Real length2, const Widest& widest) {
    if (!(length2 > kParallelSine * kParallelSine)) return;
    ++m_tests, m_short = true;  // products of rounded numbers, divided by little
    const Triple axis = across(e / 3, u);
    const Real length = norm(axis);
    [[maybe_unused]] const Real bound = take({axis.x / length, axis.y / length, axis.z / length});
    m_watch([&](auto& t) { show(t, widest, bound, 6 + e); });
  }
  template <int... e>
  void offerAllEdges(const Triple* flat, Widest& widest, std::integer_sequence<int, e...>) {
    (offerEdges<e>(flat, widest), ...);
  }
  static const Triple& unit(int i) {
    static const Triple kUnit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return kUnit[i];
  }
  static Triple across(int i, const Triple& u) { return cross(unit(i), u); }

  // Both signs at once: boxes are their own mirror images. The reported bound is that of the reported vector itself.
  Real take(const Triple& n) {
    const Real along = dot(n, m_boxes.p);
    const Real reach = dot(m_boxes.hA, sizes(n)) + dot(m_boxes.hB, sizes(m_boxes.back(n)));
    // A branch on the side would be mispredicted half of the time.
    const Real bound = std::abs(along) - reach;
    takeBound(std::copysign(Real(1), along + 0) * n, bound);
    return bound;
  }
  void takeBound(const Triple& n, Real bound) {
    if (bound > m_bound) m_n = n, m_bound = bound;
  }
  void takeWidest(int number) {
    take(axis(number));
    m_watch([&](auto& t) { t.refined(m_pair, best(), "the widest axis's own vector"); });
  }
  Triple axis(int number) const {
    if (number < 6) return number < 3 ? unit(number) : m_boxes.r[number - 3];
    const Triple n = across((number - 6) / 3, m_boxes.r[(number - 6) % 3]);
    const Real length = norm(n);
    return {n.x / length, n.y / length, n.z / length};
  }

  // For traces.
  BestAxis<3> best() const { return {m_n.vector(), m_bound}; }
  Vec<3> facing(const Triple& n) const { return (dot(n, m_boxes.p) < 0 ? -n : n).vector(); }
  void show(auto& t, const Widest& widest, Real gap, int number) const {
    const BestAxis<3> most = widest.gap > m_bound ? BestAxis<3>{facing(axis(widest.axis)), widest.gap} : best();
    const auto what = number < 6 ? t.part("face", number % 3, number < 3)
                                 : t.part("edge", (number - 6) / 3, true) + ", " + t.part("edge", number % 3, false);
    t.axis(m_pair, facing(axis(number)), gap, most, what);
  }
  void tryDirection(Triple n) {
    if (!makeUnit(n)) return;
    ++m_work[WorkCount::axisTests];
    const Real bound = dot(n, m_boxes.p) - dot(m_boxes.hA, sizes(n)) - dot(m_boxes.hB, sizes(m_boxes.back(n)));
    takeBound(n, bound);
    m_watch([&](auto& t) { t.axis(m_pair, n.vector(), bound, best(), "between the nearest features"); });
  }

  // Whether the features of the axis lie above each other: a vertex above the face, or edges that cross. Then their
  // distance is the bound, and no corner is nearer.
  bool isAttained(int number) const {
    const BoxPair3& in = m_boxes;
    const Triple back = -in.back(m_n), onA = in.foremost(in.hA, m_n), onB = in.foremost(in.hB, back);
    if (number >= 3 && number < 6) return isAbove(number - 3, in.back(onA - in.p), in.hB);
    const Triple from = in.p + in.turned(onB);
    if (number < 3) return isAbove(number, from, in.hA);
    const int i = (number - 6) / 3, j = (number - 6) % 3;
    const Triple &u = in.r[j], &e = unit(i), &f = unit(j);
    const Triple w = from - onA;  // w + t u - s e_i is orthogonal to both lines
    const Real cosine = dot(e, u), sine2 = dot(u, u) - cosine * cosine, alongA = dot(e, w), alongB = dot(w, u);
    if (!(sine2 > kCrossingSine * kCrossingSine)) return false;
    const Real t = (alongA * cosine - alongB) / sine2, s = alongA + t * cosine;
    return std::abs(dot(e, onA) + s) <= dot(e, in.hA) && std::abs(dot(f, onB) + t) <= dot(f, in.hB);
  }
  static bool isAbove(int face, const Triple& q, const Triple& half) {
    const bool x = std::abs(q.x) <= half.x, y = std::abs(q.y) <= half.y, z = std::abs(q.z) <= half.z;
    return (x | (face == 0)) & (y | (face == 1)) & (z | (face == 2));
  }

  // A box's corners in the other's frame. Along an axis without extent both ends are one corner.
  struct Corners {
    Real x[kCorners], y[kCorners], z[kCorners];
    Real length2[kCorners];  // of the vector to the other box
    Real lag[kCorners];      // distance behind the support corner along the best axis
  };
  void corners(bool ofA, Corners& out) const {
    const BoxPair3& in = m_boxes;
    const Triple &half = ofA ? in.hA : in.hB, &other = ofA ? in.hB : in.hA;
    const Triple along = ofA ? m_n : -in.back(m_n), corner = in.foremost(half, along);
    const Triple first = ofA ? in.back(corner - in.p) : in.p + in.turned(corner);
    out.x[0] = first.x, out.y[0] = first.y, out.z[0] = first.z, out.lag[0] = 0;
    addMirrored<0>(ofA, half, along, corner, out), addMirrored<1>(ofA, half, along, corner, out);
    addMirrored<2>(ofA, half, along, corner, out);
    for (int i = 0; i < kCorners; ++i) {  // the compiler takes several at a time
      const Real x = beyond(out.x[i], other.x), y = beyond(out.y[i], other.y), z = beyond(out.z[i], other.z);
      out.length2[i] = dot(Triple(x, y, z), Triple(x, y, z));
    }
  }
  template <int k>
  void addMirrored(bool ofA, const Triple& half, const Triple& along, const Triple& corner, Corners& out) const {
    const Triple edge = Real(2) * corner[k] * (ofA ? m_boxes.row(k) : m_boxes.r[k]);
    const Real behind = half[k] > 0 ? 2 * half[k] * std::abs(along[k]) : std::numeric_limits<Real>::infinity();
    constexpr int count = 1 << k;
    for (int i = 0; i < count; ++i) {
      out.x[i + count] = out.x[i] - edge.x, out.y[i + count] = out.y[i] - edge.y;
      out.z[i + count] = out.z[i] - edge.z, out.lag[i + count] = out.lag[i] + behind;
    }
  }
  // The larger of zero and x less the half extent, without a branch. An overflow has an infinite square anyway.
  static Real beyond(Real x, Real half) {
    const Real far = std::abs(x) - half;
    return (far + std::abs(far)) / 2;
  }
  // Vector from the corner to the nearest point of the other box.
  Triple toOther(const Corners& c, int i, bool ofA) const {
    const Triple &h = ofA ? m_boxes.hB : m_boxes.hA, q(c.x[i], c.y[i], c.z[i]);
    const auto way = [](Real x, Real half) {
      const Real raised = -half > x ? -half : x;
      return (half < raised ? half : raised) - x;
    };
    return {way(q.x, h.x), way(q.y, h.y), way(q.z, h.z)};
  }
  // pB - pA in A's frame.
  Triple toB(const Triple& v, bool ofA) const { return ofA ? m_boxes.turned(v) : -v; }

  void tryCorners() {
    const Real slack = kBoundRounding * m_pair.scale;
    Corners both[2];
    corners(true, both[0]), corners(false, both[1]);
    Real least2 = std::numeric_limits<Real>::infinity();
    int nearest = 0;
    for (int i = 0; i < 2 * kCorners; ++i) {
      const Corners& c = both[i / kCorners];
      if (c.lag[i % kCorners] < std::numeric_limits<Real>::infinity() && c.length2[i % kCorners] < least2) {
        least2 = c.length2[i % kCorners], nearest = i;
      }
    }
    tryDirection(toB(toOther(both[nearest / kCorners], nearest % kCorners, nearest < kCorners), nearest < kCorners));
    const Real least = std::sqrt(least2);
    if (m_bound >= least - slack) return;
    // Among equally near features rounding decides which is nearest, but not which direction proves most.
    const Real tie = least + kTiePart * least + kTieRounding * m_pair.scale;
    const Real proved = m_bound;  // another direction may have proved more
    corners(true, both[0]), corners(false, both[1]);
    for (int i = 0; i < 2 * kCorners; ++i) {
      const Corners& c = both[i / kCorners];
      const int k = i % kCorners;
      if (proved + c.lag[k] > tie || !(std::sqrt(c.length2[k]) <= tie)) continue;
      tryDirection(toB(toOther(c, k, i < kCorners), i < kCorners));
    }
  }

  [[no_unique_address]] Watch m_watch;
  const CorePair<3>& m_pair;
  const BoxPair3 m_boxes;
  QueryNeed m_need;
  BestAxis<3>& m_out;
  WorkDone& m_work;
  Triple m_n;
  Real m_bound = -std::numeric_limits<Real>::infinity();
  int m_tests = 0;
  bool m_short = false;  // an axis that is not finite was tried
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
