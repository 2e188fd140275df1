// SPDX-License-Identifier: Zlib
// World trials: measurements agree with known values, and a failed run ends with the right outcome.
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "experiments/runner/sweep_file.h"
#include "experiments/trial/measure/world_metrics.h"
#include "experiments/trial/trial.h"
#include "framework/stage/stage_solver.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace world_trial_test { namespace {

using nlohmann::json;
using test::ask;
using test::Workspace;

// Bodies fly freely: no contacts, no forces except gravity.
const std::string kThrow = R"(
name = "throw"
summary = "two balls in free flight"
dimensions = [2, 3]
needs = []
gravity = [0, "-g", 0]
dt = 0.01
steps = 100
[parameters]
g = { default = 10, min = 0, max = 100, meaning = "gravity in m/s^2" }
speed_limit = { default = 0, min = 0, max = 1000, meaning = "m/s" }
drift_limit = { default = 0, min = 0, max = 1000, meaning = "m" }
[limits]
speed = "speed_limit"
drift = "drift_limit"
[[body]]
position = [0, 0, 0]
velocity = [3, 0, 0]
shapes = [{ kind = "circle", radius = 0.5 }]
[[body]]
position = [0, 5, 0]
velocity = [0, 4, 0]
shapes = [{ kind = "circle", radius = 0.5 }]
)";

TrialResult run(const Workspace& w, const std::string& scene, const ParameterValues& params = {}, bool timed = false) {
  Planner planner;
  WorldCell cell;
  cell.params = params, cell.timed = timed;
  const PlannedTrial t = planner.world(w.write("scene.toml", scene), cell);
  return runTrial(t.request);
}

// A box that starts 2 cm inside the floor and is pushed out, and a box that starts above it and falls.
const std::string kDrop = R"(
name = "drop"
summary = "a box that starts near the floor"
dimensions = [2, 3]
needs = []
gravity = [0, -10, 0]
steps = 120
[parameters]
height = { default = 0, min = -1, max = 10, meaning = "m, of the lower side" }
[limits]
drift = 5
[[body]]
type = "fixed"
position = [0, -1, 0]
shapes = [{ kind = "box", half = [10, 1, 10] }]
[[body]]
position = [0, "0.5 + height", 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
)";

TEST(WorldTrial, initialAndSettledPenetrationAreSeparate) {
  Workspace w;
  const TrialResult inside = run(w, kDrop, {{"height", -0.02}}), above = run(w, kDrop, {{"height", 1}});
  ASSERT_EQ(inside.outcome + above.outcome, "okok") << inside.reason << above.reason;
  EXPECT_NEAR(inside.metrics.at("penetration_start"), 0.02, 1e-6);
  EXPECT_EQ(above.metrics.at("penetration_start"), 0);
  for (const TrialResult* r : {&inside, &above}) {
    const std::vector<double>& depths = r->series.at("penetration_poses");
    double late = 0, ever = 0;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (std::isnan(depths[i])) continue;
      ever = std::max(ever, depths[i]);
      if (i + 1 >= 60) late = std::max(late, depths[i]);
    }
    EXPECT_EQ(r->metrics.at("penetration_settled"), late);
    EXPECT_EQ(r->metrics.at("penetration_poses"), ever);
  }
  test::expectCaught("a depth of the start is scored",
                     inside.metrics.at("penetration_settled") == inside.metrics.at("penetration_poses"));
  EXPECT_TRUE(std::isnan(run(w, kThrow).metrics.at("penetration_settled"))) << "nothing there should rest";
}

