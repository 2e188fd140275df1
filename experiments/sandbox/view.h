// SPDX-License-Identifier: Zlib
// For a program of one's own: see its world.
//
//   World<3> world(Pipeline::parse("solver=soft_step"));
//   ...
//   view(world, Real(1) / 60);
#pragma once

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Steps the world by dt (s) in real time, in a window, until the window is closed. p: pause; space or right arrow: one
/// step, and pause. Mouse: the left button rotates the view by dragging (in 2D: pans), the right one pans, the wheel
/// zooms. f: fit all moving bodies. Escape: close. Throws UserError if no window can be opened.
template <int D>
void view(Simulation<D>& world, Real dt);

}}  // namespace lpc::LPC_PRECISION
