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

/// The complete content of a saved world.
template <int D>
struct SavedState {
  WorldSettings<D> settings;
  Bodies<D> bodies;  // without derived data: invMass, invInertia
  std::vector<ShapeRecord<D>> shapes;
  std::vector<JointRecord<D>> joints;
  std::vector<Manifold<D>> manifolds;
  std::vector<Wrench<D>> userForces;
  std::vector<SleepEvent> events;
  Real time = 0, lastDt = 0;
  Real sinceContacts = 0;  // s, from the newest detection of contacts to `time`
  std::int64_t steps = 0;
  std::vector<PairRecord> records;
  std::vector<ForceRecord<D>> forces;
};

/// The kind of a saved world, from its first bytes.
struct SavedKind {
  int dimension = 0;
  int realBytes = 0;  // size of its numbers: 8 in f64, 4 in f32
};
/// Reads the first bytes. Throws UserError when the bytes are not a saved world, or have another format version.
SavedKind savedKind(std::istream& in);

/// Writes a state. The bytes depend on the state only.
template <int D>
void writeState(std::ostream& out, SavedState<D> state);
/// Reads a state; invMass and invInertia are empty. Throws UserError when the bytes are damaged or are not a world of
/// this dimension, precision and format. requireValidState() checks the content.
template <int D>
SavedState<D> readState(std::istream& in);

/// Checks that a step can run on this state. Throws UserError for an invalid index, enum value or shape, arrays of
/// unequal length, and shape kinds that the generator does not support. Poses, velocities and forces may have any
/// value, so that a world that has exploded can be saved and loaded.
template <int D>
void requireValidState(const SavedState<D>& saved, const ContactGenerator<D>& contacts);

}}  // namespace lpc::LPC_PRECISION
