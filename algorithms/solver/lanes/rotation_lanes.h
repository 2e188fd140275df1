// SPDX-License-Identifier: Zlib
// Rotations of many bodies at once, one body per lane. The bits are those of integrateRotation().
#pragma once

#include <cstdint>
#include <span>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Turns each of `bodies` (slots) at its angular velocity for dt. A body that does not turn keeps its rotation.
void turnBodies(std::span<Pose<2>> pose, std::span<const Motion<2>> motion, std::span<const std::int32_t> bodies,
                Real dt);
void turnBodies(std::span<Pose<3>> pose, std::span<const Motion<3>> motion, std::span<const std::int32_t> bodies,
                Real dt);

}}}  // namespace lpc::LPC_PRECISION::solver
