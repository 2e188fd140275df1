// SPDX-License-Identifier: Zlib
// Records velocity problems of a running scene, and pairs of shapes that came near each other.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/plugin_probe.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/formats/fclib_file.h"
#include "experiments/trial/formats/output_file.h"
#include "experiments/trial/formats/pair_stream.h"
#include "experiments/trial/formats/problem_file.h"
#include "framework/problem/contact_problem.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

/// Both ends are included.
struct StepRange {
  long from, to;
};

struct RecordOptions {
  std::string scene, pipeline, problems, pairs;
  std::vector<std::string> params, stepTexts;
  std::optional<int> dimension, hardest;
  std::optional<double> dt;
  std::optional<long> last;
  std::optional<std::uint64_t> seed;
  std::vector<StepRange> steps;  // parsed from stepTexts

  bool asks(long step) const {
    return std::any_of(steps.begin(), steps.end(), [&](const StepRange& r) { return r.from <= step && step <= r.to; });
  }
  long lastAsked() const {
    long out = -1;
    for (const StepRange& r : steps) out = std::max(out, r.to);
    return out;
  }
};

/// Largest number of pairs in a file: 60 MB in 3D.
constexpr std::size_t kMostPairPoses = 1000000;

/// "100" or "100:200".
StepRange stepRange(const std::string& text) {
  StepRange out{};
  const char *at = text.data(), *const end = at + text.size();
  const auto read = [&](long& step) {
    const auto [after, error] = std::from_chars(at, end, step);
    at = after;
    return error == std::errc() && step >= 0 && step <= std::numeric_limits<int>::max();
  };
  bool right = read(out.from);
  out.to = out.from;
  if (right && at != end && *at == ':') ++at, right = read(out.to);
  if (!right || at != end || out.to < out.from) {
    throw UserError("--steps: '" + text +
                    "' is not a list of steps; valid: numbers from 0 and ranges, such as 100,200 or 0:99");
  }
  return out;
}

bool isFclib(const std::string& path) { return path.ends_with(".hdf5"); }

// Keeps the problem of a step, the last one if the step has several, until the residual of its solution is known.
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
  /// Residual of the last step, m/s. Precondition: the step had a problem.
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

/// The world of a trial with its script.
template <int D>
struct RecordedRun {
  explicit RecordedRun(const PlannedTrial& trial)
      : RecordedRun(trial.world(), SceneFile::load(trial.request.sceneFile)) {}
  RecordedRun(const WorldRequest& asked, const SceneFile& file)
      : scene(file.name()),
        dt(static_cast<Real>(asked.dt)),
        steps(asked.steps),
        director(specOf(asked, file)),
        world(Pipeline::parse(asked.pipeline), director.scene().settings) {}

  std::string scene;
  Real dt;
  long steps;
  Director<D> director;
  World<D> world;

 private:
  static SceneSpec<D> specOf(const WorldRequest& asked, const SceneFile& file) {
    SceneSpec<D> spec = file.build<D>(asked.params, asked.seed);
    spec.settings.model = modelFromText(asked.features);
    return spec;
  }
};

