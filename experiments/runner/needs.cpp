// SPDX-License-Identifier: Zlib
#include "experiments/runner/needs.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/runner/scene_model.h"
#include "experiments/trial/measure/metric.h"
#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr const char* kSeedsMove = "perturb";  // the parameter of a scene by which a seed perturbs its bodies

// Model features that are one stage each, and the method of that stage if the pipeline names none and the default does
// nothing.
struct SwitchedStage {
  const char* feature;
  StageKind stage;
  const char* policy;
};
constexpr SwitchedStage kSwitchedStages[] = {{"cache", StageKind::cache, ""},
                                             {"continuous", StageKind::continuous, "cast"},
                                             {"sleeping", StageKind::sleep, "timer_island"}};

constexpr std::size_t kFewestSeeds = 4;  // with fewer seeds the noise is unknown
constexpr double kUnmeasured = 2;        // only larger ratios are reported then

struct Ended : Store::Row {
  int dimension = 0;
  std::map<int, std::array<double, 3>> places;  // position of each body at the end, by slot (m)
};

std::map<int, std::array<double, 3>> placesOf(const std::vector<double>& numbers, int dimension) {
  const std::size_t stride = dimension == 2 ? 4 : 8;  // slot, position, rotation
  std::map<int, std::array<double, 3>> out;
  for (std::size_t i = 0; i + stride <= numbers.size(); i += stride) {
    out[static_cast<int>(numbers[i])] = {numbers[i + 1], numbers[i + 2], dimension == 2 ? 0 : numbers[i + 3]};
  }
  return out;
}

std::optional<Ended> read(Store& store, const PlannedTrial& trial) {
  std::optional<Store::Row> row = store.measured(trial.key);
  if (!row) return std::nullopt;
  const int dimension = trial.asked().dimension;
  return Ended{std::move(*row), dimension, placesOf(store.lastPoses(trial.key), dimension)};
}

