// SPDX-License-Identifier: Zlib
// A scene modelled otherwise than its file asks: with one feature more or less, or in the other dimension.
#pragma once

#include <string>
#include <vector>

#include "experiments/runner/trial_plan.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What the scene's file asks for, and nothing else.
inline constexpr const char* kMinimalModel = "minimal";

/// Every model there is: minimal, all, 2d, 3d, +FEATURE, -FEATURE.
std::vector<std::string> modelNames();
/// Sets features and dimension of the cell. Throws UserError with the valid names.
void applyModel(const SceneFile& file, const std::string& model, WorldCell& cell);
/// Those that differ from the scene as it is in `dimension` by one switch: the other dimension where the scene has it,
/// each feature that it needs taken away, and each that it does not need added.
std::vector<std::string> otherModels(const SceneFile& file, int dimension);

}}  // namespace lpc::LPC_PRECISION
