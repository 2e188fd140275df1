// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <string>

#include "experiments/sandbox/deed.h"
#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What was done by hand in `scene`, which `file` has built, as a director's script, as the first lane had it:
/// `lpc run SCENE --script FILE` does the same. A script that plays in the scene is in it, too. `steps`: that were
/// made; with deeds before the next one it plays on as long as the scene does. Throws UserError for what a script
/// cannot say.
template <int D>
std::string scriptOf(std::span<const Deed<D>> deeds, const SceneSpec<D>& scene, const SceneFile& file, long steps);

}}  // namespace lpc::LPC_PRECISION
