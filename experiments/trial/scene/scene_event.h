// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "experiments/trial/scene/scene_parsed.h"
#include "framework/scene/scene_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Thrown by events at run time if valid numbers give a result that overflows, such as an impulse at a long lever. It
/// ends the run at its step and is not an error of the file.
struct EventOverflow : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One [[event]] block at one turn of its loops, as seen by the reader of its kind.
template <int D>
struct EventBlock {
  TableReader& block;
  SceneNumbers& numbers;
  SceneSpec<D>& scene;
  int number;                                     // of the block in the file
  std::shared_ptr<const std::string> place = {};  // its file and line
  /// The body that a key names, as an index into scene.spawns. Whether it exists at `step` is checked later, when all
  /// blocks are read.
  std::function<int(const std::string& key)> bodyOf = {};
  // Joints and forces that have been read, as indices into the scene.
  std::function<int(const std::string&key)> jointOf = {}, forceOf = {};
  std::function<int()> addBody = {};                              // adds a [[body]] block: its index; -1 in a rehearsal
  std::function<int()> addJoint = {};                             // adds a [[joint]] block
  std::function<int()> addForce = {};                             // adds a [[force]] block
  std::function<int(typename SceneSpec<D>::Spawn)> addPart = {};  // adds a part of a split body: its index
  /// Adds a name to that body, valid from now on.
  std::function<void(const std::string& name, int body)> nameBody = {};
  std::function<void()> clear = {};  // removes all bodies
  long step = 0;
};

/// A kind of event: `read` checks its fields and stores the action in the scene.
template <int D>
struct EventKind {
  std::string_view name, meaning;
  bool names;  // it makes bodies with names, so it is read before events that may use these
  void (*read)(const EventBlock<D>&);
};
template <int D>
std::span<const EventKind<D>> eventKinds();

}}  // namespace lpc::LPC_PRECISION
