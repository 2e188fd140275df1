// SPDX-License-Identifier: Zlib
// Trials describe their own measurements: each metric and each series is one entry in the table of its kind
// (world_metrics.cpp, boxes_trial.cpp, pairs_metrics.cpp, problems_metrics.cpp), with a description and a function.
// Stores contain the descriptions.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What a trial must have; otherwise the metric is undefined (NaN).
enum class TrialNeed {
  nothing,
  timing,      // a timed trial; other trials omit the metric
  joints,      // a scene with joints
  slope,       // a scene with a body on a slope: [measures.slope]
  isolation,   // free bodies alone in space: no gravity, no forces, no fixed body
  driftLimit,  // a scene with a limit of drift: [limits] drift
  rest,        // a scene that rests at its end: [limits] levels
};
/// Which metrics a chart chooses by default: costs and errors.
enum class MetricRole { cost, error, detail };

struct MetricInfo {
  std::string_view name;   // never changes: result files contain it; a trailing * stands for several names
  std::string_view title;  // axis label
  std::string_view unit;   // "1" for a number
  std::string_view meaning;
  MetricRole role;
  /// What a smaller value means; empty if neither good nor bad. Among errors with the same meaning a chart takes the
  /// first.
  std::string_view smaller;
  TrialNeed need = TrialNeed::nothing;
};

/// `Seen` holds the observations of one kind of trial. With a null `value` the trial itself writes the names that the
/// star stands for.
template <class Seen>
struct Measure {
  MetricInfo info;
  double (*value)(const Seen&);
};

/// Evaluates each entry on `seen`. `applies(need)` tells whether the trial meets an entry's need.
template <class Seen, class Entries, class Applies>
void measure(const Entries& entries, const Seen& seen, const Applies& applies, std::map<std::string, double>& out) {
  for (const Measure<Seen>& m : entries) {
    if (!m.value || (m.info.need == TrialNeed::timing && !applies(TrialNeed::timing))) continue;
    out[std::string(m.info.name)] = applies(m.info.need) ? m.value(seen) : std::numeric_limits<double>::quiet_NaN();
  }
}

struct DescribedMetric {
  std::string_view what;  // "metric" or "series"
  std::string_view kind;  // of trial; or "any"
  MetricInfo info;
};

/// Added by the runner to every timed trial of any kind.
extern const DescribedMetric kLoad;

/// All metrics, the most telling of each kind first.
std::vector<DescribedMetric> describeMetrics();
std::string_view needName(TrialNeed need);
std::string_view roleName(MetricRole role);

void describeWorldMetrics(std::vector<DescribedMetric>& out);
void describeBoxesMetrics(std::vector<DescribedMetric>& out);
void describePairsMetrics(std::vector<DescribedMetric>& out);
void describeProblemsMetrics(std::vector<DescribedMetric>& out);

/// The q-quantile of the values, 0.5 for the median; NaN if there are none.
double quantile(std::vector<double> values, double q);

}}  // namespace lpc::LPC_PRECISION
