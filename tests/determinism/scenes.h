// SPDX-License-Identifier: Zlib
// Small worlds whose histories are pinned: between them every stage that decides a trajectory takes part. Built through
// the framework alone, so that any compiler can build them in a minute.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D>
struct PinnedScene {
  std::string name, pipeline;
  int steps;
  void (*build)(World<D>&);
  void (*act)(World<D>&, int step) = nullptr;  // before each step: bodies come and go
};

template <int D>
const std::vector<PinnedScene<D>>& pinnedScenes();

/// Runs the scene from its start; `seen` looks at the world after each step and says whether to go on.
template <int D>
void play(const PinnedScene<D>& scene, ContactListener<D>* listener, const std::function<bool(World<D>&)>& seen);

/// The hashes of all steps, as one.
template <int D>
std::uint64_t historyHash(const PinnedScene<D>& scene);

}}}  // namespace lpc::LPC_PRECISION::test
