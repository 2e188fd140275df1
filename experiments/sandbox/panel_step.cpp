// SPDX-License-Identifier: Zlib
// The cost of the last step by stage, and of the picture; energy and penetration over the steps since the panel was
// opened.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "experiments/sandbox/panels.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <class Value>
void plot(const char* name, const char* unit, const std::vector<Sample>& samples, const Value& value) {
  constexpr std::size_t kShown = 600;
  std::vector<float> shown;
  for (std::size_t i = samples.size() - std::min(samples.size(), kShown); i < samples.size(); ++i) {
    const auto v = static_cast<float>(value(samples[i]));
    if (std::isfinite(v)) shown.push_back(v);
  }
  if (shown.empty()) return ImGui::Text("%s: no value yet", name);
  const auto [least, most] = std::minmax_element(shown.begin(), shown.end());
  char text[96];
  std::snprintf(text, sizeof text, "%s %.4g %s (%.4g .. %.4g)", name, static_cast<double>(shown.back()), unit,
                static_cast<double>(*least), static_cast<double>(*most));
  ImGui::TextUnformatted(text);
  ImGui::PlotLines((std::string("##") + name).c_str(), shown.data(), static_cast<int>(shown.size()), 0, nullptr, *least,
                   std::max(*most, *least + 1e-12f), ImVec2(ImGui::GetContentRegionAvail().x, 50));
}

}  // namespace

template <int D>
void stepPanel(App<D>& app) {
  const Profiler::Frame& frame = app.session.world().profiler().frame();
  ImGui::Text("physics %.3f ms, drawing %.3f ms", 1e3 * app.stepSeconds, 1e3 * app.drawSeconds);
  const auto bar = [&](const Profiler::Time& t) {
    char text[64];
    std::snprintf(text, sizeof text, "%s %.3f ms", t.name, 1e3 * t.seconds);
    ImGui::ProgressBar(static_cast<float>(frame.seconds > 0 ? t.seconds / frame.seconds : 0), ImVec2(-1, 0), text);
  };
  for (const Profiler::Time& stage : frame.times) {
    if (std::strchr(stage.name, '.')) continue;
    bar(stage);
    const std::string phases = std::string(stage.name) + ".";
    ImGui::Indent();
    for (const Profiler::Time& t : frame.times) {
      if (std::string_view(t.name).starts_with(phases)) bar(t);
    }
    ImGui::Unindent();
  }
  const std::vector<Sample>& samples = app.session.competitors()[0].samples;
  plot("energy", "J", samples, [](const Sample& s) { return s.energy; });
  plot("penetration", "mm", samples, [](const Sample& s) { return 1e3 * s.penetration; });
  plot("step", "ms", samples, [](const Sample& s) { return 1e3 * s.seconds; });
}

template void stepPanel(App<2>&);
template void stepPanel(App<3>&);

}}  // namespace lpc::LPC_PRECISION
