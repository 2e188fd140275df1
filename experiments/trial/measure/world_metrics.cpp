// SPDX-License-Identifier: Zlib
// All measurements of a world trial: one entry per series and per metric.
#include "experiments/trial/measure/world_metrics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/trial/measure/metric.h"
#include "framework/math/worse.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Excluded from times: caches are cold and vectors grow.
constexpr long kWarmUpSteps = 10;

constexpr MetricRole kCost = MetricRole::cost, kError = MetricRole::error, kDetail = MetricRole::detail;

/// |slid - g (sin a - mu cos a) t^2 / 2|, or the whole distance where friction should hold.
template <int D>
double slopeError(const WorldSeen<D>& r) {
  const auto& slope = *r.scene.slope;
  const double g = r.scene.settings.gravity.norm(), t = static_cast<double>(r.steps) * r.scene.dt;
  const double pull = g * (std::sin(double(slope.angle)) - slope.friction * std::cos(double(slope.angle)));
  // A pull within rounding of zero is the limiting case: friction should hold.
  return std::abs(r.slid - (pull > 1e-9 * g ? pull * t * t / 2 : 0));
}

/// The speed that gravity adds to a body in one step, m/s; NaN without gravity.
template <int D>
double speedOfStep(const WorldSeen<D>& r) {
  const double speed = double(r.scene.settings.gravity.norm()) * r.scene.dt;
  return speed > 0 ? speed : std::numeric_limits<double>::quiet_NaN();
}

/// Gravity's impulse times speed of all bodies in one step (J): the scale of complementarity.
template <int D>
double energyOfStep(const WorldSeen<D>& r) {
  const double speed = speedOfStep(r);
  return r.weight > 0 ? r.weight * speed * speed : std::numeric_limits<double>::quiet_NaN();
}

template <int D>
const std::vector<double>& find(const WorldSeen<D>& seen, const std::string& name);

/// The last step before which the scene's script acts: a body is added, removed or acted on. -1: never.
template <int D>
long lastAct(const SceneSpec<D>& scene) {
  long last = -1;
  for (const auto& spawn : scene.spawns) last = std::max({last, spawn.step > 0 ? spawn.step : -1L, spawn.removeAt});
  for (const auto& event : scene.events) last = std::max(last, event.step);
  return last;
}

/// The wake-up wave: the largest increase of awake bodies after the script's last action, without the bodies that it
/// adds, and the number of steps until that is reached. NaN if the script does not act within the run; no steps if no
/// body wakes.
template <int D>
struct Wave {
  double woken = std::numeric_limits<double>::quiet_NaN(), steps = woken;
  explicit Wave(const WorldSeen<D>& seen) {
    const auto& awake = find(seen, "awake");
    const long act = lastAct(seen.scene);
    if (act < 1 || act >= static_cast<long>(awake.size())) return;
    const auto from = awake.begin() + act, most = std::max_element(from, awake.end());
    double came = 0;
    for (const auto& spawn : seen.scene.spawns) {
      came += spawn.step == act && spawn.body.type == BodyType::dynamic && spawn.body.awake;
    }
    woken = std::max(0.0, *most - *(from - 1) - came);
    if (woken > 0) steps = static_cast<double>(most - from);
  }
};

/// NaN if the run is over by then, or depths were not measured.
template <int D>
double deepestSettled(const WorldSeen<D>& seen) {
  double deepest = std::numeric_limits<double>::quiet_NaN();
  const auto& depths = find(seen, "penetration_poses");
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double time = static_cast<double>(i + 1) * seen.scene.dt;
    if (time >= Settling<D>::kSettled - seen.scene.dt / 2) deepest = std::fmax(deepest, depths[i]);
  }
  return deepest;
}

