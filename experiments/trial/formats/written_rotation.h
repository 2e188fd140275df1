// SPDX-License-Identifier: Zlib
// Rotations of a file that a run in either precision may have written.
#pragma once

#include "framework/math/user_numbers.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How far from 1 their length may be: f32's rounding, whatever reads it.
inline constexpr Real kWrittenRotation = Real(1e-5);

/// Kept to the last bit where this precision takes it for one, else of length 1. False for what is no rotation.
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
