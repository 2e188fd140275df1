// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/metric.h"

namespace lpc { inline namespace LPC_PRECISION {

const DescribedMetric kLoad = {
    "metric",
    "any",
    {"load", "load average", "1", "processes that wanted a processor when the trial started, mean of a minute",
     MetricRole::detail, "a quieter machine", TrialNeed::timing}};

std::vector<DescribedMetric> describeMetrics() {
  std::vector<DescribedMetric> out;
  describeWorldMetrics(out);
  describeBoxesMetrics(out);
  describePairsMetrics(out);
  describeProblemsMetrics(out);
  out.push_back(kLoad);
  return out;
}

std::string_view needName(TrialNeed need) {
  switch (need) {
    case TrialNeed::nothing:
      return "";
    case TrialNeed::timing:
      return "timing";
    case TrialNeed::joints:
      return "joints";
    case TrialNeed::slope:
      return "slope";
    case TrialNeed::isolation:
      return "isolation";
    case TrialNeed::rest:
      return "rest";
    case TrialNeed::driftLimit:
      return "drift limit";
  }
  return "";
}

std::string_view roleName(MetricRole role) {
  switch (role) {
    case MetricRole::cost:
      return "cost";
    case MetricRole::error:
      return "error";
    case MetricRole::detail:
      return "detail";
  }
  return "";
}

double quantile(std::vector<double> values, double q) {
  const bool some = std::any_of(values.begin(), values.end(), [](double x) { return std::isnan(x); });
  if (values.empty() || some) return std::numeric_limits<double>::quiet_NaN();  // NaN cannot be ordered
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(i);
  return i + 1 < values.size() ? values[i] * (1 - share) + values[i + 1] * share : values[i];
}

}}  // namespace lpc::LPC_PRECISION
