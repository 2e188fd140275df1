// SPDX-License-Identifier: Zlib
// Cost of changes: the lists of each body's shapes and joints are maintained, not searched, and stay correct.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace change_cost_test { namespace {

constexpr Real kDt = Real(1) / 60;

// n boxes on a floor, optionally each on its own hinge. All are changed, then the world makes one step.
template <int D>
std::uint64_t visitsOfChanging(int n, bool jointed) {
  World<D> world(Pipeline::parse("sleep=split_average"));
  const std::vector<BodyHandle> row = addRow(world, n);
  for (const BodyHandle& h : row) {
    if (jointed) world.add(pivot<D>(BodyHandle{}, h, world.pose(h).p));
  }
  world.step(kDt);
  EXPECT_EQ(world.manifolds().size(), static_cast<std::size_t>(n));
  for (const BodyHandle& h : row) {
    BodyDef<D> def = world.definition(h);
    def.shapes[0].friction = Real(0.1), def.velocity = at<D>(1, 0);
    world.change(h, def);
    EXPECT_FALSE(world.contains(h, at<D>(0, 9)));
  }
  EXPECT_EQ(world.manifolds().size(), static_cast<std::size_t>(n));
  world.step(kDt);
  return world.profiler().frame().work[WorkCount::eventVisits];
}

// For each body: its shape, its joint and its waking. For the sleep policy: each event, contact and joint.
template <int D>
void costs() {
  for (const int n : {100, 1000}) {
    EXPECT_EQ(visitsOfChanging<D>(n, false), static_cast<std::uint64_t>(4 * n));
    EXPECT_EQ(visitsOfChanging<D>(n, true), static_cast<std::uint64_t>(6 * n));
  }
}
TEST(ChangeCost, ChangingAllBodiesIsLinear) { costs<2>(), costs<3>(); }

// A hub with n bodies jointed to it.
template <int D, class Remove>
std::uint64_t visitsOfRemovingTheHub(int n, const Remove& remove) {
  WorldSettings<D> settings;
  settings.gravity.setZero();
  World<D> world({}, settings);
  const BodyDef<D> ball = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0));
  const BodyHandle hub = world.add(ball);
  for (int i = 0; i < n; ++i) {
    BodyDef<D> spoke = ball;
    spoke.X_WB.p = at<D>(0, 2 * (i + 1));
    world.add(pivot<D>(hub, world.add(spoke), at<D>(0, 0)));
  }
  world.step(kDt);
  EXPECT_EQ(world.jointsOf(static_cast<std::size_t>(hub.slot)).size(), static_cast<std::size_t>(n));
  remove(world, hub);
  EXPECT_EQ(world.bodyCount(), n);
  world.step(kDt);
  return world.profiler().frame().work[WorkCount::eventVisits];
}
// Ten times the joints may cost slightly more than ten times as much, because free slots go into a heap.
template <int D, class Remove>
bool isLinear(const Remove& remove) {
  return visitsOfRemovingTheHub<D>(2000, remove) < 20 * visitsOfRemovingTheHub<D>(200, remove);
}
template <int D>
void hubs() {
  EXPECT_TRUE(isLinear<D>([](World<D>& world, BodyHandle hub) { world.remove(hub); }));
  expectCaught("a hub's joints are taken from the front of their list",
               isLinear<D>([](World<D>& world, BodyHandle hub) {
                 for (std::size_t j = 0; j < world.joints().size(); ++j) {
                   world.remove(JointHandle{static_cast<std::int32_t>(j), world.joints()[j].generation});
                 }
                 world.remove(hub);
               }));
}
TEST(ChangeCost, RemovingAHubIsLinearInItsJoints) { hubs<2>(), hubs<3>(); }

