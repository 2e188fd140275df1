// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/panels.h"

#include <SDL2/SDL_keyboard.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "experiments/sandbox/competitor_label.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A key and its description, over as many lines as needed.
void keyLine(const char* key, const std::string& does) {
  ImGui::TextUnformatted(key);
  ImGui::SameLine(90);
  ImGui::TextWrapped("%s", does.c_str());
}

template <int D>
void keysPanel(App<D>&) {
  for (const Command<D>& c : commands<D>()) {
    if (c.key) keyLine(SDL_GetKeyName(c.key), std::string(c.name) + ": " + c.meaning);
  }
  keyLine("left mouse", "select, drag, draw (Shift: add to the selection)");
  keyLine("right mouse", D == 2 ? "pan; wheel: zoom" : "rotate, with Shift pan; wheel: zoom");
  keyLine("Ctrl", "while dragging: no rotation; with the wheel: rotate the body");
}

// Sliders for numbers in their ranges, for settings other than algorithms.
class Sliders final : public ParamVisitor {
 public:
  explicit Sliders(Marks& marks, std::string panel) : m_marks(marks), m_panel(std::move(panel)) {}
  void real(std::string_view name, Real& value, Real lo, Real hi, std::string_view unit, std::string_view meaning,
            ParamRole) override {
    const std::string label(name), told = std::string(meaning) + " (" + std::string(unit) + ")";
    ImGui::SliderScalar(label.c_str(), ImGuiDataType_Double, &value, &lo, &hi, "%.3g",
                        ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", told.c_str());
    m_marks.last(m_panel + "/" + label);
  }
  void integer(std::string_view, int&, int, int, std::string_view, ParamRole) override {}
  void flag(std::string_view, bool&, std::string_view) override {}
  void stage(std::string_view, Spec&, StageKind, std::string_view) override {}

 protected:
  void choiceIndex(std::string_view, int&, const std::vector<std::string_view>&, std::string_view) override {}

 private:
  Marks& m_marks;
  std::string m_panel;
};

template <int D>
void layersPanel(App<D>& app) {
  for (const DrawLayer& layer : kDrawLayers) {
    const std::string name(layer.name);
    ImGui::Checkbox(name.c_str(), &(app.layers.*layer.on));
    app.marks.last("Layers/" + name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", std::string(layer.meaning).c_str());
  }
  Sliders sliders(app.marks, "Layers");
  app.layers.visit(sliders);
}

// A new panel opens where none was opened before, from right to left, then again slightly lower.
ImVec2 placeOf(std::map<std::string, int>& places, const char* panel, int width) {
  if (!places.contains(panel)) {
    int place = 0;
    const auto taken = [&](const auto& p) { return p.second == place; };
    while (std::any_of(places.begin(), places.end(), taken)) ++place;
    places[panel] = place;
  }
  const int columns = std::max(1, width / 370), place = places[panel];
  return {static_cast<float>(width - 370 * (1 + place % columns)), static_cast<float>(30 + 50 * (place / columns))};
}

// Shows which switches are on.
template <int D>
std::string statesOf(const App<D>& app) {
  std::string out;
  const auto add = [&](bool on, const std::string& what) {
    if (on) out += "  " + what;
  };
  char times[16];
  std::snprintf(times, sizeof times, "%gx", app.timeScale);
  add(app.paused, "paused");
  add(app.timeScale != 1, times);
  for (const ToolInfo& t : tools()) {
    const bool drawn = app.hand.drawing() && app.hand.drawsStatic;
    add(t.tool == app.hand.tool && t.tool != Tool::grab,
        "tool: " + std::string(drawn ? "static " : "") + (t.tool == Tool::joint ? app.hand.joint + " " : "") + t.name);
  }
  add(app.meteors, "meteors"), add(app.rain, "rain"), add(app.showers, "fireworks");
  add(app.logging, "statistics"), add(app.imageSequence, "image " + std::to_string(app.images));
  return out;
}

template <int D>
bool hasLegend(const App<D>& app) {
  return app.session.competitors().size() > 1 && !app.isSideBySide();
}

constexpr std::size_t kMostLines = 12;  // of one message at the window's bottom

struct StatusLine {
  std::string text;
  std::optional<DrawColour> colour = {};
};

std::size_t charactersBeside(float pixels) {
  return static_cast<std::size_t>(std::max((ImGui::GetIO().DisplaySize.x - pixels) / ImGui::CalcTextSize("m").x, 1.0f));
}
float swatchWidth() { return ImGui::GetTextLineHeight() + 4; }

// Legend of the competitors, if all are in one view.
template <int D>
std::vector<StatusLine> legend(App<D>& app) {
  std::vector<StatusLine> out;
  const std::size_t room = charactersBeside(swatchWidth() + 2 * ImGui::GetStyle().WindowPadding.x);
  for (std::size_t competitor = 0; competitor < app.session.competitors().size(); ++competitor) {
    const CompetitorLook& look = app.competitorLooks()[competitor];
    const std::string number = std::to_string(competitor + 1) + " ";
    const std::string state = (competitor == 0 ? " (filled): " : ": ") + competitorState(app.session, competitor);
    const std::size_t others = std::min(room, number.size() + state.size());  // other texts shrink for a long title
    const std::string title = brokenIntoLines(look.title, std::max(room - others, room / 3), 1).front();
    out.push_back({number + title + state, look.colour});
  }
  return out;
}

template <int D>
std::vector<StatusLine> statusLines(App<D>& app) {
  std::vector<StatusLine> out;
  const std::size_t room = charactersBeside(2 * ImGui::GetStyle().WindowPadding.x);
  const auto add = [&](const std::string& words) {
    for (std::string& one : brokenIntoLines(words, room, kMostLines)) out.push_back({std::move(one)});
  };
  char text[512];
  const Simulation<D>& world = app.session.world();
  if (app.verbosity > 0) {
    std::snprintf(text, sizeof text,
                  "%s%s  step %ld  %.2f s  %d bodies  physics %.2f ms  drawing %.2f ms  %.0f frames/s%s",
                  app.file.name().c_str(), std::is_same_v<Real, float> ? " in f32" : "", app.session.steps(),
                  static_cast<double>(world.time()), world.bodyCount(), 1e3 * app.stepSeconds, 1e3 * app.drawSeconds,
                  app.window.picturesPerSecond(), statesOf(app).c_str());
    add(text);
  }
  if (app.verbosity > 1) {
    const Profiler::Frame& f = app.session.world().profiler().frame();
    std::snprintf(text, sizeof text, "awake %d  pairs %d  manifolds %d  points %d", f.awake, f.pairs, f.manifolds,
                  f.points);
    add(text);
  }
  if (hasLegend(app)) {
    for (StatusLine& line : legend(app)) out.push_back(std::move(line));
  }
  if (!app.message.empty()) add(app.message);
  return out;
}

float heightOf(const std::vector<StatusLine>& lines) {
  const ImGuiStyle& style = ImGui::GetStyle();
  return std::ceil(static_cast<float>(lines.size()) * ImGui::GetTextLineHeightWithSpacing() - style.ItemSpacing.y +
                   2 * style.WindowPadding.y);
}

// At the bottom of the window. Sized by its present text: ImGui's own size is that of the previous picture.
template <int D>
void status(App<D>& app) {
  const std::vector<StatusLine> lines = statusLines(app);
  if (lines.empty()) return;
  float wide = 0;
  for (const StatusLine& line : lines) {
    wide = std::max(wide, ImGui::CalcTextSize(line.text.c_str()).x + (line.colour ? swatchWidth() : 0));
  }
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::SetNextWindowPos(ImVec2(0, io.DisplaySize.y), 0, ImVec2(0, 1));
  ImGui::SetNextWindowSize(ImVec2(std::ceil(wide + 2 * ImGui::GetStyle().WindowPadding.x), heightOf(lines)));
  ImGui::SetNextWindowBgAlpha(0.85f);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                      ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::Begin("##status", nullptr, kFlags);
  for (const StatusLine& line : lines) {
    if (line.colour) swatch(*line.colour);
    ImGui::TextUnformatted(line.text.c_str());
  }
  ImGui::End();
}

}  // namespace

std::uint32_t packed(const DrawColour& c) { return IM_COL32(c.red, c.green, c.blue, c.alpha); }

void swatch(const DrawColour& colour) {
  const float size = ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + size, at.y + size}, packed(colour));
  ImGui::Dummy({size, size});
  ImGui::SameLine(0, 4);
}

template <int D>
int statusHeight(App<D>& app) {
  return static_cast<int>(heightOf(statusLines(app)));
}

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
  const float tall = static_cast<float>(app.window.height()) - 120;
  for (const PanelInfo& p : panelInfos()) {
    if (!(app.panels.*p.open)) {
      app.panels.places.erase(p.name);
      continue;
    }
    ImGui::SetNextWindowPos(placeOf(app.panels.places, p.name, app.window.width()), ImGuiCond_Appearing);
    ImGui::SetNextWindowSizeConstraints(ImVec2(360, 0), ImVec2(360, tall));
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

template int statusHeight(App<2>&);
template int statusHeight(App<3>&);
template void drawPanels(App<2>&);
template void drawPanels(App<3>&);

}}  // namespace lpc::LPC_PRECISION
