// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/equal_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "framework/stage/registry.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class Scaled { hasNone, atLimit, changed };

// In the stage itself first, then in its nested stages, in order.
Scaled scale(StageKind stage, int dimension, Spec& spec, double factor) {
  const Registered& entry = Registry::instance().find(stage, dimension, spec.name);
  for (const ParamInfo& p : entry.params) {
    if (p.role != ParamRole::effort) continue;
    const double now = std::strtod(spec.find(p.name)->name.c_str(), nullptr);
    const double wanted =
        factor > 1 ? std::max(std::round(now * factor), now + 1) : std::min(std::round(now * factor), now - 1);
    const double next = std::clamp(wanted, std::max(1.0, p.range->lo), p.range->hi);
    if (next == now) return Scaled::atLimit;
    spec.set(p.name, Spec{std::to_string(std::lround(next)), {}});
    return Scaled::changed;
  }
  Scaled out = Scaled::hasNone;
  for (const ParamInfo& p : entry.params) {
    if (!p.stage) continue;
    Spec held = *spec.find(p.name);
    const Scaled scaled = scale(p.stage->kind, dimension, held, factor);
    if (scaled != Scaled::hasNone) out = scaled;
    if (scaled != Scaled::changed) continue;
    spec.set(p.name, held);
    break;
  }
  return out;
}

Scaled scale(std::string& text, double factor, int dimension) {
  Pipeline pipeline = Pipeline::parse(canonicalText(Pipeline::parse(text), dimension));
  const Scaled scaled = scale(StageKind::solver, dimension, pipeline[StageKind::solver], factor);
  if (scaled == Scaled::changed) text = pipeline.text();
  return scaled;
}

// The allowed cost of a competitor's step relative to the first's; 1 if unknown.
template <int D>
double factorOf(const Session<D>& session, std::size_t competitor) {
  const double first = medianTime(session.competitors()[0].samples),
               time = medianTime(session.competitors()[competitor].samples);
  return first > 0 && time > 0 ? first / time : 1;
}

}  // namespace

std::optional<std::string> withMoreIterations(const std::string& text, double factor, int dimension) {
  std::string out = text;
  if (factor == 1 || scale(out, factor, dimension) != Scaled::changed) return std::nullopt;
  return out;
}

template <int D>
void equaliseCost(Session<D>& session) {
  for (std::size_t competitor = 1; competitor < session.competitors().size(); ++competitor) {
    const auto& l = session.competitors()[competitor];
    const long made = session.steps() - l.since;
    if (!l.fallen.empty() || engineOf(l.pipeline) || made == 0 || made % kTimedSteps != 0) continue;
    const double factor = factorOf(session, competitor);
    if (std::abs(factor - 1) < kSameCost) continue;
    const auto pipeline = withMoreIterations(l.pipeline, std::clamp(factor, 0.25, 4.0), D);
    if (pipeline) session.perform(SetPipeline{static_cast<int>(competitor), *pipeline});
  }
}

template <int D>
std::string whyCostStays(const Session<D>& session, std::size_t competitor) {
  const auto& l = session.competitors()[competitor];
  const double factor = factorOf(session, competitor);
  if (competitor == 0 || !l.fallen.empty() || std::abs(factor - 1) < kSameCost) return "";
  if (engineOf(l.pipeline)) return "an engine cannot change its iterations during a run";
  std::string text = l.pipeline;
  const Scaled scaled = scale(text, factor, D);
  if (scaled == Scaled::hasNone) return "its solver has no iterations";
  if (scaled == Scaled::changed) return "";
  return factor < 1 ? "it cannot have fewer iterations" : "it cannot have more iterations";
}

template void equaliseCost(Session<2>&);
template void equaliseCost(Session<3>&);
template std::string whyCostStays(const Session<2>&, std::size_t);
template std::string whyCostStays(const Session<3>&, std::size_t);

}}  // namespace lpc::LPC_PRECISION
