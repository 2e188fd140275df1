// SPDX-License-Identifier: Zlib
// Velocity problems out of a running scene.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/fclib_file.h"
#include "experiments/trial/output_file.h"
#include "experiments/trial/problem_file.h"
#include "framework/contact_problem.h"
#include "framework/director.h"
#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {
namespace {

struct RecordOptions {
  std::string scene, pipeline, problems;
  std::vector<std::string> params;
  std::vector<int> steps;
  std::optional<int> dimension, hardest;
  std::optional<double> dt;
  std::optional<long> last;
  std::optional<std::uint64_t> seed;
};

bool isFclib(const std::string& path) { return path.ends_with(".hdf5"); }

// Keeps the problem of a step until it is known what its answer leaves of it. The last of those that a step shows.
template <int D>
class ProblemWatcher final : public VelocityWatcher<D> {
 public:
  void see(const VelocityInput<D>& in) override {
    m_rows.set(in), m_rows.freeVelocities(in, m_free);
    m_manifolds = in.manifolds, m_joints = in.joints;
    if (m_rows.size() > 0) m_frozen = freeze(in, m_gravity);
  }
  explicit ProblemWatcher(const Vec<D>& gravity) : m_gravity(gravity) {}
  std::optional<FrozenProblem<D>> take() { return std::exchange(m_frozen, std::nullopt); }
  /// Of the step just done, m/s. Precondition: it has shown a problem.
  double residual() {
    m_rows.impulses(m_manifolds, m_joints, m_impulse);
    return m_rows.naturalMap(m_impulse, m_free).natural;
  }

 private:
  Vec<D> m_gravity;
  ContactProblem<D> m_rows;
  std::vector<double> m_free, m_impulse;
  std::span<Manifold<D>> m_manifolds;
  std::span<JointRecord<D>> m_joints;
  std::optional<FrozenProblem<D>> m_frozen;
};

template <int D>
void record(const RecordOptions& o, const PlannedTrial& trial) {
  const auto& t = trial.canonical;
  const SceneFile file = SceneFile::load(trial.sceneFile);
  SceneSpec<D> scene = file.build<D>(t.at("params").get<ParameterValues>(), t.at("seed").get<std::uint64_t>());
  scene.settings.features = featuresFromText(t.at("features").get<std::string>());
  const Real dt = static_cast<Real>(t.at("dt").get<double>());
  World<D> world(Pipeline::parse(t.at("pipeline").get<std::string>()), scene.settings);
  ProblemWatcher<D> watcher(scene.settings.gravity);
  world.watch(&watcher);
  Director<D> director(std::move(scene));
  struct Kept {
    double residual;
    StoredProblem<D> stored;
  };
  std::vector<Kept> kept;
  long shown = 0;
  const long steps = o.hardest ? t.at("steps").get<long>() : *std::max_element(o.steps.begin(), o.steps.end()) + 1L;
  OutputFile out(o.problems);  // not after hours of running
  const InterruptGuard interrupts;
  for (long step = 0; step < steps; ++step) {
    if (InterruptGuard::interrupted()) throw Interrupted();
    director.advance(world);
    world.step(dt);
    std::optional<FrozenProblem<D>> problem = watcher.take();
    if (!problem) continue;
    ++shown;
    if (!o.hardest && std::find(o.steps.begin(), o.steps.end(), step) == o.steps.end()) continue;
    const double residual = watcher.residual();
    if (!std::isfinite(residual)) break;  // from now on nobody could solve it
    kept.push_back({residual, {file.name(), step, std::move(*problem)}});
    if (!o.hardest || kept.size() <= static_cast<std::size_t>(*o.hardest)) continue;
    kept.erase(std::min_element(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) {
      return a.residual < b.residual || (a.residual == b.residual && a.stored.step > b.stored.step);
    }));
  }
  if (shown == 0) {
    throw UserError("no step of '" + o.scene + "' shows a velocity problem: nothing touches, or the solver owns its " +
                    "loop; valid: a scene with contacts or joints, solver=split_solver{...}");
  }
  if (o.hardest && kept.empty())
    throw UserError("'" + o.scene + "' comes apart in its first step; valid: a finite run");
  for (const int step : o.steps) {
    const auto has = [&](const Kept& k) { return k.stored.step == step; };
    if (std::any_of(kept.begin(), kept.end(), has)) continue;
    throw UserError(
        "--steps: in step " + std::to_string(step) + " of '" + o.scene +
        "' there is nothing to solve; valid: steps in which something touches or is joined, of a run that is finite");
  }
  std::vector<StoredProblem<D>> stored;
  const double gravity = double(world.settings().gravity.norm());
  for (Kept& k : kept) {
    std::printf("step %-6ld %4d bodies %4d points %3zu joints   left by its own method: ", k.stored.step,
                k.stored.problem.bodies.size(), k.stored.problem.points(), k.stored.problem.joints.size());
    gravity > 0 ? std::printf("%.3g g dt\n", k.residual / (gravity * double(dt)))
                : std::printf("%.3g m/s\n", k.residual);
    stored.push_back(std::move(k.stored));
  }
  if (isFclib(o.problems)) {
    out.stream() << fclibBytes<D>(stored.front().problem, o.problems);
  } else {
    writeProblems<D>(out.stream(), stored);
  }
  out.finish();
  std::printf("problems  %s\n", o.problems.c_str());
}

