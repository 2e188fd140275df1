// SPDX-License-Identifier: Zlib
// Competitors in words.
#pragma once

#include <string>
#include <vector>

#include "experiments/sandbox/session.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What of a pipeline is not the default, as it would be typed: "solver=soft_step{substeps=2}". An engine as it is.
std::string laneLabel(const std::string& pipeline, int dimension);

/// The same where there is little room: of an algorithm that is the default only what is otherwise in it,
/// "velocity=naive".
std::string laneTitle(const std::string& pipeline, int dimension);

/// "0.296 ms, 6.77 mm off, parted at step 2": the median step, how far the worst body is from where the first has it,
/// and since when; or why it has fallen.
template <int D>
std::string laneState(const Session<D>& session, std::size_t lane);

/// A length (m) with the unit in which it is easily read.
std::string lengthText(double length);

/// Lines of at most so many characters, broken where a word or a parameter begins; what is too much for the last is cut
/// with "...".
std::vector<std::string> brokenIntoLines(const std::string& text, std::size_t width, std::size_t lines);

}}  // namespace lpc::LPC_PRECISION
