// SPDX-License-Identifier: Zlib
// Competitors at equal cost: a competitor that costs more than the first gets fewer iterations, a cheaper one more.
// PEEL's manual advises this by hand: "tweak the number of iterations until they all use roughly the same time, then
// check which produces the best quality".
#pragma once

#include <optional>
#include <string>

#include "experiments/sandbox/session.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The pipeline with the iterations (or sub-steps) of its solver multiplied by the factor, rounded, changed by at least
/// one, and within their range; empty if its solver has neither, or is at the limit.
std::optional<std::string> withMoreIterations(const std::string& pipeline, double factor, int dimension);

/// Steps cost the same if their times differ by less than this part.
inline constexpr double kSameCost = 0.1;

/// Call after a step: changes the iterations of each competitor that has made `kTimedSteps`, or a multiple, with its
/// present pipeline, and takes another time than the first. Times are medians over the same steps, so that other load
/// affects all of them.
template <int D>
void equaliseCost(Session<D>& session);

/// Why a competitor's cost cannot follow; empty: it need not, or it follows.
template <int D>
std::string whyCostStays(const Session<D>& session, std::size_t competitor);

}}  // namespace lpc::LPC_PRECISION
