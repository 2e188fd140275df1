// SPDX-License-Identifier: Zlib
// The view of a pair shows what the query does now, and is computed once per state.
#include "experiments/sandbox/pair_look.h"

#include <gtest/gtest.h>

#include "framework/world/world.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace pair_look_test { namespace {

Shape<2> roundOne(const Shape<2>&) { return Shape<2>::capsule(1, Real(0.4)); }
Shape<3> roundOne(const Shape<3>&) { return Shape<3>::curved(ShapeKind::cylinder, std::array{Real(0.6), Real(0.8)}); }

template <int D>
struct Pair {
  World<D> world{Pipeline::parse("contacts=query_clip"), WorldSettings<D>{}};
  BodyHandle a, b;
  PairLook<D> look;

  Pair() {
    BodyDef<D> def;
    def.shapes.push_back({.shape = Shape<D>::box(Vec<D>::Constant(Real(0.5)))});
    a = world.add(def);
    def.shapes.front().shape = roundOne(def.shapes.front().shape);
    def.X_WB.p = Vec<D>::Constant(Real(0.3));
    b = world.add(def);
  }
  void move(Real by) {
    Pose<D> X = world.pose(b);
    X.p[0] += by;
    world.setPose(b, X);
  }
  void see(const std::string& query) { look.look(query, world, a.slot, b.slot); }
  // Whether the view equals a new trace of the query.
  bool holds(const std::string& query) const {
    const auto& shapes = world.shapes();
    const auto X = [&](const ShapeRecord<D>& s) {
      return world.bodies().pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    };
    const PairTrace<D> now =
        tracePair<D>(query, shapes[0].shape.view(), shapes[1].shape.view(), X(shapes[0]).inverse() * X(shapes[1]));
    return look.trace() && describe(*look.trace()) == describe(now);
  }
};

template <int D>
void looks() {
  Pair<D> pair;
  for (const char* query : {"gjk_epa", "gjk_epa{simplex=johnson}", "sat"}) {
    if (D == 3 && std::string(query) == "sat") continue;  // records no steps for curved shapes
    const long before = pair.look.made();
    for (int picture = 0; picture < 5; ++picture) pair.see(query);
    EXPECT_EQ(pair.look.made(), before + 1) << query;
    EXPECT_TRUE(pair.holds(query)) << query;
  }
  pair.see("gjk_epa");
  const long made = pair.look.made();
  pair.move(Real(0.1));
  expectCaught("a look that is kept whatever moves", pair.holds("gjk_epa"));
  pair.see("gjk_epa"), pair.see("gjk_epa");
  EXPECT_EQ(pair.look.made(), made + 1);
  EXPECT_TRUE(pair.holds("gjk_epa"));
  // After the shape is replaced, the view must not use the old shape's hull.
  BodyDef<D> def = pair.world.definition(pair.a);
  std::vector<Vec<D>> corners = {Vec<D>::Zero()};
  for (int axis = 0; axis < D; ++axis) corners.push_back(Vec<D>::Unit(axis));
  def.shapes.front().shape = Shape<D>::polytope(corners);
  pair.world.change(pair.a, def);
  pair.see("gjk_epa");
  EXPECT_EQ(pair.look.made(), made + 2);
  EXPECT_TRUE(pair.holds("gjk_epa"));
  // `found` is the first step with the final answer.
  const auto& steps = pair.look.trace()->steps;
  const std::size_t found = pair.look.found();
  EXPECT_EQ(steps[found].best, steps.back().best);
  EXPECT_TRUE(found == 0 || steps[found - 1].best != steps.back().best ||
              steps[found - 1].bestAxis != steps.back().bestAxis);
  // A query that records no steps says so, and is tried once.
  pair.see("mpr");
  EXPECT_EQ(pair.look.trace(), nullptr);
  EXPECT_NE(pair.look.says().find("cannot show its steps"), std::string::npos) << pair.look.says();
  pair.look.nobody("no body selected");
  EXPECT_EQ(pair.look.says(), "no body selected");
}
TEST(SandboxPair, IsTracedOncePerState) { looks<2>(), looks<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::pair_look_test
