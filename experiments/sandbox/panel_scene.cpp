// SPDX-License-Identifier: Zlib
// The scene's parameters, which restart it, and properties of the world that can change while it runs.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "experiments/sandbox/panels.h"
#include "framework/math/check.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A number that the scene rejects may be a count, for which a slider gives fractions. A number that is still rejected
// is not kept, since a restart by R would fail, too.
template <int D>
void beginWith(App<D>& app, const std::string& name, ParameterValue value) {
  const ParameterValues before = app.opening.parameters;
  app.opening.parameters[name] = value;
  try {
    app.reload();
  } catch (const UserError&) {
    const double whole = std::round(value.number);
    const bool mayCount = !value.isText() && whole != value.number;
    app.opening.parameters = before;
    if (!mayCount) throw;
    value.number = whole;
    beginWith(app, name, value);
  }
}

template <int D>
void parameter(App<D>& app, const SceneParameter& p) {
  const ParameterValues& given = app.opening.parameters;
  const auto it = given.find(p.name);
  ParameterValue value = it == given.end() ? p.value : it->second;
  bool changed = false;
  if (value.isText()) {
    if (ImGui::BeginCombo(p.name.c_str(), value.text.c_str())) {
      for (const Registered* r : Registry::instance().list(StageKind::joint, D)) {
        if (ImGui::Selectable(r->info.name.c_str(), r->info.name == value.text))
          value.text = r->info.name, changed = true;
      }
      ImGui::EndCombo();
    }
  } else {
    static std::map<std::string, double> held;  // by name: the value while it is dragged
    if (const auto h = held.find(p.name); h != held.end()) value.number = h->second;
    const bool wide = p.hi > 1000 * std::max(1.0, std::abs(p.lo));
    if (ImGui::SliderScalar(p.name.c_str(), ImGuiDataType_Double, &value.number, &p.lo, &p.hi, "%g",
                            ImGuiSliderFlags_AlwaysClamp | (wide ? ImGuiSliderFlags_Logarithmic : 0))) {
      held[p.name] = value.number;
    }
    changed = ImGui::IsItemDeactivatedAfterEdit();
    if (changed) held.erase(p.name);
  }
  app.marks.last("Scene/" + p.name);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", p.meaning.c_str());
  if (!changed) return;
  app.act([&] { beginWith(app, p.name, value); });
}

// A number that takes effect when the mouse button is released.
template <int D, class Act>
void slider(App<D>& app, const char* name, double value, double lo, double hi, const Act& act) {
  static std::map<std::string, double> held;  // by name: the value while it is dragged
  const auto it = held.find(name);
  double shown = it == held.end() ? value : it->second;
  if (ImGui::SliderScalar(name, ImGuiDataType_Double, &shown, &lo, &hi, "%.3g")) held[name] = shown;
  if (ImGui::IsItemDeactivatedAfterEdit()) {
    app.act([&] { act(shown); });
    held.erase(name);
  }
  app.marks.last(std::string("Scene/") + name);
}

}  // namespace

template <int D>
void scenePanel(App<D>& app) {
  ImGui::TextWrapped("%s: %s", app.file.name().c_str(), app.file.summary().c_str());
  for (const SceneParameter& p : app.file.parameters()) parameter(app, p);
  ImGui::Separator();
  const Vec<D> gravity = app.session.world().settings().gravity;
  slider(app, "gravity (m/s^2)", static_cast<double>(gravity[1]), -30, 30, [&](double g) {
    Vec<D> changed = gravity;
    changed[1] = static_cast<Real>(g);
    app.session.perform(SetGravity<D>{changed});
  });
  slider(app, "time scale", app.timeScale, 1.0 / 64, 4,
         [&](double s) { app.timeScale = std::clamp(s, 1.0 / 64, 4.0); });
  // Of the selected bodies, or of all.
  const auto all = [&](const auto& change) {
    std::vector<int> bodies = app.hand.selected();
    for (int body = 0; bodies.empty() && body < app.session.bodies(); ++body) bodies.push_back(body);
    for (const int body : bodies) {
      if (app.session.world().valid(app.session.handle(body))) app.session.perform(change(body));
    }
  };
  const auto coefficient = [&](auto member) {
    const std::vector<int>& selected = app.hand.selected();
    const std::int32_t of = selected.empty() ? -1 : app.session.handle(selected.back()).slot;
    for (const ShapeRecord<D>& s : app.session.world().shapes()) {
      if (s.body >= 0 && (of < 0 || s.body == of)) return static_cast<double>(s.*member);
    }
    return 0.0;
  };
  slider(app, "friction", coefficient(&ShapeRecord<D>::friction), 0, 2,
         [&](double x) { all([&](int body) { return ChangeBody{.body = body, .friction = static_cast<Real>(x)}; }); });
  slider(app, "restitution", coefficient(&ShapeRecord<D>::restitution), 0, 1, [&](double x) {
    all([&](int body) { return ChangeBody{.body = body, .restitution = static_cast<Real>(x)}; });
  });
}

template void scenePanel(App<2>&);
template void scenePanel(App<3>&);

}}  // namespace lpc::LPC_PRECISION
