// SPDX-License-Identifier: Zlib
#pragma once

#include <array>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Whether a triangle has an area beyond rounding; Shape::triangle and Shape::mesh refuse others. Precondition: finite
/// corners.
bool hasArea(const std::array<Vec<3>, 3>& corners);

}}  // namespace lpc::LPC_PRECISION
