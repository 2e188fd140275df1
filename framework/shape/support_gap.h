// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <limits>
#include <span>

#include "framework/math/indexed.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How far a convex set lies from the origin at least, and along which unit direction n: n . m >= gap on all of it.
template <int D>
struct Gap {
  Real gap = -std::numeric_limits<Real>::infinity();  // <= 0: the origin is in the set, or on it within rounding
  Vec<D> n = Vec<D>::Zero();
};

/// Moves w, a corner, to the point of the plane through w and its edges that is nearest to the origin; false when that
/// lies outside of the face they span, or the face is flat. Gram and Schmidt, then back substitution.
template <int D>
bool dropToFace(std::span<const Vec<D>> edges, Vec<D>& w) {
  IndexedArray<Vec<D>, D> q;
  IndexedArray<IndexedArray<Real, D>, D> r{};
  IndexedArray<Real, D> weight{};
  Vec<D> rest = -w;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    q[i] = edges[i];
    for (std::size_t j = 0; j < i; ++j) r[j][i] = q[j].dot(q[i]), q[i] -= r[j][i] * q[j];
    r[i][i] = q[i].norm();
    if (!(r[i][i] > kFlatFace * edges[i].norm())) return false;
    q[i] /= r[i][i];
    weight[i] = q[i].dot(rest), rest -= weight[i] * q[i];
  }
  Real sum = 0;
  for (std::size_t i = edges.size(); i-- > 0;) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) weight[i] -= r[i][j] * weight[j];
    weight[i] /= r[i][i], sum += weight[i];
    if (!(weight[i] > 0)) return false;
  }
  if (!edges.empty()) w = -rest;
  return sum < 1;
}

/// By the walk of Gilbert, Johnson and Keerthi (1988). `support(d)` is a point of the set that lies farthest along d.
/// What is returned is the best bound that was met and no difference of points, so a direction that is off by a little
/// costs only the square of that little. For few questions about sets without corners: the nearest point of a simplex
/// is looked for among all its faces. `left`: by how much the gap may be too small (m), beside roundings; `far`: one
/// that is proved to be more is not looked for any further.
template <int D, class Support>
Gap<D> gapToOrigin(const Support& support, Vec<D> start, Real left = 0,
                   Real far = std::numeric_limits<Real>::infinity()) {
  Gap<D> best;
  IndexedArray<Vec<D>, D + 1> points;
  std::size_t count = 0;
  Vec<D> v = start.squaredNorm() > 0 ? start : Vec<D>(Vec<D>::Unit(0));
  for (int step = 0; step < kMostGapSteps; ++step) {
    const Real length = v.norm();
    const Vec<D> towards = v / length;
    const Vec<D> w = support(Vec<D>(-towards));
    if (towards.dot(w) > best.gap) best = {towards.dot(w), towards};
    if (best.gap > far) break;
    if (step > 0 && length - best.gap <= std::max(left, kGapRounding * (length + w.norm()))) break;
    if (count == points.size()) break;  // rounding: the last simplex was full and had to hold the origin
    points[count++] = w;
    Real least = std::numeric_limits<Real>::infinity();
    unsigned keep = 0;
    for (unsigned face = 1u << (count - 1); face < 1u << count; ++face) {  // those with the newest point
      IndexedArray<Vec<D>, D> edges;
      std::size_t n = 0;
      for (std::size_t i = 0; i + 1 < count; ++i) {
        if (face >> i & 1) edges[n++] = points[i] - w;
      }
      Vec<D> nearest = w;
      if (!dropToFace<D>({edges.data(), n}, nearest)) continue;
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

}}  // namespace lpc::LPC_PRECISION
