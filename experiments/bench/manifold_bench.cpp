// SPDX-License-Identifier: Zlib
// Contacts of touching boxes and octagons in 2D: ours and the peers' on the same pairs, one after the other in one run.
// The group contacts/ has all kinds, half of them far apart; a step spends its time on touching pairs. Shapes, poses
// and pairs are prepared before, ours and the peers'. Ours writes whole manifolds: bodies, mixed friction, the normal
// in the world, points on both bodies and separations.
#include <cmath>

#include "experiments/bench/bench_groups.h"
#include "experiments/bench/manifold_peers.h"
#include "framework/math/random.h"
#include "framework/math/tolerances.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

std::vector<ManifoldPeerEntry>& manifoldPeers() {
  static std::vector<ManifoldPeerEntry> peers;
  return peers;
}

namespace {

constexpr int kPairs = 512;
constexpr double kTurn = 6.283185307179586;

/// Resting: an edge on an almost parallel edge, slightly less deep than the slop. Turned: at any angle, with centres at
/// a distance at which most overlap slightly.
enum class Touch { resting, turned };

/// Regular polygons with the inner radius 1/2 m. Two consecutive entries are a pair.
struct TouchingPairs {
  std::vector<Shape<2>> shapes;
  std::vector<Pose<2>> poses;

  TouchingPairs(int corners, Touch touch) {
    Random random(7);
    const double inner = 0.5, outer = inner / std::cos(kTurn / 2 / corners);
    std::vector<Vec<2>> points;
    for (int k = 0; k < corners; ++k)
      points.push_back(Rot<2>::angle(kTurn * (k + 0.5) / corners) * Vec<2>(Real(outer), 0));
    const Shape<2> shape = corners == 4 ? Shape<2>::box({Real(inner), Real(inner)}) : Shape<2>::polytope(points);
    for (int k = 0; k < kPairs; ++k) {
      const double side = kTurn / corners * std::floor(random.uniform(0, corners));
      Pose<2> X_WA, X_AB;
      X_WA.p = {Real(random.uniform(-9, 9)), Real(random.uniform(-9, 9))};
      X_WA.q = Rot<2>::angle(random.uniform(-3, 3));
      if (touch == Touch::resting) {
        const Vec<2> along(Real(2 * inner - 0.8 * double(kLinearSlop)), Real(0.2 * random.uniform(-1, 1)));
        X_AB.p = Rot<2>::angle(side) * along;
        X_AB.q = Rot<2>::angle(1e-3 * random.uniform(-1, 1) + kTurn / corners * std::floor(random.uniform(0, corners)));
      } else {
        const Vec<2> away(Real(random.uniform(2 * inner - 0.05, inner + outer)), 0);
        X_AB.p = Rot<2>::angle(random.uniform(-3, 3)) * away;
        X_AB.q = Rot<2>::angle(random.uniform(-3, 3));
      }
      shapes.insert(shapes.end(), {shape, shape});
      poses.insert(poses.end(), {X_WA, X_WA * X_AB});
    }
  }
};

void tell(benchmark::State& state, int points) {
  state.SetItemsProcessed(state.iterations() * kPairs);
  state.counters["points"] = points;
  state.counters["ns_per_pair"] = benchmark::Counter(static_cast<double>(state.iterations()) * kPairs * 1e-9,
                                                     benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void runGenerator(benchmark::State& state, const std::string& spec, int corners, Touch touch) {
  const TouchingPairs data(corners, touch);
  auto method = createStage<ContactGenerator<2>>(Spec::parse(spec));
  std::vector<ShapeRecord<2>> shapes;
  std::vector<ShapePair> pairs;
  for (int k = 0; k < 2 * kPairs; ++k) {
    ShapeRecord<2> record;
    record.shape = data.shapes[static_cast<std::size_t>(k)], record.body = k;
    shapes.push_back(record);
    if (k % 2 == 1) pairs.push_back({k - 1, k});
  }
  PartPairs<2> partPairs;
  WorkDone work;
  const auto convexPairs = partPairs.of(pairs, shapes, data.poses, kContactMargin, work);
  const ContactInput<2> input{convexPairs, shapes, data.poses, kContactMargin, true};
  std::vector<Manifold<2>> manifolds;
  work = WorkDone{};
  for (auto _ : state) {
    manifolds.clear();
    method->generate(input, manifolds, work);
    benchmark::ClobberMemory();
  }
  report(state, work, static_cast<double>(state.iterations()) * kPairs);
  int points = 0;
  for (const Manifold<2>& m : manifolds) points += m.count;
  tell(state, points);
}

void runPeer(benchmark::State& state, const ManifoldPeerEntry& entry, int corners, Touch touch) {
  const TouchingPairs data(corners, touch);
  const auto peer = entry.create();
  peer->build(data.shapes, data.poses);
  int points = 0;
  for (auto _ : state) {
    points = peer->collide();
    benchmark::ClobberMemory();
  }
  tell(state, points);
}

}  // namespace

void addManifolds() {
  for (const int corners : {4, 8}) {
    for (const Touch touch : {Touch::resting, Touch::turned}) {
      const std::string input = std::string(corners == 4 ? "/box-box" : "/octagon-octagon") +
                                (touch == Touch::resting ? "/resting" : "/turned");
      for (const ManifoldPeerEntry& peer : manifoldPeers()) {
        benchmark::RegisterBenchmark(("manifolds/2D/" + peer.name + input).c_str(),
                                     [=](benchmark::State& state) { runPeer(state, peer, corners, touch); });
      }
      for (const Registered* algorithm : Registry::instance().list(StageKind::contacts, 2)) {
        const std::string spec = algorithm->info.name;
        benchmark::RegisterBenchmark(("manifolds/2D/" + spec + input).c_str(),
                                     [=](benchmark::State& state) { runGenerator(state, spec, corners, touch); });
      }
    }
  }
}

}}}  // namespace lpc::LPC_PRECISION::bench
