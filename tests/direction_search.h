// SPDX-License-Identifier: Zlib
#pragma once

#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// The largest value of f(d) over unit vectors d, by trying many and refining the best: never above the true maximum,
/// usually within a percent of the sizes in play. What is separated, and how far, is such a maximum for convex sets; it
/// needs support functions only and shares no code with what is tested.
template <int D, class F>
Real maxOverDirections(F&& f, std::uint64_t seed = 7) {
  PlainDraw draw(seed);
  Vec<D> best = Vec<D>::Unit(0);
  Real value = f(best);
  const auto take = [&](const Vec<D>& d) {
    if (!(d.norm() > 0)) return;
    const Vec<D> unit = d / d.norm();
    const Real v = f(unit);
    if (v > value) value = v, best = unit;
  };
  for (int k = 0; k < D; ++k) take(Vec<D>::Unit(k)), take(-Vec<D>::Unit(k));
  for (int i = 0; i < 200; ++i) take(drawDirection<D>(draw));
  Real step = Real(0.5);
  for (int i = 0; i < 300; ++i) {
    const Real before = value;
    take(best + step * drawVector<D>(draw));
    if (value == before && i % 6 == 5) step *= Real(0.7);
  }
  return value;
}

}}}  // namespace lpc::LPC_PRECISION::test
