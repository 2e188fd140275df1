// SPDX-License-Identifier: Zlib
// How a pair query finds its answer about two bodies that are selected: each step in words, in the space of
// differences, and on the shapes.
#include <imgui.h>

#include <algorithm>
#include <limits>

#include "experiments/sandbox/list_draw.h"
#include "experiments/sandbox/panels.h"
#include "framework/check.h"
#include "framework/pair_trace.h"
#include "framework/registry.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
struct Part {
  ShapeView<D> view;
  Pose<D> X_WP;
};

// The parts of two bodies whose middles are nearest to each other.
template <int D>
std::optional<std::pair<Part<D>, Part<D>>> nearestParts(const Simulation<D>& world, std::int32_t a, std::int32_t b) {
  std::vector<Part<D>> ofA, ofB;
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body != a && s.body != b) continue;
    const Pose<D> X_WS = world.bodies().pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    forParts(s.shape, X_WS, [&](const ShapeView<D>& view, const Pose<D>& X_WP) {
      (s.body == a ? ofA : ofB).push_back({view, X_WP});
    });
  }
  std::optional<std::pair<Part<D>, Part<D>>> out;
  Real nearest = std::numeric_limits<Real>::infinity();
  for (const Part<D>& p : ofA) {
    for (const Part<D>& q : ofB) {
      const Real far = (p.X_WP.p - q.X_WP.p).norm();
      if (far < nearest) nearest = far, out = std::pair(p, q);
    }
  }
  return out;
}

template <int D>
void drawDifference(const PairTrace<D>& trace, std::size_t step, ViewCamera<D>& camera) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const int width = static_cast<int>(ImGui::GetContentRegionAvail().x), height = 260;
  ImGui::InvisibleButton("difference", ImVec2(static_cast<float>(width), static_cast<float>(height)));
  camera.resize(width, height, static_cast<int>(corner.x), static_cast<int>(corner.y));
  // All of the difference, and the origin.
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
  camera.look(lo - Vec<D>::Constant(Real(0.2)), hi + Vec<D>::Constant(Real(0.2)));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + static_cast<float>(width), corner.y + static_cast<float>(height));
  list.PushClipRect(corner, end, true);
  list.AddRectFilled(corner, end, IM_COL32(247, 247, 245, 255));
  ListDraw<D> draw(camera, list);
  drawTrace(trace, step, draw);
  list.PopClipRect();
}

}  // namespace

template <int D>
void lookIntoPair(App<D>& app) {
  app.pairTrace.reset(), app.pairSays.clear();
  const std::vector<int>& selected = app.hand.selected();
  if (selected.size() < 2) {
    app.pairSays = "select two bodies (Shift adds the second)";
    return;
  }
  const Handle a = app.session.handle(selected[0]), b = app.session.handle(selected[1]);
  const Simulation<D>& world = app.session.world();
  if (!world.valid(a) || !world.valid(b)) {
    app.pairSays = "one of them is gone";
    return;
  }
  const auto parts = nearestParts(world, a.slot, b.slot);
  if (!parts) {
    app.pairSays = "one of them has no shape";
    return;
  }
  const auto& [p, q] = *parts;
  try {
    PairTrace<D> trace = tracePair<D>(app.pairQuery, p.view, q.view, p.X_WP.inverse() * q.X_WP);
    app.pairStep = std::clamp(app.pairStep, 0, static_cast<int>(trace.steps.size()) - 1);
    const Pose<D> X_WA = trace.swapped ? q.X_WP : p.X_WP;
    app.pairTrace = {std::move(trace), X_WA};
  } catch (const UserError& e) {
    app.pairSays = e.what();
  }
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
  if (!app.pairTrace) return ImGui::TextWrapped("%s", app.pairSays.c_str());
  const PairTrace<D>& trace = app.pairTrace->trace;
  ImGui::SliderInt("step", &app.pairStep, 0, static_cast<int>(trace.steps.size()) - 1);
  app.marks.last("Pair/step");
  const auto step = static_cast<std::size_t>(app.pairStep);
  ImGui::TextWrapped("%s", describe(trace.steps[step]).c_str());
  drawDifference(trace, step, app.pairCamera);
}

template void lookIntoPair(App<2>&);
template void lookIntoPair(App<3>&);
template void pairPanel(App<2>&);
template void pairPanel(App<3>&);

}  // namespace lpc::inline LPC_PRECISION
