// SPDX-License-Identifier: Zlib
// All commands of keys and menus, in one table.
#include <SDL2/SDL_keycode.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "experiments/sandbox/app.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
std::vector<Command<D>> makeCommands() {
  using A = App<D>;
  std::vector<Command<D>> out;
  const auto add = [&](const char* menu, const char* name, int key, const char* meaning, std::function<void(A&)> run,
                       std::function<bool(const A&)> on = {}) {
    out.push_back({menu, name, key, meaning, std::move(run), std::move(on)});
  };
  const auto tool = [&](const char* name, int key, const char* meaning, Tool t, bool isStatic) {
    add(
        "Create", name, key, meaning, [=](A& a) { a.useTool(t, isStatic); },
        [=](const A& a) { return a.hand.tool == t && a.hand.drawsStatic == isStatic; });
  };

  static constexpr const char* kPresets[] = {"Preset 10", "Preset 1", "Preset 2", "Preset 3", "Preset 4",
                                             "Preset 5",  "Preset 6", "Preset 7", "Preset 8", "Preset 9"};
  static constexpr const char* kNumbers[] = {"10", "1", "2", "3", "4", "5", "6", "7", "8", "9"};
  for (int i = 1; i <= 10; ++i) {
    const int n = i % 10;
    add("Presets", kPresets[n], SDLK_0 + n, "opens this preset of the 2009 sandbox",
        [n](A& a) { a.open(kNumbers[n]); });
  }
  add("Presets", "Preset 0", 0, "opens the empty room of 2009", [](A& a) { a.open("0"); });
  add("Presets", "Preset 11", 0, "opens the long dominoes of 2009", [](A& a) { a.open("11"); });

  add(
      "World", "Pause", SDLK_p, "pauses or continues", [](A& a) { a.paused = !a.paused, a.hand.setPaused(a.paused); },
      [](const A& a) { return a.paused; });
  add("World", "Step", SDLK_RIGHT, "one step, then a pause", [](A& a) {
    a.paused = true;
    a.step();
    a.hand.setPaused(true);
  });
  add("World", "Step back", SDLK_LEFT, "one step back, then a pause", [](A& a) { a.back(); });
  add("World", "Reload", SDLK_r, "loads the scene's file again", [](A& a) { a.reload(); });
  add("World", "Clear", SDLK_x, "removes all bodies", [](A& a) { a.clear(); });
  add("World", "Save", SDLK_F1, "saves the world as a scene, sandbox.toml", [](A& a) { a.save(); });
  add("World", "Load", SDLK_F2, "loads sandbox.toml", [](A& a) { a.load(); });
  add("World", "Wake all", SDLK_w, "wakes all bodies", [](A& a) { a.hand.wake(); });
  add("World", "Slower", SDLK_COMMA, "half as fast", [](A& a) { a.timeScale = std::max(a.timeScale / 2, 1.0 / 64); });
  add("World", "Faster", SDLK_PERIOD, "twice as fast", [](A& a) { a.timeScale = std::min(a.timeScale * 2, 4.0); });
  add("World", "Other dimension", SDLK_F3, "switches the scene between 2D and 3D", [](A& a) { a.otherDimension(); });

  tool("Grab", SDLK_g, "selects and drags", Tool::grab, false);
  tool("Circle", SDLK_c, "draws circles from centre to rim; balls in 3D", Tool::circle, false);
  tool("Static circle", SDLK_v, "draws static circles", Tool::circle, true);
  tool("Box", SDLK_b, "draws boxes from corner to corner", Tool::box, false);
  tool("Capsule", SDLK_k, "draws capsules from end to end", Tool::capsule, false);
  tool("Polygon", SDLK_y, "draws polygons corner by corner, then Return; prisms in 3D", Tool::polygon, false);
  tool("Compound", SDLK_q, "draws one body of several boxes, then Return", Tool::compound, false);
  tool("Joint", SDLK_j, "joins two bodies, or a body and the world, by two clicks", Tool::joint, false);
  add("Create", "Finish", SDLK_RETURN, "makes a body of the drawing", [](A& a) { a.hand.finish(); });
  add("Create", "Cancel", SDLK_ESCAPE, "cancels drawing or dragging", [](A& a) { a.hand.cancel(); });
  add("Create", "Random polygon", SDLK_n, "adds a polygon of 3 to 8 corners at the cursor",
      [](A& a) { a.spawnPolygon(); });
  add("Create", "Fireworks", SDLK_o, "throws circles in all directions from the cursor", [](A& a) { a.fireworks(); });
  add(
      "Create", "Meteor shower", SDLK_F5, "starts or stops heavy circles from above",
      [](A& a) { a.meteors = !a.meteors; }, [](const A& a) { return a.meteors; });
  add(
      "Create", "Rain", SDLK_F6, "starts or stops small circles from above", [](A& a) { a.rain = !a.rain; },
      [](const A& a) { return a.rain; });
  add(
      "Create", "Fireworks show", SDLK_F7, "starts or stops a series of fireworks",
      [](A& a) { a.showers = !a.showers; }, [](const A& a) { return a.showers; });

  add("Body", "Delete", SDLK_d, "removes the selection, or the body under the cursor",
      [](A& a) { a.hand.removeSelected(); });
  add("Body", "Static", SDLK_s, "makes the body static or dynamic; while drawing: the new body", [](A& a) {
    if (a.hand.drawing()) {
      a.hand.drawsStatic = !a.hand.drawsStatic;
    } else {
      a.hand.makeStatic();
    }
  });
  add("Body", "Pin", SDLK_t, "pins the body's centre (it may still rotate), or frees it", [](A& a) { a.hand.pin(); });
  add("Body", "Merge", SDLK_m, "merges the selected bodies into one", [](A& a) { a.hand.merge(); });
  add("Body", "Unmerge", SDLK_u, "splits the body into one body per shape", [](A& a) { a.hand.splitByShape(); });

  add("View", "Zoom in", SDLK_PAGEUP, "zooms in", [](A& a) { a.zoom(Real(1.25)); });
  add("View", "Zoom out", SDLK_PAGEDOWN, "zooms out", [](A& a) { a.zoom(Real(0.8)); });
  add("View", "Whole scene", SDLK_HOME, "fits the whole scene into the window", [](A& a) { a.look(); });
  add("View", "Verbosity", SDLK_i, "shows nothing, one line, or all counts of the step",
      [](A& a) { a.verbosity = (a.verbosity + 1) % 3; });

  add(
      "Record", "Statistics", SDLK_l, "starts or stops writing times and counts of each step to sandbox_stats.csv",
      [](A& a) { a.toggleLog(); }, [](const A& a) { return a.logging; });
  add("Record", "Picture", SDLK_F12, "saves the window as sandbox.png", [](A& a) { a.screenshot(); });
  add(
      "Record", "Image sequence", SDLK_F9, "starts or stops saving each frame as sandbox_00001.png and so on",
      [](A& a) { a.imageSequence = !a.imageSequence; }, [](const A& a) { return a.imageSequence; });
  add("Record", "Script", SDLK_F4, "writes the manual actions as a script, sandbox_script.toml",
      [](A& a) { a.saveScript(); });

  for (const PanelInfo& p : panelInfos()) {
    const int key = std::string_view(p.name) == "Keys" ? SDLK_h : 0;
    add(
        "Panels", p.name, key, "opens or closes this panel", [&p](A& a) { a.panels.*p.open = !(a.panels.*p.open); },
        [&p](const A& a) { return a.panels.*p.open; });
  }
  constexpr int kRepeated[] = {SDLK_RIGHT, SDLK_LEFT, SDLK_PAGEUP, SDLK_PAGEDOWN, SDLK_n, SDLK_o};
  for (Command<D>& c : out) {
    c.repeats = c.key && std::find(std::begin(kRepeated), std::end(kRepeated), c.key) != std::end(kRepeated);
  }
  return out;
}

}  // namespace

template <int D>
const std::vector<Command<D>>& commands() {
  static const std::vector<Command<D>> all = makeCommands<D>();
  return all;
}

template const std::vector<Command<2>>& commands();
template const std::vector<Command<3>>& commands();

}}  // namespace lpc::LPC_PRECISION
