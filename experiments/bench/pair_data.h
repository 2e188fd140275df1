// SPDX-License-Identifier: Zlib
// Randomly drawn pairs for benchmarks, the same in each run.
#pragma once

#include <span>
#include <vector>

#include "framework/math/random.h"
#include "framework/shape/curved_core.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

inline Rot<2> drawTurn(Random& random, const Vec<2>&) { return Rot<2>::angle(random.uniform(-3, 3)); }
inline Rot<3> drawTurn(Random& random, const Vec<3>&) {
  return Rot<3>::vector({static_cast<Real>(random.uniform(-2, 2)), static_cast<Real>(random.uniform(-2, 2)),
                         static_cast<Real>(random.uniform(-2, 2))});
}

template <int D>
Vec<D> drawDirection(Random& random) {
  for (;;) {
    Vec<D> v;
    for (int d = 0; d < D; ++d) v[d] = static_cast<Real>(random.uniform(-1, 1));
    if (v.norm() > Real(0.1) && v.norm() <= 1) return v / v.norm();
  }
}

// Sizes of 0.3 to 1 m.
template <int D>
Shape<D> drawShape(Random& random, ShapeKind kind, int hullPoints) {
  const auto size = [&] { return static_cast<Real>(random.uniform(0.3, 1)); };
  switch (coreClass(kind)) {
    case CoreClass::point:
      return Shape<D>::sphere(size());
    case CoreClass::segment:
      return kind == ShapeKind::segment ? Shape<D>::segment(size()) : Shape<D>::capsule(size(), size() / 2);
    case CoreClass::box: {
      Vec<D> half;
      for (int d = 0; d < D; ++d) half[d] = size();
      return Shape<D>::box(half);
    }
    case CoreClass::curved: {
      std::vector<Real> sizes;
      for (std::size_t i = 0; i < curvedKind<D>(kind).sizes.size(); ++i) sizes.push_back(size());
      return Shape<D>::curved(kind, sizes);
    }
    case CoreClass::plane:
      return Shape<D>::plane();
    case CoreClass::hull:
      break;
  }
  std::vector<Vec<D>> points;
  const Real radius = size();
  if (kind == ShapeKind::triangle) hullPoints = 3;
  for (int k = 0; k < hullPoints; ++k) points.push_back(radius * drawDirection<D>(random));
  return Shape<D>::ofCorners(kind, points);
}

/// About half of the pairs overlap: centres are up to 1.2 times the sum of the mean sizes apart. There are thousands of
/// them, but only hundreds with hulls, which take long to make.
template <int D>
struct PairData {
  std::vector<Shape<D>> a, b;
  std::vector<Pose<D>> X_WA, X_WB;

  PairData(ShapeKind kindA, ShapeKind kindB, int hullPoints) {
    Random random(7);
    const auto radiusOf = [](const ShapeView<D>& v) {
      return v.core() == CoreClass::plane ? Real(4) : boundingRadius(v);  // a plane is unbounded
    };
    const bool hulls = kindA == ShapeKind::polytope || kindB == ShapeKind::polytope;
    for (int k = 0; k < (hulls ? 512 : 4096); ++k) {
      a.push_back(drawShape<D>(random, kindA, hullPoints)), b.push_back(drawShape<D>(random, kindB, hullPoints));
      const Real reach = Real(0.7) * (radiusOf(a.back().view()) + radiusOf(b.back().view()));
      Pose<D> A, B;
      A.p = drawDirection<D>(random), A.q = drawTurn(random, A.p);
      B.p = A.p + reach * static_cast<Real>(random.uniform(0.3, 1.7)) * drawDirection<D>(random);
      B.q = drawTurn(random, B.p);
      X_WA.push_back(A), X_WB.push_back(B);
    }
  }
};

}}}  // namespace lpc::LPC_PRECISION::bench
