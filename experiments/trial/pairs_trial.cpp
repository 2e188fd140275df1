// SPDX-License-Identifier: Zlib
// A pair query alone: the same seeded pairs for every method, its time per query, and its error before the referee.
#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/trial/pair_drawing.h"
#include "experiments/trial/pairs_metrics.h"
#include "experiments/trial/trial.h"
#include "framework/stage_narrowphase.h"
#include "oracles/verify.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using nlohmann::json;

template <int D>
PairView<D> viewOf(const DrawnPair<D>& pair) {
  return {pair.a.view(), pair.b.view(), pair.X_AB};
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
  const AlgorithmRole role = Registry::instance().find(StageKind::pairQuery, D, spec.name).info.role;
  // A witness works in a process of its own, where this thread's clock does not see it: it tells the time itself.
  const auto* witness = dynamic_cast<const Witness<D>*>(method.get());
  TrialResult out;
  if (!method->supports(kindA, kindB) || !kindExists(kindA, D) || !kindExists(kindB, D)) {
    out.fail("unsupported", t.at("kind_a").get<std::string>() + " against " + t.at("kind_b").get<std::string>(), 0);
    return out;
  }
  Random random(t.at("seed").get<std::uint64_t>());
  const Spec way = Spec::parse(t.value("drawing", std::string("in_turn")));
  const auto trueDistance = [](const DrawnPair<D>& pair) {
    return referee<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB).interval().middle();
  };
  std::vector<DrawnPair<D>> pairs;
  for (int i = 0; i < n; ++i) pairs.push_back(drawPair<D>(way, {kindA, kindB, i, trueDistance}, random));

  PairsSeen seen;
  seen.timed = t.value("timed", false), seen.asked = n;
  constexpr std::size_t kAtOnce = 1024;  // what is timed between two looks at the clock
  std::vector<PairView<D>> views;
  std::vector<PairAnswer<D>> answers;
  WorkDone work;
  XXH64_state_t* hash = XXH64_createState();
  XXH64_reset(hash, 0);
  for (std::size_t begin = 0; begin < pairs.size(); begin += kAtOnce) {
    const std::size_t end = std::min(pairs.size(), begin + kAtOnce);
    views.clear();
    for (std::size_t i = begin; i < end; ++i) views.push_back(viewOf(pairs[i]));
    answers.assign(views.size(), {});
    const int repeats = seen.timed && !witness ? 8 : 1;  // the first warms the caches
    for (int r = 0; r < repeats; ++r) {
      const double before = cpuSeconds();
      method->query(views, QueryNeed::witnesses, answers, {}, work);
      const double spent = witness ? static_cast<double>(witness->nanoseconds()) : 1e9 * (cpuSeconds() - before);
      if (r > 0 || witness) seen.nanoseconds.push_back(spent / static_cast<double>(end - begin));
    }
    for (std::size_t i = begin; i < end; ++i) {
      const PairAnswer<D>& answer = answers[i - begin];
      XXH64_update(hash, &answer.distance, sizeof answer.distance);
      const Ending ending = witness ? witness->endings()[i - begin] : Ending::answered;
      const PairView<D>& pair = views[i - begin];
      const Verdict verdict = judge(pair, pairTruth(pair), answer, role, ending, verifyTolerance(witness));
      if (verdict.error) seen.errors.push_back(*verdict.error);
      seen.wrong += verdict.end == Tally::wrong;
      seen.wrongSide += verdict.wrongSide;
      seen.refused += verdict.end == Tally::refused;
      seen.failed += endedWithoutAnswer(verdict.end);
    }
  }
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(XXH64_digest(hash)));
  XXH64_freeState(hash);
  out.hash = text;
  measure<PairsSeen>(
      pairsMetrics(), seen, [&](TrialNeed need) { return need != TrialNeed::timing || seen.timed; }, out.metrics);
  if (seen.wrong > 0) out.fail("wrong", std::to_string(static_cast<long>(seen.wrong)) + " wrong answers", 0);
  return out;
}

}  // namespace

TrialResult runPairsTrial(const json& request) {
  const json& t = request.at("trial");
  return t.at("dimension").get<int>() == 2 ? runPairs<2>(t) : runPairs<3>(t);
}

}  // namespace lpc::inline LPC_PRECISION
