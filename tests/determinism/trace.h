// SPDX-License-Identifier: Zlib
// Where two builds part: every number of a scene's history as text, step by step and stage by stage, and the first one
// that differs from another build's.
//
//   heap_2d 41 contacts 3-7 3fe0000000000000 bfb999999999999a ...
//   scene, step, stage, body or pair, bit patterns
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "tests/determinism/scenes.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// In the order of a step: boxes, pairs, contacts (as the solver gets them), sleep, impulses, velocities, positions.
template <int D>
void writeTrace(const PinnedScene<D>& scene, std::ostream& out);

struct Difference {
  int step = 0;
  std::string stage, body;  // the first that differ
  std::string text;         // for people: the numbers here and there, with their bits
};

/// Runs the scene against a trace that holds it; nothing when each bit agrees. Throws UserError when the trace does not
/// hold the scene.
template <int D>
std::optional<Difference> firstDifference(const PinnedScene<D>& scene, std::istream& trace);

}}}  // namespace lpc::LPC_PRECISION::test
