// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/panels.h"

#include <SDL2/SDL_keyboard.h>
#include <imgui.h>

#include "experiments/sandbox/lane_colours.h"
#include "experiments/sandbox/lane_label.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
void keysPanel(App<D>&) {
  for (const Command<D>& c : commands<D>()) {
    if (c.key) ImGui::Text("%-10s %s: %s", SDL_GetKeyName(c.key), c.name, c.meaning);
  }
  ImGui::TextUnformatted("left mouse  selects, drags, draws (Shift: adds to the selection)");
  ImGui::TextUnformatted(D == 2 ? "right mouse pans; the wheel zooms"
                                : "right mouse turns, with Shift pans; the wheel zooms");
  ImGui::TextUnformatted("Ctrl        while dragging: no rotation; with the wheel: turns");
}

template <int D>
void layersPanel(App<D>& app) {
  for (const DrawLayer& layer : kDrawLayers) {
    const std::string name(layer.name);
    ImGui::Checkbox(name.c_str(), &(app.layers.*layer.on));
    app.marks.last("Layers/" + name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", std::string(layer.meaning).c_str());
  }
}

// One line at the foot of the window, or more.
template <int D>
void status(App<D>& app) {
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::SetNextWindowPos(ImVec2(0, io.DisplaySize.y), 0, ImVec2(0, 1));
  ImGui::SetNextWindowBgAlpha(0.85f);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                      ImGuiWindowFlags_NoNav | ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::Begin("##status", nullptr, kFlags);
  const Simulation<D>& world = app.session.world();
  if (app.verbosity > 0) {
    ImGui::Text("%s%s  step %ld  %.2f s  %d bodies  physics %.2f ms  drawing %.2f ms  %.0f pictures/s%s",
                app.file.name().c_str(), std::is_same_v<Real, float> ? " in f32" : "", app.session.steps(),
                static_cast<double>(world.time()), world.bodyCount(), 1e3 * app.stepSeconds, 1e3 * app.drawSeconds,
                app.window.picturesPerSecond(), app.paused ? "  paused" : "");
  }
  if (app.verbosity > 1) {
    const Profiler::Frame& f = app.session.world().profiler().frame();
    ImGui::Text("awake %d  pairs %d  manifolds %d  points %d", f.awake, f.pairs, f.manifolds, f.points);
  }
  for (std::size_t lane = 0; app.session.lanes().size() > 1 && lane < app.session.lanes().size(); ++lane) {
    const auto& l = app.session.lanes()[lane];
    const DrawColour c = laneColour(lane);
    const std::string state = !l.fallen.empty() ? "  " + l.fallen
                              : l.partedAt >= 0 ? "  parted at step " + std::to_string(l.partedAt)
                                                : "";
    ImGui::TextColored(ImVec4(float(c.red) / 255, float(c.green) / 255, float(c.blue) / 255, 1), "%s%s",
                       laneLabel(l.pipeline, D).c_str(), state.c_str());
  }
  if (!app.message.empty()) ImGui::TextUnformatted(app.message.c_str());
  ImGui::End();
}

}  // namespace

template <int D>
void drawPanels(App<D>& app) {
  struct Content {
    bool Panels::*open;
    void (*draw)(App<D>&);
  };
  static constexpr Content kContents[] = {{&Panels::scene, scenePanel<D>},   {&Panels::stages, stagesPanel<D>},
                                          {&Panels::layers, layersPanel<D>}, {&Panels::step, stepPanel<D>},
                                          {&Panels::body, bodyPanel<D>},     {&Panels::compare, comparePanel<D>},
                                          {&Panels::pair, pairPanel<D>},     {&Panels::help, keysPanel<D>}};
  float x = static_cast<float>(app.window.width()) - 370;
  const float tall = static_cast<float>(app.window.height()) - 120;
  for (const PanelInfo& p : panelInfos()) {
    if (!(app.panels.*p.open)) continue;
    ImGui::SetNextWindowPos(ImVec2(x, 30), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSizeConstraints(ImVec2(360, 0), ImVec2(360, tall));
    x = x > 400 ? x - 370 : x;
    if (ImGui::Begin(p.name, &(app.panels.*p.open), ImGuiWindowFlags_AlwaysAutoResize)) {
      ImGui::PushItemWidth(-140);  // room for names
      for (const Content& c : kContents) {
        if (c.open == p.open) c.draw(app);
      }
      ImGui::PopItemWidth();
    }
    ImGui::End();
  }
  status(app);
}

template void drawPanels(App<2>&);
template void drawPanels(App<3>&);

}  // namespace lpc::inline LPC_PRECISION
