// SPDX-License-Identifier: Zlib
// The colours of competitors on one screen: those of the report's charts.
#pragma once

#include <string>
#include <vector>

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

inline constexpr std::size_t kMostCompetitors = 8;

/// Perceived difference of two colours (CIE 1976). Lines of colours closer than `kToldApart` cannot be distinguished.
double difference(const DrawColour& a, const DrawColour& b);
inline constexpr double kToldApart = 25;

/// One colour for each competitor: that of its family on all pages of a report, of `soft_step` for
/// "solver=soft_step{substeps=2}". A competitor of a family that is already shown, or with too similar a colour, gets
/// the report's colour that differs most from those shown.
std::vector<DrawColour> competitorColours(const std::vector<std::string>& pipelines, int dimension);

}}  // namespace lpc::LPC_PRECISION
