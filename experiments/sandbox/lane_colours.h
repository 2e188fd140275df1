// SPDX-License-Identifier: Zlib
// The colours of competitors on one screen: those that the report's charts give them.
#pragma once

#include <string>
#include <vector>

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

inline constexpr std::size_t kMostLanes = 8;

/// How far two colours are apart to the eye (CIE 1976). Closer than `kToldApart` lines of them are taken for one
/// another.
double difference(const DrawColour& a, const DrawColour& b);
inline constexpr double kToldApart = 25;

/// One for each, that of its family on all pages of a report: of `soft_step` for "solver=soft_step{substeps=2}". Who
/// comes after another of its family, or of one whose colour is too near, gets the one of the report's that is farthest
/// from all that are there.
std::vector<DrawColour> laneColours(const std::vector<std::string>& pipelines, int dimension);

}}  // namespace lpc::LPC_PRECISION
