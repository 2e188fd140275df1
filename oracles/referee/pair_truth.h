// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/stage/stage_narrowphase.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Allowed error of an answer, relative to the pair's `errorScale`: 1e-12; in single precision 1e-5.
constexpr double pairTolerance(bool inFloat = sizeof(Real) == sizeof(float)) { return inFloat ? 1e-5 : 1e-12; }

/// Ground truth of a pair.
template <int D>
struct PairTruth {
  RefereeAnswer<D> answer = {};
  double s = 0, posed = 0;  // errorScale, posedScale
};
template <int D>
PairTruth<D> pairTruth(const PairView<D>& pair);

}}  // namespace lpc::LPC_PRECISION
