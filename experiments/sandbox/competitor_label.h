// SPDX-License-Identifier: Zlib
// Names of competitors.
#pragma once

#include <string>
#include <vector>

#include "experiments/sandbox/session.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The parts of a pipeline that differ from the default, as typed: "solver=soft_step{substeps=2}". An engine unchanged.
std::string competitorLabel(const std::string& pipeline, int dimension);

/// A shorter form: for a default algorithm only its differences, "velocity=naive".
std::string competitorTitle(const std::string& pipeline, int dimension);

/// "0.296 ms, 6.77 mm off, parted at step 2": the median step, the largest distance of a body from its position in the
/// first competitor, and the step at which they diverged; or why it has fallen.
template <int D>
std::string competitorState(const Session<D>& session, std::size_t competitor);

/// A length (m) in a readable unit.
std::string lengthText(double length);

/// Lines of at most this many characters, broken where a word or a parameter begins; the last is cut with "..." if
/// necessary.
std::vector<std::string> brokenIntoLines(const std::string& text, std::size_t width, std::size_t lines);

}}  // namespace lpc::LPC_PRECISION
