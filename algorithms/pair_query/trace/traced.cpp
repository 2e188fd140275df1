// SPDX-License-Identifier: Zlib
// Traced instantiations, kept out of the untraced inlining.
#include "algorithms/pair_query/gjk/gjk_epa.h"
#include "algorithms/pair_query/sat/sat_answers.h"
#include "algorithms/pair_query/trace/tracer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D>
void traceGjkEpa(const GjkEpaParams<D>& params, const PairView<D>& pair, PairTrace<D>& out) {
  ++out.work[WorkCount::pairQueries];
  out.answer =
      GjkEpaSearch<D, Tracer<D>>(params, Tracer<D>(out)).answer(pair, QueryNeed::closestPoints, nullptr, out.work);
}

template <int D>
void traceSat(const PairView<D>& pair, PairTrace<D>& out) {
  ++out.work[WorkCount::pairQueries];
  SatAnswers<D, Tracer<D>>(Tracer<D>(out)).answer(pair, QueryNeed::closestPoints, nullptr, out.answer, out.work);
}

template void traceGjkEpa(const GjkEpaParams<2>&, const PairView<2>&, PairTrace<2>&);
template void traceGjkEpa(const GjkEpaParams<3>&, const PairView<3>&, PairTrace<3>&);
template void traceSat(const PairView<2>&, PairTrace<2>&);
template void traceSat(const PairView<3>&, PairTrace<3>&);

}}}  // namespace lpc::LPC_PRECISION::pair_query
