// SPDX-License-Identifier: Zlib
// Contacts as input of a cache: those of a moment ago, and the present poses of the bodies.
#pragma once

#include <algorithm>
#include <vector>

#include "framework/math/tolerances.h"
#include "framework/stage/stage_narrowphase.h"
#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// A ground, two bodies on it (one composite), and their poses a moment later. Relative motion is from zero to a
/// decimetre; the whole scene moves anywhere.
template <int D>
struct Moment {
  std::vector<ShapeRecord<D>> shapes;
  std::vector<ShapePair> pairs = {{0, 1}, {0, 2}};
  std::vector<Pose<D>> before, after;
  std::vector<Manifold<D>> old;
  PartPairs<D> partPairs;
  WorkDone work;

  std::vector<Manifold<D>> made(std::span<const ShapePair> which, const std::vector<Pose<D>>& pose) {
    std::vector<Manifold<D>> out;
    createStage<ContactGenerator<D>>({"sat_clip", {}})
        ->generate({partPairs.of(which, shapes, pose, kContactMargin, work), shapes, pose, kContactMargin}, out, work);
    for (Manifold<D>& m : out) {
      const Pose<D>& X_WA = pose[static_cast<std::size_t>(m.bodyA)];
      m.X_AB = poseBetween(X_WA, pose[static_cast<std::size_t>(m.bodyB)]);
      m.normalA = X_WA.q.inverse() * m.normal;
    }
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
    return out;
  }
  CacheInput<D> input() const { return {pairs, old, shapes, after, kContactMargin}; }
};

template <int D>
std::ostream& operator<<(std::ostream& out, const Moment<D>& m) {
  for (std::size_t i = 0; i < m.before.size(); ++i) out << m.before[i] << " then " << m.after[i] << '\n';
  return out;
}

template <int D>
Ang<D> drawTurn(Draw& draw, Real size) {
  Ang<D> turn;
  for (int k = 0; k < kAngDim<D>; ++k) turn[k] = size * draw.signedUnit();
  return turn;
}

template <int D>
Moment<D> drawMoment() {
  return *Gen([](Draw& draw) {
    Moment<D> s;
    const Shape<D> half = Shape<D>::box(Vec<D>::Constant(Real(0.25)));
    const Pose<D> left{-Vec<D>::Unit(0) / 4, {}}, right{Vec<D>::Unit(0) / 4, {}};
    const std::vector<ShapePart<D>> parts = {{half, left}, {half, right}};
    s.shapes.resize(3);
    s.shapes[0].shape = Shape<D>::box(Vec<D>::Constant(2));
    s.shapes[1].shape = Shape<D>::compound(parts);
    s.shapes[2].shape = Shape<D>::box(Vec<D>::Constant(Real(0.25)));
    s.before = {Pose<D>{}, {}, {}}, s.after = {Pose<D>{}};
    for (int i = 1; i < 3; ++i) {
      auto& x = s.before[static_cast<std::size_t>(i)];
      s.shapes[static_cast<std::size_t>(i)].body = i;
      x.p = Vec<D>::Unit(0) * static_cast<Real>(2 * i - 3) + Vec<D>::Unit(1) * (Real(2.25) + draw.signedUnit() / 200);
      x.q = integrateRotation(x.q, drawTurn<D>(draw, draw.pick({Real(0), Real(0.02), Real(0.1)})));
      Pose<D> y = x;
      const Real size = draw.pick({Real(0), Real(1e-3), Real(0.02), Real(0.1)});
      y.p += size * drawVector<D>(draw);
      y.q = integrateRotation(y.q, drawTurn<D>(draw, size));
      s.after.push_back(y);
    }
    s.shapes[0].body = 0;
    const Pose<D> X{drawVector<D>(draw), drawRotation<D>(draw)};
    for (Pose<D>& x : s.after) x = X * x;
    s.old = s.made(s.pairs, s.before);
    for (Manifold<D>& m : s.old) {
      for (ContactPoint<D>& p : m.points) {
        for (Real& x : p.impulse) x = std::abs(draw.signedUnit());
      }
    }
    return s;
  });
}

}}}  // namespace lpc::LPC_PRECISION::test
