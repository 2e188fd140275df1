// SPDX-License-Identifier: Zlib
// Makes a picture of a drawing. Films use it for recordings, `pictureOf` for a running simulation.
#pragma once

#include <string_view>
#include <vector>

#include "experiments/film/camera.h"
#include "experiments/film/depth_order.h"
#include "experiments/film/picture.h"
#include "framework/draw/draw_simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class PictureDraw final : public DebugDraw<D> {
 public:
  explicit PictureDraw(const Camera<D>& camera) : m_camera(camera) {}

  void point(const Vec<D>& p, double pixels, const DrawColour& colour) override;
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) override;
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override;
  void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) override;

  /// Returns everything drawn since the last call. Planes are in the back: one in front would hide the rest. Points and
  /// lines are in front of all shapes: contacts are inside.
  Picture picture();

 private:
  struct Part {
    bool moves;
    SeenPart seen;  // in 3D
    std::vector<Patch> patches;
  };
  std::vector<Part> partsInOrder();

  Camera<D> m_camera;
  std::vector<Patch> m_planes, m_over;
  std::vector<Part> m_parts;
  std::vector<Label> m_labels;
};

template <int D>
Picture pictureOf(const Simulation<D>& simulation, const DrawLayers& layers, const Camera<D>& camera) {
  PictureDraw<D> draw(camera);
  drawSimulation(simulation, layers, draw);
  return draw.picture();
}

}}  // namespace lpc::LPC_PRECISION
