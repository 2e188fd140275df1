// SPDX-License-Identifier: Zlib
// Pair queries on the pairs that a world asks about, in the order in which it does: what rests, comes and goes, and is
// nearly where it was in the step before. The group pair_query/ has random pairs, each by itself.
#include <algorithm>
#include <map>
#include <memory>

#include "experiments/bench/bench_groups.h"
#include "experiments/bench/pair_proof.h"
#include "experiments/trial/pair_stream.h"
#include "experiments/trial/scene_file.h"
#include "framework/director.h"
#include "framework/world.h"
#include "oracles/witness.h"

namespace lpc::inline LPC_PRECISION::bench {
namespace {

constexpr std::size_t kMostMeetings = 300000;

/// Small enough to be recorded in seconds. The first steps, in which bodies fall freely, are left out.
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

/// The views of a stream, as a generator hands them over: in each step by pair of kinds.
template <int D>
struct Replay {
  struct Batch {
    std::size_t begin, count;
    long step;
  };
  PairStream<D> stream;
  std::vector<PairView<D>> views;
  std::vector<std::uint32_t> pairs;  // number of each view's
  std::vector<Batch> batches;

  explicit Replay(const PairStream<D>& recorded) : stream(recorded) {
    auto begin = stream.meetings.begin();
    const auto kindsOf = [&](const typename PairStream<D>::Meeting& m) {
      const PairView<D> v = stream.view(m);
      return std::pair(v.a.kind, v.b.kind);
    };
    for (const auto& step : stream.steps) {
      const auto end = begin + static_cast<std::ptrdiff_t>(step.meetings);
      std::stable_sort(begin, end, [&](const auto& p, const auto& q) { return kindsOf(p) < kindsOf(q); });
      for (auto m = begin; m != end; ++m) {
        if (m == begin || kindsOf(*m) != kindsOf(*(m - 1))) batches.push_back({views.size(), 0, step.step});
        ++batches.back().count;
        views.push_back(stream.view(*m)), pairs.push_back(m->pair);
      }
      begin = end;
    }
  }
};

/// Recorded when the first benchmark needs it.
template <int D>
const Replay<D>& replayOf(const StreamScene& scene) {
  static std::map<std::string, std::unique_ptr<Replay<D>>> known;
  std::unique_ptr<Replay<D>>& at = known[scene.name];
  if (at) return *at;
  Director<D> director(specOf<D>(scene, fileOf(scene)));
  const Real dt = director.scene().dt;
  World<D> world(Pipeline{}, director.scene().settings);
  PairCollector<D> collector(scene.name, dt, world.settings().margin);
  for (long step = 0; step < scene.from + scene.steps; ++step) {
    director.advance(world);
    if (step >= scene.from && !collector.see(world, step, kMostMeetings)) break;
    world.step(dt);
  }
  at = std::make_unique<Replay<D>>(collector.stream());
  return *at;
}

/// What is remembered of each pair, as long as it is there in every step; as World keeps its records.
class Memories {
 public:
  explicit Memories(std::size_t pairs) : m_of(pairs) {}

  std::span<PairMemory> recall(std::span<const std::uint32_t> pairs, long step) {
    m_batch.clear();
    for (const std::uint32_t p : pairs) m_batch.push_back(m_of[p].step == step - 1 ? m_of[p].memory : PairMemory{});
    return m_batch;
  }
  void keep(std::span<const std::uint32_t> pairs, long step) {
    for (std::size_t k = 0; k < pairs.size(); ++k) m_of[pairs[k]] = {m_batch[k], step};
  }

 private:
  struct Kept {
    PairMemory memory{};
    long step = -2;
  };
  std::vector<Kept> m_of;
  std::vector<PairMemory> m_batch;
};

template <int D>
void runStream(benchmark::State& state, const std::string& spec, const StreamScene& scene, bool warm) {
  const Replay<D>& replay = replayOf<D>(scene);
  if (replay.views.empty()) return state.SkipWithError("no boxes come near each other");
  auto method = createStage<PairQuery<D>>(Spec::parse(spec));
  const auto* witness = dynamic_cast<const Witness<D>*>(method.get());
  std::vector<PairAnswer<D>> answers(replay.views.size());
  WorkDone work;
  const auto ask = [&] {
    std::int64_t nanoseconds = 0;
    Memories memories(replay.stream.pairs.size());
    for (const auto& batch : replay.batches) {
      const std::span pairs = std::span(replay.pairs).subspan(batch.begin, batch.count);
      const std::span<PairMemory> memory = warm ? memories.recall(pairs, batch.step) : std::span<PairMemory>();
      method->query(std::span(replay.views).subspan(batch.begin, batch.count), QueryNeed::witnesses,
                    std::span(answers).subspan(batch.begin, batch.count), memory, work);
      if (warm) memories.keep(pairs, batch.step);
      if (witness) nanoseconds += witness->nanoseconds();
    }
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

/// Whether it takes every two kinds that may meet in the scene.
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
        // Witnesses work in a process of their own, where they take their time themselves.
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

}  // namespace lpc::inline LPC_PRECISION::bench
