// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Of a text that is a finite decimal number and nothing beside it: not of `nan`, `0x10`, `5x`, ` 5` or nothing at all.
std::optional<double> finiteNumber(const std::string& text);

/// The value of --pipeline. `2009` in front stands for the pipeline of that report, which what follows changes.
std::string pipelineOf(const std::string& given, int dimension, bool noSleeping);

/// The values of --param: NAME=NUMBER, or joint=KIND. Throws UserError.
ParameterValues readParameters(const std::vector<std::string>& texts);

}}  // namespace lpc::LPC_PRECISION
