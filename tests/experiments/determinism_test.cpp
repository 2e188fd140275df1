// SPDX-License-Identifier: Zlib
// A hash per scene and pipeline: the same scene gives the same bits when run again, also after other worlds ran in
// between. The broadphases, a few for each scene, give the same trajectory.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "experiments/trial/scene/scene_file.h"
#include "framework/scene/director.h"
#include "framework/world/settings.h"
#include "framework/world/world.h"
#include "tests/check_property.h"
#include "tests/experiments/scene_states.h"

namespace lpc { inline namespace LPC_PRECISION { namespace determinism_test { namespace {

#if defined(LPC_SANITIZED)
constexpr long kSteps = 15;  // thirty times slower
#else
constexpr long kSteps = 90;
#endif
constexpr std::size_t kBodies = 400;  // larger scenes are for sweeps
constexpr long kWork = 4000;          // bodies times steps of a run: large scenes run fewer steps
constexpr int kShare = 4;             // one broadphase in so many per scene, others for the next

std::vector<SceneFile> scenes() {
  std::vector<std::string> paths;
  for (const auto& e : std::filesystem::directory_iterator(std::string(LPC_SOURCE_DIR) + "/experiments/scenes")) {
    if (e.path().extension() == ".toml") paths.push_back(e.path().string());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<SceneFile> out;
  for (const std::string& p : paths) out.push_back(SceneFile::load(p));
  return out;
}

// One hash over the states of all steps.
template <int D>
std::uint64_t historyOf(const SceneSpec<D>& scene, const std::string& pipeline) {
  World<D> world(Pipeline::parse(pipeline), scene.settings);
  Director<D> director(scene);
  std::uint64_t hash = 0;
  const long affordable = std::max(10L, kWork / static_cast<long>(scene.spawns.size()));
  for (long i = 0; i < std::min({kSteps, scene.steps, affordable}); ++i) {
    director.advance(world);
    world.step(scene.dt);
    hash = hash * 0x100000001b3u ^ world.hash();
  }
  return hash;
}

template <int D>
void sameBits(const SceneFile& file, int number) {
  if (!file.has(D) || test::bodiesOf(file.name(), D) > kBodies) return;
  const SceneSpec<D> scene = file.build<D>({}, file.defaultSeed());
  if (scene.spawns.size() > kBodies) return;
  SCOPED_TRACE(file.name() + " in " + std::to_string(D) + "D");
  const std::uint64_t expected = historyOf(scene, "");
  for (const std::string& pipeline :
       {std::string(), std::string("solver=soft_step sleep=split_average"),
        std::string("contacts=query_clip solver=split_solver{velocity=naive,position=linear}")}) {
    const std::uint64_t once = pipeline.empty() ? expected : historyOf(scene, pipeline);
    EXPECT_EQ(historyOf(scene, pipeline), once) << pipeline;
  }
  const int share = test::caseCount(test::kCases) > test::kCases ? 1 : kShare;
  for (const Registered* r : Registry::instance().list(StageKind::broadphase, D)) {
    if (number++ % share != 0) continue;
    EXPECT_EQ(historyOf(scene, "broadphase=" + r->info.name), expected) << r->info.name;
  }
}

TEST(Determinism, EveryScene) {
  int number = 0;
  for (const SceneFile& file : scenes()) {
    sameBits<2>(file, number);
    sameBits<3>(file, number + 2);
    ++number;
  }
}

// The contact generators of the default pipeline and of the 2009 settings support the shapes of every scene.
template <int D>
void needsNoOtherPipeline(const SceneFile& file) {
  if (!file.has(D)) return;
  std::array<bool, kShapeKinds> kinds{};
  for (const auto& spawn : file.build<D>({}, file.defaultSeed()).spawns) {
    for (const ShapeDef<D>& def : spawn.body.shapes) markKinds(def.shape, kinds);
  }
  for (const Pipeline& pipeline : {Pipeline{}, Settings::lpc2009(D).pipeline()}) {
    const auto contacts = createStage<ContactGenerator<D>>(pipeline[StageKind::contacts]);
    EXPECT_NO_THROW(requireContacts(*contacts, kinds, file.name())) << D << "D, " << pipeline.text();
  }
}
TEST(Determinism, EverySceneNeedsNoOtherPipeline) {
  for (const SceneFile& file : scenes()) needsNoOtherPipeline<2>(file), needsNoOtherPipeline<3>(file);
}

// The check must be able to fail: one bit in a start position changes the history.
TEST(Determinism, OneBitOfDifferenceIsSeen) {
  SceneSpec<2> scene =
      SceneFile::load(std::string(LPC_SOURCE_DIR) + "/experiments/scenes/vertical_stack.toml").build<2>({}, 1);
  const std::uint64_t before = historyOf(scene, "");
  Real& x = scene.spawns.back().body.X_WB.p[1];
  x = std::nextafter(x, Real(100));
  EXPECT_NE(historyOf(scene, ""), before);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::determinism_test
