// SPDX-License-Identifier: Zlib
#include <sstream>

#include "experiments/bench/bench_groups.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {
namespace {

constexpr int kSettle = 30, kSteps = 60;
constexpr Real kDt = Real(1) / 60;

// The field's standard pyramid: unit boxes, gaps of 0.1 m between neighbours and none between rows, friction 0.6.
template <int D>
void buildPyramid(World<D>& world, int base) {
  const auto add = [&](BodyType type, const Vec<D>& at, const Vec<D>& half) {
    BodyDef<D> body;
    body.type = type, body.X_WB.p = at;
    ShapeDef<D> shape;
    shape.shape = Shape<D>::box(half), shape.friction = Real(0.6);
    body.shapes.push_back(shape);
    world.add(body);
  };
  Vec<D> ground = Vec<D>::Constant(Real(2 * base)), under = Vec<D>::Zero();
  ground[1] = Real(0.5), under[1] = Real(-0.5);
  add(BodyType::fixed, under, ground);
  for (int row = 0; row < base; ++row) {
    for (int k = 0; k < base - row; ++k) {
      Vec<D> at = Vec<D>::Zero();
      at[0] = Real(1.1) * (static_cast<Real>(k) - static_cast<Real>(base - row - 1) / 2);
      at[1] = Real(0.5) + static_cast<Real>(row);
      add(BodyType::dynamic, at, Vec<D>::Constant(Real(0.5)));
    }
  }
}

double secondsOf(const Profiler::Frame& frame, std::string_view stage) {
  for (const Profiler::Time& t : frame.times) {
    if (t.name == stage) return t.seconds;
  }
  return 0;
}

// Every method starts from the same state, settled by the default pipeline, and returns to it after a second.
template <int D>
void runSolver(benchmark::State& state, const std::string& solver) {
  try {
    WorldSettings<D> settings;
    settings.model.sleeping = false;
    World<D> first(Pipeline{}, settings);
    buildPyramid(first, static_cast<int>(state.range(0)));
    for (int k = 0; k < kSettle; ++k) first.step(kDt);
    std::stringstream start;
    first.save(start);

    Pipeline pipeline;
    pipeline[StageKind::solver] = Spec::parse(solver);
    World<D> world(pipeline, settings);
    WorkDone work;
    double steps = 0, points = 0, whole = 0, moved = 0;
    for (auto _ : state) {
      const bool reload = world.bodyCount() == 0 || world.stepCount() == kSettle + kSteps;
      if (reload) {
        std::istringstream in(start.str());
        world.load(in);
      }
      world.step(kDt);
      const Profiler::Frame& frame = world.profiler().frame();
      state.SetIterationTime(secondsOf(frame, "solver"));
      for (std::size_t k = 0; k < work.counts.size(); ++k) work.counts[k] += frame.work.counts[k];
      steps += 1, points += frame.points, whole += frame.seconds;
      for (std::size_t i = 0; i < static_cast<std::size_t>(world.bodies().size()); ++i) {
        moved = std::max(moved, static_cast<double>((world.bodies().pose[i].p - first.bodies().pose[i].p).norm()));
      }
    }
    report(state, work, steps);
    state.counters["points"] = points / steps;
    state.counters["whole_step_us"] = 1e6 * whole / steps;
    state.counters["moved_m"] =
        moved;  // largest motion of a body within the second: almost nothing if the method is right
  } catch (const UserError& error) {
    state.SkipWithError(error.what());
  }
}

template <int D>
void addSolvers() {
  std::vector<std::string> specs;
  for (const Registered* solver : Registry::instance().list(StageKind::solver, D)) {
    for (const std::string& spec : specsOf(*solver)) specs.push_back(spec);
    for (const ParamInfo& p : solver->params) {  // a solver with stages of its own runs with each of their methods
      if (!p.stage) continue;
      for (const Registered* part : Registry::instance().list(p.stage->kind, D)) {
        specs.push_back(solver->info.name + "{" + p.name + "=" + part->info.name + "}");
      }
    }
  }
  for (const std::string& spec : specs) {
    const std::string name = "solver/" + std::to_string(D) + "D/" + spec + "/pyramid";
    benchmark::RegisterBenchmark(name.c_str(), [spec](benchmark::State& state) { runSolver<D>(state, spec); })
        ->Arg(10)
        ->Arg(20)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace

void addSolvers() {
  addSolvers<2>();
  addSolvers<3>();
}

}}}  // namespace lpc::LPC_PRECISION::bench
