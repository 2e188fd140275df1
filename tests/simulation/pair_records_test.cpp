// SPDX-License-Identifier: Zlib
// The records of pairs that a world keeps from step to step. replay_test.cpp shows for every generator that a loaded
// world continues bit for bit, including the records.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/check_property.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace pair_records_test { namespace {

constexpr Real kDt = Real(1) / 60;

// The pairs that have a record: slots of their shapes and indices of their parts.
template <int D>
std::vector<std::array<int, 4>> recorded(const World<D>& world) {
  std::vector<std::array<int, 4>> out;
  for (const PairRecord& r : world.pairRecords()) out.push_back({r.shapeA, r.shapeB, r.partA, r.partB});
  return out;
}
using Pairs = std::vector<std::array<int, 4>>;

bool remembersSomething(std::span<const PairRecord> records) {
  return std::all_of(records.begin(), records.end(), [](const PairRecord& r) { return r.memory != PairMemory{}; });
}

// A box lies on a floor; a ball passes above it.
template <int D>
void comesAndGoes() {
  World<D> world(Pipeline::parse("contacts=query_clip"));
  addGround(world);
  const BodyHandle box = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5)));
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 1.505)));
  world.step(kDt);
  EXPECT_EQ(recorded(world), (Pairs{{0, 1, 0, 0}, {1, 2, 0, 0}}));
  EXPECT_TRUE(remembersSomething(world.pairRecords()));
  world.setPose(ball, {at<D>(0, 9), {}});
  world.step(kDt);
  EXPECT_EQ(recorded(world), (Pairs{{0, 1, 0, 0}})) << "their boxes are far apart";
  world.remove(box);
  EXPECT_EQ(recorded(world), Pairs{}) << "one of the two is no more";
}
TEST(PairRecords, ComeAndGoWithCandidates) { comesAndGoes<2>(), comesAndGoes<3>(); }

// Sleeping pairs, and pairs with contacts kept by the cache, are not queried and keep their records.
template <int D>
void outlast(const std::string& pipeline, bool sleeping) {
  SCOPED_TRACE(pipeline);
  WorldSettings<D> settings;
  settings.model.sleeping = sleeping;
  World<D> world(Pipeline::parse(pipeline), settings);
  addGround(world);
  world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5)));
  world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 1.5)));
  std::uint64_t asked = 1;
  for (int i = 0; i < 600 && asked > 0; ++i) {
    world.step(kDt);
    asked = world.profiler().frame().work[WorkCount::pairQueries];
  }
  EXPECT_EQ(asked, 0u) << "somebody is still asked about";
  EXPECT_EQ(recorded(world), (Pairs{{0, 1, 0, 0}, {1, 2, 0, 0}}));
  EXPECT_TRUE(remembersSomething(world.pairRecords()));
}
TEST(PairRecords, OutlastRestAndRecycling) {
  outlast<2>("contacts=query_clip sleep=split_average", true);
  outlast<3>("contacts=query_clip sleep=split_average", true);
  outlast<2>("contacts=query_clip cache=recycling", false);
  outlast<3>("contacts=query_clip cache=recycling", false);
}

// Each pair of parts has its own record.
template <int D>
void parts() {
  World<D> world(Pipeline::parse("contacts=deepest_point"));
  addGround(world);
  const Shape<D> cube = Shape<D>::box(Vec<D>::Constant(Real(0.5)));
  const std::vector<ShapePart<D>> pair = {{cube, {at<D>(-0.5, 0), {}}}, {cube, {at<D>(0.5, 0), {}}}};
  world.add(body<D>(Shape<D>::compound(pair), at<D>(0, 0.5)));
  world.step(kDt);
  EXPECT_EQ(recorded(world), (Pairs{{0, 1, 0, 0}, {0, 1, 0, 1}}));
  EXPECT_NE(world.pairRecords()[0].bodyA, world.pairRecords()[0].bodyB);
}
TEST(PairRecords, ArePerPairOfParts) { parts<2>(), parts<3>(); }

// No records if no method uses memory, or if the model has no cache.
template <int D>
void none() {
  for (const char* pipeline : {"contacts=sat_clip", "contacts=deepest_point{query=mpr}", "contacts=query_clip"}) {
    WorldSettings<D> settings;
    settings.model.cache = std::string_view(pipeline) != "contacts=query_clip";
    World<D> world(Pipeline::parse(pipeline), settings);
    addHeap(world, 4, 7);
    for (int i = 0; i < 60; ++i) world.step(kDt);
    EXPECT_GT(world.manifolds().size(), 1u) << pipeline;
    EXPECT_TRUE(world.pairRecords().empty()) << pipeline;
  }
}
TEST(PairRecords, AreNotKeptWithoutMemoryOrCache) { none<2>(), none<3>(); }

// Records of another method in a saved world do no harm and are dropped.
template <int D>
void otherPipelines() {
  World<D> first(Pipeline::parse("contacts=query_clip"));
  addHeap(first, 6, 7);
  for (int i = 0; i < 60; ++i) first.step(kDt);
  ASSERT_FALSE(first.pairRecords().empty());
  for (const char* pipeline : {"contacts=sat_clip", "contacts=deepest_point"}) {
    World<D> world(Pipeline::parse(pipeline));
    std::istringstream in(saved(first));
    world.load(in);
    EXPECT_EQ(saved(world), saved(first)) << pipeline;
    world.step(kDt);
    EXPECT_EQ(world.pairRecords().empty(), std::string_view(pipeline) == "contacts=sat_clip") << pipeline;
  }
}
// Also if all bodies sleep and no pair is queried.
TEST(PairRecords, OfSleepersAreDroppedByMethodsWithoutMemory) {
  WorldSettings<2> settings;
  settings.model.sleeping = true;
  World<2> first(Pipeline::parse("contacts=query_clip sleep=split_average"), settings);
  addGround(first);
  const BodyHandle box = first.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), {0, Real(0.5)}));
  for (int i = 0; i < 600 && first.awake(box); ++i) first.step(kDt);
  ASSERT_FALSE(first.awake(box));
  ASSERT_EQ(first.pairRecords().size(), 1u);
  World<2> other(Pipeline::parse("contacts=sat_clip sleep=split_average"), settings);
  std::istringstream in(saved(first));
  other.load(in);
  other.step(kDt);
  EXPECT_TRUE(other.pairRecords().empty());
}
TEST(PairRecords, CanBeReadByAnotherPipeline) { otherPipelines<2>(), otherPipelines<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::pair_records_test
