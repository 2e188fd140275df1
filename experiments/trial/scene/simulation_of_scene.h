// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <string>

#include "framework/scene/scene_spec.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A world with these stages, or what "engine=NAME" begins; with the scene's settings, or as it was saved. Nobody of
/// the scene has come yet. Throws UserError for what this scene or this build cannot have.
template <int D>
std::unique_ptr<Simulation<D>> simulationOf(const std::string& pipeline, const SceneSpec<D>& scene);

}}  // namespace lpc::LPC_PRECISION
