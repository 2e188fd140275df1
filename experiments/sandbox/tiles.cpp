// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/tiles.h"

#include <algorithm>

#include "experiments/sandbox/look_at_all.h"

namespace lpc { inline namespace LPC_PRECISION {

std::vector<Tile> tilesOf(std::size_t count, int columns, const Tile& area) {
  const int rows = (static_cast<int>(count) + columns - 1) / columns;
  const int width = area.width / columns, height = area.height / rows;
  std::vector<Tile> out;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    out.push_back({area.left + i % columns * width, area.top + i / columns * height, width, height});
  }
  return out;
}

template <int D>
int columnsFor(ViewCamera<D> camera, const Simulation<D>& world, std::size_t count, const Tile& area, int head) {
  int best = 1;
  Real largest = 0;
  for (int columns = 1; columns <= static_cast<int>(count); ++columns) {
    const Tile tile = tilesOf(count, columns, area).front();
    camera.resize(tile.width, std::max(tile.height - head, 1));
    camera.look(Vec<D>::Constant(-1), Vec<D>::Constant(1));  // for an empty scene
    lookAtAll(camera, world);
    if (const Real scale = camera.scaleAt(camera.origin()); scale > largest) best = columns, largest = scale;
  }
  return best;
}

template int columnsFor(ViewCamera<2>, const Simulation<2>&, std::size_t, const Tile&, int);
template int columnsFor(ViewCamera<3>, const Simulation<3>&, std::size_t, const Tile&, int);

}}  // namespace lpc::LPC_PRECISION
