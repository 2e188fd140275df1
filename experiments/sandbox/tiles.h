// SPDX-License-Identifier: Zlib
// Divides the window among competitors side by side: rows of equal tiles, since they share one camera.
#pragma once

#include <vector>

#include "experiments/sandbox/view_camera.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

struct Tile {  // px, from the window's upper left corner
  int left = 0, top = 0, width = 0, height = 0;
  bool has(const Vec<2>& pixel) const {
    const auto within = [](Real at, int from, int size) { return at >= Real(from) && at < Real(from + size); };
    return within(pixel[0], left, width) && within(pixel[1], top, height);
  }
};

/// The first is the upper left one, row by row.
std::vector<Tile> tilesOf(std::size_t count, int columns, const Tile& area);

/// The number of columns with which the scene is shown largest, below a title of this height (px) in each tile.
template <int D>
int columnsFor(ViewCamera<D> camera, const Simulation<D>& world, std::size_t count, const Tile& area, int head);

}}  // namespace lpc::LPC_PRECISION
