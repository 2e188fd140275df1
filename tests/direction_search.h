// SPDX-License-Identifier: Zlib
#pragma once

#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Estimates the maximum of f(d) over unit vectors d: samples many directions and refines the best. Never above the
/// true maximum; usually within 1 % of the sizes involved. The signed distance of convex sets is such a maximum. It
/// needs only support functions and shares no code with the tested methods.
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
