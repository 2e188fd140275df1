// SPDX-License-Identifier: Zlib
// Competitors at the same cost: who is dearer than the first gets fewer iterations, who is cheaper more. PEEL's manual
// advises it by hand: "tweak the number of iterations until they all use roughly the same time, then check which
// produces the best quality".
#pragma once

#include <optional>
#include <string>

#include "experiments/sandbox/session.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The pipeline with so many times the iterations (or sub-steps) of its solver, rounded, at least one more or less, and
/// within what it takes; nothing where its solver has neither, or has as many as it may.
std::optional<std::string> withMoreIterations(const std::string& pipeline, double factor, int dimension);

/// A step of theirs takes what one of the first's takes, but for this part.
inline constexpr double kSameCost = 0.1;

/// After a step: changes the iterations of each lane that has made `kTimedSteps`, or a multiple, by its present
/// pipeline, and takes another time than the first. Times are medians of the same steps: what else the machine does
/// meets all.
template <int D>
void equaliseCost(Session<D>& session);

/// Why a lane keeps the time that it takes; empty: it need not, or it follows.
template <int D>
std::string whyCostStays(const Session<D>& session, std::size_t lane);

}}  // namespace lpc::LPC_PRECISION
