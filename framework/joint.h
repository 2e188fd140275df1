// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/body.h"

namespace lpc::inline LPC_PRECISION {

/// A pivot as a user adds it: one point of two bodies stays together. In 3D it leaves all three rotations free.
template <int D>
struct PivotDef {
  Handle bodyA, bodyB;
  Vec<D> anchor = Vec<D>::Zero();  // world, at the time of adding (m)
  bool collide = false;            // do the two bodies collide with each other?
};

template <int D>
struct PivotJoint {
  std::int32_t bodyA = -1, bodyB = -1;                      // -1: free slot
  Vec<D> localA = Vec<D>::Zero(), localB = Vec<D>::Zero();  // in the centre-of-mass frames
  Vec<D> impulse = Vec<D>::Zero();                          // accumulated, on B, world, N s
  std::uint8_t collide = 0;
  std::uint32_t generation = 0;
};

}  // namespace lpc::inline LPC_PRECISION
