// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A shape on a body, as a user adds it.
template <int D>
struct ShapeDef {
  Shape<D> shape = Shape<D>::sphere(Real(0.5));
  Pose<D> X_BS{};             // pose of the shape in the body frame
  Real density = 1;           // kg/m^D
  Real friction = Real(0.5);  // Coulomb; a pair uses the geometric mean of its two shapes
  Real restitution = 0;       // a pair uses the arithmetic mean
  std::uint32_t category = 1;
  std::uint32_t mask = ~0u;    // a pair collides when each category is in the other's mask
  std::uint64_t userData = 0;  // the user's own number: stored and saved, never read
};

}}  // namespace lpc::LPC_PRECISION