// In the shipped ensembles, which rank methods, no seed makes two bodies overlap.
TEST(WorldTrial, noSeedOfARankedSweepStartsWithAnOverlap) {
  const auto deepest = [](const std::string& name, bool air) {
    double found = 0;
    Planner planner;
    for (const PlannedSweep& sweep : planSweeps(name, {"catto"})) {
      std::set<std::string> seen;
      std::vector<PlannedTrial> trials = sweep.trials;
      for (const CalibratedCell& cell : sweep.calibrated) {
        for (const PlannedTrial& t : cell.plan(1)) trials.push_back(t);
      }
      for (PlannedTrial t : trials) {
        if (!t.unsupported.empty()) continue;
        WorldRequest& asked = t.request.world();
        asked.steps = 1, asked.timed = false;
        if (!air) {
          for (const char* space : {"gap", "drop", "spacing", "beside"}) {
            if (asked.params.contains(space)) asked.params[space] = 0.0;
          }
        }
        if (!seen.insert(json(asked.params).dump() + std::to_string(asked.seed)).second) continue;
        const TrialResult r = runTrial(t.request);
        found = std::max(found, r.metrics.at("penetration_start"));
      }
      EXPECT_GE(seen.size(), 40u) << name;
    }
    return found;
  };
  for (const std::string name : {"ensembles", "equal_cost"}) {
    EXPECT_EQ(deepest(name, true), 0) << name;
    test::expectCaught("boxes without air", deepest(name, false) < 1e-6);
  }
}

TEST(WorldTrial, metricsOfFreeFlight) {
  Workspace w;
  const TrialResult r = run(w, kThrow, {{"g", 0}});
  EXPECT_EQ(r.outcome, "ok");
  EXPECT_EQ(r.metrics.at("steps_done"), 100);
  EXPECT_EQ(r.metrics.at("bodies"), 2);
  const double mass = 3.14159265358979323846 / 4;
  EXPECT_NEAR(r.metrics.at("energy_start"), mass * (9 + 16) / 2, 1e-12);
  EXPECT_NEAR(r.metrics.at("energy_end"), r.metrics.at("energy_start"), 1e-12);
  EXPECT_NEAR(r.metrics.at("momentum_error"), 0, 1e-14);
  EXPECT_NEAR(r.metrics.at("max_drift"), 4, 1e-12);
  EXPECT_NEAR(r.metrics.at("end_drift_top"), 4, 1e-12) << "the upper ball";
  EXPECT_TRUE(std::isnan(r.metrics.at("slope_distance"))) << "nobody slides here";
  EXPECT_TRUE(std::isnan(r.metrics.at("joint_error_max"))) << "no joints";
  EXPECT_TRUE(std::isnan(r.metrics.at("drift_limit"))) << "bodies may go anywhere";
  EXPECT_NEAR(r.metrics.at("max_speed"), 4, 1e-12);
  EXPECT_NEAR(r.series.at("height").back(), 9, 1e-12);
  for (const auto& [name, list] : r.series) EXPECT_EQ(list.size(), 100u) << name;
  EXPECT_EQ(r.series.count("seconds"), 0u) << "an untimed trial holds no time";
  // Initial, every 60th, final.
  ASSERT_EQ(r.poses.size(), 3u);
  EXPECT_NEAR(r.poses.at(60)[1], 3 * 0.6, 1e-12);
  EXPECT_EQ(r.poses.at(100).size(), 2u * 4);
}

// A slope with another name and gravity, on which the sliding body is not the last one.
const std::string kHill = R"toml(
name = "my_hill"
summary = "a block slides down a hill"
dimensions = [2, 3]
needs = ["cache", "friction"]
gravity = [0, "-g", 0]
steps = 60
[parameters]
g = { default = 4, min = 0, max = 100, meaning = "gravity in m/s^2" }
mu = { default = 0.2, min = 0, max = 10, meaning = "Coulomb's coefficient" }
[defaults]
friction = "mu"
[measures.slope]
body = "block"
angle = 0.5
friction = "mu"
[[body]]
type = "fixed"
position = ["-sin(0.5)", "-cos(0.5)", 0]
angle = -0.5
shapes = [{ kind = "box", half = [100, 1, 20] }]
[[body]]
name = "block"
position = ["0.5 * sin(0.5)", "0.5 * cos(0.5)", 0]
angle = -0.5
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
[[body]]
position = [0, 500, 0]
shapes = [{ kind = "circle", radius = 0.5 }]
)toml";

