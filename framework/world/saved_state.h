// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <iosfwd>
#include <vector>

#include "framework/problem/force.h"
#include "framework/problem/joint.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/stage/stage_sleep.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Everything that a saved world holds.
template <int D>
struct SavedState {
  WorldSettings<D> settings;
  Bodies<D> bodies;  // without what is derived: invMass, invInertia
  std::vector<ShapeRecord<D>> shapes;
  std::vector<JointRecord<D>> joints;
  std::vector<Manifold<D>> manifolds;
  std::vector<Wrench<D>> userForces;
  std::vector<SleepEvent> events;
  Real time = 0, lastDt = 0;
  std::int64_t steps = 0;
  std::vector<PairRecord> records;
  std::vector<ForceRecord<D>> forces;
};

/// What the first bytes of a saved world tell.
struct SavedKind {
  int dimension = 0;
  int realBytes = 0;  // of its numbers: 8 in f64, 4 in f32
};
/// Throws UserError when they are of no saved world, or of one in another format.
SavedKind savedKind(std::istream& in);

/// The bytes are a function of the state.
template <int D>
void writeState(std::ostream& out, SavedState<D> state);
/// Throws UserError when the bytes are not a world of this dimension, precision and format, or damaged. What they hold
/// is for requireSound() to judge; invMass and invInertia are empty.
template <int D>
SavedState<D> readState(std::istream& in);

/// Throws UserError when a step could not run on this: a number that is indexed by and points at nothing, arrays of
/// unequal length, an enum's value without a name, a shape that cannot be one, kinds that the generator does not
/// support. Poses, velocities and forces may be anything: a world that has exploded is saved as it is.
template <int D>
void requireSound(const SavedState<D>& saved, const ContactGenerator<D>& contacts);

}}  // namespace lpc::LPC_PRECISION
