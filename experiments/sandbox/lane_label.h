// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// What of a pipeline is not the default, as it would be typed: "solver=soft_step{substeps=2}". An engine as it is.
std::string laneLabel(const std::string& pipeline, int dimension);

}  // namespace lpc::inline LPC_PRECISION
