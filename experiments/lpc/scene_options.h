// SPDX-License-Identifier: Zlib
#pragma once

#include <string>
#include <vector>

#include "experiments/trial/scene_file.h"

namespace lpc::inline LPC_PRECISION {

/// The values of --param: NAME=NUMBER, or joint=KIND. Throws UserError.
ParameterValues readParameters(const std::vector<std::string>& texts);

}  // namespace lpc::inline LPC_PRECISION
