// SPDX-License-Identifier: Zlib
// Stage objects of a user's own in a world: they run without being registered.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "framework/world/world.h"
#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace stage_set_test { namespace {

constexpr Real kDt = Real(1) / 60;

/// What a CountedBroadphase has seen; it outlives the world.
struct Calls {
  int findPairs = 0;
  bool soundChanges = true;  // only new proxies were added, only known ones removed
};

/// Not registered. Hands on to a method that remembers boxes from step to step.
template <int D>
class CountedBroadphase final : public Broadphase<D> {
 public:
  explicit CountedBroadphase(Calls& calls) : m_calls(calls) {}
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    for (const ProxyId i : changes.removed) m_calls.soundChanges = m_known.erase(i) == 1 && m_calls.soundChanges;
    for (const ProxyId i : changes.added) m_calls.soundChanges = m_known.insert(i).second && m_calls.soundChanges;
    m_inner->update(proxies, changes);
  }
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    ++m_calls.findPairs;
    m_inner->findPairs(proxies, out, work);
  }

 private:
  Calls& m_calls;
  std::set<ProxyId> m_known;
  std::unique_ptr<Broadphase<D>> m_inner = createStage<Broadphase<D>>({"dynamic_tree", {}});
};

/// Supports no shapes.
template <int D>
class NoContacts final : public ContactGenerator<D> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return false; }
  void generate(const ContactInput<D>&, std::vector<Manifold<D>>&, WorkDone&) override {}
};

template <int D>
StageSet<D> counted(Calls& calls) {
  StageSet<D> out{Pipeline()};
  out.set(std::make_unique<CountedBroadphase<D>>(calls), "counted");
  return out;
}

template <int D>
void fill(World<D>& world, int n) {
  addGround(world);
  for (int i = 0; i < n; ++i) world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0.1 * i, 0.6 + 1.1 * i)));
}
template <int D>
void run(World<D>& world, int steps) {
  for (int i = 0; i < steps; ++i) world.step(kDt);
}

template <class Dimension>
class StageSetTest : public testing::Test {};
TYPED_TEST_SUITE(StageSetTest, BothDimensions);

TYPED_TEST(StageSetTest, AnUnregisteredStageRuns) {
  constexpr int D = TypeParam::D;
  Calls calls;
  World<D> own(counted<D>(calls)), plain(Pipeline::parse("broadphase=dynamic_tree"));
  fill(own, 5), fill(plain, 5);
  run(own, 60), run(plain, 60);
  EXPECT_EQ(own.hash(), plain.hash());
  EXPECT_EQ(calls.findPairs, 60);
  EXPECT_EQ(own.pipeline()[StageKind::broadphase].name, "counted");
  EXPECT_EQ(own.pipeline()[StageKind::solver], Pipeline()[StageKind::solver]);
}

TYPED_TEST(StageSetTest, LoadKeepsTheObject) {
  constexpr int D = TypeParam::D;
  Calls calls;
  World<D> world(counted<D>(calls));
  fill(world, 3);
  run(world, 20);
  std::stringstream bytes;
  world.save(bytes);
  run(world, 20);
  const std::uint64_t hash = world.hash();
  world.remove(world.handle(1));  // the broadphase has not heard of these two yet
  fill(world, 6);
  world.load(bytes);
  run(world, 20);
  EXPECT_EQ(world.hash(), hash);
  EXPECT_EQ(calls.findPairs, 60);
  EXPECT_TRUE(calls.soundChanges);
}

TYPED_TEST(StageSetTest, AnObjectReplacesAnAlgorithmBetweenSteps) {
  constexpr int D = TypeParam::D;
  Calls calls;
  World<D> world, plain;
  fill(world, 3), fill(plain, 3);
  run(world, 10), run(plain, 10);
  world.setPipeline(counted<D>(calls));
  EXPECT_NE(refusalOf([&] { world.setPipeline(world.pipeline()); }).find("counted"), std::string::npos);
  run(world, 10), run(plain, 10);
  world.setPipeline(Pipeline());
  run(world, 10), run(plain, 10);
  EXPECT_EQ(calls.findPairs, 10);
  EXPECT_EQ(world.hash(), plain.hash());
}

TYPED_TEST(StageSetTest, WhatCannotRunIsRefused) {
  constexpr int D = TypeParam::D;
  StageSet<D> stages{Pipeline()};
  EXPECT_EQ(refusalOf([&] { stages.set(std::unique_ptr<Solver<D>>()); }), "solver: the stage object is null");
  EXPECT_FALSE(stages.isOwn(StageKind::solver));
  stages.set(std::make_unique<NoContacts<D>>());
  EXPECT_TRUE(stages.isOwn(StageKind::contacts));
  World<D> world;
  fill(world, 1);
  const std::string refusal = refusalOf([&] { world.setPipeline(std::move(stages)); });
  EXPECT_NE(refusal.find("contacts=own does not support"), std::string::npos) << refusal;
  run(world, 1);  // nothing has changed
}

template <int D, class S>
concept Takes = requires(StageSet<D> stages, std::unique_ptr<S> stage) {
  stages.set(std::move(stage));
};
static_assert(Takes<2, Broadphase<2>> && Takes<3, CountedBroadphase<3>>);
static_assert(!Takes<2, Broadphase<3>> && !Takes<3, CountedBroadphase<2>>, "of the other dimension");
static_assert(!Takes<2, VelocityResolver<2>>, "a part of a solver is no stage of a world");

}}}}}  // namespace lpc::LPC_PRECISION::test::stage_set_test
