// SPDX-License-Identifier: Zlib
// What the panels hold, each in a file of its own.
#pragma once

#include <cstdint>

#include "experiments/sandbox/app.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
void scenePanel(App<D>& app);
template <int D>
void stagesPanel(App<D>& app);
template <int D>
void stepPanel(App<D>& app);
template <int D>
void bodyPanel(App<D>& app);
template <int D>
void comparePanel(App<D>& app);
template <int D>
void pairPanel(App<D>& app);
/// Before a picture: what the pair panel shows in it.
template <int D>
void lookIntoPair(App<D>& app);

/// A colour as ImGui has it.
std::uint32_t packed(const DrawColour& c);
/// Where competitors part.
inline constexpr DrawColour kPartedMark{214, 39, 40};
/// A square of a colour before words: of light ones words would not be read.
void swatch(const DrawColour& colour);

/// px: of the lines at the window's foot.
template <int D>
int statusHeight(App<D>& app);

}}  // namespace lpc::LPC_PRECISION
