// SPDX-License-Identifier: Zlib
// Entries that stand for several metrics: `work_*`, `us_*`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/trial/measure/metric.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The names for which an entry stands. The star remains if methods define the names, as for `us_*`.
std::vector<std::string> namesOf(const MetricInfo& info);
/// Whether the entry is that metric, or has a star that stands for it.
bool isMetric(const MetricInfo& info, std::string_view name);

}}  // namespace lpc::LPC_PRECISION
