// SPDX-License-Identifier: Zlib
// A velocity problem that is known only by its matrix, without bodies, as published collections store it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// u = W x + velocity. Row order: for each contact its normal and its D - 1 orthonormal tangents, then equality rows.
/// Laws and signs are those of ContactProblem: u_n > 0 separates. Double in either precision, as in ContactProblem.
struct GivenProblem {
  // W, symmetric, in compressed columns: column j is at start[j] to start[j + 1] - 1, by ascending row.
  IndexedVector<std::int32_t> start = {0}, row;
  IndexedVector<double> value;
  IndexedVector<double> friction;  // by contact
  IndexedVector<double> velocity;  // by row, minus the target; a resolver adds the effect of its impulses
  IndexedVector<double> impulse;   // by row: impulses of the last step; after a solve, the solution

  std::int32_t size() const { return static_cast<std::int32_t>(velocity.size()); }
  double at(std::int32_t i, std::int32_t j) const {
    const auto end = row.begin() + start[j + 1];
    const auto it = std::lower_bound(row.begin() + start[j], end, i);
    return it != end && *it == i ? value[it - row.begin()] : 0;
  }
  /// Calls f(row, value) for all entries of a column of W.
  template <class F>
  void eachOf(std::int32_t column, const F& f) const {
    const auto end = start[column + 1];
    for (auto k = start[column]; k < end; ++k) f(row[k], value[k]);
  }
};

}}  // namespace lpc::LPC_PRECISION
