// SPDX-License-Identifier: Zlib
#include "oracles/referee/pair_truth.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
PairTruth<D> pairTruth(const PairView<D>& pair) {
  PairTruth<D> known{.answer = referee<D>(pair.a, {}, pair.b, pair.X_AB)};
  const double phi = known.answer.interval().middle();
  known.s = errorScale<D>(pair.a, {}, pair.b, pair.X_AB, phi), known.posed = posedScale<D>(pair.a, pair.b, phi);
  return known;
}

template PairTruth<2> pairTruth(const PairView<2>&);
template PairTruth<3> pairTruth(const PairView<3>&);

}}  // namespace lpc::LPC_PRECISION
