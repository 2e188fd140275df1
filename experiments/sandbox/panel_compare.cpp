// SPDX-License-Identifier: Zlib
// Several competitors on one scene: their pipelines, the cost of a step, and their distance from the first.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "experiments/sandbox/competitor_colours.h"
#include "experiments/sandbox/competitor_label.h"
#include "experiments/sandbox/equal_cost.h"
#include "experiments/sandbox/panels.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Distance from the first over all steps: from a nanometre to ten metres, logarithmic. A grey line marks the error at
// which they diverge, a red one the step at which they did.
void errorPlot(const std::vector<Sample>& samples, double parted, long partedAt, const DrawColour& colour) {
  constexpr double kFoot = 1e-9, kTop = 10;
  constexpr float kTall = 24;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float wide = ImGui::GetContentRegionAvail().x;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto y = [&](double error) {
    const double part = std::log(std::clamp(error, kFoot, kTop) / kFoot) / std::log(kTop / kFoot);
    return at.y + kTall * (1 - static_cast<float>(part));
  };
  list.AddRectFilled(at, {at.x + wide, at.y + kTall}, IM_COL32_WHITE);
  list.AddLine({at.x, y(parted)}, {at.x + wide, y(parted)}, IM_COL32(200, 200, 200, 255));
  const auto columns = static_cast<std::size_t>(std::max(wide, 1.0f));
  const auto x = [&](std::size_t sample) {
    return at.x + wide * static_cast<float>(sample) / static_cast<float>(samples.size());
  };
  const std::size_t each = samples.size() / columns + 1;  // the worst of each column
  ImVec2 last;
  for (std::size_t i = 0; i < samples.size(); i += each) {
    double worst = 0;
    for (std::size_t k = i; k < std::min(i + each, samples.size()); ++k) worst = std::max(worst, samples[k].error);
    const ImVec2 next(x(i), y(worst));
    if (i > 0) list.AddLine(last, next, packed(colour), 1.5f);
    last = next;
  }
  if (partedAt > 0) {
    const float mark = std::floor(x(static_cast<std::size_t>(partedAt - 1)));
    list.AddRectFilled({mark, at.y}, {mark + 1, at.y + kTall}, packed(kPartedMark));
  }
  ImGui::Dummy({wide, kTall});
}

}  // namespace

template <int D>
void comparePanel(App<D>& app) {
  const auto& competitors = app.session.competitors();
  bool beside = app.arrangement == Arrangement::sideBySide;
  ImGui::Checkbox("side by side", &beside);
  app.marks.last("Compare/side by side");
  app.arrangeAs(beside ? Arrangement::sideBySide : Arrangement::overlaid);
  const double first = medianTime(competitors[0].samples);
  if (competitors.size() > 1) {
    ImGui::Checkbox("same cost: iterations adapted to the first one's time", &app.equalCost);
    app.marks.last("Compare/same cost");
  }
  for (std::size_t competitor = 0; competitor < competitors.size(); ++competitor) {
    const auto& l = competitors[competitor];
    ImGui::PushID(static_cast<int>(competitor));
    swatch(app.competitorLooks()[competitor].colour);
    ImGui::TextWrapped("%zu %s", competitor + 1, app.competitorLooks()[competitor].title.c_str());
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", app.competitorLooks()[competitor].label.c_str());
    ImGui::TextWrapped("%s", competitorState(app.session, competitor).c_str());
    const std::string stays = app.equalCost ? whyCostStays(app.session, competitor) : "";
    if (!stays.empty()) ImGui::TextWrapped("cost not adapted: %s", stays.c_str());
    if (competitor > 0) errorPlot(l.samples, Session<D>::kParted, l.partedAt, app.competitorLooks()[competitor].colour);
    if (competitors.size() > 1 && ImGui::SmallButton("remove")) {
      app.act([&] { app.removeCompetitor(competitor); });
    }
    app.marks.last("Compare/remove " + std::to_string(competitor + 1));
    if (competitor > 0 && first > 0) {
      ImGui::SameLine();
      ImGui::Text("time per step: %.2f x the first one's", medianTime(l.samples) / first);
    }
    ImGui::PopID();
  }
  if (competitors.size() >= kMostCompetitors) return;
  static std::string text;  // being typed
  ImGui::InputText("pipeline or engine", &text);
  app.marks.last("Compare/pipeline");
  if (ImGui::Button("add and restart")) app.act([&] { app.addCompetitor(text); });
  app.marks.last("Compare/add");
}

template void comparePanel(App<2>&);
template void comparePanel(App<3>&);

}}  // namespace lpc::LPC_PRECISION
