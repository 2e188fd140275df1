// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <span>

#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {

/// What was read from a saved world, before anybody uses it.
template <int D>
struct SavedState {
  const WorldSettings<D>& settings;
  const Bodies<D>& bodies;  // without what is derived: invMass, invInertia
  std::span<const ShapeRecord<D>> shapes;
  std::span<const PivotJoint<D>> joints;
  std::span<const Manifold<D>> manifolds;
  std::span<const Wrench<D>> userForces;
  std::span<const SleepEvent> events;
  Real time, lastDt;
  std::int64_t steps;
};

/// Throws UserError when a step could not run on this: a number that is indexed by and points at nothing, arrays of
/// unequal length, an enum's value without a name, a shape that cannot be one, kinds that the generator does not
/// support. Poses, velocities and forces may be anything: a world that has exploded is saved as it is.
template <int D>
void requireSound(const SavedState<D>& saved, const ContactGenerator<D>& contacts);

}  // namespace lpc::inline LPC_PRECISION
