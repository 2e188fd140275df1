// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>

#include "framework/draw/debug_draw.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Draws the edges of the broadphase's structure, as of the last step or query: one colour per level, pale for cells
/// without a shape's box, or all in `tint`. An unbounded cell is drawn up to the farthest box.
template <int D>
void drawStructure(const World<D>& world, DebugDraw<D>& draw, const std::optional<DrawColour>& tint = {});

}}  // namespace lpc::LPC_PRECISION
