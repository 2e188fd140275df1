// SPDX-License-Identifier: Zlib
// Same history, same bits: saving, loading, other broadphases, watching, strangers far away.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using test::addHeap;
using test::at;
using test::body;

constexpr Real kDt = Real(1) / 60;

std::vector<std::string> pipelines() {
  return {"", "solver=soft_step", "cache=none", "sleep=split_average",
          "contacts=query_clip solver=split_solver{velocity=millington,position=nonlinear}"};
}

template <int D>
std::vector<std::uint64_t> hashes(World<D>& world, int steps) {
  std::vector<std::uint64_t> out;
  for (int i = 0; i < steps; ++i) {
    world.step(kDt);
    out.push_back(world.hash());
  }
  return out;
}

template <int D>
std::string saved(const World<D>& world) {
  std::ostringstream out;
  world.save(out);
  return out.str();
}

template <int D>
void saveLoadContinue(const std::string& pipeline) {
  SCOPED_TRACE(std::to_string(D) + "D " + pipeline);
  World<D> world(Pipeline::parse(pipeline));
  addHeap(world, 8, 7);
  hashes(world, 60);
  // One that was removed and one that was added leave a hole and a reused slot.
  world.remove(world.handle(3));
  const std::string bytes = saved(world);
  EXPECT_EQ(saved(world), bytes) << "saving disturbs";
  World<D> other(Pipeline::parse(pipeline));
  std::istringstream in(bytes);
  other.load(in);
  EXPECT_EQ(saved(other), bytes);
  world.add(body<D>(Shape<D>::sphere(Real(0.3)), at<D>(0, 9)));
  other.add(body<D>(Shape<D>::sphere(Real(0.3)), at<D>(0, 9)));
  for (int i = 0; i < 60; ++i) {
    world.step(kDt), other.step(kDt);
    ASSERT_EQ(saved(world), saved(other)) << "step " << i << " after loading";
  }
}

TEST(Replay, SavedLoadedAndContinuedIsTheSameBytes) {
  for (const std::string& p : pipelines()) saveLoadContinue<2>(p), saveLoadContinue<3>(p);
}

TEST(Replay, DamagedSavesAreRefusedAndChangeNothing) {
  World<2> world;
  addHeap(world, 3, 7);
  const std::string bytes = saved(world);
  const std::uint64_t hash = world.hash();
  for (const std::string& wrong : {std::string("nonsense"), std::string(), bytes.substr(0, bytes.size() / 2)}) {
    std::istringstream in(wrong);
    EXPECT_THROW(world.load(in), UserError);
    EXPECT_EQ(world.hash(), hash);
  }
  World<3> space;
  std::istringstream in(bytes);
  EXPECT_THROW(space.load(in), UserError);
}

template <int D>
void sameForAllBroadphases() {
  std::vector<std::uint64_t> expected;
  for (const Registered* r : Registry::instance().list(StageKind::broadphase, D)) {
    World<D> world(Pipeline::parse("broadphase=" + r->info.name));
    addHeap(world, 12, 3);
    const auto found = hashes(world, 150);
    if (expected.empty()) expected = found;
    EXPECT_EQ(found, expected) << r->info.name << " in " << D << "D";
  }
  EXPECT_FALSE(expected.empty());
}

TEST(Replay, EveryBroadphaseGivesTheSameTrajectory) {
  sameForAllBroadphases<2>();
  sameForAllBroadphases<3>();
}

// The property must be able to fail: a pipeline that really differs differs.
TEST(Replay, AnotherResolverGivesAnotherTrajectory) {
  World<2> a, b(Pipeline::parse("solver=soft_step"));
  addHeap(a, 12, 3), addHeap(b, 12, 3);
  EXPECT_NE(hashes(a, 150), hashes(b, 150));
}

template <int D>
void strangersChangeNothing() {
  const auto poses = [](bool stranger) {
    World<D> world;
    addHeap(world, 10, 5);
    if (stranger) world.add(body<D>(Shape<D>::sphere(1), at<D>(1000, 1000), BodyType::fixed));
    world.profiler().keepFrames(stranger);
    for (int i = 0; i < 100; ++i) world.step(kDt);
    std::vector<Vec<D>> out;
    for (std::size_t i = 0; i < 13; ++i) out.push_back(world.bodies().pose[i].p);
    return out;
  };
  EXPECT_EQ(poses(false), poses(true));
}

TEST(Replay, AStrangerFarAwayAndAKeptProfileChangeNothing) {
  strangersChangeNothing<2>();
  strangersChangeNothing<3>();
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
