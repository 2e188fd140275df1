// SPDX-License-Identifier: Zlib
// Where two builds diverge: every number of a scene's history as text, step by step and stage by stage, and the first
// number that differs between the builds.
//
//   heap_2d 41 contacts 3-7 3fe0000000000000 bfb999999999999a ...
//   scene, step, stage, body or pair, bit patterns
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "tests/determinism/scenes.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// In the order of a step: boxes, pairs, contacts (before the solver changes them), sleep, impulses, velocities,
/// positions.
template <int D>
void writeTrace(const PinnedScene<D>& scene, std::ostream& out);

struct Difference {
  int step = 0;
  std::string stage, body;  // of the first difference
  std::string text;         // message: both numbers, with their bits
};

/// Compares a run of the scene to a trace; returns nothing if all bits agree. Throws UserError if the trace lacks the
/// scene.
template <int D>
std::optional<Difference> firstDifference(const PinnedScene<D>& scene, std::istream& trace);

}}}  // namespace lpc::LPC_PRECISION::test
