// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/list_draw.h"

#include <imgui.h>

#include "experiments/sandbox/panels.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

ImVec2 inPanel(const Vec<2>& pixel) { return {static_cast<float>(pixel[0]), static_cast<float>(pixel[1])}; }

}  // namespace

template <int D>
void ListDraw<D>::point(const Vec<D>& p, double pixels, const DrawColour& colour) {
  m_list.AddCircleFilled(inPanel(m_camera.toPixel(p)), static_cast<float>(pixels) / 2, packed(colour));
}

template <int D>
void ListDraw<D>::line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) {
  m_list.AddLine(inPanel(m_camera.toPixel(a)), inPanel(m_camera.toPixel(b)), packed(colour), 1.5f);
}

template <int D>
void ListDraw<D>::shape(const ShapeView<D>&, const Pose<D>& X_WS, const Look& look) {
  point(X_WS.p, 6, look.fill);
}

template <int D>
void ListDraw<D>::text(const Vec<D>& p, std::string_view text, const DrawColour& colour) {
  m_list.AddText(inPanel(m_camera.toPixel(p)), packed(colour), text.data(), text.data() + text.size());
}

template class ListDraw<2>;
template class ListDraw<3>;

}}  // namespace lpc::LPC_PRECISION
