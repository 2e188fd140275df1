// SPDX-License-Identifier: Zlib
// Apart from the trial: a program without the oracles runs no trial of pairs, but its stores describe the same metrics.
#pragma once

#include <optional>
#include <span>

#include "experiments/trial/measure/metric.h"
#include "framework/math/work.h"

namespace lpc { inline namespace LPC_PRECISION {

struct PairsSeen {
  bool timed = false;
  double asked = 0, failed = 0, refused = 0, wrong = 0, wrongSide = 0, sideAlone = 0;
  std::vector<double> errors, nanoseconds;  // of answers; of batches, per query
  std::vector<double> singles;              // ns a query, of queries one by one
  double queries = 0;                       // those that were asked again to be timed, too
  std::optional<WorkDone> work;             // in all of these; a witness does not tell it
};

std::span<const Measure<PairsSeen>> pairsMetrics();

}}  // namespace lpc::LPC_PRECISION