template <int D>
const std::vector<Measure<WorldSeen<D>>>& seriesEntries() {
  using R = const WorldSeen<D>&;
  static const std::vector<Measure<WorldSeen<D>>> kEntries = {
      {{"kinetic", "kinetic energy", "J", "of all dynamic bodies", kDetail, ""}, [](R r) { return r.now.kinetic; }},
      {{"potential", "potential energy", "J", "of gravity, 0 at the origin's height", kDetail, ""},
       [](R r) { return r.now.potential; }},
      {{"max_speed", "fastest body", "m/s", "speed of the fastest body", kDetail, ""},
       [](R r) { return r.now.maxSpeed; }},
      {{"max_penetration", "largest penetration", "m", "deepest overlap of a contact", kDetail, "less overlap"},
       [](R r) { return r.now.maxPenetration; }},
      {{"mean_penetration", "mean penetration", "m", "mean overlap of the contacts", kDetail, "less overlap"},
       [](R r) { return r.now.meanPenetration; }},
      {{"penetration_poses", "penetration of shapes", "m",
        "deepest overlap of two shapes at the poses, by one exact query for everybody, every tenth step", kDetail,
        "less overlap"},
       [](R r) { return r.depth; }},
      {{"complementarity", "complementarity", "J", "worst normal impulse times closing speed", kDetail,
        "contacts obey Signorini"},
       [](R r) { return r.now.complementarity; }},
      {{"residual", "normalised complementarity", "1",
        "worst normal impulse times closing speed, over m (g dt)^2 of all bodies: how far a step is from solved",
        kDetail, "contacts obey Signorini"},
       [](R r) { return r.now.complementarity / energyOfStep(r); }},
      {{"natural_map", "natural map of contacts and joints", "1",
        "residual of the step's velocity problem: largest error of a row by Coulomb's law with De Saxce's correction, "
        "over "
        "g dt; only of methods that solve velocities apart",
        kDetail, "the problem of a step is solved"},
       [](R r) { return r.naturalMap / speedOfStep(r); }},
      {{"cone_excess", "excess over the friction cone", "N s", "worst friction impulse beyond Coulomb's cone", kDetail,
        "friction obeys Coulomb"},
       [](R r) { return r.now.coneExcess; }},
      {{"joint_error", "joint error", "m", "farthest that the anchors of a joint are apart", kDetail,
        "joints hold better", TrialNeed::joints},
       [](R r) { return r.now.jointError; }},
      {{"joint_turn", "joint turned", "rad", "farthest that a joint is turned from what it holds", kDetail,
        "joints hold better", TrialNeed::joints},
       [](R r) { return r.now.jointTurn; }},
      {{"drift", "drift", "m", "farthest that a body is from where it came", kDetail, "less drift"},
       [](R r) { return r.drift; }},
      {{"height", "height", "m", "of the highest body", kDetail, ""}, [](R r) { return r.height; }},
      {{"slope_distance", "distance slid", "m", "way of the body that slides", kDetail, "", TrialNeed::slope},
       [](R r) { return r.slid; }},
      {{"pairs", "pairs", "1", "pairs of shapes that the broadphase found", kDetail, ""},
       [](R r) { return double(r.frame.pairs); }},
      {{"points", "contact points", "1", "contact points", kDetail, ""}, [](R r) { return double(r.frame.points); }},
      {{"bodies", "bodies", "1", "bodies in the world", kDetail, ""}, [](R r) { return double(r.frame.bodies); }},
      {{"awake", "bodies awake", "1", "dynamic bodies awake", kDetail, ""}, [](R r) { return double(r.frame.awake); }},
      {{"seconds", "time of a step", "s", "processor time of the step", kDetail, "cheaper", TrialNeed::timing},
       [](R r) { return r.seconds; }},
      {{"sec_*", "time of a stage", "s", "processor time of a stage in the step", kDetail, "cheaper",
        TrialNeed::timing},
       nullptr},
  };
  return kEntries;
}

