// SPDX-License-Identifier: Zlib
// The axes of one pair, shared by the answers (sat.cpp) and the traced search (traced.cpp).
#pragma once

#include "algorithms/pair_query/core/plane_pair.h"
#include "algorithms/pair_query/sat/sat_boxes.h"
#include "algorithms/pair_query/sat/sat_polytope3.h"
#include "framework/stage/pair_trace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// PairQuery::trace.
template <int D>
void traceSat(const PairView<D>& pair, PairTrace<D>& out);

namespace {  // as in gjk_epa.h

template <int D, class Watch>
class SatAnswers {
 public:
  explicit SatAnswers(const Watch& watch = {}) : m_watch(watch), m_polytope(watch) {}

  /// `memory` may be null. Always inlined: a call would cost 2D boxes 2 % of the instructions.
  __attribute__((always_inline)) void answer(const PairView<D>& view, QueryNeed need, PairMemory* memory,
                                             PairAnswer<D>& out, WorkDone& work) {
    const CorePair<D> pair(view);
    if (hasPlane(pair.a.kind, pair.b.kind)) {
      out = m_plane.answer(pair, need, work);
      return;
    }
    BestAxis<D> best;
    if (pair.a.hull || pair.b.hull) {
      m_polytope.run(pair, need, memory, best, work);
    } else {
      SatBoxes<D, Watch>(pair, need, best, work, m_watch).run();
    }
    finishAnswer<D>(pair, best, QueryStatus::converged, need, m_touching, out, work);
    m_watch([&](auto& t) { t.refined(pair, best, "between the features that touch"); });
  }

 private:
  [[no_unique_address]] Watch m_watch;
  PlanePair<D> m_plane;
  SatPolytope<D, Watch> m_polytope;
  TouchingPoint m_touching;
};

}  // namespace

}}}  // namespace lpc::LPC_PRECISION::pair_query