template <int D>
void recordProblems(const RecordOptions& o, const PlannedTrial& trial) {
  RecordedRun<D> run(trial);
  World<D>& world = run.world;
  ProblemWatcher<D> watcher(world.settings().gravity);
  world.watch(&watcher);
  struct Kept {
    double residual;
    StoredProblem<D> stored;
  };
  std::vector<Kept> kept;
  long shown = 0;
  const long steps = o.hardest ? run.steps : o.lastAsked() + 1;
  OutputFile out(o.problems);  // not after hours of running
  const InterruptGuard interrupts;
  for (long step = 0; step < steps; ++step) {
    if (InterruptGuard::interrupted()) throw Interrupted();
    run.director.advance(world);
    world.step(run.dt);
    std::optional<FrozenProblem<D>> problem = watcher.take();
    if (!problem) continue;
    ++shown;
    if (!o.hardest && !o.asks(step)) continue;
    const double residual = watcher.residual();
    if (!std::isfinite(residual)) break;  // no method could solve later problems
    kept.push_back({residual, {run.scene, step, std::move(*problem)}});
    if (!o.hardest || kept.size() <= static_cast<std::size_t>(*o.hardest)) continue;
    kept.erase(std::min_element(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) {
      return a.residual < b.residual || (a.residual == b.residual && a.stored.step > b.stored.step);
    }));
  }
  if (shown == 0) {
    throw UserError("no step of '" + o.scene +
                    "' has a velocity problem: no contacts or joints, or a solver without a separate velocity " +
                    "stage; valid: a scene with contacts or joints, solver=split_solver{...}");
  }
  if (o.hardest && kept.empty())
    throw UserError("'" + o.scene + "' diverges in its first step; valid: a run that stays finite");
  for (const StepRange& r : o.steps) {
    const auto has = [&](const Kept& k) { return r.from <= k.stored.step && k.stored.step <= r.to; };
    if (std::any_of(kept.begin(), kept.end(), has)) continue;
    const std::string which = r.from == r.to ? "step " + std::to_string(r.from)
                                             : "steps " + std::to_string(r.from) + " to " + std::to_string(r.to);
    throw UserError("--steps: in " + which + " of '" + o.scene +
                    "' there is nothing to solve; valid: steps with contacts or joints of a run that stays finite");
  }
  std::vector<StoredProblem<D>> stored;
  const double gravity = double(world.settings().gravity.norm());
  for (Kept& k : kept) {
    std::printf("step %-6ld %4d bodies %4d points %3zu joints   residual of its own method: ", k.stored.step,
                k.stored.problem.bodies.size(), k.stored.problem.points(), k.stored.problem.joints.size());
    gravity > 0 ? std::printf("%.3g g dt\n", k.residual / (gravity * double(run.dt)))
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

template <int D>
void recordPairs(const RecordOptions& o, const PlannedTrial& trial) {
  RecordedRun<D> run(trial);
  PairCollector<D> collector(run.scene, run.dt, run.world.settings().margin);
  const long steps = o.steps.empty() ? run.steps : o.lastAsked() + 1;
  OutputFile out(o.pairs);  // not after hours of running
  const InterruptGuard interrupts;
  bool full = false;
  for (long step = 0; step < steps && !full; ++step) {
    if (InterruptGuard::interrupted()) throw Interrupted();
    run.director.advance(run.world);
    if (o.steps.empty() || o.asks(step)) full = !collector.see(run.world, step, kMostPairPoses);
    if (!full && step + 1 < steps) run.world.step(run.dt);
  }
  const PairStream<D>& stream = collector.stream();
  const std::string most = std::to_string(kMostPairPoses);
  if (full && !o.steps.empty()) {
    throw UserError("--steps: these steps of '" + o.scene + "' have more than " + most +
                    " pairs, the most that a file holds; valid: fewer steps, or a smaller scene");
  }
  if (stream.pairPoses.empty()) {
    throw UserError("no boxes of '" + o.scene +
                    "' come near each other in these steps; valid: steps with close pairs of shapes");
  }
  writePairs<D>(out.stream(), stream);
  out.finish();
  std::printf("%zu steps, %zu pairs in total, %zu distinct pairs, %zu shapes%s\npairs  %s\n", stream.steps.size(),
              stream.pairPoses.size(), stream.pairs.size(), stream.shapes.size(),
              full ? (": the next step would exceed " + most).c_str() : "", o.pairs.c_str());
}

void recordScene(RecordOptions& o, const Session& session) {
  for (const std::string& text : o.stepTexts) o.steps.push_back(stepRange(text));
  const bool ofPairs = !o.pairs.empty();
  if (o.problems.empty() != ofPairs) {
    throw UserError("lpc record writes one file; valid: either --problems FILE or --pairs FILE");
  }
  if (!ofPairs && o.hardest.has_value() == !o.steps.empty()) {
    throw UserError("--problems needs a choice of steps; valid: either --steps 100,200 or --hardest 3");
  }
  const bool isOne = o.steps.size() == 1 && o.steps[0].from == o.steps[0].to;
  if (isFclib(o.problems) && (o.hardest ? *o.hardest != 1 : !isOne)) {
    throw UserError(o.problems + ": an FCLIB file holds one problem; valid: one step, --hardest 1, or a .json file");
  }
  NamedFiles inputs = {{"the scene", findToml("scenes", o.scene)}};
  for (const std::string& path : session.plugins) inputs.emplace_back("the plugin", path);
  keepApart(inputs, {{"--problems", o.problems}, {"--pairs", o.pairs}});
  WorldCell cell;
  cell.params = readParameters(o.params), cell.dimension = o.dimension, cell.pipeline = o.pipeline;
  cell.dt = o.dt, cell.steps = o.last, cell.seed = o.seed;
  Planner planner;
  const PlannedTrial trial = planner.world(o.scene, cell);
  if (!trial.unsupported.empty()) throw UserError(trial.unsupported);
  requireCheckedConstructors();
  if (trial.request.ofEngine()) {
    throw UserError("an engine gives no access to velocity problems and pairs; valid: a pipeline of LPC's stages");
  }
  const bool flat = trial.asked().dimension == 2;
  if (ofPairs) {
    flat ? recordPairs<2>(o, trial) : recordPairs<3>(o, trial);
  } else {
    flat ? recordProblems<2>(o, trial) : recordProblems<3>(o, trial);
  }
}

void addRecord(CommandLine& app, Session& session) {
  CommandLine command =
      app.subcommand("record", "Writes velocity problems or pairs of shapes from steps of a scene into a file");
  auto o = std::make_shared<RecordOptions>();
  command.option("scene", o->scene, "name in experiments/scenes, or a TOML file").required();
  Option problems = command.option("--problems", o->problems,
                                   "file for velocity problems (format: docs/problems.md); NAME.hdf5: FCLIB's format");
  problems.file();
  Option pairs = command.option(
      "--pairs", o->pairs,
      "file for pairs of convex parts with close boxes, step by step; without --steps all steps, up to 1000000 pairs");
  pairs.file().without(problems);
  Option steps = command.option("--steps", o->stepTexts, "steps to write, such as 100,200 or 0:99; the first is 0");
  steps.commaSeparated();
  Option hardest = command.option(
      "--hardest", o->hardest,
      "number of steps to write: those with the largest residual (natural map) after the run's own method");
  hardest.range(1L, 1000L).without(steps).without(pairs);
  command.option("--until", o->last, "with --hardest: length of the run in steps; default: the scene's").with(hardest);
  command.option("--pipeline", o->pipeline, "algorithms of the recorded run");
  command.option("--param", o->params, "a parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)");
  command.option("--dt", o->dt, "length of a step (s); default: the scene's");
  command.option("--seed", o->seed, "seed of the scene's random numbers; default: the scene's")
      .range(0L, std::numeric_limits<long>::max());
  command.option("--dimension", o->dimension, "2 or 3; default: the scene's first");
  command.footer(
      "Example: lpc record vertical_stack --problems stack.json --steps 100,200\n"
      "         lpc record card_house --problems cards.json --hardest 3\n"
      "         lpc record vertical_stack --pairs stack.pairs --steps 0:99");
  command.callback([o, &session] { recordScene(*o, session); });
}

LPC_COMMAND("record", addRecord);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
