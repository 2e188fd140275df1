// SPDX-License-Identifier: Zlib
// The selected body in numbers, and exact placing while the world is paused.
#include <imgui.h>

#include <cmath>

#include "experiments/sandbox/panels.h"
#include "experiments/trial/formats/body_type_name.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
double turnOf(const Rot<D>& q) {
  if constexpr (D == 2) {
    return static_cast<double>(q.radians());
  } else {
    return 2 * std::acos(std::min(1.0, std::abs(static_cast<double>(q.w))));
  }
}

}  // namespace

template <int D>
void bodyPanel(App<D>& app) {
  const std::vector<int>& selected = app.hand.selected();
  if (selected.empty()) return ImGui::TextUnformatted("no body selected");
  const int body = selected.back();
  const BodyHandle h = app.session.handle(body);
  const Simulation<D>& world = app.session.world();
  if (!world.valid(h)) return ImGui::TextUnformatted("the body no longer exists");
  const auto i = static_cast<std::size_t>(h.slot);
  const Bodies<D>& b = world.bodies();
  const Pose<D> X_WB = world.pose(h);
  if (selected.size() > 1) ImGui::Text("last of %d selected bodies", static_cast<int>(selected.size()));
  ImGui::Text("body %d, %s%s%s", body, bodyTypeName(b.type[i]), b.pinned[i] ? ", pinned" : "",
              b.awake[i] ? "" : ", asleep");
  ImGui::Text("mass %.6g kg, rotation %.4g rad", static_cast<double>(b.mass[i]), turnOf<D>(X_WB.q));
  ImGui::Text("speed %.4g m/s", static_cast<double>(b.motion[i].v.norm()));
  constexpr const char* kAxes[] = {"x (m)", "y (m)", "z (m)"};
  for (int d = 0; d < D; ++d) {
    auto value = static_cast<double>(X_WB.p[d]);
    const bool entered = ImGui::InputDouble(kAxes[d], &value, 0, 0, "%.9g", ImGuiInputTextFlags_EnterReturnsTrue);
    app.marks.last(std::string("Body/") + kAxes[d]);
    if (!entered || !std::isfinite(value)) continue;
    Vec<D> p = X_WB.p;
    p[d] = static_cast<Real>(value);
    app.act([&] { app.session.perform(SetBody<D>{.body = body, .position = p}); });
  }
}

template void bodyPanel(App<2>&);
template void bodyPanel(App<3>&);

}}  // namespace lpc::LPC_PRECISION
