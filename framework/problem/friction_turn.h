// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/math/indexed.h"
#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Converts friction impulses from the tangents of one normal to those of another. tangents(n) jumps where n_z changes
/// its sign. On a slope the two bases may therefore be mirror images although the normals differ by one rounding. So
/// friction is carried as a vector, not as two numbers.
template <int D>
class FrictionTurn {
 public:
  FrictionTurn(const Vec<D>& from, const Vec<D>& to)
      : m_same(from == to), m_turn(tangents(to).transpose() * tangents(from)) {}

  void operator()(IndexedArray<Real, D>& impulse) const {
    if (m_same) return;
    Vec<D - 1> friction;
    for (int k = 1; k < D; ++k) friction[k - 1] = impulse[k];
    friction = (m_turn * friction).eval();
    for (int k = 1; k < D; ++k) impulse[k] = friction[k - 1];
  }

 private:
  bool m_same;
  RealMatrix<D - 1, D - 1> m_turn;
};

}}  // namespace lpc::LPC_PRECISION
