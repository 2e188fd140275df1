// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// A dynamic box with edges of 1 m, centred at (x, y), in 3D at z = 0.
template <int D>
BodyDef<D> boxAt(Real x, Real y) {
  BodyDef<D> def;
  def.X_WB.p[0] = x, def.X_WB.p[1] = y;
  def.shapes.push_back({.shape = Shape<D>::box(Vec<D>::Constant(Real(0.5)))});
  return def;
}

}}}  // namespace lpc::LPC_PRECISION::test
