// SPDX-License-Identifier: Zlib
// Contact reduction: which of many points a manifold keeps, four in 3D by one of several rules, and two in 2D.
//
// All rules keep one of the deepest points, within the pair's tolerance; a solver without it lets the body sink. Among
// equal points the one with the smaller feature number wins, and it is replaced only for a clear gain, so that the
// choice is the same in the next step.
#pragma once

#include "algorithms/contacts/patch/contact_patch.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

enum class Reduction { spread, area, extremes, deepest };

inline void visitReduction(ParamVisitor& v, Reduction& rule) {
  v.choice("reduction", rule, {"spread", "area", "extremes", "deepest"},
           "which four points a patch keeps in 3D; in 2D it has two ends");
}

/// Failures of the two rules that ignore the area, in 3D.
inline void declareNarrowRules(std::vector<FailureMode>& failures) {
  failures.push_back({"reduction=extremes: a patch of many corners that lies aslant",
                      "the extreme ones are few, or neighbours", "Contacts.RockingFacesSpanThePatch"});
  failures.push_back({"reduction=deepest: a face on a face", "four points of one side, or what rounding says",
                      "Contacts.RockingFacesSpanThePatch"});
}

/// Indices into a list of points.
struct KeptPoints {
  std::array<std::size_t, 4> at{};
  std::size_t count = 0;

  void add(std::size_t i) { at[count++] = i; }
  bool has(std::size_t i) const { return std::find(at.begin(), at.begin() + count, i) != at.begin() + count; }
};

template <int D>
Real deepestOf(std::span<const PatchPoint<D>> points) {
  Real least = points[0].separation;
  for (const PatchPoint<D>& p : points) least = std::min(least, p.separation);
  return least;
}
/// The first point that is as deep as the deepest, within the tolerance.
template <int D>
std::size_t firstDeep(std::span<const PatchPoint<D>> points, Real tolerance) {
  const Real least = deepestOf(points);
  std::size_t i = 0;
  while (points[i].separation > least + tolerance) ++i;
  return i;
}

/// Keeps one of the deepest points and one far from it, and the farthest on both sides of the line through them. Points
/// that add no area are dropped.
inline KeptPoints keepSpread(const Vec<3>& n, Real tolerance, std::span<const PatchPoint<3>> points) {
  const Real deepest = deepestOf(points);
  std::size_t ends[2] = {firstDeep(points, tolerance), 0};
  const auto apart = [&](std::size_t i, std::size_t k) { return (points[i].p2 - points[k].p2).squaredNorm(); };
  // To the far end and back, until neither end changes: the four points then span at least half of the area.
  Real best = 0;
  for (int sweep = 0; sweep < kMostSpreads; ++sweep) {
    const std::size_t here = ends[sweep % 2];
    bool moved = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool allowed = sweep % 2 == 0 || points[i].separation <= deepest + tolerance;
      if (allowed && apart(i, here) > kClearGain * best) best = apart(i, here), ends[1 - sweep % 2] = i, moved = true;
    }
    if (!moved) break;
  }
  KeptPoints kept;
  kept.add(ends[0]);
  if (best > 0) kept.add(ends[1]);
  const Vec<3> p0 = points[ends[0]].p2;
  const Vec<3> across = n.cross(points[ends[1]].p2 - p0);
  const Real least = tolerance * across.norm();
  Real left = least, right = least;
  std::size_t l = 0, r = 0;
  bool hasLeft = false, hasRight = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Real area = across.dot(points[i].p2 - p0);
    if (area > kClearGain * left) left = area, l = i, hasLeft = true;
    if (-area > kClearGain * right) right = -area, r = i, hasRight = true;
  }
  if (hasLeft) kept.add(l);
  if (hasRight) kept.add(r);
  return kept;
}

