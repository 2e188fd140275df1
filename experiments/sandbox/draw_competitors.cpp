// SPDX-License-Identifier: Zlib
// The picture of a session: all competitors in one view, or each in a tile with its title.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "experiments/sandbox/app.h"
#include "experiments/sandbox/competitor_colours.h"
#include "experiments/sandbox/competitor_label.h"
#include "experiments/sandbox/look_at_all.h"
#include "experiments/sandbox/panels.h"
#include "experiments/sandbox/pick.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kPad = 4;                // px, around the text of a title
constexpr std::size_t kMostTitle = 2;  // lines of a label; another line below it holds numbers

int titleHeight(int lines) { return (lines + 1) * static_cast<int>(ImGui::GetTextLineHeightWithSpacing()) + 2 * kPad; }

ImVec2 cornerOf(const Tile& t) { return {static_cast<float>(t.left), static_cast<float>(t.top)}; }
ImVec2 endOf(const Tile& t) { return {static_cast<float>(t.left + t.width), static_cast<float>(t.top + t.height)}; }

// Indent of the text of a title, after its coloured square and its number.
float indentOf() { return 2 * kPad + ImGui::GetTextLineHeight() + 2 * ImGui::CalcTextSize("m").x; }

std::size_t charactersIn(const Tile& tile) {
  const float room = static_cast<float>(tile.width) - indentOf() - 2 * kPad;
  return static_cast<std::size_t>(std::max(room / ImGui::CalcTextSize("m").x, 1.0f));
}

std::string inFewerWords(std::string state) {
  for (const std::string_view word : {" off", " step"}) {
    if (const std::size_t at = state.find(word); at != state.npos) state.erase(at, word.size());
  }
  return state;
}

// The part of a tile below its title, inside its frame.
Tile viewIn(const Tile& tile, int head) {
  return {tile.left + 1, tile.top + head, std::max(tile.width - 2, 1), std::max(tile.height - head - 1, 1)};
}

template <int D>
void drawTitle(App<D>& app, std::size_t competitor) {
  const Tile &top = app.titles[competitor], &view = app.views[competitor];
  const Tile tile{top.left, top.top, top.width, view.top + view.height + 1 - top.top};
  const CompetitorLook& look = app.competitorLooks()[competitor];
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled(cornerOf(top), endOf(top), IM_COL32(240, 240, 238, 255));
  list.AddRect(cornerOf(tile), endOf(tile), IM_COL32(190, 190, 190, 255));
  list.PushClipRect(cornerOf(top), endOf(top), true);
  const float size = ImGui::GetTextLineHeight(), line = ImGui::GetTextLineHeightWithSpacing();
  const ImVec2 at(static_cast<float>(tile.left + kPad), static_cast<float>(tile.top + kPad));
  list.AddRectFilled(at, {at.x + size, at.y + size}, packed(look.colour));
  const float x = at.x + size + kPad;
  list.AddText({x, at.y}, IM_COL32_BLACK, std::to_string(competitor + 1).c_str());
  const float indent = static_cast<float>(tile.left) + indentOf();
  float y = at.y;
  const auto words = [&](const std::string& text, int lines) {
    for (const std::string& one : brokenIntoLines(text, charactersIn(tile), static_cast<std::size_t>(lines))) {
      list.AddText({indent, y}, IM_COL32_BLACK, one.c_str());
      y += line;
    }
  };
  words(look.title, app.titleLines);
  y = at.y + static_cast<float>(app.titleLines) * line;
  const std::string state = competitorState(app.session, competitor);
  words(state.size() <= charactersIn(tile) ? state : inFewerWords(state), 1);
  list.PopClipRect();
  if (ImGui::IsMouseHoveringRect(cornerOf(top), endOf(top), false) && !ImGui::GetIO().WantCaptureMouse) {
    ImGui::SetTooltip("%s\n%s", look.label.c_str(), state.c_str());
  }
}

}  // namespace

template <int D>
const std::vector<CompetitorLook>& App<D>::competitorLooks() {
  const auto& competitors = session.competitors();
  if (std::equal(
          competitors.begin(), competitors.end(), m_competitorLooks.begin(), m_competitorLooks.end(),
          [](const auto& competitor, const CompetitorLook& look) { return competitor.pipeline == look.pipeline; })) {
    return m_competitorLooks;
  }
  std::vector<std::string> pipelines;
  for (const auto& competitor : competitors) pipelines.push_back(competitor.pipeline);
  const std::vector<DrawColour> colours = competitorColours(pipelines, D);
  m_competitorLooks.clear();
  for (std::size_t competitor = 0; competitor < competitors.size(); ++competitor) {
    const std::string& pipeline = pipelines[competitor];
    m_competitorLooks.push_back(
        {pipeline, competitorLabel(pipeline, D), competitorTitle(pipeline, D), colours[competitor]});
  }
  return m_competitorLooks;
}

