// SPDX-License-Identifier: Zlib
// Worlds with a mesh or chain: the same bits with every broadphase and after saving, a cost that hardly grows with the
// surface, one event per pair, and fast bodies that do not fall through.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/surfaces.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace surface_test { namespace {

constexpr Real kDt = Real(1) / 60;

double waves(double x) { return 0.4 * std::abs(x - 3 * std::floor(x / 3) - 1.5); }

template <int D>
void addTerrain(World<D>& world) {
  BodyDef<D> ground = body<D>(roughGround<D>(2, GroundOf::surface, waves), Vec<D>::Zero(), BodyType::fixed);
  ground.shapes[0].X_BS.p = at<D>(-6, 0);
  world.add(ground);
  Random random(4);
  for (int i = 0; i < 14; ++i) {
    const double x = random.uniform(-4, 4), z = random.uniform(-2, 2);
    const Shape<D> shapes[] = {Shape<D>::box(Vec<D>::Constant(Real(0.3))), Shape<D>::sphere(Real(0.3)),
                               Shape<D>::capsule(Real(0.3), Real(0.2))};
    world.add(body<D>(shapes[i % 3], at<D>(x, 1.5 + 0.4 * i, z)));
  }
}

template <int D>
std::vector<std::uint64_t> hashes(const std::string& pipeline) {
  World<D> world(Pipeline::parse(pipeline));
  addTerrain(world);
  std::vector<std::uint64_t> out;
  for (int i = 0; i < 120; ++i) world.step(kDt), out.push_back(world.hash());
  return out;
}
template <int D>
void sameBitsByEveryBroadphase() {
  const auto naive = hashes<D>("broadphase=naive");
  for (const Registered* r : Registry::instance().list(StageKind::broadphase, D)) {
    if (!competes(*r) || r->info.guarantee != Guarantee::exact) continue;
    EXPECT_EQ(hashes<D>("broadphase=" + r->info.name), naive) << r->info.name;
  }
}
TEST(Surface, SameBitsByEveryBroadphase2) { sameBitsByEveryBroadphase<2>(); }
TEST(Surface, SameBitsByEveryBroadphase3) { sameBitsByEveryBroadphase<3>(); }

template <int D>
void savedIsContinued(const std::string& pipeline) {
  World<D> a(Pipeline::parse(pipeline)), b(Pipeline::parse(pipeline));
  addTerrain(a);
  for (int i = 0; i < 60; ++i) a.step(kDt);
  std::istringstream in(saved(a));
  b.load(in);
  ASSERT_EQ(saved(b), saved(a));
  for (int i = 0; i < 60; ++i) {
    a.step(kDt), b.step(kDt);
    ASSERT_EQ(saved(a), saved(b)) << pipeline << ", step " << i;
  }
}
TEST(Surface, SavedIsContinued) {
  for (const char* pipeline : {"contacts=sat_clip", "contacts=query_clip",
                               "contacts=persistent_manifold cache=recycling", "continuous=speculative"}) {
    savedIsContinued<2>(pipeline);
    savedIsContinued<3>(pipeline);
  }
}

// Work per step of a box on level ground with 2 n^2 parts.
template <int D>
std::uint64_t workOnLevelGround(int n) {
  Shape<D> ground = Shape<D>::sphere(1);
  if constexpr (D == 2) {
    std::vector<Vec<2>> points;
    for (int i = 2 * n * n; i >= 0; --i) points.push_back(at<2>(i - n * n, 0));
    ground = Shape<2>::chain(points, false);
  } else {
    std::vector<Vec<3>> points;
    std::vector<std::array<int, 3>> triangles;
    for (int i = 0; i <= n; ++i) {
      for (int k = 0; k <= n; ++k) points.push_back(at<3>(i - n / 2, 0, k - n / 2));
    }
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) {
        const int a = i * (n + 1) + k, b = a + n + 1;
        triangles.insert(triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
      }
    }
    ground = Shape<3>::mesh(points, triangles);
  }
  World<D> world(Pipeline::parse("continuous=cast"));
  world.add(body<D>(ground, Vec<D>::Zero(), BodyType::fixed));
  BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.4))), at<D>(0.3, 0.4, 0.2));
  def.velocity = at<D>(40, 0);  // fast: the swept region counts, too
  def.canSleep = false;
  world.add(def);
  std::uint64_t most = 0;
  for (int i = 0; i < 10; ++i) {
    world.step(kDt);
    const WorkDone& work = world.profiler().frame().work;
    most = std::max(most, work[WorkCount::nodeVisits] + work[WorkCount::partTests]);
  }
  return most;
}
TEST(Surface, CostGrowsWithTheLogarithm) {
  // With 156 times as many parts.
  EXPECT_LT(workOnLevelGround<2>(100), 3 * workOnLevelGround<2>(8));
  EXPECT_LT(workOnLevelGround<3>(100), 3 * workOnLevelGround<3>(8));
}

template <int D>
class Counts final : public ContactListener<D> {
 public:
  bool begin(const World<D>&, const Manifold<D>&) override { return ++begun, true; }
  void end(const World<D>&, const Manifold<D>&) override { ++ended; }
  int begun = 0, ended = 0;
};
template <int D>
void listenersHearOnce() {
  World<D> world;
  Counts<D> counts;
  world.addListener(&counts);
  world.add(body<D>(roughGround<D>(5, GroundOf::surface, level), Vec<D>::Zero(), BodyType::fixed));
  BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5));
  def.velocity = at<D>(4, 0), def.shapes[0].friction = 0;
  world.add(def);
  for (int i = 0; i < 100; ++i) world.step(kDt);
  EXPECT_EQ(counts.begun, 1);
  EXPECT_EQ(counts.ended, 0);
}
TEST(Surface, ListenersHearOnce) {
  listenersHearOnce<2>();
  listenersHearOnce<3>();
}

template <int D>
bool bulletIsStopped(const std::string& continuous) {
  World<D> world(Pipeline::parse("continuous=" + continuous));
  world.add(body<D>(roughGround<D>(5, GroundOf::surface, level), Vec<D>::Zero(), BodyType::fixed));
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(3, 3, 0.3));
  def.velocity = at<D>(20, -150);
  const BodyHandle bullet = world.add(def);
  for (int i = 0; i < 30; ++i) world.step(kDt);
  return world.pose(bullet).p[1] > 0;
}
TEST(Surface, BulletsDoNotFallThrough) {
  for (const char* continuous : {"cast", "ray", "speculative"}) {
    EXPECT_TRUE(bulletIsStopped<2>(continuous)) << continuous;
    EXPECT_TRUE(bulletIsStopped<3>(continuous)) << continuous;
  }
  expectCaught("a chain and a bullet that nobody looks at", bulletIsStopped<2>("none"));
  expectCaught("a mesh and a bullet that nobody looks at", bulletIsStopped<3>("none"));
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::surface_test
