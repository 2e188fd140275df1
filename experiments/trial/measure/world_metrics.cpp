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
      {{"kinetic", "kinetic energy", "J", "kinetic energy of all dynamic bodies", kDetail, ""},
       [](R r) { return r.now.kinetic; }},
      {{"potential", "potential energy", "J", "potential energy of gravity, 0 at the height of the origin", kDetail,
        ""},
       [](R r) { return r.now.potential; }},
      {{"max_speed", "fastest body", "m/s", "speed of the fastest body", kDetail, ""},
       [](R r) { return r.now.maxSpeed; }},
      {{"max_penetration", "largest penetration", "m", "largest penetration of a contact", kDetail, "less overlap"},
       [](R r) { return r.now.maxPenetration; }},
      {{"mean_penetration", "mean penetration", "m", "mean penetration of the contacts", kDetail, "less overlap"},
       [](R r) { return r.now.meanPenetration; }},
      {{"penetration_poses", "penetration of shapes", "m",
        "largest overlap of two shapes at their poses, by the same exact query for all methods, every tenth step",
        kDetail, "less overlap"},
       [](R r) { return r.depth; }},
      {{"complementarity", "complementarity", "J", "largest normal impulse times closing speed", kDetail,
        "contacts obey Signorini"},
       [](R r) { return r.now.complementarity; }},
      {{"residual", "normalised complementarity", "1",
        "largest normal impulse times closing speed, over m (g dt)^2 of all bodies: how far the step is from its "
        "solution",
        kDetail, "contacts obey Signorini"},
       [](R r) { return r.now.complementarity / energyOfStep(r); }},
      {{"natural_map", "natural map of contacts and joints", "1",
        "residual of the step's velocity problem: largest residual of a row by Coulomb's law with De Saxce's "
        "correction, "
        "over "
        "g dt; only for methods with a separate velocity stage",
        kDetail, "the problem of a step is solved"},
       [](R r) { return r.naturalMap / speedOfStep(r); }},
      {{"cone_excess", "excess over the friction cone", "N s", "largest friction impulse beyond Coulomb's cone",
        kDetail, "friction obeys Coulomb"},
       [](R r) { return r.now.coneExcess; }},
      {{"joint_error", "joint error", "m", "largest distance between the two anchors of a joint", kDetail,
        "joints hold better", TrialNeed::joints},
       [](R r) { return r.now.jointError; }},
      {{"joint_turn", "joint turned", "rad", "largest angular error of a joint", kDetail, "joints hold better",
        TrialNeed::joints},
       [](R r) { return r.now.jointTurn; }},
      {{"drift", "drift", "m", "largest distance of a body from where it entered the world", kDetail, "less drift"},
       [](R r) { return r.drift; }},
      {{"height", "height", "m", "height of the highest body", kDetail, ""}, [](R r) { return r.height; }},
      {{"slope_distance", "distance slid", "m", "distance of the sliding body", kDetail, "", TrialNeed::slope},
       [](R r) { return r.slid; }},
      {{"pairs", "pairs", "1", "pairs of shapes found by the broadphase", kDetail, ""},
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
        "multiply-adds of rows, factorisations, solves and residuals of the solver, mean over steps: a cost without "
        "timing noise",
        kCost, "cheaper"},
       nullptr},
      {{"work_row_updates", "row updates per step", "1",
        "updates of single constraint rows, mean over steps: compares only methods of the Gauss-Seidel type", kCost,
        "cheaper"},
       nullptr},
      {{"slope_error", "error of the distance slid", "m",
        "error of the distance slid, against the closed form of a block on a slope", kError, "nearer the closed form",
        TrialNeed::slope},
       slopeError<D>},
      {{"joint_error_max", "largest joint error", "m",
        "largest distance between the two anchors of a joint in any step", kError, "joints hold better",
        TrialNeed::joints},
       [](R r) { return r.largest("joint_error"); }},
      {{"joint_turn_max", "largest turn of a joint", "rad", "largest angular error of a joint in any step", kDetail,
        "joints hold better", TrialNeed::joints},
       [](R r) { return r.largest("joint_turn"); }},
      {{"penetration_settled", "largest penetration after a second", "m",
        "largest overlap of two shapes at their poses after the first second, without impacts of the start; for scenes "
        "that should rest",
        kError, "less overlap", TrialNeed::driftLimit},
       deepestSettled<D>},
      {{"max_penetration", "largest penetration", "m", "largest penetration of a contact in any step", kError,
        "less overlap"},
       [](R r) { return r.largest("max_penetration"); }},
      {{"penetration_poses", "largest penetration of shapes", "m",
        "largest overlap of two shapes at their poses, by the same exact query for all methods, every tenth step",
        kError, "less overlap"},
       [](R r) { return r.deepest; }},
      {{"penetration_start", "penetration at the start", "m",
        "largest overlap of two shapes before the first step, which no method has caused", kDetail, ""},
       [](R r) { return r.startDepth; }},
      {{"penetration_integral", "penetration over time", "m s",
        "largest penetration of a contact, integrated over time", kDetail, "less overlap"},
       [](R r) { return r.total("max_penetration") * r.scene.dt; }},
      {{"sunk", "sunk at the end", "1",
        "sinking at the end over the size of the smallest body: largest of sag, overlap and sinking in a second, "
        "beyond the slop; above 0.01 a run has sunk",
        kDetail, "what rests is held", TrialNeed::rest},
       [](R r) { return r.rest.share(); }},
      {{"sunk_sag", "sag beyond the slop at the end", "1",
        "largest sag of a body beyond its allowed fall and the slop of each level, over the size of the smallest body",
        kDetail, "what rests is held", TrialNeed::rest},
       [](R r) { return r.rest.sagShare(); }},
      {{"sunk_overlap", "overlap at the end", "1",
        "largest overlap of two shapes beyond the slop, over the size of the smallest body", kDetail,
        "what rests is held", TrialNeed::rest},
       [](R r) { return r.rest.depthShare(); }},
      {{"sunk_sinking", "sinking at the end", "1/s",
        "largest sinking of a body in the last second, over the size of the smallest body", kDetail,
        "what rests is held", TrialNeed::rest},
       [](R r) { return r.rest.sinkingShare(); }},
      {{"smallest_body", "smallest body", "m", "smallest side of the smallest dynamic body", kDetail, "",
        TrialNeed::rest},
       [](R r) { return r.rest.size; }},
      {{"lateral_max", "sideways drift", "m",
        "largest distance of a body across gravity from where it entered the world, in any step", kDetail,
        "less drift"},
       [](R r) { return r.settling.lateralMax; }},
      {{"sag_end", "sag at the end", "m",
        "largest distance of a body along gravity from where it entered the world, at the end", kDetail, "less sag"},
       [](R r) { return r.settling.sag; }},
      {{"tilt_end", "tilt at the end", "rad", "largest rotation of a body since it entered the world, at the end",
        kDetail, "less tilt"},
       [](R r) { return r.settling.tilt; }},
      {{"creep", "creep at the end", "m/s", "largest motion of a body in the last second", kDetail, "what rests stays"},
       [](R r) { return r.settling.creep(); }},
      {{"jitter", "jitter at the end", "m/s", "speed of the fastest body, median over the last second", kDetail,
        "what rests stays"},
       [](R r) { return r.settling.jitter(); }},
      {{"rest_since", "time to rest", "s", "time after which no body is faster than 0.05 m/s; no value if one still is",
        kDetail, "rests sooner"},
       [](R r) { return r.settling.restSince(); }},
      {{"supports_changed", "changed supports", "1",
        "pairs of bodies that touch at the end but not after one second, or vice versa", kDetail,
        "what stands keeps its neighbours"},
       [](R r) { return r.supportsChanged; }},
      {{"fell_through", "bodies that fell through", "1", "bodies with their centre inside a static body at the end",
        kDetail, "no tunnelling"},
       [](R r) { return r.fellThrough; }},
      {{"tunnelled", "bodies that tunnelled", "1",
        "bodies with a centre that passed through a static body, in any step", kDetail, "no tunnelling"},
       [](R r) { return r.tunnelled; }},
      {{"ghost_hits", "ghost hits", "1",
        "impulses between shapes that would not have touched in the step, one per pair and step", kDetail,
        "what passes by is left alone"},
       [](R r) { return r.ghostHits; }},
      {{"lost_time", "lost time", "s",
        "time that bodies lose when continuous collision stops them within a step, summed", kDetail,
        "fewer and later stops"},
       [](R r) { return r.lostTime; }},
      {{"angular_momentum_error", "change of angular momentum", "kg m^2/s",
        "change of angular momentum about the origin not explained by external torques", kDetail,
        "angular momentum is kept", TrialNeed::isolation},
       [](R r) { return (r.now.angularMomentum - r.start.angularMomentum).norm(); }},
      {{"momentum_error", "change of momentum", "kg m/s", "change of momentum not explained by external forces",
        kDetail, "momentum is kept", TrialNeed::isolation},
       [](R r) { return (r.now.momentum - r.start.momentum).norm(); }},
      {{"mean_penetration_end", "mean penetration at the end", "m", "mean penetration of the contacts of the last step",
        kDetail, "less overlap"},
       [](R r) { return r.end("mean_penetration"); }},
      {{"mean_penetration_poses_end", "mean penetration of shapes at the end", "m",
        "mean overlap of pairs of shapes at the last tested poses, by the exact query", kDetail, "less overlap"},
       [](R r) { return r.meanDepth; }},
      {{"max_drift", "largest drift", "m", "largest distance of a body from where it entered the world, in any step",
        kDetail, "less drift"},
       [](R r) { return r.largest("drift"); }},
      {{"end_drift_max", "largest drift at the end", "m",
        "largest distance of a body from where it entered the world, at the end", kDetail, "less drift"},
       [](R r) { return r.end("drift"); }},
      {{"end_drift_top", "drift of the top body at the end", "m",
        "distance of the body that was highest at the start from its start, at the end", kDetail, "less drift"},
       [](R r) { return r.topDrift; }},
      {{"complementarity_max", "largest complementarity", "J",
        "largest normal impulse times closing speed of a contact without restitution: one of the two should be 0",
        kDetail, "contacts obey Signorini"},
       [](R r) { return r.largest("complementarity"); }},
      {{"residual_median", "normalised complementarity", "1",
        "largest normal impulse times closing speed of a step over m (g dt)^2 of all bodies, median over steps",
        kDetail, "contacts obey Signorini"},
       [](R r) { return r.quantileOf("residual", 0.5); }},
      {{"natural_map_median", "natural map of contacts and joints", "1",
        "residual of a step's velocity problem: largest residual of a row by Coulomb's law with De Saxce's correction, "
        "over g "
        "dt, median over steps; only for methods with a separate velocity stage, and not in timed trials",
        kDetail, "the problem of a step is solved"},
       [](R r) { return r.quantileOf("natural_map", 0.5); }},
      {{"cone_excess_max", "largest excess over the friction cone", "N s",
        "largest friction impulse beyond Coulomb's cone", kDetail, "friction obeys Coulomb"},
       [](R r) { return r.largest("cone_excess"); }},
      {{"max_speed", "largest speed", "m/s", "speed of the fastest body in any step", kDetail, ""},
       [](R r) { return r.largest("max_speed"); }},
      {{"max_speed_end", "largest speed at the end", "m/s", "speed of the fastest body in the last step", kDetail, ""},
       [](R r) { return r.end("max_speed"); }},
      {{"energy_start", "energy at the start", "J", "kinetic plus gravitational energy", kDetail, ""},
       [](R r) { return r.start.kinetic + r.start.potential; }},
      {{"energy_end", "energy at the end", "J", "kinetic plus gravitational energy", kDetail, ""},
       [](R r) { return r.end("kinetic") + r.end("potential"); }},
      {{"energy_max", "largest energy", "J", "kinetic plus gravitational energy, in any step", kDetail, ""},
       [](R r) { return r.energyMax; }},
      {{"slope_distance", "distance slid", "m", "distance of the sliding body, at the end", kDetail, "",
        TrialNeed::slope},
       [](R r) { return r.end("slope_distance"); }},
      {{"gravity", "gravity", "m/s^2", "magnitude of gravity", kDetail, ""},
       [](R r) { return double(r.scene.settings.gravity.norm()); }},
      {{"drift_limit", "limit of drift", "m", "largest allowed distance of a body from where it entered the world",
        kDetail, "", TrialNeed::driftLimit},
       [](R r) { return double(r.scene.limits.drift); }},
      {{"bodies", "bodies", "1", "largest number of bodies in any step", kDetail, ""},
       [](R r) { return r.largest("bodies"); }},
      {{"awake_mean", "bodies awake, mean", "1", "dynamic bodies awake, mean over steps", kDetail, "sleeps more"},
       [](R r) { return r.total("awake") / static_cast<double>(r.steps); }},
      {{"woken", "woken by the last act", "1",
        "largest number of awake bodies after the script's last event, minus the number before it", kDetail,
        "fewer wake for nothing"},
       [](R r) { return Wave<D>(r).woken; }},
      {{"wake_steps", "steps until all are woken", "1",
        "steps from the script's last event to the first step with the most awake bodies", kDetail, "wakes sooner"},
       [](R r) { return Wave<D>(r).steps; }},
      {{"contacts_end", "contact points at the end", "1", "contact points of the last step", kDetail, ""},
       [](R r) { return r.end("points"); }},
      {{"steps_done", "steps", "1", "steps done until the end", kDetail, ""}, [](R r) { return double(r.steps); }},
      {{"ms_per_step_p25", "time per step, lower quartile", "ms", "25th percentile of the time per step", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.25); }},
      {{"ms_per_step_p75", "time per step, upper quartile", "ms", "75th percentile of the time per step", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.75); }},
      {{"ms_per_step_p99", "time per step, 99th percentile", "ms", "99th percentile of the time per step", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 0.99); }},
      {{"ms_per_step_worst", "time per step, worst", "ms", "time of the slowest step after the first ten", kDetail,
        "cheaper", TrialNeed::timing},
       [](R r) { return 1e3 * r.quantileOf("seconds", 1); }},
      {{"us_*", "time of a stage", "us", "processor time of a stage, median over steps", kDetail, "cheaper",
        TrialNeed::timing},
       nullptr},
      {{"work_*", "work per step", "1", "count of work, mean over steps", kDetail, "cheaper"}, nullptr},
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
  throw std::logic_error("a metric reads unknown series '" + name + "'; valid: " + valid);
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
