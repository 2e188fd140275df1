// SPDX-License-Identifier: Zlib
// Separate from the trial: a program without the oracles cannot run trials of pairs, but its stores describe the same
// metrics.
#pragma once

#include <optional>
#include <span>

#include "experiments/trial/measure/metric.h"
#include "framework/math/work.h"

namespace lpc { inline namespace LPC_PRECISION {

struct PairsSeen {
  bool timed = false;
  double asked = 0, failed = 0, refused = 0, wrong = 0, wrongSide = 0, sideAlone = 0;
  std::vector<double> errors, nanoseconds;  // per answer; per batch, divided by its queries
  std::vector<double> singles;              // ns a query, of queries one by one
  double queries = 0;                       // including repeated queries for timing
  std::optional<WorkDone> work;             // over all of these; witnesses do not report it
};

std::span<const Measure<PairsSeen>> pairsMetrics();

}}  // namespace lpc::LPC_PRECISION
