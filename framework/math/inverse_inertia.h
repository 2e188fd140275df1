// SPDX-License-Identifier: Zlib
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Inverts an inertia, scaled by a power of two, so that the determinant of a body of a millimetre or a kilometre stays
/// in the range of a float. NaN gives NaN. Precondition: the trace is positive or NaN.
template <class Matrix>
Matrix inverseAtItsScale(const Matrix& inertia) {
  const auto trace = inertia.trace();
  const int size = std::isfinite(trace) ? std::ilogb(trace) : 0;
  const auto scaled = [size](const Matrix& m) -> Matrix {
    return m.unaryExpr([size](auto x) { return std::ldexp(x, -size); });
  };
  return scaled(Matrix(scaled(inertia).inverse()));
}

/// Inverts an inertia. Empty when the inverse is not representable: the body is too small, or it is a thin needle in a
/// rotated frame. Then the rounding of the other entries exceeds the inertia about the needle's axis. Precondition: the
/// trace is > 0.
template <int D>
std::optional<Inertia<D>> inverseInertia(const Inertia<D>& inertia) {
  const Inertia<D> inverse = inverseAtItsScale(inertia);
  if (!inverse.allFinite() || Eigen::LLT<Inertia<D>>(inverse).info() != Eigen::Success) return std::nullopt;
  return inverse;
}

}}  // namespace lpc::LPC_PRECISION
