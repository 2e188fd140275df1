// SPDX-License-Identifier: Zlib
#pragma once

#include "experiments/sandbox/view_camera.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// All moving bodies, or in a world at rest all bounded ones.
template <int D>
void lookAtAll(ViewCamera<D>& camera, const Simulation<D>& world);

}}  // namespace lpc::LPC_PRECISION
