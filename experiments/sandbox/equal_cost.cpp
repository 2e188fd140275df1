// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/equal_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "framework/registry.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// In the stage itself first, then in those that it holds, in their order.
bool scale(StageKind stage, int dimension, Spec& spec, double factor) {
  const Registered& entry = Registry::instance().find(stage, dimension, spec.name);
  for (const ParamInfo& p : entry.params) {
    if (p.type != "integer" || (p.name != "iterations" && p.name != "substeps")) continue;
    const double now = std::strtod(spec.find(p.name)->name.c_str(), nullptr);
    const double wanted =
        factor > 1 ? std::max(std::round(now * factor), now + 1) : std::min(std::round(now * factor), now - 1);
    const double next = std::clamp(wanted, std::max(1.0, p.range->lo), p.range->hi);
    if (next == now) return false;
    spec.set(p.name, Spec{std::to_string(std::lround(next)), {}});
    return true;
  }
  for (const ParamInfo& p : entry.params) {
    if (!p.stage) continue;
    Spec held = *spec.find(p.name);
    if (!scale(p.stage->kind, dimension, held, factor)) continue;
    spec.set(p.name, held);
    return true;
  }
  return false;
}

}  // namespace

std::optional<std::string> withMoreIterations(const std::string& text, double factor, int dimension) {
  Pipeline pipeline = Pipeline::parse(canonicalText(Pipeline::parse(text), dimension));
  if (factor == 1 || !scale(StageKind::solver, dimension, pipeline[StageKind::solver], factor)) return std::nullopt;
  return pipeline.text();
}

}  // namespace lpc::inline LPC_PRECISION
