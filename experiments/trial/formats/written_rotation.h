// SPDX-License-Identifier: Zlib
// Rotations of a file written in either precision.
#pragma once

#include "framework/math/user_numbers.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Largest deviation of their length from 1: f32's rounding, in either precision.
inline constexpr Real kWrittenRotation = Real(1e-5);

/// Kept bit by bit if this precision accepts it as unit, otherwise normalised. False if it is not a rotation.
template <int D>
bool takeWritten(Rot<D>& q) {
  if (isUnit(q)) return true;
  Real square = 0;
  if constexpr (D == 2) square = q.c * q.c + q.s * q.s;
  if constexpr (D == 3) square = q.w * q.w + q.imag().squaredNorm();
  if (!(std::abs(std::sqrt(square) - 1) < kWrittenRotation)) return false;
  q = q.normalized();
  return true;
}

}}  // namespace lpc::LPC_PRECISION