// With several competitors, titles and legend must not cover bodies; with one, the status lines are in the border.
template <int D>
void App<D>::arrange() {
  const std::size_t competitors = session.competitors().size();
  Tile area{0, 0, window.width(), window.height()};
  if (competitors > 1) {
    area.top = static_cast<int>(std::ceil(ImGui::GetFrameHeight()));
    area.height = std::max(area.height - area.top - statusHeight(*this), 1);
  }
  views.assign(competitors, area), titles.clear();
  if (isSideBySide()) {
    const std::array<int, 4> chosenFor = {static_cast<int>(competitors), area.width, window.height(), 1};
    if (m_lookDue || m_columnsFor != chosenFor) {
      const int columns = columnsFor(camera, session.world(), competitors, area, titleHeight(1));
      m_lookDue |= columns != m_columns || m_columnsFor != chosenFor;
      m_columns = columns, m_columnsFor = chosenFor;
    }
    views = tilesOf(competitors, m_columns, area);
    titleLines = 1;
    for (const CompetitorLook& look : competitorLooks()) {
      const auto lines = brokenIntoLines(look.title, charactersIn(views[0]), kMostTitle);
      titleLines = std::max(titleLines, static_cast<int>(lines.size()));
    }
    for (Tile& tile : views) {
      titles.push_back({tile.left, tile.top, tile.width, titleHeight(titleLines)});
      tile = viewIn(tile, titles.back().height);
    }
  } else {
    m_columnsFor = {};
  }
  lookInto(0);
  if (std::exchange(m_lookDue, false)) lookAtAll(camera, session.world());
}

template <int D>
void App<D>::lookInto(std::size_t competitor) {
  const Tile& view = views[competitor];
  camera.resize(view.width, view.height, view.left, view.top);
}

// The body under the mouse in a tile is selected in the first view, wherever it is there.
template <int D>
Vec<2> App<D>::inFirstView(const Vec<2>& pixel) {
  const auto at = std::find_if(views.begin(), views.end(), [&](const Tile& view) { return view.has(pixel); });
  if (m_holding || at == views.end()) return pixel + m_shift;
  m_shift = Vec<2>(views[0].left - at->left, views[0].top - at->top);
  const auto competitor = static_cast<std::size_t>(at - views.begin());
  if (!isSideBySide() || competitor == 0 || competitor >= session.competitors().size()) return pixel + m_shift;
  const Picked<D> picked = pick(session.world(competitor), camera, Vec<2>(pixel + m_shift));
  const int body = picked.slot < 0 ? -1 : session.bodyAt(picked.slot, competitor);
  if (body < 0 || !session.world().valid(session.handle(body))) return pixel + m_shift;
  const Pose<D> X_WB = session.world(competitor).pose(session.handle(body, competitor));
  const Vec<D> there = session.world().pose(session.handle(body)) * (X_WB.inverse() * picked.point);
  if (const Vec<2> seen = camera.toPixel(there); seen.allFinite()) m_shift = seen - pixel;
  return pixel + m_shift;
}

template <int D>
void App<D>::drawOverlaid() {
  const std::size_t competitors = session.competitors().size();
  DrawLayers drawn = layers;
  m_canvas.begin(camera);
  for (std::size_t competitor = 0; competitor < competitors; ++competitor) {
    if (competitor > 0) drawn.tint = competitorLooks()[competitor].colour;
    drawSimulation(session.world(competitor), drawn, m_canvas);
  }
  DrawLayers outlines;
  outlines.shapes = layers.shapes;
  for (std::size_t competitor = 1; competitor < competitors && competitors > 2; ++competitor) {
    m_canvas.dash(static_cast<int>(competitor) - 1, static_cast<int>(competitors) - 1);
    outlines.tint = competitorLooks()[competitor].colour;
    drawSimulation(session.world(competitor), outlines, m_canvas);
  }
  drawHand();
  m_canvas.end();
}

template <int D>
void App<D>::drawSideBySide() {
  for (std::size_t competitor = 0; competitor < session.competitors().size(); ++competitor) {
    lookInto(competitor);
    m_canvas.begin(camera);
    drawSimulation(session.world(competitor), layers, m_canvas);
    competitor == 0 ? drawHand() : hand.drawSelected(competitor, m_canvas);
    m_canvas.end();
    drawTitle(*this, competitor);
  }
  lookInto(0);  // the mouse acts in the first view
}

template <int D>
void App<D>::drawHand() {
  hand.draw(m_canvas);
  if (!panels.pair || !pair.trace()) return;
  drawTraceOnShapes(*pair.trace(), static_cast<std::size_t>(pairStep), pair.X_WA(), m_canvas);
}

template Vec<2> App<2>::inFirstView(const Vec<2>&);
template Vec<2> App<3>::inFirstView(const Vec<2>&);
template void App<2>::arrange();
template void App<3>::arrange();
template void App<2>::drawOverlaid();
template void App<3>::drawOverlaid();
template void App<2>::drawSideBySide();
template void App<3>::drawSideBySide();
template const std::vector<CompetitorLook>& App<2>::competitorLooks();
template const std::vector<CompetitorLook>& App<3>::competitorLooks();

}}  // namespace lpc::LPC_PRECISION
