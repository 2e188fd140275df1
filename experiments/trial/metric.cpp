// SPDX-License-Identifier: Zlib
#include "experiments/trial/metric.h"

namespace lpc::inline LPC_PRECISION {

std::vector<DescribedMetric> describeMetrics() {
  std::vector<DescribedMetric> out;
  describeWorldMetrics(out);
  describeBoxesMetrics(out);
  describePairsMetrics(out);
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

}  // namespace lpc::inline LPC_PRECISION