// Whether the measured distance `way` agrees with g (sin a - mu cos a) t^2 / 2 within one step's motion.
bool slidRight(double way, double g, double mu) {
  const double right = g * (std::sin(0.5) - mu * std::cos(0.5)) * 0.5;
  return std::abs(way - std::max(0.0, right)) < 0.03 * std::max(0.1, right);
}

TEST(WorldTrial, slidingIsComparedWithItsClosedForm) {
  Workspace w;
  for (const double g : {4.0, 10.0}) {
    const TrialResult r = run(w, kHill, {{"g", g}});
    EXPECT_TRUE(slidRight(r.metrics.at("slope_distance"), g, 0.2)) << r.metrics.at("slope_distance");
    EXPECT_LT(r.metrics.at("slope_error"), 0.03 * g * 0.15);
    EXPECT_NEAR(r.metrics.at("gravity"), g, 1e-6);
    EXPECT_EQ(r.series.at("slope_distance").back(), r.metrics.at("slope_distance"));
  }
  const TrialResult held = run(w, kHill, {{"mu", 1}});
  EXPECT_LT(held.metrics.at("slope_error"), 0.01);
  EXPECT_EQ(held.metrics.at("slope_error"), held.metrics.at("slope_distance"));
  // Planted bugs: the gravity of other scenes, and the last body instead of the named one.
  const TrialResult r = run(w, kHill);
  EXPECT_FALSE(slidRight(r.metrics.at("slope_distance"), 10, 0.2)) << "gravity of 10 for any scene was not seen";
  EXPECT_FALSE(slidRight(500 - r.poses.at(60).at(2 * 4 + 2), 4, 0.2)) << "the last body was not seen";
}

// Every name that trials of any kind write has a description.
bool isDescribed(std::string_view what, std::string_view kind, const std::string& name) {
  for (const DescribedMetric& m : describeMetrics()) {
    if (m.what != what || m.kind != kind) continue;
    const bool star = m.info.name.back() == '*';
    if (star ? name.starts_with(m.info.name.substr(0, m.info.name.size() - 1)) : name == m.info.name) return true;
  }
  return false;
}

TEST(Metrics, everyMetricIsDescribed) {
  Workspace w;
  for (const bool timed : {false, true}) {
    const TrialResult r = run(w, kHill, {}, timed);
    for (const auto& [name, value] : r.metrics) EXPECT_TRUE(isDescribed("metric", "world", name)) << name;
    for (const auto& [name, list] : r.series) EXPECT_TRUE(isDescribed("series", "world", name)) << name;
  }
  Planner planner;
  for (const json& cell : {json{{"dimension", 2},
                                {"n", 16},
                                {"distribution", "uniform"},
                                {"broadphase", "naive"},
                                {"frames", 12},
                                {"timed", true}}}) {
    const TrialResult r = runTrial(planner.boxes(cell).request);
    EXPECT_EQ(r.metrics.size(), 7u);
    for (const auto& [name, value] : r.metrics) EXPECT_TRUE(isDescribed("metric", "boxes", name)) << name;
  }
  EXPECT_FALSE(isDescribed("metric", "world", "max_penetratoin")) << "the planted bug was not seen";
  std::set<std::string> names;
  for (const DescribedMetric& m : describeMetrics()) {
    EXPECT_TRUE(names.insert(std::string(m.what) + " " + std::string(m.info.name)).second) << m.info.name;
    EXPECT_FALSE(m.info.title.empty() || m.info.unit.empty() || m.info.meaning.empty()) << m.info.name;
  }
}

TEST(Metrics, oneThatReadsAMisspeltSeriesIsAnError) {
  const SceneSpec<2> scene;
  const WorldSeen<2> seen(scene);
  EXPECT_EQ(seen.largest("drift"), 0);
  try {
    seen.largest("drfit");
    FAIL() << "an empty series for a name that nobody has";
  } catch (const std::logic_error& e) {
    EXPECT_NE(std::string(e.what()).find("drift"), std::string::npos) << "the valid names: " << e.what();
  }
}

