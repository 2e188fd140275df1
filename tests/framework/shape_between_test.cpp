// SPDX-License-Identifier: Zlib
#include "framework/shape/shape_between.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/draw.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

constexpr Real kRounding = 64 * kEps;

template <int D>
void expectInside(const ShapeDef<D>& s, const Vec<D>& p, Real tolerance) {
  const ShapeView<D>& v = s.shape.view();
  const Vec<D> local = s.X_BS.q.inverse() * Vec<D>(p - s.X_BS.p);
  const Vec<D> outside = (local.cwiseAbs() - v.half).cwiseMax(Real(0));
  EXPECT_LE(outside.norm(), v.radius + tolerance);
}

template <int D>
void boxes() {
  Vec<D> a = Vec<D>::Constant(1), b = Vec<D>::Constant(3);
  a[1] = 4;  // corners in no particular order
  const ShapeDef<D> box = boxBetween<D>(a, b), same = boxBetween<D>(b, a);
  EXPECT_EQ(box.shape.view().half, same.shape.view().half);
  EXPECT_EQ(box.X_BS.p, same.X_BS.p);
  Vec<D> half = Vec<D>::Constant(1), middle = Vec<D>::Constant(2);
  half[1] = Real(0.5), middle[1] = Real(3.5);
  EXPECT_EQ(box.shape.view().half, half);
  EXPECT_EQ(box.X_BS.p, middle);
  Ang<D> turn = Ang<D>::Constant(Real(0.7));
  const Rot<D> q = integrateRotation(Rot<D>{}, turn);
  const ShapeDef<D> turned = boxBetween<D>(a, b, q);
  for (const Vec<D>& corner : {a, b}) {  // on the surface in every axis
    const Vec<D> local = turned.X_BS.q.inverse() * Vec<D>(corner - turned.X_BS.p);
    EXPECT_LE((local.cwiseAbs() - turned.shape.view().half).cwiseAbs().maxCoeff(), kRounding);
  }
}

TEST(ShapeBetween, BoxByAnyTwoCorners) {
  boxes<2>(), boxes<3>();
  EXPECT_THROW(boxBetween<2>({0, 0}, {0, 1}), UserError);  // no area
}

template <int D>
bool reachesBothEnds(const ShapeDef<D>& capsule, const Vec<D>& from, const Vec<D>& to) {
  const Vec<D> end = Vec<D>::Unit(0) * capsule.shape.view().half[0];
  return (capsule.X_BS * Vec<D>(-end) - from).norm() <= kRounding && (capsule.X_BS * end - to).norm() <= kRounding;
}

template <int D>
void capsules() {
  for (int k = 0; k < 2 * D; ++k) {  // both directions along each axis, and a little aside
    Vec<D> to = Vec<D>::Constant(1);
    to[k / 2] += k % 2 ? Real(-4) : Real(2);
    const Vec<D> from = Vec<D>::Constant(1);
    const ShapeDef<D> c = capsuleBetween<D>(from, to, Real(0.25));
    EXPECT_TRUE(reachesBothEnds<D>(c, from, to));
    expectInside<D>(c, from, kRounding);
    ShapeDef<D> unturned = c;
    unturned.X_BS.q = Rot<D>{};
    if (k == 2) expectCaught("a capsule that is not turned", reachesBothEnds<D>(unturned, from, to));
  }
  // Almost opposite to x, where the cosine of half the angle is nearly zero.
  for (const double aside : {1e-3, 1e-6, 1e-9}) {
    Vec<D> to = Vec<D>::Constant(static_cast<Real>(aside));
    to[0] = -10;
    EXPECT_TRUE(reachesBothEnds<D>(capsuleBetween<D>(Vec<D>::Zero(), to, Real(0.25)), Vec<D>::Zero(), to)) << aside;
  }
  EXPECT_EQ(capsuleBetween<D>(Vec<D>::Zero(), Vec<D>::Zero(), 1).shape.kind(), ShapeKind::sphere);
}

TEST(ShapeBetween, CapsuleByTwoPoints) { capsules<2>(), capsules<3>(); }

TEST(ShapeBetween, SegmentByTwoPoints) {
  const ShapeDef<2> s = segmentBetween({10, 5}, {20, 1});
  EXPECT_TRUE(reachesBothEnds<2>(s, {10, 5}, {20, 1}));
  EXPECT_THROW(segmentBetween({1, 1}, {1, 1}), UserError);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
