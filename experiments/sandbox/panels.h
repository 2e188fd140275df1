// SPDX-License-Identifier: Zlib
// The content of the panels, each in a file of its own.
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
/// Call before a picture: prepares the pair panel's view.
template <int D>
void lookIntoPair(App<D>& app);

/// A colour as ImGui has it.
std::uint32_t packed(const DrawColour& c);
/// The step at which competitors diverge.
inline constexpr DrawColour kPartedMark{214, 39, 40};
/// A coloured square before text: text in a light colour would be unreadable.
void swatch(const DrawColour& colour);

/// px: height of the lines at the window's bottom.
template <int D>
int statusHeight(App<D>& app);

}}  // namespace lpc::LPC_PRECISION
