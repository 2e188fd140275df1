// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>

#include "framework/draw/debug_draw.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The edges of what the world's broadphase divides by, as of the last step or query: a colour for each level, pale
/// where no box of a shape stands, or all in one. What has no end is drawn as far as there are boxes.
template <int D>
void drawStructure(const World<D>& world, DebugDraw<D>& draw, const std::optional<DrawColour>& tint = {});

}}  // namespace lpc::LPC_PRECISION