TEST(WorldTrial, timedTrialsHoldTimesAndTheSameHistory) {
  Workspace w;
  const TrialResult a = run(w, kThrow), b = run(w, kThrow, {}, true);
  EXPECT_EQ(a.hash, b.hash);
  for (const char* name : {"seconds", "sec_solver", "sec_broadphase", "sec_contacts"}) {
    ASSERT_TRUE(b.series.count(name)) << name;
    EXPECT_EQ(b.series.at(name).size(), 100u);
  }
  for (const char* name : {"ms_per_step_median", "ms_per_step_p25", "ms_per_step_p75", "us_solver", "us_broadphase"}) {
    EXPECT_GE(b.metrics.at(name), 0) << name;
  }
  EXPECT_TRUE(std::isnan(a.metrics.at("momentum_error"))) << "gravity acts";
  const TrialResult back = resultFromJson(json::parse(toJson(b).dump()));
  EXPECT_EQ(json(back.series).dump(), json(b.series).dump()) << "where nothing was measured is null, and stays so";
  EXPECT_TRUE(std::isnan(back.metrics.at("momentum_error"))) << "NaN is kept, not dropped";
}

/// The default solver, which reports NaN impulses in its third step but moves all bodies correctly.
template <int D>
class PushesNaN final : public Solver<D> {
 public:
  struct Params {
    bool joints = false;
    void visit(ParamVisitor& v) { v.flag("joints", joints, "through a joint, else a contact"); }
  };
  explicit PushesNaN(const Params& params)
      : m_joints(params.joints), m_right(createStage<Solver<D>>({"split_solver", {}})) {}
  static AlgorithmInfo info() {
    return {.name = "planted_push",
            .summary = "planted bug",
            .paper = "",
            .complexity = "that of split_solver",
            .role = AlgorithmRole::witness};
  }
  void step(const StepInput<D>& in) override {
    m_right->step(in);
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    if (++m_steps != 3) return;
    (m_joints ? in.joints[0].impulse[0] : in.manifolds.at(0).points[0].impulse[0]) = nan;
  }

 private:
  bool m_joints;
  std::unique_ptr<Solver<D>> m_right;
  int m_steps = 0;
};
LPC_REGISTER(Solver, PushesNaN, 2);

TEST(WorldTrial, aNaNImpulseEndsTheRun) {
  Workspace w;
  std::string scene = kHill + "[[joint]]\nkind = \"pivot\"\na = \"world\"\nb = \"block\"\nanchor = [0, 0]\n";
  scene.replace(scene.find("[\"cache\", "), 10, "[\"joints\", \"cache\", ");
  Planner planner;
  for (const char* solver : {"planted_push", "planted_push{joints=true}"}) {
    for (const long steps : {3, 60}) {
      WorldCell cell;
      cell.pipeline = std::string("solver=") + solver, cell.steps = steps;
      const PlannedTrial t = planner.world(w.write("scene.toml", scene), cell);
      const TrialResult r = runTrial(t.request);
      EXPECT_EQ(r.outcome, "diverged") << solver;
      EXPECT_EQ(r.reason, "nan") << solver;
      EXPECT_EQ(r.step, 3) << solver;
      if (std::string(solver) == "planted_push") {
        EXPECT_TRUE(std::isnan(r.metrics.at("cone_excess_max")));
      }
    }
  }
}

TEST(WorldTrial, limitsHaveOutcomes) {
  Workspace w;
  const TrialResult fast = run(w, kThrow, {{"speed_limit", 5.05}});
  EXPECT_EQ(fast.outcome, "exploded");
  EXPECT_EQ(fast.step, 41) << "|v| = sqrt(9 + (10 t)^2) passes 5.05 at t = 0.406";
  EXPECT_EQ(fast.metrics.at("steps_done"), 41);
  const TrialResult far = run(w, kThrow, {{"g", 0}, {"drift_limit", 2}});
  EXPECT_EQ(far.outcome, "collapsed");
  EXPECT_NEAR(static_cast<double>(far.step), 51, 1);
  EXPECT_NE(far.reason.find("body 1"), std::string::npos) << far.reason;
}

