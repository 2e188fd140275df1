// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <string_view>

#include "oracles/corpus/hard_pairs.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Classifies a pair by the referee's answer, the same for all methods. The first that applies of
///   huge_ratio      one shape is at least 100 times as large as the other
///   thin            one shape is less than 1e-3 as thick as it is long, segments aside
///   touching        gap or depth below 1e-6 of the smaller shape
///   parallel_faces  a face (2D: edge) of each is perpendicular to the normal, within 1e-3 rad
///   separated
///   contained       along the normal, one shape's extent lies within the other's
///   shallow, deep   depth up to a tenth of the smaller shape, or more
/// and `undecided` when the referee has no answer.
template <int D>
std::string_view regimeOf(const HardPair<D>& pair, const RefereeAnswer<D>& truth);
std::span<const std::string_view> regimeNames();

}}  // namespace lpc::LPC_PRECISION
