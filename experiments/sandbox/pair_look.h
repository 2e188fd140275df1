// SPDX-License-Identifier: Zlib
// The trace of a pair query on two bodies of a world, cached while its input is unchanged: a trace may have a thousand
// steps, and a window draws sixty pictures a second.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/stage/pair_trace.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class PairLook {
 public:
  /// Traces the two parts of these bodies (slots) with the nearest centres. Repeats the query only if query, shapes or
  /// poses differ from the last call.
  void look(const std::string& query, const Simulation<D>& world, std::int32_t a, std::int32_t b);
  /// There is no pair; `why` is the reason.
  void nobody(std::string why);

  const PairTrace<D>* trace() const { return m_trace ? &*m_trace : nullptr; }
  const Pose<D>& X_WA() const { return m_X_WA; }      // of the trace's A
  const std::string& says() const { return m_says; }  // why there is no trace
  std::size_t found() const;                          // the first step with the answer's axis
  long made() const { return m_made; }                // number of traces made

 private:
  // A copy of a shape keeps its hull, to which a trace points.
  using Placed = std::pair<Shape<D>, Pose<D>>;
  struct Asked {
    std::string query;
    std::vector<Placed> a, b;  // X_WS
  };
  static bool same(const std::vector<Placed>& one, const std::vector<Placed>& other);

  std::optional<Asked> m_asked;
  std::optional<PairTrace<D>> m_trace;
  Pose<D> m_X_WA;
  std::string m_says;
  long m_made = 0;
};

}}  // namespace lpc::LPC_PRECISION
