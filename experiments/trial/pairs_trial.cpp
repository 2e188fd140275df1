// SPDX-License-Identifier: Zlib
// A pair query alone: the same seeded pairs for every method, its time per query, and its error before the referee.
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/trial/metric.h"
#include "experiments/trial/trial.h"
#include "framework/curved_core.h"
#include "framework/random.h"
#include "framework/stage_narrowphase.h"
#include "framework/support_map.h"
#include "oracles/verify.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using nlohmann::json;

struct PairsSeen {
  bool timed = false;
  double asked = 0, failed = 0, refused = 0, wrong = 0;
  std::vector<double> errors, nanoseconds;  // of answers; of batches, per query
};

using S = const PairsSeen&;
const Measure<PairsSeen> kMetrics[] = {
    {{"ns_per_query", "time per query", "ns", "processor time of one pair of shapes, in batches", MetricRole::cost,
      "cheaper", TrialNeed::timing},
     [](S s) { return quantile(s.nanoseconds, 0.5); }},
    {{"max_error", "worst error", "1", "worst error of the distance or depth, over the size of the query",
      MetricRole::error, "more exact"},
     [](S s) { return quantile(s.errors, 1); }},
    {{"p99_error", "error of 99 of 100", "1", "99 of 100 queries stay below it, over the size of the query",
      MetricRole::error, "more exact"},
     [](S s) { return quantile(s.errors, 0.99); }},
    {{"median_error", "median error", "1", "of the distance or depth, over the size of the query", MetricRole::error,
      "more exact"},
     [](S s) { return quantile(s.errors, 0.5); }},
    {{"failed", "without an answer", "1", "queries that ended without an answer", MetricRole::error,
      "fewer without an answer"},
     [](S s) { return s.failed; }},
    {{"wrong_boolean", "wrong yes or no", "1", "queries whose yes or no is certainly wrong", MetricRole::error,
      "fewer wrong answers"},
     [](S s) { return s.wrong; }},
    {{"refused", "refused", "1", "queries of declared shapes that were refused", MetricRole::error,
      "fewer without an answer"},
     [](S s) { return s.refused; }},
    {{"asked", "queries", "1", "queries asked", MetricRole::detail, ""}, [](S s) { return s.asked; }},
};

template <int D>
struct Pair {
  Shape<D> a, b;
  Pose<D> X_AB;

  PairView<D> view() const { return {a.view(), b.view(), X_AB}; }
};

template <int D>
Shape<D> drawShape(ShapeKind kind, double size, Random& random) {
  const auto length = [&] { return static_cast<Real>(size * random.uniform(0.2, 1)); };
  switch (coreClass(kind)) {
    case CoreClass::point:
      return Shape<D>::sphere(length());
    case CoreClass::segment: {
      if (kind == ShapeKind::segment) return Shape<D>::segment(length());
      const Real half = length();
      return Shape<D>::capsule(half, length() / 2);
    }
    case CoreClass::box: {
      Vec<D> half;
      for (int d = 0; d < D; ++d) half[d] = length();
      return Shape<D>::box(half);
    }
    case CoreClass::curved: {
      std::vector<Real> sizes;
      for (std::size_t i = 0; i < curvedKind<D>(kind).sizes.size(); ++i) sizes.push_back(length());
      return Shape<D>::curved(kind, sizes);
    }
    case CoreClass::plane:
      return Shape<D>::plane();
    case CoreClass::hull:
      break;
  }
  std::vector<Vec<D>> points;
  for (int i = 0; i < 12; ++i) {
    Vec<D> p;
    for (int d = 0; d < D; ++d) p[d] = static_cast<Real>(size * random.uniform(-1, 1));
    points.push_back(p);
  }
  return Shape<D>::polytope(points);
}

Rot<2> drawRotation2(Random& random) { return Rot<2>::angle(random.uniform(-3.14159, 3.14159)); }
Rot<3> drawRotation3(Random& random) {
  return Rot<3>::vector(Vec<3>(Real(random.uniform(-3, 3)), Real(random.uniform(-3, 3)), Real(random.uniform(-3, 3))));
}

// Six families in turn: apart, near each other, touching within 1e-9, overlapping, centres together, and faces
// parallel. They are where methods differ (RELIABILITY: touching, deep, parallel); every third round has sizes 1 : 100.
template <int D>
Pair<D> drawPair(ShapeKind kindA, ShapeKind kindB, int index, Random& random) {
  const int family = index % 6;
  const double sizeB = index / 6 % 3 == 2 ? 0.01 : 1;
  Pair<D> pair{drawShape<D>(kindA, 1, random), drawShape<D>(kindB, sizeB, random), {}};
  Rot<D> q;
  if constexpr (D == 2) {
    q = drawRotation2(random);
  } else {
    q = drawRotation3(random);
  }
  if (family != 5) pair.X_AB.q = q;
  Vec<D> direction = Vec<D>::Zero();
  for (int d = 0; d < D; ++d) direction[d] = static_cast<Real>(random.uniform(-1, 1));
  if (!(direction.norm() > Real(1e-3))) direction[0] = 1;
  if (family == 5) direction = Vec<D>::Unit(static_cast<int>(random.below(D)));
  direction.normalize();
  const Real reach = boundingRadius(pair.a.view()) + boundingRadius(pair.b.view());
  const double places[] = {random.uniform(1.1, 4), random.uniform(0.8, 1.2), 1, random.uniform(0.1, 0.8), 0, 1};
  pair.X_AB.p = direction * (reach * static_cast<Real>(places[family]));
  if (family == 2 || family == 5) {  // move along the line until the distance is about zero
    for (int turn = 0; turn < 40; ++turn) {
      const double gap = referee<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB).interval().middle();
      if (std::abs(gap) < 1e-9) break;
      pair.X_AB.p -= direction * static_cast<Real>(gap);
    }
  }
  return pair;
}

