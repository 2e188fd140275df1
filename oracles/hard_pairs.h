// SPDX-License-Identifier: Zlib
// Seeded pairs of two given kinds, half of them from the families of inputs in which collision code was reported wrong.
#pragma once

#include <cstdint>
#include <string_view>

#include "framework/random.h"
#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION {

template <int D>
struct HardPair {
  Shape<D> a, b;
  Pose<D> X_AB;
  std::string_view family;
};

/// The index-th pair, whatever was drawn before: a pair is named by (seed, index). `scale` is the size of the shapes
/// (m).
template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, double scale, std::uint64_t seed, int index);

}  // namespace lpc::inline LPC_PRECISION