using Lists = std::vector<std::vector<std::int32_t>>;  // by body slot
struct Whose {
  Lists shapes, joints;
};
template <int D>
Whose byWalking(const World<D>& world) {
  const std::size_t n = world.bodies().used.size();
  Whose out{Lists(n), Lists(n)};
  const auto list = [](Lists& lists, std::int32_t body, std::size_t slot) {
    if (body >= 0) lists[static_cast<std::size_t>(body)].push_back(static_cast<std::int32_t>(slot));
  };
  for (std::size_t s = 0; s < world.shapes().size(); ++s) list(out.shapes, world.shapes()[s].body, s);
  for (std::size_t j = 0; j < world.joints().size(); ++j) {
    if (!world.joints()[j].kind) continue;
    list(out.joints, world.joints()[j].bodyA, j), list(out.joints, world.joints()[j].bodyB, j);
  }
  return out;
}
template <class Of>
bool listed(const Lists& truth, std::size_t bodies, const Of& of) {
  bool same = truth.size() == bodies;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::span<const std::int32_t> list = of(i);
    same = same && std::equal(list.begin(), list.end(), truth[i].begin(), truth[i].end());
  }
  return same;
}
template <int D>
bool shapesListed(const World<D>& world, const Whose& truth) {
  return listed(truth.shapes, world.bodies().used.size(), [&](std::size_t i) { return world.shapesOf(i); });
}
template <int D>
bool jointsListed(const World<D>& world, const Whose& truth) {
  return listed(truth.joints, world.bodies().used.size(), [&](std::size_t i) { return world.jointsOf(i); });
}

// Every operation that gives a body shapes or joints, or takes them, in random order.
template <int D>
void lives() {
  Random random(17);
  World<D> world;
  std::vector<BodyHandle> bodies;
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
  Whose before;
  int staleShapes = 0, staleJoints = 0;
  for (int i = 0; i < 600; ++i) {
    before = byWalking(world);
    const int what = bodies.size() < 4 ? 0 : below(8);
    if (what <= 1) {
      bodies.push_back(world.add(drawn()));
    } else if (what == 2) {
      const std::size_t k = any();
      world.remove(bodies[k]);
      bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(k));
    } else if (what == 3) {
      BodyDef<D> def = world.definition(bodies[any()]);
      const BodyHandle h = bodies[any()];
      if (below(2)) def.shapes.push_back(drawn().shapes[0]);
      world.change(h, def);
    } else if (what == 4) {
      const std::size_t a = any(), b = any();
      if (a == b) continue;
      world.merge(bodies[a], bodies[b]);
      bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(b));
    } else if (what == 5) {
      const std::vector<BodyHandle> parts = world.splitByShape(bodies[any()]);
      bodies.insert(bodies.end(), parts.begin() + 1, parts.end());
    } else if (what == 6) {
      const std::size_t a = any(), b = any();
      if (a != b) world.add(pivot<D>(bodies[a], bodies[b], at<D>(below(9), 0)));
    } else {
      std::istringstream in(saved(world));
      world.load(in);
    }
    const Whose truth = byWalking(world);
    ASSERT_TRUE(shapesListed(world, truth)) << "after " << i << ", which is " << what;
    ASSERT_TRUE(jointsListed(world, truth)) << "after " << i << ", which is " << what;
    staleShapes += !shapesListed(world, before), staleJoints += !jointsListed(world, before);
    for (const JointRecord<D>& j : world.joints()) {
      if (!j.kind) continue;
      ASSERT_TRUE(world.bodies().used[static_cast<std::size_t>(j.bodyA)]) << i;
      ASSERT_TRUE(world.bodies().used[static_cast<std::size_t>(j.bodyB)]) << i;
    }
  }
  EXPECT_GT(std::count_if(world.joints().begin(), world.joints().end(), [](const auto& j) { return bool(j.kind); }), 0);
  expectCaught("whose shapes are whose, a change late", staleShapes == 0);
  expectCaught("whose joints are whose, a change late", staleJoints == 0);
}
TEST(ChangeCost, ShapesAndJointsStayWithTheirBodies) { lives<2>(), lives<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::change_cost_test
