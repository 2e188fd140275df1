// SPDX-License-Identifier: Zlib
// The painter's algorithm for convex parts: compares them pair by pair, then finds an order that agrees with all
// comparisons.
#include "experiments/film/depth_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "experiments/film/picture.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::size_t kCorners = 16;  // of an outline in comparisons
constexpr double kLeastShared = 0.5;  // px^2: smaller overlaps are seams between neighbours, and rounding

double signedArea(const std::vector<Vec<2>>& p) {
  double twice = 0;
  for (std::size_t i = 2; i < p.size(); ++i) {
    const Vec<2> a = p[i - 1] - p[0], b = p[i] - p[0];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

// The same outline with few corners, inside it, counter-clockwise.
std::vector<Vec<2>> plainer(const std::vector<Vec<2>>& outline) {
  std::vector<Vec<2>> out;
  const std::size_t stride = (outline.size() + kCorners - 1) / kCorners;
  for (std::size_t i = 0; i < outline.size(); i += stride) out.push_back(outline[i]);
  if (signedArea(out) < 0) std::reverse(out.begin(), out.end());
  return out;
}

std::vector<Vec<2>> sharedPart(std::vector<Vec<2>> a, const std::vector<Vec<2>>& b) {
  for (std::size_t k = 0; k < b.size() && !a.empty(); ++k) {
    const Vec<2> along = b[(k + 1) % b.size()] - b[k], inward(-along[1], along[0]);
    a = cutPolygon(a, inward, inward.dot(b[k]));
  }
  return a;
}

struct Span {
  Vec<2> lo, hi;
};
Span spanOf(const std::vector<Vec<2>>& corners) {
  Span out{Vec<2>::Constant(std::numeric_limits<double>::infinity()), {}};
  out.hi = -out.lo;
  for (const Vec<2>& c : corners) out.lo = out.lo.cwiseMin(c), out.hi = out.hi.cwiseMax(c);
  return out;
}

}  // namespace

std::function<double(const Vec<2>&)> nearnessOf(const ShapeView<3>& shape, const Pose<3>& X_WS,
                                                const Camera<3>& camera) {
  if (shape.core() == CoreClass::point || shape.core() == CoreClass::segment) {
    const Vec<3> along_W = X_WS.q * Vec<3>(shape.core() == CoreClass::point ? 0 : shape.half[0], 0, 0);
    const Vec<2> from = camera.flat(X_WS.p - along_W), along = 2 * camera.flat(along_W);
    const double start = (X_WS.p - along_W).dot(camera.towards), climb = 2 * along_W.dot(camera.towards);
    return [=, radius = double(shape.radius)](const Vec<2>& pixel) {
      const Vec<2> way = camera.flatOf(pixel) - from;
      const double t = std::clamp(way.dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
      return start + t * climb + std::sqrt(std::max(0.0, radius * radius - (way - t * along).squaredNorm()));
    };
  }
  // Nearness is linear on each plane; the surface is the farthest of the planes that face the viewer.
  std::vector<Vec<3>> planes;  // (at the origin of the flat coordinates, per m to the right, per m up)
  const auto add = [&](const Vec<3>& normal_S, double offset) {
    const Vec<3> n_W = X_WS.q * normal_S;
    const double facing = n_W.dot(camera.towards);
    if (facing < 1e-9) return;
    const double h = offset + shape.radius + n_W.dot(X_WS.p);
    planes.push_back(Vec<3>(h, -n_W.dot(camera.right), -n_W.dot(camera.up)) / facing);
  };
  if (shape.core() == CoreClass::hull) {
    for (const auto& f : shape.hull->faces) add(f.normal, f.offset);
  } else {
    for (int i = 0; i < 27; ++i) {
      const Vec<3> d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      if (d.isZero() || (shape.core() == CoreClass::box && d.squaredNorm() > 1)) continue;
      add(d.normalized(), coreSupport(shape, d).dot(d.normalized()));
    }
  }
  return [=](const Vec<2>& pixel) {
    const Vec<2> at = camera.flatOf(pixel);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec<3>& p : planes) nearest = std::min(nearest, p.dot(Vec<3>(1, at[0], at[1])));
    return nearest;
  };
}

DepthOrder depthOrder(const std::vector<SeenPart>& seen) {
  const std::size_t count = seen.size();
  std::vector<std::vector<Vec<2>>> outlines;
  std::vector<Span> spans;
  for (const SeenPart& s : seen) {
    outlines.push_back(plainer(s.outline));
    spans.push_back(spanOf(outlines.back()));
  }
  std::vector<std::size_t> byLeft(count);
  std::iota(byLeft.begin(), byLeft.end(), std::size_t{0});
  std::stable_sort(byLeft.begin(), byLeft.end(),
                   [&](std::size_t a, std::size_t b) { return spans[a].lo[0] < spans[b].lo[0]; });

  DepthOrder out;
  std::vector<std::vector<std::size_t>> coveredBy(count);
  std::vector<std::size_t> covers(count, 0);  // among parts that are not yet in the order
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t a = byLeft[i];
    for (std::size_t k = i + 1; k < count && spans[byLeft[k]].lo[0] < spans[a].hi[0]; ++k) {
      const std::size_t b = byLeft[k];
      if (spans[a].hi[1] <= spans[b].lo[1] || spans[b].hi[1] <= spans[a].lo[1]) continue;
      const std::vector<Vec<2>> both = sharedPart(outlines[a], outlines[b]);
      if (signedArea(both) < kLeastShared) continue;
      Vec<2> middle = Vec<2>::Zero();
      for (const Vec<2>& c : both) middle += c / static_cast<double>(both.size());
      const bool aIsNearer = seen[a].nearness(middle) > seen[b].nearness(middle);
      const auto [back, front] = aIsNearer ? std::pair(b, a) : std::pair(a, b);
      coveredBy[back].push_back(front), ++covers[front];
      out.covered.emplace_back(back, front);
    }
  }

  std::set<std::size_t> waiting, ready;
  for (std::size_t i = 0; i < count; ++i) (covers[i] == 0 ? ready : waiting).insert(i);
  while (out.backToFront.size() < count) {
    std::set<std::size_t>& from = ready.empty() ? waiting : ready;  // a cycle is cut at its first part
    const std::size_t next = *from.begin();
    from.erase(from.begin());
    out.backToFront.push_back(next);
    for (const std::size_t f : coveredBy[next]) {
      if (--covers[f] == 0 && waiting.erase(f) > 0) ready.insert(f);
    }
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
