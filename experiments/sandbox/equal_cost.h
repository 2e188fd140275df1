// SPDX-License-Identifier: Zlib
// Competitors at the same cost: who is dearer than the first gets fewer iterations, who is cheaper more. PEEL's manual
// advises it by hand: "tweak the number of iterations until they all use roughly the same time, then check which
// produces the best quality".
#pragma once

#include <optional>
#include <string>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// The pipeline with so many times the iterations (or sub-steps) of its solver, rounded, at least one more or less, and
/// within what it takes; nothing where its solver has neither, or has as many as it may.
std::optional<std::string> withMoreIterations(const std::string& pipeline, double factor, int dimension);

}  // namespace lpc::inline LPC_PRECISION
