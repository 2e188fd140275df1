// SPDX-License-Identifier: Zlib
#pragma once

#include <Eigen/QR>
#include <limits>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// How far a convex set lies from the origin at least, and along which unit direction n: n . m >= gap on all of it.
template <int D>
struct Gap {
  Real gap = -std::numeric_limits<Real>::infinity();  // <= 0: the origin is in the set, or on it within rounding
  Vec<D> n = Vec<D>::Zero();
};

/// By the walk of Gilbert, Johnson and Keerthi (1988). `support(d)` is a point of the set that lies farthest along d.
/// What is returned is the best bound that was met and no difference of points, so a direction that is off by a little
/// costs only the square of that little. For few questions about sets without corners: the nearest point of a simplex
/// is looked for among all its faces.
template <int D, class Support>
Gap<D> gapToOrigin(const Support& support, Vec<D> start) {
  constexpr int kMostSteps = 64;
  using Edges = Eigen::Matrix<Real, D, Eigen::Dynamic, 0, D, D>;
  Gap<D> best;
  std::array<Vec<D>, static_cast<std::size_t>(D) + 1> points;
  std::size_t count = 0;
  Vec<D> v = start.squaredNorm() > 0 ? start : Vec<D>(Vec<D>::Unit(0));
  for (int step = 0; step < kMostSteps; ++step) {
    const Real length = v.norm();
    const Vec<D> n = v / length;
    const Vec<D> w = support(Vec<D>(-n));
    if (n.dot(w) > best.gap) best = {n.dot(w), n};
    if (step > 0 && length - best.gap <= 4 * std::numeric_limits<Real>::epsilon() * (length + w.norm())) break;
    if (count == points.size()) break;  // rounding: the last simplex was full and had to hold the origin
    points[count++] = w;
    Real least = std::numeric_limits<Real>::infinity();
    unsigned keep = 0;
    for (unsigned face = 1u << (count - 1); face < 1u << count; ++face) {  // those with the newest point
      Edges edges(D, 0);
      for (std::size_t i = 0; i + 1 < count; ++i) {
        if (!(face >> i & 1)) continue;
        edges.conservativeResize(Eigen::NoChange, edges.cols() + 1);
        edges.col(edges.cols() - 1) = points[i] - w;
      }
      Vec<D> nearest = w;
      if (edges.cols() > 0) {
        const auto weights = edges.colPivHouseholderQr().solve(-w).eval();
        if (!((weights.array() > 0).all() && weights.sum() < 1)) continue;
        nearest += edges * weights;
      }
      if (nearest.norm() < least) least = nearest.norm(), keep = face, v = nearest;
    }
    if (!(least > 0) || (step > 0 && !(least < length))) break;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (keep >> i & 1) points[kept++] = points[i];
    }
    count = kept;
  }
  return best;
}

}  // namespace lpc::inline LPC_PRECISION
