// SPDX-License-Identifier: Zlib
// A surface of many triangles or segments, for worlds in which bodies fly into one.
#pragma once

#include <array>
#include <vector>

#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// A chain or mesh across the x axis, 80 m high. Its normals point to -x. Edges along y are 1 m long.
template <int D>
Shape<D> surfaceAcross() {
  std::vector<Vec<D>> points;
  constexpr int kHalf = 40;
  if constexpr (D == 2) {
    for (int i = kHalf; i >= -kHalf; --i) points.push_back(at<D>(0, i));
    return Shape<D>::chain(points, false);
  } else {
    std::vector<std::array<int, 3>> triangles;
    for (int i = -kHalf; i <= kHalf; ++i) {
      for (const int z : {-kHalf, 0, kHalf}) points.push_back(at<D>(0, i, z));
    }
    for (int i = 0; i < 2 * kHalf; ++i) {
      for (int k = 3 * i; k < 3 * i + 2; ++k) {
        triangles.push_back({k, k + 4, k + 3}), triangles.push_back({k, k + 1, k + 4});
      }
    }
    return Shape<D>::mesh(points, triangles);
  }
}

}}}  // namespace lpc::LPC_PRECISION::test
