// SPDX-License-Identifier: Zlib
// The method of each stage with every parameter, read from the registry.
#include <imgui.h>

#include <cmath>
#include <cstdlib>

#include "experiments/sandbox/panels.h"
#include "framework/stage/registry.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Each function returns whether the user has finished a change.
template <int D>
class SpecEditor {
 public:
  explicit SpecEditor(App<D>& app) : m_app(app) {}

  bool stage(const std::string& label, StageKind kind, Spec& spec) {
    bool changed = false;
    const std::string shown = label.substr(label.rfind('.') + 1) + "##" + label;
    if (ImGui::BeginCombo(shown.c_str(), spec.name.c_str())) {
      for (const Registered* r : Registry::instance().list(kind, D)) {
        if (r->info.role == AlgorithmRole::witness) continue;
        if (ImGui::Selectable(r->info.name.c_str(), r->info.name == spec.name)) {
          spec = r->canonical(Spec::parse(r->info.name)), changed = true;
        }
        mark(label + "/" + r->info.name);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", r->info.summary.c_str());
      }
      ImGui::EndCombo();
    } else {
      mark(label);
    }
    ImGui::PushID(label.c_str());
    ImGui::Indent();
    for (const ParamInfo& p : Registry::instance().find(kind, D, spec.name).params)
      changed |= parameter(label, p, spec);
    ImGui::Unindent();
    ImGui::PopID();
    return changed;
  }

 private:
  void mark(const std::string& name) { m_app.marks.last("Stages/" + name); }

  bool parameter(const std::string& of, const ParamInfo& p, Spec& spec) {
    const Spec* given = spec.find(p.name);
    Spec value = given ? *given : Spec{p.defaultText, {}};
    const std::string id = of + "." + p.name;
    bool changed = false;
    if (p.stage) {
      changed = stage(id, p.stage->kind, value);
    } else if (!p.choices.empty()) {
      changed = choice(p, value);
      mark(id);
    } else {
      changed = number(id, p, value);
      mark(id);
    }
    if (!p.stage && ImGui::IsItemHovered()) {
      ImGui::SetTooltip("%s%s", p.meaning.c_str(),
                        p.unit == "1" || p.unit.empty() ? "" : (" (" + p.unit + ")").c_str());
    }
    if (changed) spec.set(p.name, value);
    return changed;
  }

  bool choice(const ParamInfo& p, Spec& value) {
    bool changed = false;
    if (!ImGui::BeginCombo(p.name.c_str(), value.name.c_str())) return false;
    for (const std::string& c : p.choices) {
      if (ImGui::Selectable(c.c_str(), c == value.name)) value = Spec{c, {}}, changed = true;
    }
    ImGui::EndCombo();
    return changed;
  }

  // While it is dragged, the world keeps the old value.
  bool number(const std::string& id, const ParamInfo& p, Spec& value) {
    const bool whole = p.type == "integer";
    double shown = m_held == id ? m_value : std::strtod(value.name.c_str(), nullptr);
    const double lo = p.range->lo, hi = p.range->hi;
    const bool wide = hi > 100 * std::max(1.0, std::abs(lo)) || (lo > 0 && hi > 1000 * lo);
    if (ImGui::SliderScalar(p.name.c_str(), ImGuiDataType_Double, &shown, &lo, &hi, whole ? "%.0f" : "%.4g",
                            wide ? ImGuiSliderFlags_Logarithmic : 0)) {
      m_held = id, m_value = whole ? std::round(shown) : shown;
    }
    if (!ImGui::IsItemDeactivatedAfterEdit() || m_held != id) return false;
    char text[40];
    std::snprintf(text, sizeof text, whole ? "%.0f" : "%.9g", m_value);
    value = Spec{text, {}};
    m_held.clear();
    return true;
  }

  App<D>& m_app;
  static inline std::string m_held;  // the number being dragged; there is one mouse
  static inline double m_value = 0;
};

}  // namespace

template <int D>
void stagesPanel(App<D>& app) {
  for (std::size_t competitor = 0; competitor < app.session.competitors().size(); ++competitor) {
    const std::string& text = app.session.competitors()[competitor].pipeline;
    if (app.session.competitors().size() > 1)
      ImGui::TextUnformatted(("lane " + std::to_string(competitor + 1)).c_str());
    if (engineOf(text)) {
      ImGui::TextUnformatted(text.c_str());
      continue;
    }
    ImGui::PushID(static_cast<int>(competitor));
    Pipeline pipeline = Pipeline::parse(canonicalText(Pipeline::parse(text), D));
    bool changed = false;
    SpecEditor<D> editor(app);
    for (const StageKind kind : kWorldStages)
      changed |= editor.stage(std::string(stageName(kind)), kind, pipeline[kind]);
    if (changed) {
      app.act([&] { app.session.perform(SetPipeline{static_cast<int>(competitor), pipeline.text()}); });
    }
    ImGui::PopID();
  }
}

template void stagesPanel(App<2>&);
template void stagesPanel(App<3>&);

}}  // namespace lpc::LPC_PRECISION
