// SPDX-License-Identifier: Zlib
// A broadphase alone, on a recorded stream of boxes: every method gets the same bits, and each frame's pairs are
// compared with the result of a sweep in this file that uses no registered algorithm.
#include <xxhash.h>

#include <algorithm>
#include <cstdio>

#include "experiments/trial/box_distribution.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/trial.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kWarmUpFrames = 10;  // frames that are not timed
constexpr double kFrameDt = 1.0 / 60;

/// Counts and times per frame.
struct BoxesSeen {
  bool timed = false;
  std::vector<double> nanoseconds, found, tests, visits;
  double wrong = 0;
};

double mean(const std::vector<double>& list) {
  double sum = 0;
  for (double x : list) sum += x;
  return list.empty() ? 0 : sum / static_cast<double>(list.size());
}

using S = const BoxesSeen&;
const Measure<BoxesSeen> kMetrics[] = {
    {{"ns_per_frame_median", "time per frame", "ns", "processor time of update and findPairs for one frame, median",
      MetricRole::cost, "cheaper", TrialNeed::timing},
     [](S s) { return quantile(s.nanoseconds, 0.5); }},
    {{"box_tests_mean", "box tests per frame", "1", "overlap tests between boxes per frame", MetricRole::cost,
      "cheaper"},
     [](S s) { return mean(s.tests); }},
    {{"wrong_pairs", "wrong pairs", "1", "missing and extra pairs, compared with the test of all pairs",
      MetricRole::error, "fewer wrong pairs"},
     [](S s) { return s.wrong; }},
    {{"node_visits_mean", "visits per frame", "1", "tree nodes or grid cells visited per frame", MetricRole::detail,
      "cheaper"},
     [](S s) { return mean(s.visits); }},
    {{"pairs_mean", "pairs per frame", "1", "overlapping pairs per frame", MetricRole::detail, ""},
     [](S s) { return mean(s.found); }},
    {{"ns_per_frame_p25", "time per frame, lower quartile", "ns", "25th percentile of the time per frame",
      MetricRole::detail, "cheaper", TrialNeed::timing},
     [](S s) { return quantile(s.nanoseconds, 0.25); }},
    {{"ns_per_frame_p75", "time per frame, upper quartile", "ns", "75th percentile of the time per frame",
      MetricRole::detail, "cheaper", TrialNeed::timing},
     [](S s) { return quantile(s.nanoseconds, 0.75); }},
};

template <int D>
std::vector<ProxyPair> allPairs(const Proxies<D>& proxies) {
  std::vector<ProxyPair> out;
  // Sorted by the first axis: brute force would take n^2 for ten thousand boxes in every frame.
  std::vector<ProxyId> order(static_cast<std::size_t>(proxies.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<ProxyId>(i);
  const auto& lo = proxies.lo[0];
  const auto at = [](ProxyId i) { return static_cast<std::size_t>(i); };
  std::sort(order.begin(), order.end(), [&](ProxyId a, ProxyId b) { return lo[at(a)] < lo[at(b)]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size() && lo[at(order[j])] <= proxies.hi[0][at(order[i])]; ++j) {
      const ProxyId a = std::min(order[i], order[j]), b = std::max(order[i], order[j]);
      if (proxies.boxesOverlap(a, b) && proxies.mayCollide(a, b)) out.push_back({a, b});
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

template <int D>
TrialResult runBoxes(const BoxesRequest& asked) {
  const int n = asked.n, frames = asked.frames;
  const Spec distribution = Spec::parse(asked.distribution), spec = Spec::parse(asked.broadphase);
  const auto method = createStage<Broadphase<D>>(spec);
  const Guarantee guarantee = Registry::instance().find(StageKind::broadphase, D, spec.name).info.guarantee;

  MovingBoxes<D> boxes = makeMovingBoxes<D>(distribution, n, asked.seed);
  Proxies<D> proxies;
  proxies.resize(n);
  std::vector<ProxyId> everyone;
  for (ProxyId i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    everyone.push_back(i);
    proxies.body[k] = i, proxies.active[k] = 1, proxies.category[k] = 1, proxies.mask[k] = ~0u;
  }
  TrialResult out;
  BoxesSeen seen;
  seen.timed = asked.timed;
  std::vector<ProxyPair> pairs;
  XXH64_state_t* hash = XXH64_createState();
  XXH64_reset(hash, 0);
  for (int frame = 0; frame < frames; ++frame) {
    for (ProxyId i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      proxies.setBox(i, {boxes.place[k].array() - boxes.half[k], boxes.place[k].array() + boxes.half[k]});
    }
    ProxyChanges changes;
    (frame == 0 ? changes.added : changes.moved) = everyone;
    pairs.clear();
    WorkDone work;
    const double before = cpuSeconds();
    method->update(proxies, changes);
    method->findPairs(proxies, pairs, work);
    const double after = cpuSeconds();
    if (frame >= kWarmUpFrames) seen.nanoseconds.push_back(1e9 * (after - before));
    seen.found.push_back(static_cast<double>(pairs.size()));
    seen.tests.push_back(static_cast<double>(work[WorkCount::boxTests]));
    seen.visits.push_back(static_cast<double>(work[WorkCount::nodeVisits]));
    std::sort(pairs.begin(), pairs.end());
    XXH64_update(hash, pairs.data(), pairs.size() * sizeof(ProxyPair));
    const std::vector<ProxyPair> right = allPairs(proxies);
    std::vector<ProxyPair> missing, extra;
    std::set_difference(right.begin(), right.end(), pairs.begin(), pairs.end(), std::back_inserter(missing));
    std::set_difference(pairs.begin(), pairs.end(), right.begin(), right.end(), std::back_inserter(extra));
    if (guarantee == Guarantee::conservative) extra.clear();
    seen.wrong += static_cast<double>(missing.size() + extra.size());
    if (out.outcome == "ok" && !(missing.empty() && extra.empty())) {
      const ProxyPair first = missing.empty() ? extra[0] : missing[0];
      out.fail("wrong",
               std::to_string(missing.size()) + " pairs missing, " + std::to_string(extra.size()) +
                   " extra; first: " + std::to_string(first.a) + "-" + std::to_string(first.b),
               frame);
    }
    boxes.advance(kFrameDt);
  }
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(XXH64_digest(hash)));
  XXH64_freeState(hash);
  out.hash = text;
  measure<BoxesSeen>(
      kMetrics, seen, [&](TrialNeed need) { return need != TrialNeed::timing || seen.timed; }, out.metrics);
  return out;
}

}  // namespace

void describeBoxesMetrics(std::vector<DescribedMetric>& out) {
  for (const auto& entry : kMetrics) out.push_back({"metric", "boxes", entry.info});
}

TrialResult runBoxesTrial(const BoxesRequest& asked) {
  return asked.dimension == 2 ? runBoxes<2>(asked) : runBoxes<3>(asked);
}

}}  // namespace lpc::LPC_PRECISION
