// SPDX-License-Identifier: Zlib
// Entries that stand for several metrics: `work_*`, `us_*`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/trial/measure/metric.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The names that an entry stands for. A star stays where methods name what they do: of `us_*`.
std::vector<std::string> namesOf(const MetricInfo& info);
/// Is it that metric, or one that its star stands for?
bool isMetric(const MetricInfo& info, std::string_view name);

}}  // namespace lpc::LPC_PRECISION
