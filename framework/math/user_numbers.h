// SPDX-License-Identifier: Zlib
// Checks of numbers from the user. Each throws UserError with the owner, the number, and the valid values.
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "framework/math/check.h"
#include "framework/math/space.h"
#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

inline bool isUnit(const Rot<2>& q) { return std::abs(q.c * q.c + q.s * q.s - 1) < 4 * kUnitTolerance; }
inline bool isUnit(const Rot<3>& q) { return std::abs(q.w * q.w + q.imag().squaredNorm() - 1) < 4 * kUnitTolerance; }

template <int D>
void checkPose(const Pose<D>& x, const std::string& subject) {
  if (!x.p.allFinite()) throw UserError(subject + ": the position is not finite");
  if (!isUnit(x.q)) throw UserError(subject + ": the rotation is not a unit complex number or quaternion");
}

template <int D>
void checkMotion(const Motion<D>& m, const std::string& subject) {
  if (!m.v.allFinite() || !m.w.allFinite()) throw UserError(subject + ": the velocity is not finite");
}

// Also called in each step, so a valid number must not build a string.
inline void checkAmount(Real value, std::string_view subject, const char* what) {
  if (value >= 0 && std::isfinite(value)) return;
  throw UserError(std::string(subject) + ": " + what + " is " + std::to_string(value) +
                  "; valid: a finite number >= 0");
}

}}  // namespace lpc::LPC_PRECISION
