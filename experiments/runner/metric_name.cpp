// SPDX-License-Identifier: Zlib
#include "experiments/runner/metric_name.h"

#include <algorithm>

#include "framework/math/work.h"

namespace lpc { inline namespace LPC_PRECISION {

std::vector<std::string> namesOf(const MetricInfo& info) {
  if (info.name != "work_*") return {std::string(info.name)};
  std::vector<std::string> out;
  for (const std::string_view count : kCountNames) out.push_back("work_" + std::string(count));
  return out;
}

bool isMetric(const MetricInfo& info, std::string_view name) {
  const std::vector<std::string> names = namesOf(info);
  return std::any_of(names.begin(), names.end(), [&](const std::string& known) {
    const std::string_view fixed(known.data(), known.size() - 1);
    return known == name || (known.ends_with('*') && name.size() > fixed.size() && name.starts_with(fixed));
  });
}

}}  // namespace lpc::LPC_PRECISION
