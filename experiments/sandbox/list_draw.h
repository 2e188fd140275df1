// SPDX-License-Identifier: Zlib
// Draws points, lines and text into a panel, without light or depth.
#pragma once

#include "experiments/sandbox/view_camera.h"
#include "framework/draw/debug_draw.h"

struct ImDrawList;

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class ListDraw final : public DebugDraw<D> {
 public:
  /// Both must outlive it.
  ListDraw(const ViewCamera<D>& camera, ImDrawList& list) : m_camera(camera), m_list(list) {}

  void point(const Vec<D>& p, double pixels, const DrawColour& colour) override;
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) override;
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override;  // its origin only
  void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) override;

 private:
  const ViewCamera<D>& m_camera;
  ImDrawList& m_list;
};

}}  // namespace lpc::LPC_PRECISION
