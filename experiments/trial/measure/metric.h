// SPDX-License-Identifier: Zlib
// What trials measure describes itself: each metric and each series is one entry of its kind's table
// (world_metrics.cpp, boxes_trial.cpp, pairs_metrics.cpp, problems_metrics.cpp), which says what it is and computes it.
// The words travel with the store.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What a trial must have, or the metric is not defined for it (NaN).
enum class TrialNeed {
  nothing,
  timing,      // a timed trial; others do not hold the metric at all
  joints,      // a scene with joints
  slope,       // a scene that says which body slides down which slope: [measures.slope]
  isolation,   // free bodies alone in space: no gravity, no forces, nobody fixed
  driftLimit,  // a scene that says how far bodies may drift: [limits] drift
  rest,        // a scene that rests at its end: [limits] levels
};
/// What a chart that is given nothing else takes first: costs and errors.
enum class MetricRole { cost, error, detail };

struct MetricInfo {
  std::string_view name;   // stable for ever: it stands in result files; with * at its end one of several
  std::string_view title;  // for an axis
  std::string_view unit;   // "1" for a number
  std::string_view meaning;
  MetricRole role;
  /// What a smaller value means; empty where it means neither good nor bad. Of the errors with one meaning a chart
  /// takes the first.
  std::string_view smaller;
  TrialNeed need = TrialNeed::nothing;
};

/// `Seen` is what a trial of one kind has seen. A null `value`: the trial itself writes what the star stands for.
template <class Seen>
struct Measure {
  MetricInfo info;
  double (*value)(const Seen&);
};

/// What `seen` says to each entry. `applies(need)` tells whether it has what an entry needs.
template <class Seen, class Entries, class Applies>
void measure(const Entries& entries, const Seen& seen, const Applies& applies, std::map<std::string, double>& out) {
  for (const Measure<Seen>& m : entries) {
    if (!m.value || (m.info.need == TrialNeed::timing && !applies(TrialNeed::timing))) continue;
    out[std::string(m.info.name)] = applies(m.info.need) ? m.value(seen) : std::numeric_limits<double>::quiet_NaN();
  }
}

struct DescribedMetric {
  std::string_view what;  // "metric" or "series"
  std::string_view kind;  // of trial; "any"
  MetricInfo info;
};

/// What the runner adds to every timed trial, whatever its kind.
extern const DescribedMetric kLoad;

/// All of them, of each kind those that tell most first.
std::vector<DescribedMetric> describeMetrics();
std::string_view needName(TrialNeed need);
std::string_view roleName(MetricRole role);

void describeWorldMetrics(std::vector<DescribedMetric>& out);
void describeBoxesMetrics(std::vector<DescribedMetric>& out);
void describePairsMetrics(std::vector<DescribedMetric>& out);
void describeProblemsMetrics(std::vector<DescribedMetric>& out);

/// The q-th part of the values in order, 0.5 for the median; NaN for none.
double quantile(std::vector<double> values, double q);

}}  // namespace lpc::LPC_PRECISION
