// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/competitor_label.h"

#include <algorithm>
#include <cstdio>

#include "framework/stage/registry.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Without parameters at their defaults.
Spec shortened(const Spec& spec, StageKind stage, int dimension) {
  const Registered& entry = Registry::instance().find(stage, dimension, spec.name);
  const Spec usual = entry.canonical(Spec{spec.name, {}});
  Spec out{spec.name, {}};
  for (const ParamInfo& p : entry.params) {
    const Spec* given = spec.find(p.name);
    if (!given || *given == *usual.find(p.name)) continue;
    out.set(p.name, p.stage ? shortened(*given, p.stage->kind, dimension) : *given);
  }
  return out;
}

std::string named(std::string_view name, const Spec& spec) { return std::string(name) + "=" + spec.text(); }

std::string labelOf(const std::string& text, int dimension, bool inShort) {
  if (engineOf(text)) return text;
  const Pipeline pipeline = Pipeline::parse(canonicalText(Pipeline::parse(text), dimension));
  const Pipeline usual = Pipeline::parse(canonicalText(Pipeline(), dimension));
  std::string out;
  const auto add = [&](const std::string& part) { out += (out.empty() ? "" : " ") + part; };
  for (const StageKind kind : kWorldStages) {
    if (pipeline[kind] == usual[kind]) continue;
    const Spec spec = shortened(pipeline[kind], kind, dimension);
    if (!inShort || spec.name != usual[kind].name) {
      add(named(stageName(kind), spec));
      continue;
    }
    for (const ParamInfo& p : Registry::instance().find(kind, dimension, spec.name).params) {
      if (const Spec* given = spec.find(p.name)) add(named(p.name, *given));
    }
  }
  return out.empty() ? "the default stages" : out;
}

}  // namespace

std::string competitorLabel(const std::string& text, int dimension) { return labelOf(text, dimension, false); }
std::string competitorTitle(const std::string& text, int dimension) { return labelOf(text, dimension, true); }

template <int D>
std::string competitorState(const Session<D>& session, std::size_t competitor) {
  const auto& l = session.competitors()[competitor];
  if (!l.fallen.empty()) return l.fallen;
  char text[64];
  std::snprintf(text, sizeof text, "%.3g ms", 1e3 * medianTime(l.samples));
  std::string out = text;
  if (competitor == 0 || l.samples.empty()) return out;
  const double error = l.samples.back().error;
  out += error > 0 ? ", " + lengthText(error) + " off" : ", equal to the first";
  return l.partedAt < 0 ? out : out + ", diverged at step " + std::to_string(l.partedAt);
}

std::string lengthText(double length) {
  struct Unit {
    double size;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1, "m"}, {1e-3, "mm"}, {1e-6, "um"}, {1e-9, "nm"}};
  const Unit* unit = kUnits;
  while (unit != std::end(kUnits) - 1 && length < 0.9995 * unit->size) ++unit;
  char text[64];
  if (length < 1e-12) return length > 0 ? "below 1 pm" : "0 m";
  std::snprintf(text, sizeof text, "%.3g %s", length / unit->size, unit->name);
  return text;
}

std::vector<std::string> brokenIntoLines(const std::string& text, std::size_t width, std::size_t lines) {
  constexpr std::string_view kMore = "...";
  std::vector<std::string> out;
  std::string_view rest = text;
  while (!rest.empty() && out.size() < lines) {
    if (rest.size() <= width) return out.emplace_back(rest), out;
    if (out.size() + 1 == lines) {
      out.emplace_back(rest.substr(0, width - std::min(width, kMore.size())));
      out.back() += kMore.substr(0, std::min(width, kMore.size()));
      return out;
    }
    std::size_t end = width;
    for (std::size_t i = width; i > width / 2; --i) {
      if (rest[i - 1] == ' ' || rest[i - 1] == '{' || rest[i - 1] == ',') {
        end = i;
        break;
      }
    }
    out.emplace_back(rest.substr(0, end));
    rest.remove_prefix(end);
  }
  return out;
}

template std::string competitorState(const Session<2>&, std::size_t);
template std::string competitorState(const Session<3>&, std::size_t);

}}  // namespace lpc::LPC_PRECISION
