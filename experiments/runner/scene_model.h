// SPDX-License-Identifier: Zlib
// Variants of a scene's model: with one feature more or less, or in the other dimension.
#pragma once

#include <string>
#include <vector>

#include "experiments/runner/trial_plan.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The model in the scene's file.
inline constexpr const char* kMinimalModel = "minimal";

/// All models: minimal, all, 2d, 3d, +FEATURE, -FEATURE.
std::vector<std::string> modelNames();
/// Sets model and dimension of the cell. Throws UserError with the valid names.
void applyModel(const SceneFile& file, const std::string& model, WorldCell& cell);
/// The models that differ from the scene's own in `dimension` by one switch: the other dimension if the scene has it,
/// each needed feature removed, and each other feature added.
std::vector<std::string> otherModels(const SceneFile& file, int dimension);

}}  // namespace lpc::LPC_PRECISION
