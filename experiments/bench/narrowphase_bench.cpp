// SPDX-License-Identifier: Zlib
#include <cmath>

#include "experiments/bench/bench_groups.h"
#include "experiments/bench/pair_data.h"
#include "experiments/bench/pair_peers.h"
#include "experiments/bench/pair_proof.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {
namespace {

constexpr int kHullPoints[] = {8, 32, 128};

template <int D>
void runQuery(benchmark::State& state, const std::string& spec, ShapeKind kindA, ShapeKind kindB, QueryNeed need,
              bool oneByOne) {
  const PairData<D> data(kindA, kindB, static_cast<int>(state.range(0)));
  const std::size_t count = data.a.size();
  auto method = createStage<PairQuery<D>>(Spec::parse(spec));
  std::vector<PairView<D>> pairs;
  std::vector<PairAnswer<D>> answers(count);
  for (std::size_t k = 0; k < count; ++k)
    pairs.push_back({data.a[k].view(), data.b[k].view(), data.X_WA[k].inverse() * data.X_WB[k]});
  WorkDone work;
  const auto* witness = dynamic_cast<const Witness<D>*>(method.get());
  for (auto _ : state) {
    if (oneByOne) {
      for (std::size_t k = 0; k < count; ++k) method->query({&pairs[k], 1}, need, {&answers[k], 1}, {}, work);
    } else {
      method->query(pairs, need, answers, {}, work);
    }
    benchmark::ClobberMemory();
    if (witness) state.SetIterationTime(1e-9 * static_cast<double>(witness->nanoseconds()));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
  report(state, work, static_cast<double>(state.iterations()) * static_cast<double>(count));

  method->query(pairs, QueryNeed::closestPoints, answers, {}, work);
  PairProof<D> proof;
  proof.count(pairs, answers);
  proof.tell(state);
  state.counters["ns_per_pair"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(count) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <int D>
void runGenerator(benchmark::State& state, const std::string& spec, ShapeKind kindA, ShapeKind kindB) {
  const PairData<D> data(kindA, kindB, static_cast<int>(state.range(0)));
  const std::size_t count = data.a.size();
  auto method = createStage<ContactGenerator<D>>(Spec::parse(spec));
  std::vector<ShapeRecord<D>> shapes;
  std::vector<Pose<D>> poses;
  std::vector<ShapePair> pairs;
  for (std::size_t k = 0; k < count; ++k) {
    const auto slot = static_cast<std::int32_t>(shapes.size());
    for (const Shape<D>& shape : {data.a[k], data.b[k]}) {
      ShapeRecord<D> record;
      record.shape = shape, record.body = static_cast<std::int32_t>(shapes.size());
      shapes.push_back(record);
    }
    poses.push_back(data.X_WA[k]), poses.push_back(data.X_WB[k]);
    pairs.push_back({slot, slot + 1});
  }
  PartPairs<D> partPairs;
  WorkDone work;
  const auto convexPairs = partPairs.of(pairs, shapes, poses, Real(0.02), work);
  const ContactInput<D> input{convexPairs, shapes, poses, Real(0.02), true};
  std::vector<Manifold<D>> manifolds;
  for (auto _ : state) {
    manifolds.clear();
    method->generate(input, manifolds, work);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
  report(state, work, static_cast<double>(state.iterations()) * static_cast<double>(count));

  // A pair certainly overlaps when a centre lies in the other shape; then it must have a contact.
  std::vector<bool> touched(count);
  int points = 0, silent = 0;
  for (const Manifold<D>& m : manifolds) {
    touched[static_cast<std::size_t>(m.shapeA) / 2] = true;
    points += m.count;
  }
  for (std::size_t k = 0; k < count; ++k) {
    silent += !touched[k] && containsPoint(data.a[k].view(), data.X_WA[k], data.X_WB[k].p) &&
              containsPoint(data.b[k].view(), data.X_WB[k], data.X_WB[k].p);
  }
  state.counters["manifolds"] = static_cast<double>(manifolds.size());
  state.counters["points"] = points, state.counters["silent_overlaps"] = silent;
  state.counters["ns_per_pair"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(count) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

std::string kindText(ShapeKind a, ShapeKind b) {
  return std::string(shapeKindName(a)) + "-" + std::string(shapeKindName(b));
}

void addSizes(benchmark::internal::Benchmark* bench, AlgorithmRole role, int dimension, ShapeKind a, ShapeKind b) {
  // Witnesses run in a process of their own, where they measure their time.
  if (role == AlgorithmRole::witness) bench->UseManualTime();
  if (a != ShapeKind::polytope && b != ShapeKind::polytope) {
    bench->Arg(0);
    return;
  }
  for (int points : kHullPoints) {
    if (dimension == 3 || points <= 32) bench->Arg(points);
  }
}

template <int D, class Stage, class Add>
void forKinds(StageKind stage, Add add) {
  for (const Registered* algorithm : Registry::instance().list(stage, D)) {
    for (const std::string& spec : specsOf(*algorithm)) {
      const auto method = createStage<Stage>(Spec::parse(spec));
      for (int a = 0; a < kShapeKinds; ++a) {
        for (int b = a; b < kShapeKinds; ++b) {
          const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
          const bool exists = kindExists(kindA, D) && kindExists(kindB, D);
          if (exists && method->supports(kindA, kindB)) add(algorithm->info.role, spec, kindA, kindB);
        }
      }
    }
  }
}

template <int D>
void addQueries() {
  const std::string dimension = std::to_string(D) + "D/";
  forKinds<D, PairQuery<D>>(
      StageKind::pairQuery, [&](AlgorithmRole role, const std::string& spec, ShapeKind a, ShapeKind b) {
        struct Ask {
          QueryNeed need;
          const char* text;
          bool oneByOne = false;
        };
        static constexpr Ask kAsks[] = {{QueryNeed::boolean, "/boolean"},
                                        {QueryNeed::distance, "/distance"},
                                        {QueryNeed::closestPoints, "/witnesses"},
                                        {QueryNeed::closestPoints, "/witnesses_one_by_one", true}};
        for (const Ask& ask : kAsks) {
          if (ask.oneByOne && role == AlgorithmRole::witness)
            continue;  // its time would be that of the communication with its process
          const std::string name = "pair_query/" + dimension + spec + "/" + kindText(a, b) + ask.text;
          const auto run = [=](benchmark::State& state) { runQuery<D>(state, spec, a, b, ask.need, ask.oneByOne); };
          addSizes(benchmark::RegisterBenchmark(name.c_str(), run), role, D, a, b);
        }
      });
}

// Functions of other libraries called as their users call them, with prepared shapes. The witnesses' own times include
// two reads of the clock per pair.
void addPairPeers() {
  for (const PairPeerEntry& entry : pairPeers()) {
    for (const ShapeKind kind : entry.kinds) {
      const std::string name = "pair_query/3D/" + entry.name + "/" + kindText(kind, kind) + "/contacts";
      benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        const PairData<3> data(kind, kind, 0);
        const auto peer = entry.create(data);
        int overlaps = 0;
        for (auto _ : state) overlaps = peer->run();
        state.counters["overlaps"] = overlaps;
        state.counters["ns_per_pair"] =
            benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(data.a.size()) * 1e-9,
                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
      })->Arg(0);
    }
  }
}

template <int D>
void addGenerators() {
  const std::string dimension = std::to_string(D) + "D/";
  forKinds<D, ContactGenerator<D>>(
      StageKind::contacts, [&](AlgorithmRole role, const std::string& spec, ShapeKind a, ShapeKind b) {
        const std::string name = "contacts/" + dimension + spec + "/" + kindText(a, b);
        addSizes(benchmark::RegisterBenchmark(name.c_str(),
                                              [=](benchmark::State& state) { runGenerator<D>(state, spec, a, b); }),
                 role, D, a, b);
      });
}

}  // namespace

std::vector<PairPeerEntry>& pairPeers() {
  static std::vector<PairPeerEntry> peers;
  return peers;
}

void addPairQueries() {
  addQueries<2>();
  addQueries<3>();
  addPairPeers();
}
void addContactGenerators() {
  addGenerators<2>();
  addGenerators<3>();
}

}}}  // namespace lpc::LPC_PRECISION::bench