template <int D>
const std::vector<Measure<WorldSeen<D>>>& metricEntries() {
  using R = const WorldSeen<D>&;
  static const std::vector<Measure<WorldSeen<D>>> kEntries = {
      {{"ms_per_step_median", "time per step", "ms", "processor time of a step, median over steps", kCost, "cheaper",
        TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.5); }},
      {{"work_multiply_adds", "multiply-adds per step", "1",
        "of rows, factorisations, solves and residuals of the resolver, mean: a cost without noise", kCost, "cheaper"},
       nullptr},
      {{"work_row_updates", "row updates per step", "1",
        "constraint rows solved once by sweeps, mean: compares methods of the Gauss-Seidel type only", kCost,
        "cheaper"},
       nullptr},
      {{"slope_error", "error of the distance slid", "m", "distance slid against the closed form of a block on a slope",
        kError, "nearer the closed form", TrialNeed::slope},
       slopeError<D>},
      {{"joint_error_max", "largest joint error", "m", "farthest that the anchors of a joint were apart in any step",
        kError, "joints hold better", TrialNeed::joints},
       [](R r) { return r.largest("joint_error"); }},
      {{"joint_turn_max", "largest turn of a joint", "rad",
        "farthest that a joint was turned from what it holds in any step", kDetail, "joints hold better",
        TrialNeed::joints},
       [](R r) { return r.largest("joint_turn"); }},
      {{"penetration_settled", "largest penetration after a second", "m",
        "deepest overlap of two shapes at the poses from the first second on, where bodies should rest: what they fell "
        "at the start is not in it",
        kError, "less overlap", TrialNeed::driftLimit},
       deepestSettled<D>},
      {{"max_penetration", "largest penetration", "m", "deepest overlap of a contact in any step", kError,
        "less overlap"},
       [](R r) { return r.largest("max_penetration"); }},
      {{"penetration_poses", "largest penetration of shapes", "m",
        "deepest overlap of two shapes at the poses, by one exact query for everybody, every tenth step", kError,
        "less overlap"},
       [](R r) { return r.deepest; }},
      {{"penetration_start", "penetration at the start", "m",
        "deepest overlap of two shapes before the first step: what no method has made", kDetail, ""},
       [](R r) { return r.startDepth; }},
      {{"penetration_integral", "penetration over time", "m s", "deepest overlap of a contact, summed over time",
        kDetail, "less overlap"},
       [](R r) { return r.total("max_penetration") * r.scene.dt; }},
      {{"sunk", "sunk at the end", "1",
        "how far what should rest has sunk at the end, as a share of the smallest body: the largest of sag, "
        "overlap and sinking in a second, beyond the slop that methods keep; above 0.01 a run has sunk",
        kDetail, "what rests is held", TrialNeed::rest},
       [](R r) { return r.rest.share(); }},
      {{"sunk_sag", "sag beyond the slop at the end", "1",
        "farthest that a body has sunk beyond what it may fall and the slop of each level, over the smallest body",
        kDetail, "what rests is held", TrialNeed::rest},
       [](R r) { return r.rest.sagShare(); }},
      {{"sunk_overlap", "overlap at the end", "1",
        "deepest overlap of two shapes beyond the slop, over the smallest body", kDetail, "what rests is held",
        TrialNeed::rest},
       [](R r) { return r.rest.depthShare(); }},
      {{"sunk_sinking", "sinking at the end", "1/s",
        "farthest that a body has sunk in the last second, over the smallest body", kDetail, "what rests is held",
        TrialNeed::rest},
       [](R r) { return r.rest.sinkingShare(); }},
      {{"smallest_body", "smallest body", "m", "smallest side of the smallest dynamic body", kDetail, "",
        TrialNeed::rest},
       [](R r) { return r.rest.size; }},
      {{"lateral_max", "sideways drift", "m", "farthest across gravity that a body ever was from where it came",
        kDetail, "less drift"},
       [](R r) { return r.settling.lateralMax; }},
      {{"sag_end", "sag at the end", "m", "farthest along gravity that a body is from where it came, at the end",
        kDetail, "less sag"},
       [](R r) { return r.settling.sag; }},
      {{"tilt_end", "tilt at the end", "rad", "farthest that a body is turned from how it came, at the end", kDetail,
        "less tilt"},
       [](R r) { return r.settling.tilt; }},
      {{"creep", "creep at the end", "m/s", "farthest that a body has moved in the last second", kDetail,
        "what rests stays"},
       [](R r) { return r.settling.creep(); }},
      {{"jitter", "jitter at the end", "m/s", "fastest body, median over the last second", kDetail, "what rests stays"},
       [](R r) { return r.settling.jitter(); }},
      {{"rest_since", "time to rest", "s", "since when no body was faster than 0.05 m/s; none while one is", kDetail,
        "rests sooner"},
       [](R r) { return r.settling.restSince(); }},
      {{"supports_changed", "changed supports", "1",
        "pairs of bodies that touch at the end and did not after one second, or the other way round", kDetail,
        "what stands keeps its neighbours"},
       [](R r) { return r.supportsChanged; }},
      {{"fell_through", "bodies that fell through", "1", "bodies whose centre is inside what is fixed, at the end",
        kDetail, "no tunnelling"},
       [](R r) { return r.fellThrough; }},
      {{"tunnelled", "bodies that tunnelled", "1",
        "bodies whose centre has passed through what is fixed and came out, in any step", kDetail, "no tunnelling"},
       [](R r) { return r.tunnelled; }},
      {{"ghost_hits", "ghost hits", "1",
        "impulses, one for each pair and step, between shapes that would not have met in it", kDetail,
        "what passes by is left alone"},
       [](R r) { return r.ghostHits; }},
      {{"lost_time", "lost time", "s", "that bodies have lost where they were stopped on their way, summed", kDetail,
        "fewer and later stops"},
       [](R r) { return r.lostTime; }},
      {{"angular_momentum_error", "change of angular momentum", "kg m^2/s",
        "change of angular momentum about the origin that no outer torque explains", kDetail,
        "angular momentum is kept", TrialNeed::isolation},
       [](R r) { return (r.now.angularMomentum - r.start.angularMomentum).norm(); }},
      {{"momentum_error", "change of momentum", "kg m/s", "change of momentum that no outer force explains", kDetail,
        "momentum is kept", TrialNeed::isolation},
       [](R r) { return (r.now.momentum - r.start.momentum).norm(); }},
      {{"mean_penetration_end", "mean penetration at the end", "m", "mean overlap of the contacts of the last step",
        kDetail, "less overlap"},
       [](R r) { return r.end("mean_penetration"); }},
      {{"mean_penetration_poses_end", "mean penetration of shapes at the end", "m",
        "mean overlap of pairs of shapes at the last poses asked, by the exact query", kDetail, "less overlap"},
       [](R r) { return r.meanDepth; }},
      {{"max_drift", "largest drift", "m", "farthest that a body ever was from where it came", kDetail, "less drift"},
       [](R r) { return r.largest("drift"); }},
      {{"end_drift_max", "largest drift at the end", "m", "farthest that a body is from where it came, at the end",
        kDetail, "less drift"},
       [](R r) { return r.end("drift"); }},
      {{"end_drift_top", "drift of the top body at the end", "m", "of the body that was highest at the start", kDetail,
        "less drift"},
       [](R r) { return r.topDrift; }},
      {{"complementarity_max", "largest complementarity", "J",
        "worst normal impulse times closing speed of a contact that shall not bounce: one of the two should be 0",
        kDetail, "contacts obey Signorini"},
       [](R r) { return r.largest("complementarity"); }},
      {{"residual_median", "normalised complementarity", "1",
        "worst normal impulse times closing speed of a step over m (g dt)^2 of all bodies, median over steps", kDetail,
        "contacts obey Signorini"},
       [](R r) { return r.quantileOf("residual", 0.5); }},
      {{"natural_map_median", "natural map of contacts and joints", "1",
        "residual of a step's velocity problem: largest error of a row by Coulomb's law with De Saxce's correction, "
        "over g "
        "dt, median over steps; only of methods that solve velocities apart, and not in timed trials",
        kDetail, "the problem of a step is solved"},
       [](R r) { return r.quantileOf("natural_map", 0.5); }},
      {{"cone_excess_max", "largest excess over the friction cone", "N s",
        "worst friction impulse beyond Coulomb's cone", kDetail, "friction obeys Coulomb"},
       [](R r) { return r.largest("cone_excess"); }},
      {{"max_speed", "largest speed", "m/s", "fastest body in any step", kDetail, ""},
       [](R r) { return r.largest("max_speed"); }},
      {{"max_speed_end", "largest speed at the end", "m/s", "fastest body in the last step", kDetail, ""},
       [](R r) { return r.end("max_speed"); }},
      {{"energy_start", "energy at the start", "J", "kinetic and of gravity", kDetail, ""},
       [](R r) { return r.start.kinetic + r.start.potential; }},
      {{"energy_end", "energy at the end", "J", "kinetic and of gravity", kDetail, ""},
       [](R r) { return r.end("kinetic") + r.end("potential"); }},
      {{"energy_max", "largest energy", "J", "kinetic and of gravity, in any step", kDetail, ""},
       [](R r) { return r.energyMax; }},
      {{"slope_distance", "distance slid", "m", "way of the body that slides, at the end", kDetail, "",
        TrialNeed::slope},
       [](R r) { return r.end("slope_distance"); }},
      {{"gravity", "gravity", "m/s^2", "strength of the gravity that acted", kDetail, ""},
       [](R r) { return double(r.scene.settings.gravity.norm()); }},
      {{"drift_limit", "limit of drift", "m", "how far a body may be from where it came", kDetail, "",
        TrialNeed::driftLimit},
       [](R r) { return double(r.scene.limits.drift); }},
      {{"bodies", "bodies", "1", "most bodies of any step", kDetail, ""}, [](R r) { return r.largest("bodies"); }},
      {{"awake_mean", "bodies awake, mean", "1", "dynamic bodies awake, mean over steps", kDetail, "sleeps more"},
       [](R r) { return r.total("awake") / static_cast<double>(r.steps); }},
      {{"woken", "woken by the last act", "1",
        "how many more bodies are awake at the most after the script's last act than before it", kDetail,
        "fewer wake for nothing"},
       [](R r) { return Wave<D>(r).woken; }},
      {{"wake_steps", "steps until all are woken", "1",
        "steps from the script's last act to the first in which most bodies are awake", kDetail, "wakes sooner"},
       [](R r) { return Wave<D>(r).steps; }},
      {{"contacts_end", "contact points at the end", "1", "contact points of the last step", kDetail, ""},
       [](R r) { return r.end("points"); }},
      {{"steps_done", "steps", "1", "steps until the end", kDetail, ""}, [](R r) { return double(r.steps); }},
      {{"ms_per_step_p25", "time per step, lower quartile", "ms", "a quarter of the steps is faster", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.25); }},
      {{"ms_per_step_p75", "time per step, upper quartile", "ms", "a quarter of the steps is slower", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.75); }},
      {{"ms_per_step_p99", "time per step, 99th percentile", "ms", "a hundredth of the steps is slower", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.99); }},
      {{"ms_per_step_worst", "time per step, worst", "ms", "the slowest step after the first ten", kDetail, "cheaper",
        TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 1); }},
      {{"us_*", "time of a stage", "us", "processor time of a stage, median over steps", kDetail, "cheaper",
        TrialNeed::timing},
       nullptr},
      {{"work_*", "work per step", "1", "what was done, counted, mean over steps", kDetail, "cheaper"}, nullptr},
  };
  return kEntries;
}