TEST(WorldTrial, unsupportedIsAnOutcome) {
  Workspace w;
  std::string stick = kThrow;
  stick.replace(stick.find("kind = \"circle\", radius = 0.5"), 29, "kind = \"blob\", radius = 0.5 ");
  EXPECT_THROW(run(w, stick), UserError) << "a broken scene is the user's mistake, not an outcome";
  Planner planner;
  WorldCell cell;
  cell.dimension = 3;
  std::string flat = kThrow;
  flat.replace(flat.find("[2, 3]"), 6, "[2]   ");
  EXPECT_NE(planner.world(w.write("flat.toml", flat), cell).unsupported.find("3D"), std::string::npos);
}

// Poses at the same times whatever the step; a trial that asks for nothing keeps its old key.
TEST(WorldTrial, keepsPosesAndSeriesAsAsked) {
  Workspace w;
  Planner planner;
  const auto trial = [&](double dt, long steps, std::optional<double> every, bool series) {
    WorldCell cell;
    cell.dt = dt, cell.steps = steps, cell.posesEvery = every, cell.series = series;
    return planner.world(w.write("scene.toml", kThrow), cell);
  };
  const auto ran = [](const PlannedTrial& t) { return runTrial(t.request); };
  const auto kept = [](const TrialResult& r) {
    std::vector<long> steps;
    for (const auto& [step, data] : r.poses) steps.push_back(step);
    return steps;
  };
  const PlannedTrial usual = trial(0.01, 100, {}, true), asked = trial(0.01, 100, 0.25, false);
  const TrialResult a = ran(usual), b = ran(asked);
  EXPECT_EQ(kept(a), (std::vector<long>{0, 60, 100}));
  EXPECT_EQ(kept(b), (std::vector<long>{0, 25, 50, 75, 100}));
  EXPECT_EQ(kept(ran(trial(0.0025, 400, 0.25, true))), (std::vector<long>{0, 100, 200, 300, 400}));
  EXPECT_FALSE(a.series.empty());
  EXPECT_TRUE(b.series.empty());
  EXPECT_EQ(a.hash, b.hash) << "what is kept changes nothing";
  EXPECT_NE(usual.key, asked.key);
  EXPECT_FALSE(usual.canonical.contains("poses_every") || usual.canonical.contains("series"));
}

TEST(WorldSweep, axesMeanWhatTheManualSays) {
  Workspace w;
  w.write("throw.toml", kThrow);
  const auto sweeps = planSweeps(w.write("s.toml", R"(
summary = "s"
kind = "world"
pipeline = "cache=none sleep=split_average"
[axes]
scene = "throw"
g = [1, 2]
dt = 0.02
iterations = [3, 5]
model = ["minimal", "3d", "+friction"]
sleep = "none"
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=$iterations}}"
"soft" = "solver=soft_step{substeps=$iterations}"
)"),
                                 {});
  ASSERT_EQ(sweeps[0].trials.size(), 2u * 2 * 3 * 2);
  int solid = 0, friction = 0;
  for (const PlannedTrial& t : sweeps[0].trials) {
    const std::string pipeline = t.canonical["pipeline"];
    const std::string n = std::to_string(t.axes["iterations"].get<int>());
    const std::string resolver = t.axes["resolver"];
    EXPECT_NE(pipeline.find(resolver == "catto" ? "catto{iterations=" + n : "soft_step{substeps=" + n),
              std::string::npos);
    EXPECT_NE(pipeline.find("cache=none"), std::string::npos) << "of the base pipeline";
    EXPECT_NE(pipeline.find("sleep=none"), std::string::npos) << "the axis overrides, also with a default";
    EXPECT_EQ(t.canonical["params"]["g"], t.axes["g"].get<double>());
    EXPECT_EQ(t.canonical["dt"], 0.02);
    solid += t.canonical["dimension"] == 3, friction += t.canonical["features"] == "friction";
    if (t.axes["model"] == "minimal") {
      EXPECT_EQ(t.canonical["features"], "");
    }
  }
  EXPECT_EQ(solid, 8);
  EXPECT_EQ(friction, 8);
  const std::map<std::string, std::string> roles = {{"scene", "run"},          {"g", "parameter"}, {"dt", "run"},
                                                    {"iterations", "setting"}, {"model", "run"},   {"sleep", "stage"},
                                                    {"resolver", "label"}};
  EXPECT_EQ(sweeps[0].roles, roles) << "what each axis is";
}

