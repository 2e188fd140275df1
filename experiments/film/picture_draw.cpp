// SPDX-License-Identifier: Zlib
#include "experiments/film/picture_draw.h"

#include <algorithm>
#include <string>
#include <utility>

#include "experiments/film/shape_patches.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// The edges only.
std::vector<Patch> ofGlass(const std::vector<Patch>& patches) {
  std::vector<Patch> out;
  for (const Patch& p : patches) {
    for (std::size_t i = 0; i < p.corners.size(); ++i) {
      out.push_back({{p.corners[i], p.corners[(i + 1) % p.corners.size()]}, p.edge, p.edge});
    }
  }
  return out;
}

}  // namespace

template <int D>
void PictureDraw<D>::point(const Vec<D>& p, double pixels, const DrawColour& colour) {
  const Vec<2> at = m_camera.pixel(p);
  Patch dot{{}, colour, colour};
  Vec<2> out(pixels / 2, 0);
  for (int i = 0; i < 8; ++i) {
    dot.corners.push_back(at + out);
    out = 0.7071067811865476 * Vec<2>(out[0] - out[1], out[0] + out[1]);
  }
  m_over.push_back(std::move(dot));
}

template <int D>
void PictureDraw<D>::line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) {
  m_over.push_back({{m_camera.pixel(a), m_camera.pixel(b)}, colour, colour});
}

template <int D>
void PictureDraw<D>::shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) {
  const bool plane = shape.core() == CoreClass::plane;
  std::vector<Patch> patches;
  if (plane) {
    patches.push_back({planePatch(X_WS, m_camera), look.fill, look.edge});
  } else {
    patches = patchesOf(shape, X_WS, m_camera, look.fill, look.edge);
  }
  if (look.outline) patches = ofGlass(patches);
  if (plane) {
    m_planes.insert(m_planes.end(), patches.begin(), patches.end());
    return;
  }
  m_parts.push_back({look.moves, {}, std::move(patches)});
  if constexpr (D == 3) {
    m_parts.back().seen = {outlineOf(shape, X_WS, m_camera), nearnessOf(shape, X_WS, m_camera)};
  }
}

template <int D>
void PictureDraw<D>::text(const Vec<D>& p, std::string_view text, const DrawColour& colour) {
  m_labels.push_back({m_camera.pixel(p), std::string(text), colour});
}

// Draws from back to front. In 2D nothing is behind another body, and moving bodies are drawn last. In 3D a fixed body
// may be in front of a moving one, such as a wall, or the ground above a body that fell through it. Such a fixed body
// is drawn transparent, since the picture is about the moving bodies.
template <int D>
auto PictureDraw<D>::partsInOrder() -> std::vector<Part> {
  std::vector<Part> parts = std::exchange(m_parts, {});
  if constexpr (D == 2) {
    std::stable_partition(parts.begin(), parts.end(), [](const Part& p) { return !p.moves; });
    return parts;
  }
  std::vector<SeenPart> seen;
  for (Part& p : parts) seen.push_back(std::move(p.seen));
  const DepthOrder order = depthOrder(seen);
  std::vector<bool> glass(parts.size(), false);
  for (const auto& [back, front] : order.covered) {
    if (parts[back].moves && !parts[front].moves) glass[front] = true;
  }
  std::vector<Part> sorted;
  for (const std::size_t i : order.backToFront) {
    if (glass[i]) parts[i].patches = ofGlass(parts[i].patches);
    sorted.push_back(std::move(parts[i]));
  }
  return sorted;
}

template <int D>
Picture PictureDraw<D>::picture() {
  Picture out{m_camera.width, m_camera.height, std::exchange(m_planes, {}), std::exchange(m_labels, {})};
  for (Part& part : partsInOrder()) {
    for (Patch& p : part.patches) out.patches.push_back(std::move(p));
  }
  for (Patch& p : std::exchange(m_over, {})) out.patches.push_back(std::move(p));
  return out;
}

template class PictureDraw<2>;
template class PictureDraw<3>;

}}  // namespace lpc::LPC_PRECISION
