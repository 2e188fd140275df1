// SPDX-License-Identifier: Zlib
// Small worlds with pinned histories. Together they run every stage that decides a trajectory. They need only the
// framework, so that any compiler can build them in a minute.
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
  void (*act)(World<D>&, int step) = nullptr;  // before each step: adds and removes bodies
};

template <int D>
const std::vector<PinnedScene<D>>& pinnedScenes();

/// Runs the scene from its start; calls `seen` after each step and stops when it returns false.
template <int D>
void play(const PinnedScene<D>& scene, ContactListener<D>* listener, const std::function<bool(World<D>&)>& seen);

/// One hash of the hashes of all steps.
template <int D>
std::uint64_t historyHash(const PinnedScene<D>& scene);

}}}  // namespace lpc::LPC_PRECISION::test