void recordScene(const RecordOptions& o, const Session& session) {
  if (o.hardest.has_value() == !o.steps.empty()) {
    throw UserError("lpc record keeps the problems of some steps; valid: either --steps 100,200 or --hardest 3");
  }
  for (const int step : o.steps) {
    if (step >= 0) continue;
    throw UserError("--steps: " + std::to_string(step) + " is no step; valid: numbers from 0");
  }
  if (isFclib(o.problems) && (o.hardest ? *o.hardest != 1 : o.steps.size() != 1)) {
    throw UserError(o.problems + ": a file of FCLIB holds one problem; valid: one step, --hardest 1, or a .json file");
  }
  NamedFiles inputs = {{"the scene", findToml("scenes", o.scene)}};
  for (const std::string& path : session.plugins) inputs.emplace_back("the plugin", path);
  keepApart(inputs, {{"--problems", o.problems}});
  WorldCell cell;
  cell.params = readParameters(o.params), cell.dimension = o.dimension, cell.pipeline = o.pipeline;
  cell.dt = o.dt, cell.steps = o.last, cell.seed = o.seed;
  Planner planner;
  const PlannedTrial trial = planner.world(o.scene, cell);
  if (!trial.unsupported.empty()) throw UserError(trial.unsupported);
  if (trial.canonical.contains("engine")) {
    throw UserError("an engine shows no velocity problems; valid: a pipeline of ours");
  }
  trial.canonical.at("dimension") == 2 ? record<2>(o, trial) : record<3>(o, trial);
}

void addRecord(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("record", "Writes the velocity problems of some steps of a scene into a file");
  auto o = std::make_shared<RecordOptions>();
  command.option("scene", o->scene, "name in experiments/scenes, or a TOML file").required();
  command.option("--problems", o->problems, "where to; docs/problems.md describes the file. NAME.hdf5: FCLIB's format")
      .required()
      .file();
  Option steps = command.option("--steps", o->steps, "those of these steps, the first being 0");
  steps.commaSeparated();
  Option hardest = command.option("--hardest", o->hardest,
                                  "of all steps those of which the step's own method left most unsolved, by the "
                                  "natural map");
  hardest.range(1L, 1000L).without(steps);
  command.option("--until", o->last, "with --hardest: number of steps; default: the scene's").with(hardest);
  command.option("--pipeline", o->pipeline, "algorithms of the run that is recorded");
  command.option("--param", o->params, "a parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)");
  command.option("--dt", o->dt, "length of a step (s); default: the scene's");
  command.option("--seed", o->seed, "of the scene's random numbers; default: the scene's")
      .range(0L, std::numeric_limits<long>::max());
  command.option("--dimension", o->dimension, "2 or 3; default: the scene's first");
  command.footer(
      "Example: lpc record vertical_stack --problems stack.json --steps 100,200\n"
      "         lpc record card_house --problems cards.json --hardest 3");
  command.callback([o, &session] { recordScene(*o, session); });
}

LPC_COMMAND("record", addRecord);

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
