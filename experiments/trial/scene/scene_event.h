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

/// What events throw while the run lasts, when numbers that are fine each come to what no number holds, such as a blow
/// at a long lever: an end of the run at its step, and no mistake of the file.
struct EventOverflow : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One [[event]] block at one turn of its loops, as the reader of its kind sees it.
template <int D>
struct EventBlock {
  TableReader& block;
  SceneNumbers& numbers;
  SceneSpec<D>& scene;
  int number;                                     // of the block in the file
  std::shared_ptr<const std::string> place = {};  // its file and line
  /// The body that a key names, as its place in scene.spawns. It must be there at `step`, which is seen to later, when
  /// all blocks are read.
  std::function<int(const std::string& key)> bodyOf = {};
  // Those of joints and forces that have been read, as their places in the scene.
  std::function<int(const std::string&key)> jointOf = {}, forceOf = {};
  std::function<int()> addBody = {};   // by the keys of a [[body]] block: its place; -1 in a rehearsal
  std::function<int()> addJoint = {};  // by those of a [[joint]] block
  std::function<int()> addForce = {};  // by those of a [[force]] block
  std::function<int(typename SceneSpec<D>::Spawn)> addPart = {};  // of a body that is taken apart: its place
  /// From now on that body has this name, too.
  std::function<void(const std::string& name, int body)> nameBody = {};
  std::function<void()> clear = {};  // nobody is there any more
  long step = 0;
};

/// A kind of event: its fields and its mistakes are in `read`, which leaves in the scene what shall be done.
template <int D>
struct EventKind {
  std::string_view name, meaning;
  bool names;  // it makes bodies that others may name, so it is read before them
  void (*read)(const EventBlock<D>&);
};
template <int D>
std::span<const EventKind<D>> eventKinds();

}}  // namespace lpc::LPC_PRECISION
