// SPDX-License-Identifier: Zlib
// A velocity problem of which nothing is known but its matrix: what others publish, and no bodies that it came from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// u = W x + velocity, rows in the order: of each contact its normal and its D - 1 tangents, which are at right angles
/// and measure alike, then those of equalities. The laws are those of ContactProblem; the signs, too: u_n > 0 parts.
/// All of it is double in either precision, as is that of ContactProblem.
struct GivenProblem {
  // W, symmetric, in compressed columns: those of column j are at start[j] to start[j + 1], by rising row.
  IndexedVector<std::int32_t> start = {0}, row;
  IndexedVector<double> value;
  IndexedVector<double> friction;  // by contact
  IndexedVector<double> velocity;  // by row, less what is wanted; with the impulses that a resolver has given
  IndexedVector<double> impulse;   // by row: of the last step, and after a solve its answer

  std::int32_t size() const { return static_cast<std::int32_t>(velocity.size()); }
  double at(std::int32_t i, std::int32_t j) const {
    const auto end = row.begin() + start[j + 1];
    const auto it = std::lower_bound(row.begin() + start[j], end, i);
    return it != end && *it == i ? value[it - row.begin()] : 0;
  }
  /// f(row, W of it) of all entries of a column.
  template <class F>
  void eachOf(std::int32_t column, const F& f) const {
    const auto end = start[column + 1];
    for (auto k = start[column]; k < end; ++k) f(row[k], value[k]);
  }
};

}}  // namespace lpc::LPC_PRECISION
