// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <string>

#include "experiments/sandbox/action.h"
#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The actions by hand in `scene`, built from `file`, as a director's script for the first competitor: `lpc run SCENE
/// --script FILE` repeats them. A script of the scene is included. `steps`: number of steps made; if actions precede
/// the next step, the script runs as long as the scene. Throws UserError for actions that a script cannot express.
template <int D>
std::string scriptOf(std::span<const Action<D>> actions, const SceneSpec<D>& scene, const SceneFile& file, long steps);

}}  // namespace lpc::LPC_PRECISION
