// SPDX-License-Identifier: Zlib
// Pairs that a method answered with the right distance and the wrong points.
#include <gtest/gtest.h>

#include "framework/stage_narrowphase.h"
#include "oracles/referee.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

// A capsule's axis lies across the rim of an ellipsoid as thin as a leaf: the bound has a ridge there, on which the
// normal was left off by 1e-9, and the witness left the leaf by a four-hundredth of its thickness.
TEST(CurvedWitness, OnTheRimOfALeaf) {
  const Real sizes[3] = {Real(0.00013830885213746415), Real(0.00092962255144690773), Real(4.1478712712727765e-08)};
  const Shape<3> capsule = Shape<3>::capsule(Real(0.0006763391439389496), Real(1.9227659814205744e-08));
  const Shape<3> leaf = Shape<3>::curved(ShapeKind::ellipsoid, sizes);
  const Pose<3> X_WA{
      {Real(-0.0002791177585726106), Real(-0.00012917231672695322), Real(5.4549927114345916e-05)},
      {Real(0.5036966505044097), Real(0.18605481988522671), Real(-0.45283886903409509), Real(-0.71176558427619696)}};
  const Pose<3> X_WB{
      {Real(-0.00039655348755581919), Real(-0.00036603001260861548), Real(3.9390562152055632e-05)},
      {Real(-0.037550240706508864), Real(-0.60033381228851579), Real(0.30622497451423497), Real(-0.73784521292055327)}};
  const auto method = createStage<PairQuery<3>>({"gjk_epa", {}});
  const Pose<3> X_AB = X_WA.inverse() * X_WB;
  const PairAnswer<3> answer = queryPair<3>(*method, capsule.view(), leaf.view(), X_AB);
  const auto outside = [](const Vec<3>& p, const Shape<3>& shape, const Pose<3>& X) {
    return referee<3>(Shape<3>::sphere(0).view(), {p, {}}, shape.view(), X).interval().middle();
  };
  const double s = 1e-3;  // about the size of both
  EXPECT_NEAR(outside(answer.pA, capsule, {}), 0, 1e-13 * s);
  EXPECT_NEAR(outside(answer.pB, leaf, X_AB), 0, 1e-13 * s);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
