// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <limits>
#include <span>

#include "framework/math/indexed.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Distance of a convex set from the origin, and its unit direction n: n . m >= gap for all points m of the set.
template <int D>
struct Gap {
  Real gap = -std::numeric_limits<Real>::infinity();  // <= 0: the set contains the origin, or touches it within
                                                      // rounding
  Vec<D> n = Vec<D>::Zero();
};

/// Moves the corner w of a face to the point nearest to the origin in the plane through w and its edges. Returns false
/// when this point is outside of the face, or the face is flat. Gram-Schmidt, then back substitution.
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

/// Distance of a convex set from the origin by GJK (Gilbert, Johnson and Keerthi 1988). `support(d)` is the support
/// point of the set along d. Returns the best lower bound found, whose error is only the square of the error of its
/// direction. Only for rare queries of sets without corners, because each simplex is searched by testing all its faces.
/// `left`: allowed error of the gap (m), besides rounding. `far`: the search stops when the gap is proved to be larger.
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
    if (count == points.size()) break;  // rounding: the last simplex was full and had to contain the origin
    points[count++] = w;
    Real least = std::numeric_limits<Real>::infinity();
    unsigned keep = 0;
    for (unsigned face = 1u << (count - 1); face < 1u << count; ++face) {  // faces that contain the newest point
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
