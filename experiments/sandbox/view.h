// SPDX-License-Identifier: Zlib
// For a program of one's own: see its world.
//
//   World<3> world(Pipeline::parse("solver=soft_step"));
//   ...
//   view(world, Real(1) / 60);
#pragma once

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Steps the world by dt (s), as many times a second as it has seconds, in a window, until that is closed. p: pause;
/// space or right arrow: one step, and pause. Mouse: the left button turns what it drags (in 2D: moves), the right one
/// moves it, the wheel zooms. f: see all that moves. Escape: close. Throws UserError where no window can be.
template <int D>
void view(Simulation<D>& world, Real dt);

}}  // namespace lpc::LPC_PRECISION
