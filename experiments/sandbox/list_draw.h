// SPDX-License-Identifier: Zlib
// Draws into a panel: points, lines and words, of what needs no light and no depth.
#pragma once

#include <imgui.h>

#include <string>

#include "experiments/sandbox/view_camera.h"
#include "framework/debug_draw.h"

namespace lpc::inline LPC_PRECISION {

template <int D>
class ListDraw final : public DebugDraw<D> {
 public:
  /// Both must outlive it.
  ListDraw(const ViewCamera<D>& camera, ImDrawList& list) : m_camera(camera), m_list(list) {}

  void point(const Vec<D>& p, double pixels, const Colour& colour) override {
    m_list.AddCircleFilled(at(p), static_cast<float>(pixels) / 2, packed(colour));
  }
  void line(const Vec<D>& a, const Vec<D>& b, const Colour& colour) override {
    m_list.AddLine(at(a), at(b), packed(colour), 1.5f);
  }
  void shape(const ShapeView<D>&, const Pose<D>& X_WS, const Look& look) override { point(X_WS.p, 6, look.fill); }
  void text(const Vec<D>& p, std::string_view text, const Colour& colour) override {
    m_list.AddText(at(p), packed(colour), text.data(), text.data() + text.size());
  }

 private:
  ImVec2 at(const Vec<D>& p) const {
    const Vec<2> pixel = m_camera.toPixel(p);
    return {static_cast<float>(pixel[0]), static_cast<float>(pixel[1])};
  }
  static ImU32 packed(const Colour& c) { return IM_COL32(c.red, c.green, c.blue, c.alpha); }

  const ViewCamera<D>& m_camera;
  ImDrawList& m_list;
};

}  // namespace lpc::inline LPC_PRECISION
