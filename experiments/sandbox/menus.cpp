// SPDX-License-Identifier: Zlib
#include <SDL2/SDL_keyboard.h>
#include <imgui.h>

#include <filesystem>

#include "experiments/runner/locations.h"
#include "experiments/sandbox/app.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
void sceneMenu(App<D>& app) {
  const bool open = ImGui::BeginMenu("Scenes");
  app.marks.last("Scenes");
  if (!open) return;
  static const std::vector<std::string> scenes =
      listToml("scenes");  // read once: the folder does not change while it runs
  for (const std::string& path : scenes) {
    const std::string name = std::filesystem::path(path).stem().string();
    if (ImGui::MenuItem(name.c_str(), nullptr, name == app.file.name())) app.act([&app, path] { app.open(path); });
    app.marks.last("Scenes/" + name);
  }
  ImGui::EndMenu();
}

// The kind of joint that the joint tool makes.
template <int D>
void jointMenu(App<D>& app) {
  const bool open = ImGui::BeginMenu("Joints");
  app.marks.last("Joints");
  if (!open) return;
  for (const Registered* r : Registry::instance().list(StageKind::joint, D)) {
    if (ImGui::MenuItem(r->info.name.c_str(), nullptr, r->info.name == app.hand.joint)) {
      app.useTool(Tool::joint);
      app.hand.joint = r->info.name;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", r->info.summary.c_str());
    app.marks.last("Joints/" + r->info.name);
  }
  ImGui::EndMenu();
}

template <int D>
void layerMenu(App<D>& app) {
  const bool open = ImGui::BeginMenu("See");
  app.marks.last("See");
  if (!open) return;
  for (const DrawLayer& layer : kDrawLayers) {
    const std::string name(layer.name);
    ImGui::MenuItem(name.c_str(), nullptr, &(app.layers.*layer.on));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", std::string(layer.meaning).c_str());
    app.marks.last("See/" + name);
  }
  ImGui::EndMenu();
}

}  // namespace

template <int D>
void drawMenus(App<D>& app) {
  if (!ImGui::BeginMainMenuBar()) return;
  sceneMenu(app);
  const auto& all = commands<D>();
  for (std::size_t i = 0; i < all.size();) {
    const char* menu = all[i].menu;
    const bool open = ImGui::BeginMenu(menu);
    app.marks.last(menu);
    for (; i < all.size() && all[i].menu == std::string_view(menu); ++i) {
      if (!open) continue;
      const Command<D>& c = all[i];
      if (ImGui::MenuItem(c.name, c.key ? SDL_GetKeyName(c.key) : nullptr, c.on && c.on(app))) {
        app.act([&app, &c] { c.run(app); });
      }
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", c.meaning);
      app.marks.last(std::string(menu) + "/" + c.name);
    }
    if (open) ImGui::EndMenu();
  }
  jointMenu(app), layerMenu(app);
  ImGui::EndMainMenuBar();
}

template void drawMenus(App<2>&);
template void drawMenus(App<3>&);

}}  // namespace lpc::LPC_PRECISION