/// Keeps one of the deepest, the farthest from it, the point that makes the largest triangle with both, and the point
/// that adds most to the triangle. They span at least a quarter of the area, less kClearGain^-3/2. Let L be the
/// distance of the first two, l and r the largest heights above their line on its two sides. All points lie within L of
/// the first, so their area is at most 2 L (l + r). The triangle has L max(l, r) / 2, and the other side alone would
/// add L min(l, r) / 2.
inline KeptPoints keepArea(const Vec<3>& n, Real tolerance, std::span<const PatchPoint<3>> points) {
  // The first of the points with the largest value above `least`, except for a clear gain; none if there is no such
  // point.
  const auto largest = [&](Real least, const auto& value, std::size_t& at) {
    bool found = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Real v = value(i);
      if (v > kClearGain * least) least = v, at = i, found = true;
    }
    return found;
  };
  KeptPoints kept;
  const std::size_t a = firstDeep(points, tolerance);
  std::size_t b = a, c = a, d = a;
  kept.add(a);
  const auto place = [&](std::size_t i) -> Vec<3> { return points[i].p2 - points[a].p2; };
  if (!largest(
          0, [&](std::size_t i) { return place(i).squaredNorm(); }, b))
    return kept;
  kept.add(b);
  const Vec<3> pb = place(b), across = n.cross(pb);
  const Real least = tolerance * across.norm();
  if (!largest(
          least, [&](std::size_t i) { return std::abs(across.dot(place(i))); }, c)) {
    // On a line the deepest point may lie between its ends.
    const auto beyond = [&](std::size_t i) { return (place(i) - pb).squaredNorm(); };
    if (largest(beyond(a), beyond, d)) kept.add(d);
    return kept;
  }
  kept.add(c);
  // A point outside the triangle sees one or two of its edges, and adds the triangles on those.
  const Vec<3> pc = place(c), m = across.dot(pc) > 0 ? n : Vec<3>(-n);
  const auto beside = [&](const Vec<3>& from, const Vec<3>& to, const Vec<3>& p) {
    return std::max(m.cross(from - to).dot(p - from), Real(0));
  };
  const auto added = [&](std::size_t i) {
    const Vec<3> p = place(i);
    return beside(Vec<3>::Zero(), pb, p) + beside(pb, pc, p) + beside(pc, Vec<3>::Zero(), p);
  };
  if (largest(least, added, d)) kept.add(d);
  return kept;
}

/// Keeps the extreme points along four directions fixed in shape 1; one of the deepest replaces the nearest of them. A
/// corner may be extreme along two directions: then there are fewer points.
inline KeptPoints keepExtremes(const Vec<3>& n, Real tolerance, std::span<const PatchPoint<3>> points) {
  const Vec<3> t1 = n.cross(Vec<3>::Unit(std::abs(n[0]) > kLeansOnX ? 1 : 0)).normalized(), t2 = n.cross(t1);
  KeptPoints kept;
  for (const Vec<3>& t : {t1, Vec<3>(-t1), t2, Vec<3>(-t2)}) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (t.dot(points[i].p2 - points[best].p2) > tolerance) best = i;
    }
    if (!kept.has(best)) kept.add(best);
  }
  const std::size_t deep = firstDeep(points, tolerance);
  if (kept.has(deep)) return kept;
  if (kept.count < kept.at.size()) {
    kept.add(deep);
    return kept;
  }
  const auto apart = [&](std::size_t i) { return (points[i].p2 - points[deep].p2).squaredNorm(); };
  *std::min_element(kept.at.begin(), kept.at.end(), [&](std::size_t i, std::size_t k) { return apart(i) < apart(k); }) =
      deep;
  return kept;
}

/// Keeps the four deepest, wherever they lie.
inline KeptPoints keepDeepest(Real tolerance, std::span<const PatchPoint<3>> points) {
  KeptPoints kept;
  while (kept.count < kept.at.size()) {
    Real least = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!kept.has(i)) least = std::min(least, points[i].separation);
    }
    std::size_t next = 0;
    while (kept.has(next) || points[next].separation > least + tolerance) ++next;
    kept.add(next);
  }
  return kept;
}

/// n: unit normal of the patch, of either sign. Depths that differ by less than the tolerance (m) count as equal. If
/// points were dropped, the rest is sorted by feature.
inline void reducePatch(Reduction rule, const Vec<3>& n, Real tolerance, std::vector<PatchPoint<3>>& points) {
  if (points.size() <= 4) return;
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.feature < b.feature; });
  KeptPoints kept;
  switch (rule) {
    case Reduction::spread:
      kept = keepSpread(n, tolerance, points);
      break;
    case Reduction::area:
      kept = keepArea(n, tolerance, points);
      break;
    case Reduction::extremes:
      kept = keepExtremes(n, tolerance, points);
      break;
    case Reduction::deepest:
      kept = keepDeepest(tolerance, points);
      break;
  }
  std::sort(kept.at.begin(), kept.at.begin() + kept.count);
  for (std::size_t i = 0; i < kept.count; ++i) points[i] = points[kept.at[i]];
  points.resize(kept.count, points[0]);
}

/// In 2D keeps one of the deepest points and the one farthest from it.
inline void reducePatch(Reduction, const Vec<2>& n, Real tolerance, std::vector<PatchPoint<2>>& points) {
  if (points.size() <= 2) return;
  const Vec<2> t(-n[1], n[0]);
  const std::size_t deep = firstDeep<2>(points, tolerance);
  std::size_t far = 0;
  const auto apart = [&](std::size_t i) { return std::abs(t.dot(points[i].p1 - points[deep].p1)); };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (apart(i) > apart(far)) far = i;
  }
  points = {points[deep], points[far]};
}

}}}  // namespace lpc::LPC_PRECISION::contacts
