// SPDX-License-Identifier: Zlib
// A world with a generator that adds one contact point a step. replay_test.cpp shows that it continues bit for bit when
// loaded; tests/conformance/contact_history_test.cpp tests its manifolds.
#include <gtest/gtest.h>

#include "framework/world/invariants.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace persistent_manifold_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
BodyDef<D> askew(const Vec<D>& position) {
  BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), position);
  Ang<D> turn = Ang<D>::Zero();
  turn[0] = Real(0.07), turn[kAngDim<D> - 1] = Real(0.1);
  def.X_WB.q = integrateRotation(Rot<D>{}, turn);
  return def;
}

// Two boxes fall on a floor, the lower one tilted. After ten seconds they are stacked and at rest.
template <int D>
bool boxesComeToRest(const std::string& pipeline) {
  World<D> world(Pipeline::parse(pipeline));
  addGround(world);
  const BodyHandle first = world.add(askew<D>(at<D>(0, 0.6)));
  const BodyHandle second = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0.1, 1.71)));
  for (int i = 0; i < 600; ++i) world.step(kDt);
  const auto lies = [&](BodyHandle h, Real height) {
    return std::abs(world.pose(h).p[1] - height) <= 3 * kLinearSlop && std::abs(world.pose(h).p[0]) < Real(0.3);
  };
  return lies(first, Real(0.5)) && lies(second, Real(1.5)) && invariants(world).kinetic < 1e-12;
}
TEST(PersistentManifold, BoxesComeToRest) {
  for (const std::string with : {"", " cache=by_distance", " cache=recycling", " solver=soft_step"}) {
    EXPECT_TRUE(boxesComeToRest<2>("contacts=persistent_manifold" + with)) << with;
    EXPECT_TRUE(boxesComeToRest<3>("contacts=persistent_manifold" + with)) << with;
  }
  expectCaught("PersistentManifold one point 2D", boxesComeToRest<2>("contacts=deepest_point"));
  expectCaught("PersistentManifold one point 3D", boxesComeToRest<3>("contacts=deepest_point"));
}

// Largest number of points of a box's manifold in the two seconds after its release above a floor.
template <int D>
int mostPoints(const std::string& pipeline, bool cache) {
  WorldSettings<D> settings;
  settings.model.cache = cache;
  World<D> world(Pipeline::parse(pipeline), settings);
  addGround(world);
  world.add(askew<D>(at<D>(0, 0.6)));
  std::int32_t most = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(kDt);
    for (const Manifold<D>& m : world.manifolds()) most = std::max(most, m.count);
  }
  return most;
}
// A model without a cache loses points as well as impulses. A cache method that drops impulses keeps the points.
TEST(PersistentManifold, PointsAreForgottenWithTheCache) {
  EXPECT_EQ(mostPoints<2>("contacts=persistent_manifold", false), 1);
  EXPECT_EQ(mostPoints<3>("contacts=persistent_manifold", false), 1);
  for (const std::string cache : {"by_feature", "none"}) {
    EXPECT_EQ(mostPoints<2>("contacts=persistent_manifold cache=" + cache, true), 2) << cache;
    EXPECT_GE(mostPoints<3>("contacts=persistent_manifold cache=" + cache, true), 3) << cache;
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::persistent_manifold_test