bool endedWithoutAnswer(Tally end) {
  return end == Tally::notFinite || end == Tally::threw || end == Tally::crashed || end == Tally::hung;
}

template <int D>
TrialResult runPairs(const json& t) {
  const ShapeKind kindA = shapeKindFromName(t.at("kind_a").get<std::string>());
  const ShapeKind kindB = shapeKindFromName(t.at("kind_b").get<std::string>());
  const int n = t.at("n").get<int>();
  const Spec spec = Spec::parse(t.at("pair_query").get<std::string>());
  const auto method = createStage<PairQuery<D>>(spec);
  const Role role = Registry::instance().find(StageKind::pairQuery, D, spec.name).info.role;
  // A witness works in a process of its own, where this thread's clock does not see it: it tells the time itself.
  const auto* witness = dynamic_cast<const Witness<D>*>(method.get());
  TrialResult out;
  if (!method->supports(kindA, kindB) || !kindExists(kindA, D) || !kindExists(kindB, D)) {
    out.fail("unsupported", t.at("kind_a").get<std::string>() + " against " + t.at("kind_b").get<std::string>(), 0);
    return out;
  }
  Random random(t.at("seed").get<std::uint64_t>());
  std::vector<Pair<D>> pairs;
  for (int i = 0; i < n; ++i) pairs.push_back(drawPair<D>(kindA, kindB, i, random));

  PairsSeen seen;
  seen.timed = t.value("timed", false), seen.asked = n;
  const auto batch = std::make_unique<PairBatch<D>>();
  const auto answers = std::make_unique<PairAnswers<D>>();
  Work work;
  XXH64_state_t* hash = XXH64_createState();
  XXH64_reset(hash, 0);
  for (std::size_t begin = 0; begin < pairs.size(); begin += PairBatch<D>::kCapacity) {
    const std::size_t end = std::min(pairs.size(), begin + PairBatch<D>::kCapacity);
    batch->clear(kindA, kindB);
    for (std::size_t i = begin; i < end; ++i) batch->add(pairs[i].a.view(), pairs[i].b.view(), pairs[i].X_AB);
    const int repeats = seen.timed && !witness ? 8 : 1;  // the first warms the caches
    for (int r = 0; r < repeats; ++r) {
      const double before = cpuSeconds();
      method->query(*batch, Need::witnesses, *answers, {}, work);
      const double spent = witness ? static_cast<double>(witness->nanoseconds()) : 1e9 * (cpuSeconds() - before);
      if (r > 0 || witness) seen.nanoseconds.push_back(spent / static_cast<double>(end - begin));
    }
    for (std::size_t i = begin; i < end; ++i) {
      const PairAnswer<D> answer = answers->get(static_cast<int>(i - begin));
      XXH64_update(hash, &answer.distance, sizeof answer.distance);
      const Ending ending = witness ? witness->endings()[i - begin] : Ending::answered;
      const PairView<D> pair = pairs[i].view();
      const Verdict verdict = judge(pair, pairTruth(pair), answer, role, ending);
      if (verdict.error) seen.errors.push_back(*verdict.error);
      seen.wrong += verdict.wrongSide;
      seen.refused += verdict.end == Tally::refused;
      seen.failed += endedWithoutAnswer(verdict.end);
    }
  }
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(XXH64_digest(hash)));
  XXH64_freeState(hash);
  out.hash = text;
  measure<PairsSeen>(
      kMetrics, seen, [&](TrialNeed need) { return need != TrialNeed::timing || seen.timed; }, out.metrics);
  if (seen.wrong > 0) out.fail("wrong", std::to_string(static_cast<long>(seen.wrong)) + " wrong yes or no", 0);
  return out;
}

}  // namespace

void describePairsMetrics(std::vector<DescribedMetric>& out) {
  for (const auto& entry : kMetrics) out.push_back({"metric", "pairs", entry.info});
}

TrialResult runPairsTrial(const json& request) {
  const json& t = request.at("trial");
  return t.at("dimension").get<int>() == 2 ? runPairs<2>(t) : runPairs<3>(t);
}

}  // namespace lpc::inline LPC_PRECISION
