// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <string>

#include "framework/scene/scene_spec.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A world with these stages, or an engine for "engine=NAME"; with the scene's settings, or as it was saved, and
/// without the scene's bodies. Throws UserError for anything that this scene or this build cannot have.
template <int D>
std::unique_ptr<Simulation<D>> simulationOf(const std::string& pipeline, const SceneSpec<D>& scene);

}}  // namespace lpc::LPC_PRECISION
