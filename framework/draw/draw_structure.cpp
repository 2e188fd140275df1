// SPDX-License-Identifier: Zlib
#include "framework/draw/draw_structure.h"

#include <cmath>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Colours by level from the root, repeating; adjacent levels differ clearly.
constexpr std::array<DrawColour, 6> kLevelColours = {{{0, 114, 178, 255},
                                                      {230, 159, 0, 255},
                                                      {0, 158, 115, 255},
                                                      {204, 121, 167, 255},
                                                      {86, 180, 233, 255},
                                                      {213, 94, 0, 255}}};
constexpr unsigned char kEmptyAlpha = 90;  // alpha of empty cells

template <int D>
Aabb<D> withEnds(const Aabb<D>& box, const Aabb<D>& all) {
  Aabb<D> out = box;
  for (int d = 0; d < D; ++d) {
    if (std::isinf(box.lo[d])) out.lo[d] = std::min(all.lo[d], box.hi[d]);
    if (std::isinf(box.hi[d])) out.hi[d] = std::max(all.hi[d], box.lo[d]);
  }
  return out;
}

template <int D>
void drawPart(const Aabb<D>& box, const DrawColour& colour, DebugDraw<D>& draw) {
  for (int corner = 0; corner < 1 << D; ++corner) {
    Vec<D> from;
    for (int d = 0; d < D; ++d) from[d] = (corner >> d) & 1 ? box.hi[d] : box.lo[d];
    for (int d = 0; d < D; ++d) {
      if ((corner >> d) & 1) continue;
      Vec<D> to = from;
      to[d] = box.hi[d];
      draw.line(from, to, colour);
    }
  }
}

}  // namespace

template <int D>
void drawStructure(const World<D>& world, DebugDraw<D>& draw, const std::optional<DrawColour>& tint) {
  std::vector<StructureBox<D>> boxes;
  world.broadphaseStructure(boxes);
  Aabb<D> all;
  for (ProxyId i = 0; i < world.proxies().size(); ++i) all = all.merged(world.proxies().box(i));
  for (const StructureBox<D>& part : boxes) {
    const Aabb<D> box = withEnds(part.box, all);
    if (!box.lo.allFinite() || !box.hi.allFinite()) continue;  // there are no boxes
    DrawColour colour = kLevelColours[static_cast<std::size_t>(part.level) % kLevelColours.size()];
    if (!part.holds) colour.alpha = kEmptyAlpha;
    drawPart(box, tint.value_or(colour), draw);
  }
}

template void drawStructure(const World<2>&, DebugDraw<2>&, const std::optional<DrawColour>&);
template void drawStructure(const World<3>&, DebugDraw<3>&, const std::optional<DrawColour>&);

}}  // namespace lpc::LPC_PRECISION
