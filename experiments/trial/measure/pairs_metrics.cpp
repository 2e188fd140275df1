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
    {{"ns_per_query", "time per query", "ns", "processor time per pair of shapes, measured in batches",
      MetricRole::cost, "cheaper", TrialNeed::timing},
     [](SeenPairs s) { return quantile(s.nanoseconds, 0.5); }},
    {{"ns_single", "time of a single query", "ns",
      "processor time of a single query, including two clock readings: as external libraries are measured",
      MetricRole::cost, "cheaper", TrialNeed::timing},
     [](SeenPairs s) { return quantile(s.singles, 0.5); }},
    {{"max_error", "worst error", "1", "largest error of the distance or depth, over the size of the query",
      MetricRole::error, "more exact"},
     [](SeenPairs s) { return quantile(s.errors, 1); }},
    {{"p99_error", "error of 99 of 100", "1", "99th percentile of the error, over the size of the query",
      MetricRole::error, "more exact"},
     [](SeenPairs s) { return quantile(s.errors, 0.99); }},
    {{"median_error", "median error", "1", "median error of the distance or depth, over the size of the query",
      MetricRole::error, "more exact"},
     [](SeenPairs s) { return quantile(s.errors, 0.5); }},
    {{"failed", "without an answer", "1", "queries that ended without an answer", MetricRole::error,
      "fewer without an answer"},
     [](SeenPairs s) { return s.failed; }},
    {{"wrong_boolean", "wrong yes or no", "1", "queries with a provably wrong overlap answer", MetricRole::error,
      "fewer wrong answers"},
     [](SeenPairs s) { return s.wrongSide; }},
    {{"wrong", "wrong answers", "1",
      "answers that the referee proves wrong: overlap wrong, or error above 1e-12 (f32: 1e-5) of the size",
      MetricRole::error, "fewer wrong answers"},
     [](SeenPairs s) { return s.wrong; }},
    {{"side_alone", "judged by the side alone", "1",
      "queries checked for overlap only, because the method claims no distance for separated shapes",
      MetricRole::detail, ""},
     [](SeenPairs s) { return s.sideAlone; }},
    {{"refused", "refused", "1", "queries refused although the method declares their shapes", MetricRole::error,
      "fewer without an answer"},
     [](SeenPairs s) { return s.refused; }},
    {{"support_calls", "support points", "1", "support points per query, mean: a cost without timing noise",
      MetricRole::detail, "cheaper"},
     [](SeenPairs s) { return workPerQuery(s, WorkCount::supportCalls); }},
    {{"axis_tests", "axis tests", "1", "separating axes tested per query, mean: a cost without timing noise",
      MetricRole::detail, "cheaper"},
     [](SeenPairs s) { return workPerQuery(s, WorkCount::axisTests); }},
    {{"polytope_faces", "faces of EPA", "1", "EPA faces created per query, mean: a cost without timing noise",
      MetricRole::detail, "cheaper"},
     [](SeenPairs s) { return workPerQuery(s, WorkCount::polytopeFaces); }},
    {{"asked", "queries", "1", "queries checked by the referee; of a stream only a sample", MetricRole::detail, ""},
     [](SeenPairs s) { return s.asked; }},
};

}  // namespace

std::span<const Measure<PairsSeen>> pairsMetrics() { return kPairsMetrics; }

void describePairsMetrics(std::vector<DescribedMetric>& out) {
  for (const auto& entry : kPairsMetrics) out.push_back({"metric", "pairs", entry.info});
}

}}  // namespace lpc::LPC_PRECISION
