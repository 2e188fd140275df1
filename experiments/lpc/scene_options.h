// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Parses a finite decimal number and nothing else: rejects `nan`, `0x10`, `5x`, ` 5` and the empty text.
std::optional<double> finiteNumber(const std::string& text);

/// The value of --pipeline. A leading `2009` stands for the pipeline of that report; the rest changes it.
std::string pipelineOf(const std::string& given, int dimension, bool noSleeping);

/// The values of --param: NAME=NUMBER, or joint=KIND. Throws UserError.
ParameterValues readParameters(const std::vector<std::string>& texts);

}}  // namespace lpc::LPC_PRECISION
