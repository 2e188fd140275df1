// SPDX-License-Identifier: Zlib
// Pair queries on the recorded pairs of a world, in its order: resting pairs, new and ended ones, nearly at their poses
// of the step before. The group pair_query/ has random pairs, each alone.
#include <map>
#include <memory>

#include "experiments/bench/bench_groups.h"
#include "experiments/bench/pair_proof.h"
#include "experiments/trial/scene/scene_file.h"
#include "experiments/trial/stream_replay.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {
namespace {

constexpr std::size_t kMostPairPoses = 300000;

/// Small enough to be recorded in seconds. Skips the first steps, in which bodies fall freely.
struct StreamScene {
  const char* name;
  ParameterValues params;
  long from, steps;
};
const StreamScene kStreamScenes[] = {{"box_pile", {{"n", 200.}}, 90, 60},
                                     {"convex_pile", {{"columns", 3.}, {"layers", 12.}}, 90, 60},
                                     {"vertical_stack", {}, 60, 60},
                                     {"tumbler", {{"n", 16.}}, 120, 60},
                                     {"rain", {{"columns", 4.}}, 200, 60}};

template <int D>
SceneSpec<D> specOf(const StreamScene& scene, const SceneFile& file) {
  return file.build<D>(scene.params, 1);
}

SceneFile fileOf(const StreamScene& scene) {
  return SceneFile::load(LPC_SOURCE_DIR "/experiments/scenes/" + std::string(scene.name) + ".toml");
}

/// Recorded when the first benchmark needs it.
template <int D>
const StreamReplay<D>& replayOf(const StreamScene& scene) {
  static std::map<std::string, std::unique_ptr<StreamReplay<D>>> known;
  std::unique_ptr<StreamReplay<D>>& at = known[scene.name];
  if (!at) {
    at = std::make_unique<StreamReplay<D>>(
        recordStream<D>(scene.name, specOf<D>(scene, fileOf(scene)), scene.from, scene.steps, kMostPairPoses));
  }
  return *at;
}

template <int D>
void runStream(benchmark::State& state, const std::string& spec, const StreamScene& scene, bool warm) {
  const StreamReplay<D>& replay = replayOf<D>(scene);
  if (replay.views.empty()) return state.SkipWithError("no bounding boxes come near each other");
  auto method = createStage<PairQuery<D>>(Spec::parse(spec));
  const auto* witness = dynamic_cast<const Witness<D>*>(method.get());
  std::vector<PairAnswer<D>> answers(replay.views.size());
  WorkDone work;
  const auto ask = [&] {
    std::int64_t nanoseconds = 0;
    askStream<D>(*method, replay, warm, answers, work, [&](const auto&) {
      if (witness) nanoseconds += witness->nanoseconds();
    });
    return nanoseconds;
  };
  for (auto _ : state) {
    const std::int64_t nanoseconds = ask();
    benchmark::ClobberMemory();
    if (witness) state.SetIterationTime(1e-9 * static_cast<double>(nanoseconds));
  }
  const double asked = static_cast<double>(state.iterations()) * static_cast<double>(replay.views.size());
  state.SetItemsProcessed(static_cast<std::int64_t>(asked));
  report(state, work, asked);
  PairProof<D> proof;
  proof.count(replay.views, answers);
  proof.tell(state);
  state.counters["pairs"] = static_cast<double>(replay.views.size());
  state.counters["ns_per_pair"] =
      benchmark::Counter(asked * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Whether it supports every two kinds that may meet in the scene.
template <int D>
bool supportsAll(const PairQuery<D>& method, const SceneSpec<D>& spec) {
  std::array<bool, kShapeKinds> all{}, moving{};
  for (const auto& spawn : spec.spawns) {
    for (const ShapeDef<D>& s : spawn.body.shapes) {
      markKinds(s.shape, all);
      if (spawn.body.type == BodyType::dynamic) markKinds(s.shape, moving);
    }
  }
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = a; b < all.size(); ++b) {
      const bool meet = (all[a] && moving[b]) || (moving[a] && all[b]);
      if (meet && !method.supports(static_cast<ShapeKind>(a), static_cast<ShapeKind>(b))) return false;
    }
  }
  return true;
}

template <int D>
void addStreamsOf(const StreamScene& scene) {
  const SceneFile file = fileOf(scene);
  if (!file.has(D)) return;
  const SceneSpec<D> spec = specOf<D>(scene, file);
  for (const Registered* algorithm : Registry::instance().list(StageKind::pairQuery, D)) {
    for (const std::string& text : specsOf(*algorithm)) {
      const auto method = createStage<PairQuery<D>>(Spec::parse(text));
      if (!supportsAll(*method, spec)) continue;
      for (const bool warm : {false, true}) {
        if (warm && !method->remembers()) continue;
        const std::string name = "streams/" + std::to_string(D) + "D/" + scene.name + "/" + text;
        auto* bench = benchmark::RegisterBenchmark(
            (name + (warm ? "/warm" : "/cold")).c_str(),
            [=, &scene](benchmark::State& state) { runStream<D>(state, text, scene, warm); });
        // Witnesses run in a process of their own, where they measure their time.
        if (algorithm->info.role == AlgorithmRole::witness) bench->UseManualTime();
      }
    }
  }
}

}  // namespace

void addStreams() {
  for (const StreamScene& scene : kStreamScenes) {
    addStreamsOf<2>(scene);
    addStreamsOf<3>(scene);
  }
}

}}}  // namespace lpc::LPC_PRECISION::bench
