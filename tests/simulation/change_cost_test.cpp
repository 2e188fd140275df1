// SPDX-License-Identifier: Zlib
// Whose shapes and joints are whose is kept and not searched for: what a change costs, and that nothing is mixed up.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION::test::change_cost_test {
namespace {

constexpr Real kDt = Real(1) / 60;

// A row of n boxes on a floor, each on a hinge of its own; all are changed, and one step is made.
template <int D>
std::uint64_t visitsOfChanging(int n, bool jointed) {
  World<D> world(Pipeline::parse("sleep=split_average"));
  Vec<D> half = Vec<D>::Constant(1);
  half[0] = static_cast<Real>(2 * n);
  world.add(body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed));
  std::vector<Handle> row;
  for (int i = 0; i < n; ++i) {
    row.push_back(world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(2 * i - n, 0.5))));
    if (jointed) world.add(pivot<D>(Handle{}, row.back(), at<D>(2 * i - n, 0.5)));
  }
  world.step(kDt);
  EXPECT_EQ(world.manifolds().size(), static_cast<std::size_t>(n));
  for (const Handle& h : row) {
    BodyDef<D> def = world.definition(h);
    def.shapes[0].friction = Real(0.1), def.velocity = at<D>(1, 0);
    world.change(h, def);
    EXPECT_FALSE(world.contains(h, at<D>(0, 9)));
  }
  EXPECT_EQ(world.manifolds().size(), static_cast<std::size_t>(n));
  world.step(kDt);
  return world.profiler().frame().work[WorkCount::eventVisits];
}

// Of each body its shape, its joint and its waking; of the sleep policy each event, contact and joint.
template <int D>
void costs() {
  for (const int n : {100, 1000}) {
    EXPECT_EQ(visitsOfChanging<D>(n, false), static_cast<std::uint64_t>(4 * n));
    EXPECT_EQ(visitsOfChanging<D>(n, true), static_cast<std::uint64_t>(6 * n));
  }
}
TEST(ChangeCost, AllBodiesCostWhatTheyAre) { costs<2>(), costs<3>(); }

template <int D>
std::vector<std::vector<std::int32_t>> shapesByWalking(const World<D>& world) {
  std::vector<std::vector<std::int32_t>> out(world.bodies().used.size());
  for (std::size_t s = 0; s < world.shapes().size(); ++s) {
    const std::int32_t body = world.shapes()[s].body;
    if (body >= 0) out[static_cast<std::size_t>(body)].push_back(static_cast<std::int32_t>(s));
  }
  return out;
}
template <int D>
bool listed(const World<D>& world, const std::vector<std::vector<std::int32_t>>& truth) {
  bool same = truth.size() == world.bodies().used.size();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto list = world.shapesOf(i);
    same = same && std::equal(list.begin(), list.end(), truth[i].begin(), truth[i].end());
  }
  return same;
}

// Everything that gives a body shapes or joints, or takes them, in a drawn order.
template <int D>
void lives() {
  Random random(17);
  World<D> world;
  std::vector<Handle> bodies;
  const auto below = [&](std::size_t n) { return static_cast<int>(random.below(n)); };
  const auto any = [&] { return static_cast<std::size_t>(random.below(bodies.size())); };
  const auto drawn = [&] {
    BodyDef<D> def;
    def.X_WB.p[0] = static_cast<Real>(below(9));
    for (int n = 1 + below(3); n > 0; --n) {
      def.shapes.push_back({.shape = Shape<D>::sphere(Real(0.5)), .X_BS = {at<D>(n, 0), {}}});
    }
    return def;
  };
  std::vector<std::vector<std::int32_t>> before;
  int stale = 0;
  for (int i = 0; i < 600; ++i) {
    before = shapesByWalking(world);
    const int what = bodies.size() < 4 ? 0 : below(8);
    if (what <= 1) {
      bodies.push_back(world.add(drawn()));
    } else if (what == 2) {
      const std::size_t k = any();
      world.remove(bodies[k]);
      bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(k));
    } else if (what == 3) {
      BodyDef<D> def = world.definition(bodies[any()]);
      const Handle h = bodies[any()];
      if (below(2)) def.shapes.push_back(drawn().shapes[0]);
      world.change(h, def);
    } else if (what == 4) {
      const std::size_t a = any(), b = any();
      if (a == b) continue;
      world.merge(bodies[a], bodies[b]);
      bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(b));
    } else if (what == 5) {
      const std::vector<Handle> parts = world.takeApart(bodies[any()]);
      bodies.insert(bodies.end(), parts.begin() + 1, parts.end());
    } else if (what == 6) {
      const std::size_t a = any(), b = any();
      if (a != b) world.add(pivot<D>(bodies[a], bodies[b], at<D>(below(9), 0)));
    } else {
      std::istringstream in(saved(world));
      world.load(in);
    }
    const auto truth = shapesByWalking(world);
    ASSERT_TRUE(listed(world, truth)) << "after " << i << ", which is " << what;
    stale += !listed(world, before);
    for (const JointRecord<D>& j : world.joints()) {
      if (!j.kind) continue;
      ASSERT_TRUE(world.bodies().used[static_cast<std::size_t>(j.bodyA)]) << i;
      ASSERT_TRUE(world.bodies().used[static_cast<std::size_t>(j.bodyB)]) << i;
    }
  }
  EXPECT_GT(std::count_if(world.joints().begin(), world.joints().end(), [](const auto& j) { return bool(j.kind); }), 0);
  expectCaught("whose shapes are whose, a change late", stale == 0);
}
TEST(ChangeCost, WhoseShapesAreWhoseIsRight) { lives<2>(), lives<3>(); }

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test::change_cost_test
