// SPDX-License-Identifier: Zlib
// Seeded pairs of two given kinds. Two thirds of them come from the families of inputs in which collision libraries
// were reported wrong; uniform random poses find almost none of those bugs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION {

template <int D>
struct HardPair {
  Shape<D> a, b;
  Pose<D> X_WA = {}, X_WB = {};
  /// X_WA^-1 * X_WB as computed in Real, which far from the origin is not what was meant. It is what a pair query is
  /// asked, so it is what the referee judges.
  Pose<D> X_AB = {};
  double angle = 0;  // 2D: X_AB.q is Rot<2>::angle(angle), bit for bit, so that a file of cases can hold the pair
  std::string_view family = "random";
  double scale = 1;   // size of the shapes (m)
  double offset = 0;  // distance of the pair from the world's origin, in scales
};

/// All families, "random" first. `nasty_hulls` needs a polytope.
std::span<const std::string_view> hardPairFamilies();

/// The index-th pair, whatever was drawn before: a pair is named by (kinds, seed, index).
template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, std::uint64_t seed, int index);

/// As a line of a file of cases, as tests/regressions/*.json; `more` is appended to it, as `, "name": value`.
template <int D>
std::string caseText(const std::string& id, const HardPair<D>& pair, const std::string& more);

/// As JSON, with all digits; null when it is not finite.
std::string numberText(double x);

/// How simple a pair is to look at: vertices of the shape without its rounding.
template <int D>
int coreVertexCount(const ShapeView<D>& shape);

}  // namespace lpc::inline LPC_PRECISION
