// SPDX-License-Identifier: Zlib
// The farthest vertex of a hull, for searches that ask for dozens of them: several at a time by the instruction set
// that the machine has, with the same answer on all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION::pair_query {

/// From here on several at a time are faster than one by one, and there is always work for two times eight lanes.
inline constexpr std::size_t kManyVertices = 16;

/// Index of the vertex that lies farthest along d, of several the first, as coreSupport finds it. There are
/// kManyVertices or more, and d is finite.
std::size_t farthestVertex(const std::vector<Vec<3>>& vertices, const Vec<3>& d);
static_assert(sizeof(Vec<3>) == 3 * sizeof(Real), "vertices are triples of numbers, one after the other");

}  // namespace lpc::inline LPC_PRECISION::pair_query
