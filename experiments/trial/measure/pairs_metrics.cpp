// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/pairs_metrics.h"

#include "experiments/trial/measure/metric.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using SeenPairs = const PairsSeen&;

double workPerQuery(SeenPairs s, WorkCount count) {
  return s.work ? static_cast<double>((*s.work)[count]) / s.queries : std::numeric_limits<double>::quiet_NaN();
}

const Measure<PairsSeen> kPairsMetrics[] = {
    {{"ns_per_query", "time per query", "ns", "processor time of one pair of shapes, in batches", MetricRole::cost,
      "cheaper", TrialNeed::timing},
     [](SeenPairs s) { return quantile(s.nanoseconds, 0.5); }},
    {{"ns_single", "time of a single query", "ns",
      "of one pair of shapes by itself, between two readings of the clock, which are in it: as libraries are asked",
      MetricRole::cost, "cheaper", TrialNeed::timing},
     [](SeenPairs s) { return quantile(s.singles, 0.5); }},
    {{"max_error", "worst error", "1", "worst error of the distance or depth, over the size of the query",
      MetricRole::error, "more exact"},
     [](SeenPairs s) { return quantile(s.errors, 1); }},
    {{"p99_error", "error of 99 of 100", "1", "99 of 100 queries stay below it, over the size of the query",
      MetricRole::error, "more exact"},
     [](SeenPairs s) { return quantile(s.errors, 0.99); }},
    {{"median_error", "median error", "1", "of the distance or depth, over the size of the query", MetricRole::error,
      "more exact"},
     [](SeenPairs s) { return quantile(s.errors, 0.5); }},
    {{"failed", "without an answer", "1", "queries that ended without an answer", MetricRole::error,
      "fewer without an answer"},
     [](SeenPairs s) { return s.failed; }},
    {{"wrong_boolean", "wrong yes or no", "1", "queries whose yes or no is certainly wrong", MetricRole::error,
      "fewer wrong answers"},
     [](SeenPairs s) { return s.wrongSide; }},
    {{"wrong", "wrong answers", "1",
      "answers that the referee proves wrong: on the wrong side, or off by more than 1e-12 (f32: 1e-5) of the size",
      MetricRole::error, "fewer wrong answers"},
     [](SeenPairs s) { return s.wrong; }},
    {{"side_alone", "judged by the side alone", "1",
      "queries about shapes that the method says are apart, and whose distance it does not claim", MetricRole::detail,
      ""},
     [](SeenPairs s) { return s.sideAlone; }},
    {{"refused", "refused", "1", "queries of declared shapes that were refused", MetricRole::error,
      "fewer without an answer"},
     [](SeenPairs s) { return s.refused; }},
    {{"support_calls", "support points", "1", "support points computed for a query, mean: a cost without noise",
      MetricRole::detail, "cheaper"},
     [](SeenPairs s) { return workPerQuery(s, WorkCount::supportCalls); }},
    {{"axis_tests", "axis tests", "1", "separating axes projected for a query, mean: a cost without noise",
      MetricRole::detail, "cheaper"},
     [](SeenPairs s) { return workPerQuery(s, WorkCount::axisTests); }},
    {{"polytope_faces", "faces of EPA", "1", "faces that EPA made for a query, mean: a cost without noise",
      MetricRole::detail, "cheaper"},
     [](SeenPairs s) { return workPerQuery(s, WorkCount::polytopeFaces); }},
    {{"asked", "queries", "1", "queries that were judged: of a stream one in so many", MetricRole::detail, ""},
     [](SeenPairs s) { return s.asked; }},
};

}  // namespace

std::span<const Measure<PairsSeen>> pairsMetrics() { return kPairsMetrics; }

void describePairsMetrics(std::vector<DescribedMetric>& out) {
  for (const auto& entry : kPairsMetrics) out.push_back({"metric", "pairs", entry.info});
}

}}  // namespace lpc::LPC_PRECISION
