// SPDX-License-Identifier: Zlib
// Shapes of several convex parts: what is rejected, and the mass and near parts of the whole.
#include <gtest/gtest.h>

#include "framework/shape/mass.h"
#include "framework/shape/shape_tolerances.h"
#include "framework/stage/stage_narrowphase.h"
#include "tests/check_property.h"
#include "tests/generators.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace compound_test { namespace {

template <int D>
Shape<D> compoundOf(std::initializer_list<ShapePart<D>> parts, PartOverlap overlap = PartOverlap::counted) {
  return Shape<D>::compound(std::vector<ShapePart<D>>(parts), overlap);
}

template <int D>
void refusals() {
  const Shape<D> ball = Shape<D>::sphere(1);
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  const auto refused = [](std::initializer_list<ShapePart<D>> parts, const std::string& why) {
    try {
      compoundOf<D>(parts);
      ADD_FAILURE() << "taken, though: " << why;
    } catch (const UserError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refused({}, "no parts");
  refused({{ball}, {compoundOf<D>({{ball}})}}, "part 1: is a compound");
  refused({{Shape<D>::plane()}}, "part 0: is a plane");
  refused({{ball, {Vec<D>::Constant(nan), {}}}}, "part 0: the position is not finite");
  Rot<D> stretched;
  if constexpr (D == 2) {
    stretched.c = 2;
  } else {
    stretched.w = 2;
  }
  refused({{ball, {Vec<D>::Zero(), stretched}}}, "part 0: the rotation is not a unit");
}
TEST(Compound, RefusesBadParts) { refusals<2>(), refusals<3>(); }

template <int D>
bool refusedForOverlap(const std::vector<ShapePart<D>>& parts) {
  try {
    Shape<D>::compound(parts, PartOverlap::refused);
    return false;
  } catch (const UserError& e) {
    return std::string_view(e.what()).ends_with("overlaps part 0; valid: parts without overlap");
  }
}
template <int D>
bool boxesOverlap(const std::vector<ShapePart<D>>& parts) {
  return boundingBox(parts[0].shape, parts[0].X_SP).overlaps(boundingBox(parts[1].shape, parts[1].X_SP));
}

// Two parts that share a face or a point, in any pose, do not overlap. Moved into each other by twice the tolerance,
// they do.
template <int D, class Refuses>
void facesMayBeShared(const Refuses& refuses) {
  RapidCheckDraw draw;
  Vec<D> a, b;
  for (int k = 0; k < D; ++k) a[k] = draw.real(0.1, 2), b[k] = draw.real(0.1, 2);
  const bool round = draw.coin();  // a ball or an ellipsoid touches the box's face
  const std::vector<Real> half(b.data(), b.data() + D);
  const ShapePart<D> box{Shape<D>::box(a), *poses<D>(3)};
  // A box, sometimes as a hull with its frame beside it: the overlap test shrinks it about its own centre.
  Vec<D> aside = Vec<D>::Zero();
  aside[0] = draw.real(0, 5);
  std::vector<Vec<D>> corners;
  for (int bits = 0; bits < 1 << D; ++bits) {
    Vec<D> v = aside;
    for (int k = 0; k < D; ++k) v[k] += (bits >> k) & 1 ? b[k] : -b[k];
    corners.push_back(v);
  }
  const Shape<D> shape = round ? Shape<D>::curved(ShapeKind::ellipsoid, half) : Shape<D>::polytope(corners);
  if (round) aside.setZero();
  Vec<D> beside = Vec<D>::Zero();
  beside[0] = a[0] + b[0];
  beside[1] = draw.real(-1, 1) * (round ? a[1] : a[1] + b[1]) * Real(0.9);
  const auto at = [&](const Vec<D>& p) { return ShapePart<D>{shape, box.X_SP * Pose<D>{p - aside, {}}}; };
  RC_ASSERT(!refuses(std::vector{box, at(beside)}));
  beside[0] -= 2 * kPartOverlap * (a[0] + b[0]);
  RC_ASSERT(refuses(std::vector{box, at(beside)}));
}
template <int D>
void overlaps() {
  check(
      "parts may share faces", [] { facesMayBeShared<D>(refusedForOverlap<D>); }, 300);
  expectFalsified(
      "parts whose boxes overlap are refused", [] { facesMayBeShared<D>(boxesOverlap<D>); }, 300);
  expectFalsified("no parts are refused", [] {
    facesMayBeShared<D>([](const std::vector<ShapePart<D>>& parts) {
      return Shape<D>::compound(parts, PartOverlap::counted).convex();
    });
  });
}
TEST(Compound, OverlapIsRefusedWhenAsked) { overlaps<2>(), overlaps<3>(); }

// An L of two boxes equals its bounding box minus the missing box. Two identical parts count twice.
template <int D>
void masses() {
  Vec<D> upright = Vec<D>::Constant(1), foot = Vec<D>::Constant(1);
  upright[1] = 2, foot[0] = Real(0.5);
  const Shape<D> l =
      compoundOf<D>({{Shape<D>::box(upright)}, {Shape<D>::box(foot), {at<D>(1.5, -1), {}}}}, PartOverlap::refused);
  const MassProperties<D> m = massProperties(l, Real(2));
  Vec<D> whole = upright, missing = foot;
  whole[0] = Real(1.5);
  const auto placed = [](const Vec<D>& half, const Vec<D>& p) {
    return transformed(massProperties(Shape<D>::box(half).view(), Real(2)), Pose<D>{p, {}});
  };
  // The L plus the missing box is the bounding box.
  const MassProperties<D> made = combined(m, placed(missing, at<D>(1.5, 1))), box = placed(whole, at<D>(0.5, 0));
  EXPECT_NEAR(made.mass, box.mass, 64 * kEps * box.mass);
  EXPECT_LE((made.center - box.center).norm(), 64 * kEps);
  EXPECT_LE((made.inertia - box.inertia).norm(), 64 * kEps * box.inertia.norm());

  const Shape<D> ball = Shape<D>::sphere(1);
  const Real once = massProperties(ball.view(), Real(3)).mass;
  EXPECT_NEAR(massProperties(compoundOf<D>({{ball}, {ball}}), Real(3)).mass, 2 * once, 8 * kEps * once);
}
TEST(Compound, MassIsThatOfItsParts) { masses<2>(), masses<3>(); }

// Indices of the pairs of parts of two shapes that are near each other.
template <int D>
std::vector<std::pair<int, int>> nearParts(const std::vector<ShapeRecord<D>>& shapes,
                                           const std::vector<Pose<D>>& pose) {
  const ShapePair pair{0, 1};
  PartPairs<D> partPairs;
  WorkDone work;
  std::vector<std::pair<int, int>> numbers;
  for (const ConvexPair<D>& c : partPairs.of({&pair, 1}, shapes, pose, kContactMargin, work)) {
    numbers.emplace_back(c.partA, c.partB);
  }
  EXPECT_LT(work[WorkCount::partTests], 100u);
  return numbers;
}
template <int D>
void culled() {
  using Numbers = std::vector<std::pair<int, int>>;
  std::vector<ShapePart<D>> teeth;
  for (int i = 0; i < 10; ++i) teeth.push_back({Shape<D>::box(Vec<D>::Constant(Real(0.4))), {at<D>(i, 0), {}}});
  // Two combs, one above the other at half and at 1.5 times the margin, shifted by five and a half teeth.
  const ShapeRecord<D> comb{.shape = Shape<D>::compound(teeth), .body = 0}, other{.shape = comb.shape, .body = 1};
  const auto above = [](double gap) { return std::vector<Pose<D>>{{}, {at<D>(5.5, 0.8 + gap), {}}}; };
  EXPECT_EQ(nearParts<D>({comb, other}, above(0.5 * kContactMargin)),
            (Numbers{{5, 0}, {6, 0}, {6, 1}, {7, 1}, {7, 2}, {8, 2}, {8, 3}, {9, 3}, {9, 4}}));
  EXPECT_EQ(nearParts<D>({comb, other}, above(1.5 * kContactMargin)), Numbers{});
  // Stairs with steps of 0.1 m, three of which are near a plane, in either order of the bodies.
  for (std::size_t i = 0; i < teeth.size(); ++i) teeth[i].X_SP.p[1] = Real(0.1) * static_cast<Real>(i);
  ShapeRecord<D> stairs{.shape = Shape<D>::compound(teeth), .body = 0}, plane{.shape = Shape<D>::plane(), .body = 1};
  const Pose<D> low{at<D>(0, 0.21), {}};
  EXPECT_EQ(nearParts<D>({stairs, plane}, {low, {}}), (Numbers{{0, 0}, {1, 0}, {2, 0}}));
  stairs.body = 1, plane.body = 0;
  EXPECT_EQ(nearParts<D>({plane, stairs}, {Pose<D>{}, low}), (Numbers{{0, 0}, {0, 1}, {0, 2}}));
}
TEST(Compound, OnlyNearPartsArePaired) { culled<2>(), culled<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::compound_test
