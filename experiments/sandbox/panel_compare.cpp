// SPDX-License-Identifier: Zlib
// Several competitors on one scene: who they are, what a step costs each, and how far each is from the first.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "experiments/sandbox/lane_colours.h"
#include "experiments/sandbox/lane_label.h"
#include "experiments/sandbox/panels.h"

namespace lpc::inline LPC_PRECISION {
template <int D>
void comparePanel(App<D>& app) {
  const auto& lanes = app.session.lanes();
  bool beside = app.arrangement == Arrangement::sideBySide;
  ImGui::Checkbox("side by side", &beside);
  app.marks.last("Compare/side by side");
  app.arrangement = beside ? Arrangement::sideBySide : Arrangement::overlaid;
  const double first = medianTime(lanes[0].samples);
  if (lanes.size() > 1) {
    ImGui::Checkbox("same cost: iterations follow the first's time", &app.equalCost);
    app.marks.last("Compare/same cost");
  }
  for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
    const auto& l = lanes[lane];
    ImGui::PushID(static_cast<int>(lane));
    const DrawColour c = laneColour(lane);
    ImGui::TextColored(ImVec4(float(c.red) / 255, float(c.green) / 255, float(c.blue) / 255, 1), "%zu", lane + 1);
    ImGui::SameLine();
    ImGui::TextWrapped("%s", laneLabel(l.pipeline, D).c_str());
    const double time = medianTime(l.samples);
    ImGui::Text("step %.3f ms (%.2f of the first)", 1e3 * time, first > 0 ? time / first : 0.0);
    if (!l.fallen.empty()) ImGui::TextWrapped("%s", l.fallen.c_str());
    if (lane > 0 && !l.samples.empty()) {
      ImGui::Text("%.3g m from the first; parted at %s", l.samples.back().error,
                  l.partedAt < 0 ? "no step yet" : ("step " + std::to_string(l.partedAt)).c_str());
    }
    if (lanes.size() > 1 && ImGui::SmallButton("take out")) {
      app.act([&] { app.takeOut(lane); });
    }
    app.marks.last("Compare/take out " + std::to_string(lane + 1));
    ImGui::PopID();
  }
  if (lanes.size() >= kMostLanes) return;
  static std::string text;  // being typed
  ImGui::InputText("pipeline or engine", &text);
  app.marks.last("Compare/pipeline");
  if (ImGui::Button("add, and begin anew")) app.act([&] { app.addLane(text); });
  app.marks.last("Compare/add");
}

template void comparePanel(App<2>&);
template void comparePanel(App<3>&);

}  // namespace lpc::inline LPC_PRECISION
