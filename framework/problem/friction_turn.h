// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/math/indexed.h"
#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Adds in the order in which Eigen adds the terms of a product.
inline Real sumOfThree(Real x, Real y, Real z) { return sizeof(Real) == 8 ? (x + y) + z : x + (y + z); }

/// Converts friction impulses from the tangents of one normal to those of another. tangents(n) jumps where n_z changes
/// its sign. On a slope the two bases may therefore be mirror images although the normals differ by one rounding. So
/// friction is carried as a vector, not as two numbers. Computed number by number: Eigen's products would read as a
/// whole what was stored as numbers, for which the processor waits.
template <int D>
class FrictionTurn {
 public:
  FrictionTurn(const Vec<D>& from, const Vec<D>& to) : m_same(from == to) {
    const RealMatrix<D, D - 1> a = tangents(to), b = tangents(from);
    for (int i = 0; i < D - 1; ++i) {
      for (int k = 0; k < D - 1; ++k) {
        if constexpr (D == 2) {
          m_turn(i, k) = a(0, i) * b(0, k) + a(1, i) * b(1, k);
        } else {
          m_turn(i, k) = sumOfThree(a(0, i) * b(0, k), a(1, i) * b(1, k), a(2, i) * b(2, k));
        }
      }
    }
  }

  void operator()(IndexedArray<Real, D>& impulse) const {
    if (m_same) return;
    if constexpr (D == 2) {
      impulse[1] *= m_turn(0, 0);
    } else {
      const Real x = impulse[1], y = impulse[2];
      impulse[1] = m_turn(0, 0) * x + m_turn(0, 1) * y;
      impulse[2] = m_turn(1, 0) * x + m_turn(1, 1) * y;
    }
  }

 private:
  bool m_same;
  RealMatrix<D - 1, D - 1> m_turn;
};

}}  // namespace lpc::LPC_PRECISION
