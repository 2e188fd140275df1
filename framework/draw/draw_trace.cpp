// SPDX-License-Identifier: Zlib
#include <Eigen/QR>
#include <algorithm>
#include <numbers>

#include "framework/draw/debug_draw.h"
#include "framework/shape/support_map.h"
#include "framework/stage/pair_trace.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr DrawColour kGrey{130, 130, 130, 255}, kBlue{40, 90, 220, 255}, kYellow{230, 160, 0, 255},
    kGreen{20, 160, 60, 255};
constexpr double kSmall = 3, kDot = 6, kBig = 9;  // pixels

bool bounded(const PairView<2>& pair) { return pair.a.core() != CoreClass::plane && pair.b.core() != CoreClass::plane; }
bool bounded(const PairView<3>& pair) { return pair.a.core() != CoreClass::plane && pair.b.core() != CoreClass::plane; }

// The point of the difference with the least n . w.
template <int D>
Vec<D> differenceAlong(const PairView<D>& pair, const Vec<D>& n) {
  return pair.X_AB * coreSupport(pair.b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n))) - coreSupport(pair.a, n);
}

// Points of the difference in all directions; in 2D in order.
std::vector<Vec<2>> around(const PairView<2>& pair) {
  constexpr int kDirections = 96;
  std::vector<Vec<2>> out;
  for (int k = 0; bounded(pair) && k < kDirections; ++k) {
    const double angle = 2 * std::numbers::pi * k / kDirections;
    out.push_back(differenceAlong<2>(pair, Rot<2>::angle(angle) * Vec<2>(1, 0)));
  }
  return out;
}
std::vector<Vec<3>> around(const PairView<3>& pair) {
  constexpr int kHalf = 3;  // directions through a grid of points on a cube's surface
  std::vector<Vec<3>> out;
  for (int x = -kHalf; bounded(pair) && x <= kHalf; ++x) {
    for (int y = -kHalf; y <= kHalf; ++y) {
      for (int z = -kHalf; z <= kHalf; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) < kHalf) continue;
        out.push_back(differenceAlong<3>(pair, Vec<3>(Real(x), Real(y), Real(z))));
      }
    }
  }
  return out;
}

template <int D>
void drawAll(const std::vector<Vec<D>>& points, double pixels, const DrawColour& colour, DebugDraw<D>& draw) {
  for (const Vec<D>& p : points) draw.point(p, pixels, colour);
}

// A line between every two points, as in a simplex.
template <int D>
void drawEdges(const std::vector<Vec<D>>& points, const DrawColour& colour, DebugDraw<D>& draw) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = i + 1; k < points.size(); ++k) draw.line(points[i], points[k], colour);
  }
}

// A rim, ordered around n.
template <int D>
void drawRim(std::vector<Vec<D>> points, const Vec<D>& n, const DrawColour& colour, DebugDraw<D>& draw) {
  drawAll(points, kDot, colour, draw);
  if constexpr (D == 3) {
    const RealMatrix<3, 2> t = tangents(n);
    Vec<3> middle = Vec<3>::Zero();
    for (const Vec<3>& p : points) middle += p / static_cast<Real>(points.size());
    const auto turn = [&](const Vec<3>& p) {
      const RealMatrix<2, 1> q = t.transpose() * (p - middle);
      return angleOf(static_cast<double>(q[1]), static_cast<double>(q[0]));
    };
    std::sort(points.begin(), points.end(), [&](const Vec<3>& p, const Vec<3>& q) { return turn(p) < turn(q); });
  }
  for (std::size_t i = 0; points.size() > 1 && i < points.size(); ++i) {
    draw.line(points[i], points[(i + 1) % points.size()], colour);
  }
}

// The points of the cores that differ by the simplex's nearest point. False when a corner is not a recorded support
// point.
template <int D>
bool nearestOnShapes(const std::vector<Vec<D>>& onA, const std::vector<Vec<D>>& onB, const Vec<D>& nearest, Vec<D>& a,
                     Vec<D>& b) {
  const auto count = static_cast<Eigen::Index>(onA.size());
  Eigen::Matrix<Real, D + 1, Eigen::Dynamic> corners(D + 1, count);
  RealMatrix<D + 1, 1> wanted;
  const Real size = std::max({nearest.norm(), (onB[0] - onA[0]).norm(), std::numeric_limits<Real>::min()});
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    corners.col(i) << (onB[k] - onA[k]), size;
  }
  wanted << nearest, size;
  const Eigen::Matrix<Real, Eigen::Dynamic, 1> weights = corners.colPivHouseholderQr().solve(wanted);
  a.setZero(), b.setZero();
  for (Eigen::Index i = 0; i < count; ++i) {
    a += weights[i] * onA[static_cast<std::size_t>(i)], b += weights[i] * onB[static_cast<std::size_t>(i)];
  }
  return weights.allFinite();
}

}  // namespace

