// SPDX-License-Identifier: Zlib
// How a pair query finds its answer for two selected bodies: each step in words, in the Minkowski difference, and on
// the shapes.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "experiments/sandbox/list_draw.h"
#include "experiments/sandbox/panels.h"
#include "framework/shape/support_map.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
void drawDifference(const PairTrace<D>& trace, std::size_t step, ViewCamera<D>& camera) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const int width = static_cast<int>(ImGui::GetContentRegionAvail().x), height = 260;
  ImGui::InvisibleButton("difference", ImVec2(static_cast<float>(width), static_cast<float>(height)));
  camera.resize(width, height, static_cast<int>(corner.x), static_cast<int>(corner.y));
  // The whole difference, and the origin.
  Vec<D> lo = Vec<D>::Zero(), hi = lo;
  const PairView<D>& pair = trace.pair;
  for (int axis = 0; axis < D; ++axis) {
    for (const Real side : {Real(-1), Real(1)}) {
      const Vec<D> n = side * Vec<D>::Unit(axis);
      const Vec<D> a = coreSupport(pair.a, Vec<D>(-n));
      const Vec<D> b = pair.X_AB * coreSupport(pair.b, Vec<D>(pair.X_AB.q.inverse() * n));
      if (!(b - a).allFinite()) continue;  // of a plane
      lo = lo.cwiseMin(b - a), hi = hi.cwiseMax(b - a);
    }
  }
  const Vec<D> rim = Vec<D>::Constant((hi - lo).norm() / 20);
  camera.look(lo - rim, hi + rim);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + static_cast<float>(width), corner.y + static_cast<float>(height));
  list.PushClipRect(corner, end, true);
  list.AddRectFilled(corner, end, IM_COL32(247, 247, 245, 255));
  ListDraw<D> draw(camera, list);
  drawTrace(trace, step, draw);
  list.PopClipRect();
}

// The proved bound after each step, and the current step.
template <int D>
void plotProved(const PairTrace<D>& trace, int step) {
  std::vector<float> best;
  for (const TraceStep<D>& s : trace.steps) {
    if (std::isfinite(s.best)) best.push_back(static_cast<float>(s.best));  // not before the first direction
  }
  if (best.size() < 8) return;  // for a few steps the text suffices
  ImGui::TextUnformatted("proved bound (m), step by step");
  const auto [least, most] = std::minmax_element(best.begin(), best.end());
  const float low = *least, high = std::max(*most, low + 1e-12f);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 40;
  ImGui::PlotLines("##proved", best.data(), static_cast<int>(best.size()), 0, nullptr, low, high,
                   ImVec2(width, height));
  const float at = static_cast<float>(step) - static_cast<float>(trace.steps.size() - best.size());
  const float x = corner.x + width * std::max(at, 0.0f) / static_cast<float>(best.size() - 1);
  ImGui::GetWindowDrawList()->AddLine(ImVec2(x, corner.y), ImVec2(x, corner.y + height), IM_COL32(230, 160, 0, 255), 2);
}

}  // namespace

template <int D>
void lookIntoPair(App<D>& app) {
  const PairTrace<D>* before = app.pair.trace();
  const bool atAnswer = before && app.pairStep + 1 == static_cast<int>(before->steps.size());
  const std::vector<int>& selected = app.hand.selected();
  if (selected.size() < 2) return app.pair.nobody("select two bodies (Shift adds the second)");
  const BodyHandle a = app.session.handle(selected[0]), b = app.session.handle(selected[1]);
  const Simulation<D>& world = app.session.world();
  if (!world.valid(a) || !world.valid(b)) return app.pair.nobody("a selected body no longer exists");
  app.pair.look(app.pairQuery, world, a.slot, b.slot);
  if (!app.pair.trace()) return;
  const int last = static_cast<int>(app.pair.trace()->steps.size()) - 1;
  app.pairStep = atAnswer ? last : std::clamp(app.pairStep, 0, last);
}

template <int D>
void pairPanel(App<D>& app) {
  if (ImGui::BeginCombo("query", app.pairQuery.c_str())) {
    for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
      if (r->info.role != AlgorithmRole::competitor) continue;
      if (ImGui::Selectable(r->info.name.c_str(), r->info.name == app.pairQuery)) app.pairQuery = r->info.name;
      app.marks.last("Pair/" + r->info.name);
    }
    ImGui::EndCombo();
  }
  app.marks.last("Pair/query");
  const PairTrace<D>* trace = app.pair.trace();
  if (!trace) return ImGui::TextWrapped("%s", app.pair.says().c_str());
  const int last = static_cast<int>(trace->steps.size()) - 1;
  ImGui::SliderInt("step", &app.pairStep, 0, last, ("%d of " + std::to_string(last)).c_str());
  app.marks.last("Pair/step");
  const auto jump = [&](const char* name, int to, const char* meaning) {
    if (ImGui::Button(name)) app.pairStep = std::clamp(to, 0, last);
    app.marks.last(std::string("Pair/") + name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", meaning);
    ImGui::SameLine();
  };
  jump("first", 0, "the first step");
  jump("-1", app.pairStep - 1, "the step before");
  jump("+1", app.pairStep + 1, "the next step");
  jump("found", static_cast<int>(app.pair.found()),
       "first step with the axis of the answer; later steps only prove it");
  jump("answer", last, "the last step");
  ImGui::NewLine();
  plotProved(*trace, app.pairStep);
  const auto step = static_cast<std::size_t>(app.pairStep);
  ImGui::TextWrapped("%s", describe(trace->steps[step]).c_str());
  drawDifference(*trace, step, app.pairCamera);
}

template void lookIntoPair(App<2>&);
template void lookIntoPair(App<3>&);
template void pairPanel(App<2>&);
template void pairPanel(App<3>&);

}}  // namespace lpc::LPC_PRECISION
