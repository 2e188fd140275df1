// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/debug_draw.h"

namespace lpc::inline LPC_PRECISION {

inline constexpr std::size_t kMostLanes = 8;

/// Of competitors on one screen, in the order in which they were named: those of the report's charts.
inline DrawColour laneColour(std::size_t lane) {
  constexpr DrawColour kColours[kMostLanes] = {{0xd5, 0x5e, 0x00}, {0x00, 0x72, 0xb2}, {0x00, 0x9e, 0x73},
                                               {0xcc, 0x79, 0xa7}, {0xe6, 0x9f, 0x00}, {0x56, 0xb4, 0xe9},
                                               {0x33, 0x22, 0x88}, {0x88, 0x22, 0x55}};
  return kColours[lane % kMostLanes];
}

}  // namespace lpc::inline LPC_PRECISION