template <int D>
void drawTrace(const PairTrace<D>& trace, std::size_t number, DebugDraw<D>& draw) {
  const TraceStep<D>& step = trace.steps.at(number);
  const std::vector<Vec<D>> outline = around(trace.pair);
  Real size = 0;
  for (const Vec<D>& p : outline) size = std::max(size, p.norm());
  if (D == 2) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      draw.line(outline[i], outline[(i + 1) % outline.size()], kGrey);
    }
  } else {
    drawAll(outline, kSmall, kGrey, draw);
  }
  const Vec<D> origin = Vec<D>::Zero();
  for (int k = 0; k < D; ++k) {
    const Vec<D> arm = size / 20 * Vec<D>::Unit(k);
    draw.line(origin - arm, origin + arm, kGrey);
  }

  if (step.faces.empty()) drawEdges(step.corners, kBlue, draw);
  for (std::size_t i = 0; i < step.faces.size(); ++i) {
    const auto& face = step.faces[i];
    const DrawColour colour = static_cast<int>(i) == step.face ? kYellow : kBlue;
    for (std::size_t k = 0; k + (D == 2) < face.size(); ++k) {
      const auto at = [&](std::size_t c) { return step.corners[face[c % face.size()]]; };
      draw.line(at(k), at(k + 1), colour);
    }
  }
  drawAll(step.corners, kDot, kBlue, draw);
  if (step.nearest) draw.point(*step.nearest, kBig, kBlue), draw.line(origin, *step.nearest, kBlue);

  if (std::isfinite(step.best)) draw.line(origin, step.best * step.bestAxis, kGreen);
  if (step.kind == TraceKind::answer || step.direction.isZero(0)) return;
  const Vec<D> foot = step.bound * step.direction;
  draw.line(origin, foot, kYellow);
  draw.point(step.support, kBig, kYellow);
  draw.line(foot, step.support, kYellow);
  const auto across = tangents(step.direction);
  for (int k = 0; k < D - 1; ++k) {
    const Vec<D> arm = size / 4 * across.col(k);
    draw.line(foot - arm, foot + arm, kYellow);
  }
}

template <int D>
void drawTraceOnShapes(const PairTrace<D>& trace, std::size_t number, const Pose<D>& X_WA, DebugDraw<D>& draw) {
  const TraceStep<D>& step = trace.steps.at(number);
  const auto placed = [&](std::vector<Vec<D>> points) {
    for (Vec<D>& p : points) p = X_WA * p;
    return points;
  };
  // A corner of the simplex is the support point of an earlier step.
  std::vector<Vec<D>> onA, onB;
  for (const Vec<D>& w : step.corners) {
    for (std::size_t i = 0; i < number; ++i) {
      const TraceStep<D>& s = trace.steps[i];
      if (s.direction.isZero(0) || s.support != w) continue;
      onA.push_back(s.supportA), onB.push_back(s.supportB);
      break;
    }
  }
  for (const auto* points : {&onA, &onB}) {
    if (step.faces.empty()) drawEdges(placed(*points), kBlue, draw);
    drawAll(placed(*points), kDot, kBlue, draw);
  }
  Vec<D> a, b;
  const bool known = step.nearest && !onA.empty() && onA.size() == step.corners.size();
  if (known && nearestOnShapes<D>(onA, onB, *step.nearest, a, b)) {
    draw.point(X_WA * a, kBig, kBlue), draw.point(X_WA * b, kBig, kBlue);
    draw.line(X_WA * a, X_WA * b, kBlue);
  }

  if (step.direction.isZero(0)) return;
  if (step.kind == TraceKind::answer) {
    draw.point(X_WA * step.supportA, kBig, kGreen), draw.point(X_WA * step.supportB, kBig, kGreen);
    draw.line(X_WA * step.supportA, X_WA * step.supportB, kGreen);
    return;
  }
  const Vec<D> n = X_WA.q * step.direction;
  drawRim(placed(step.featureA), n, kYellow, draw);
  drawRim(placed(step.featureB), n, kYellow, draw);
  Vec<D> from = Vec<D>::Zero();
  for (const Vec<D>& v : step.featureA) from += v / static_cast<Real>(step.featureA.size());
  draw.line(X_WA * from, X_WA * Vec<D>(from + step.bound * step.direction), kYellow);
}

template void drawTrace(const PairTrace<2>&, std::size_t, DebugDraw<2>&);
template void drawTrace(const PairTrace<3>&, std::size_t, DebugDraw<3>&);
template void drawTraceOnShapes(const PairTrace<2>&, std::size_t, const Pose<2>&, DebugDraw<2>&);
template void drawTraceOnShapes(const PairTrace<3>&, std::size_t, const Pose<3>&, DebugDraw<3>&);

}}  // namespace lpc::LPC_PRECISION
