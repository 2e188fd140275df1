// SPDX-License-Identifier: Zlib
// What the panels hold, each in a file of its own.
#pragma once

#include "experiments/sandbox/app.h"

namespace lpc::inline LPC_PRECISION {

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

}  // namespace lpc::inline LPC_PRECISION