TEST(WorldSweep, partsOfAStageAreMethods) {
  Workspace w;
  w.write("throw.toml", kThrow);
  const auto sweeps = planSweeps(w.write("s.toml", R"(
summary = "s"
kind = "world"
pipeline = "solver=split_solver{velocity=$velocity}"
[axes]
scene = "throw"
velocity = ["catto", "naive"]
)"),
                                 {});
  EXPECT_EQ(sweeps[0].roles.at("velocity"), "stage");
}

TEST(WorldSweep, aBaselineIsAValueOfAnAxis) {
  Workspace w;
  w.write("throw.toml", kThrow);
  const auto plan = [&](const std::string& baseline) {
    return planSweeps(w.write("s.toml", "summary = \"s\"\nkind = \"world\"\nbaseline = \"" + baseline +
                                            "\"\n[axes]\nscene = \"throw\"\nsleep = [\"none\", \"split_average\"]\n"),
                      {});
  };
  EXPECT_EQ(plan("none")[0].baseline, "none");
  try {
    plan("nnoe");
    FAIL() << "no axis has this value";
  } catch (const UserError& e) {
    const std::string what = e.what();
    EXPECT_NE(
        what.find("s.toml:3: no axis has the value 'nnoe'; did you mean 'none'? valid: none, split_average, throw"),
        std::string::npos)
        << what;
  }
}

// One sweep covers both precisions: f32 runs in its own worker, if this build has one.
TEST(WorldSweep, runsInTheWorkerOfItsPrecision) {
  Workspace w;
  w.write("throw.toml", kThrow);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"world\"\ntimed = true\nrepeats = 2\n[axes]\nscene = \"throw\"\nprecision = " +
              std::string(test::kSingle ? "[\"f64\", \"f32\"]\n" : "\"f64\"\n"));
  const auto out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome = 'ok' AND timed = 1"),
            test::kSingle ? "4" : "2");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(DISTINCT hash) FROM trial"), test::kSingle ? "2" : "1");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT length(data) FROM series WHERE name = 'kinetic'"), "800");
  // The store contains what a report must know.
  EXPECT_EQ(
      ask(w.path("s.db"), "SELECT unit || '|' || role FROM metrics WHERE what='metric' AND name='max_penetration'"),
      "m|error");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT kind || json_remove(roles, '$.commands') FROM sweep"),
            R"(world{"precision":"run","scene":"run"})");
}

TEST(CommandRun, printsProfilesAndRecords) {
  Workspace w;
  w.write("throw.toml", kThrow);
  const auto out = w.lpc("run throw.toml --param g=5 --profile p.csv --record r.rec");
  ASSERT_EQ(out.code, 0) << out.text;
  EXPECT_NE(out.text.find("outcome   ok"), std::string::npos) << out.text;
  EXPECT_GT(std::filesystem::file_size(w.path("p.csv")), 1000u);
  EXPECT_GT(std::filesystem::file_size(w.path("r.rec")), 1000u);
  EXPECT_EQ(w.lpc("run throw.toml --param speed_limit=5").code, 1) << "a run that fails";
  EXPECT_EQ(json::parse(w.lpc("run throw.toml --json").text)["outcome"], "ok");
  EXPECT_EQ(w.lpc("run throw.toml --record /nowhere/r.rec").code, 2);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::world_trial_test
