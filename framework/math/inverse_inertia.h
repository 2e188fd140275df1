// SPDX-License-Identifier: Zlib
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Scaled by a power of two, so that the determinant of the inertia of what is a millimetre or a kilometre long is a
/// float, too. Of what is no number neither is the inverse. Precondition: the trace is not below or at 0.
template <class Matrix>
Matrix inverseAtItsScale(const Matrix& inertia) {
  const auto trace = inertia.trace();
  const int size = std::isfinite(trace) ? std::ilogb(trace) : 0;
  const auto scaled = [size](const Matrix& m) -> Matrix {
    return m.unaryExpr([size](auto x) { return std::ldexp(x, -size); });
  };
  return scaled(Matrix(scaled(inertia).inverse()));
}

/// None where numbers hold none: of what is too small, or a needle so thin that its inertia about itself is less than
/// the rounding of the others, in a frame that is not its own. Precondition: the trace is above 0.
template <int D>
std::optional<Inertia<D>> inverseInertia(const Inertia<D>& inertia) {
  const Inertia<D> inverse = inverseAtItsScale(inertia);
  if (!inverse.allFinite() || Eigen::LLT<Inertia<D>>(inverse).info() != Eigen::Success) return std::nullopt;
  return inverse;
}

}}  // namespace lpc::LPC_PRECISION