// Median and largest distance between the bodies of two ends.
void compare(const Ended& a, const Ended& b, std::vector<double>& median, std::vector<double>& largest) {
  std::vector<double> ways;
  for (const auto& [slot, p] : a.places) {
    const auto other = b.places.find(slot);
    if (other == b.places.end()) continue;
    const auto& q = other->second;
    ways.push_back(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  if (ways.empty()) return;
  median.push_back(quantile(ways, 0.5)), largest.push_back(*std::max_element(ways.begin(), ways.end()));
}

void compareWork(const Ended& own, const Ended& other, ModelSeen& out) {
  const auto ratio = [&](const char* name, std::vector<double>& into) {
    const auto a = own.metrics.find(name), b = other.metrics.find(name);
    if (a != own.metrics.end() && b != other.metrics.end() && a->second > 0) into.push_back(b->second / a->second);
  };
  ratio("ms_per_step_median", out.time), ratio("work_multiply_adds", out.rows);
  if (own.dimension != other.dimension) out.sameWork = false;  // a point costs more in 3D than in 2D
  for (const auto& [name, value] : own.metrics) {
    const auto found = other.metrics.find(name);
    if (name.starts_with("work_") && (found == other.metrics.end() || found->second != value)) out.sameWork = false;
  }
}

// Equal work differs only by the machine's noise.
const char* whyNoTime(const std::vector<double>& ratios, const std::vector<double>& again) {
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  double low = 1, high = 1;
  for (const double ratio : again) low = std::min(low, ratio), high = std::max(high, ratio);
  if (*least <= high && *most >= low) return "time within the noise";
  const double ratio = quantile(ratios, 0.5);
  const bool unmeasured = ratios.size() < kFewestSeeds && std::max(ratio, 1 / ratio) <= kUnmeasured;
  return unmeasured ? "too few seeds to measure the noise" : nullptr;
}

// "sleep=none" if the model's switch concerns a stage that does nothing.
std::string idleStage(const std::string& model, const std::string& pipeline) {
  if (engineOf(pipeline) || (model[0] != '+' && model[0] != '-')) return "";
  for (const SwitchedStage& s : kSwitchedStages) {
    if (model.substr(1) != s.feature || Pipeline::parse(pipeline)[s.stage].name != "none") continue;
    return std::string(stageName(s.stage)) + "=none";
  }
  return "";
}

}  // namespace

std::string withPolicies(const std::string& pipeline) {
  if (engineOf(pipeline)) return pipeline;
  Pipeline out;
  const std::vector<StageKind> named = out.replace(pipeline);
  for (const SwitchedStage& s : kSwitchedStages) {
    const bool chosen = std::find(named.begin(), named.end(), s.stage) != named.end();
    if (!chosen && out[s.stage].name == "none") out[s.stage].name = s.policy;
  }
  return out.text();
}

PlannedSweep planNeeds(const NeedsQuestion& q) {
  Planner planner;
  const SceneFile& file = planner.scene(q.scene);
  const int dimension = q.dimension.value_or(file.dimensions().at(0));
  PlannedSweep out;
  out.name = "needs_" + file.name(), out.kind = "world", out.baseline = kMinimalModel;
  out.summary = "what " + file.name() + " needs: one switch of its model at a time";
  out.charts = {"needs"};
  out.roles = {{"scene", "run"}, {"model", "run"}, {"seed", "run"}, {"dimension", "run"}};
  const auto add = [&](const std::string& model, int seed, int repeat) {
    WorldCell cell;
    cell.params = q.params, cell.pipeline = withPolicies(q.pipeline), cell.steps = q.steps;
    cell.dimension = dimension, cell.seed = static_cast<std::uint64_t>(seed), cell.repeat = repeat, cell.timed = true;
    if (file.parameter(kSeedsMove) && q.perturbation > 0) {
      cell.params.emplace(kSeedsMove, q.perturbation);
    }
    applyModel(file, model, cell);
    PlannedTrial trial = planner.world(q.scene, cell);
    trial.axes = {{"kind", "world"},        {"scene", file.name()}, {"model", model}, {"seed", seed},
                  {"dimension", dimension}, {"repeat", repeat},     {"timed", true},  {"precision", cell.precision}};
    out.trials.push_back(std::move(trial));
  };
  for (int seed = 1; seed <= q.seeds; ++seed) {
    add(kMinimalModel, seed, 0), add(kMinimalModel, seed, 1);
    for (const std::string& model : otherModels(file, dimension)) add(model, seed, 0);
  }
  if (!out.trials[0].unsupported.empty()) throw UserError(out.trials[0].unsupported);
  return out;
}

std::string remarkOn(const ModelSeen& model, const ModelSeen& again) {
  if (model.failed) {
    return std::to_string(model.failed) + " of " + std::to_string(model.trials) + " " + model.failure;
  }
  if (model.model.empty()) return "the noise";
  if (!model.idle.empty()) return "nothing to measure: " + model.idle;
  if (model.time.empty()) return "";
  std::vector<std::string> said;
  if (model.sameWork) said.emplace_back("equal work counts");
  if (const char* why = whyNoTime(model.time, again.time)) said.emplace_back(why);
  return joined(said);
}

NeedsSeen readNeeds(const PlannedSweep& sweep, Store& store) {
  NeedsSeen out;
  std::optional<Ended> first, own;
  for (const PlannedTrial& trial : sweep.trials) {
    const std::optional<Ended> ended = read(store, trial);
    const std::string model = trial.axes["model"];
    const bool again = trial.axes["repeat"] == 1;
    if (model == kMinimalModel && !again) {
      own = ended, ++out.seeds;
      if (own && own->outcome != "ok") {
        if (!out.failed++) out.failure = own->outcome + ": " + own->reason;
        own.reset();
      }
      if (first && own) compare(*first, *own, out.median, out.largest);
      if (!first) first = own;
      continue;
    }
    const std::string name = again ? "" : model;
    auto seen = std::find_if(out.models.begin(), out.models.end(), [&](const ModelSeen& m) { return m.model == name; });
    if (seen == out.models.end()) {
      seen = out.models.emplace(out.models.end());
      seen->model = name;
      if (!again) seen->idle = idleStage(name, trial.world().pipeline);
    }
    if (!own || !ended) continue;  // stopped before it ran
    ++seen->trials;
    if (ended->outcome != "ok") {
      if (!seen->failed++) seen->failure = ended->outcome + ": " + ended->reason;
      continue;
    }
    compareWork(*own, *ended, *seen);
    compare(*own, *ended, seen->median, seen->largest);
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