template <int D>
const std::vector<double>& find(const WorldSeen<D>& seen, const std::string& name) {
  const auto it = seen.series.find(name);
  if (it != seen.series.end()) return it->second;
  std::string valid;
  for (const auto& entry : seriesEntries<D>()) {
    if (entry.info.name == name) {  // not in this trial: before the first step, or a need is not met
      static const std::vector<double> kNone;
      return kNone;
    }
    valid += (valid.empty() ? "" : ", ") + std::string(entry.info.name);
  }
  throw std::logic_error("a metric reads the series '" + name + "'; valid: " + valid);
}

}  // namespace

template <int D>
bool WorldSeen<D>::has(TrialNeed need) const {
  switch (need) {
    case TrialNeed::nothing:
      return true;
    case TrialNeed::timing:
      return timed;
    case TrialNeed::joints:
      return !scene.joints.empty();
    case TrialNeed::slope:
      return scene.slope.has_value();
    case TrialNeed::isolation:
      return isolated && steps > 0;
    case TrialNeed::driftLimit:
      return scene.limits.drift > 0;
    case TrialNeed::rest:
      return scene.limits.levels > 0;
  }
  return false;
}

template <int D>
double WorldSeen<D>::largest(const char* name) const {
  double x = 0;
  for (double v : find(*this, name)) x = worse(x, v);
  return x;
}
template <int D>
double WorldSeen<D>::total(const char* name) const {
  double sum = 0;
  for (double v : find(*this, name)) sum += v;
  return sum;
}
template <int D>
double WorldSeen<D>::end(const char* name) const {
  const auto& list = find(*this, name);
  return list.empty() ? 0.0 : list.back();
}
template <int D>
double WorldSeen<D>::quantileOf(const std::string& name, double q) const {
  const auto& list = find(*this, name);
  std::vector<double> values(list.begin() + std::min<long>(kWarmUpSteps, static_cast<long>(list.size())), list.end());
  std::erase_if(values, [](double x) { return std::isnan(x); });  // not reported, or undefined
  return quantile(std::move(values), q);
}

template <int D>
void putSeries(WorldSeen<D>& seen) {
  for (const auto& entry : seriesEntries<D>()) {
    if (entry.value && seen.has(entry.info.need)) {
      seen.series[std::string(entry.info.name)].push_back(entry.value(seen));
    }
  }
}

template <int D>
std::map<std::string, double> worldMetrics(const WorldSeen<D>& seen) {
  std::map<std::string, double> out;
  measure(
      metricEntries<D>(), seen, [&](TrialNeed need) { return seen.has(need); }, out);
  return out;
}

void describeWorldMetrics(std::vector<DescribedMetric>& out) {
  for (const auto& entry : metricEntries<2>()) out.push_back({"metric", "world", entry.info});
  for (const auto& entry : seriesEntries<2>()) out.push_back({"series", "world", entry.info});
}

template struct WorldSeen<2>;
template struct WorldSeen<3>;
template void putSeries(WorldSeen<2>&);
template void putSeries(WorldSeen<3>&);
template std::map<std::string, double> worldMetrics(const WorldSeen<2>&);
template std::map<std::string, double> worldMetrics(const WorldSeen<3>&);

}}  // namespace lpc::LPC_PRECISION
