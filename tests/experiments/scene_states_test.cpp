// SPDX-License-Identifier: Zlib
// Each scene with default parameters, bit by bit: a change of a scene changes its line in scene_states.txt.
#include "tests/experiments/scene_states.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <filesystem>
#include <functional>

#include "experiments/runner/locations.h"
#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scene_states_test { namespace {

#if defined(LPC_SANITIZED)
constexpr std::size_t kBodies = 1000;  // larger scenes take seconds to build
#else
constexpr std::size_t kBodies = 1000000;
#endif

class Hash {
 public:
  void word(std::uint64_t w) {
    m_hash = (m_hash ^ w) * 0x9e3779b97f4a7c15u;
    m_hash ^= m_hash >> 32;
  }
  void number(double x) { word(std::bit_cast<std::uint64_t>(x + 0.0)); }  // -0 counts as 0
  void text(const std::string& s) {
    for (const char c : s) word(static_cast<unsigned char>(c));
    word(s.size());
  }
  template <class Derived>
  void numbers(const Eigen::MatrixBase<Derived>& m) {
    for (const Real x : m.reshaped()) number(x);
  }
  template <int D>
  void pose(const Pose<D>& X) {
    numbers(X.p), numbers(X.q.matrix());
  }
  std::string hex() const {
    char out[17];
    std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(m_hash));
    return out;
  }

 private:
  std::uint64_t m_hash = 0;
};

template <int D>
void addBody(const BodyDef<D>& body, Hash& hash) {
  hash.word(static_cast<std::uint64_t>(body.type)), hash.pose(body.X_WB);
  hash.numbers(body.velocity), hash.numbers(body.angularVelocity);
  for (const bool b : {body.pinned, body.rotatable, body.canSleep, body.awake}) hash.word(b);
  for (const ShapeDef<D>& s : body.shapes) {
    forParts(s.shape, s.X_BS, [&](const ShapeView<D>& part, const Pose<D>& X_BS) {
      hash.word(static_cast<std::uint64_t>(part.kind));
      hash.pose(X_BS), hash.number(part.radius);
      hash.numbers(part.hull ? Vec<D>(Vec<D>::Zero()) : part.half);  // a hull's follows from its vertices
      if (!part.hull) return;
      for (const Vec<D>& v : part.hull->vertices) hash.numbers(v);
    });
    hash.number(s.density), hash.number(s.friction), hash.number(s.restitution);
    hash.word(s.category), hash.word(s.mask);
  }
}

// Hashes the steps and bodies of events; their effects are code.
template <int D>
std::string hashOf(const SceneSpec<D>& scene) {
  Hash hash;
  hash.numbers(scene.settings.gravity), hash.number(scene.dt);
  hash.number(scene.settings.restitutionThreshold), hash.number(scene.settings.margin);
  hash.word(static_cast<std::uint64_t>(scene.steps)), hash.text(modelText(scene.settings.model));
  for (const auto& s : scene.spawns) {
    hash.word(static_cast<std::uint64_t>(s.step)), hash.word(static_cast<std::uint64_t>(s.removeAt));
    addBody(s.body, hash);
  }
  for (const auto& j : scene.joints) {
    hash.word(static_cast<std::uint64_t>(j.bodyA)), hash.word(static_cast<std::uint64_t>(j.bodyB));
    hash.text(j.def.kind), hash.pose(j.def.X_WJ), hash.word(j.def.collide),
        hash.word(static_cast<std::uint64_t>(j.step));
    if (j.def.X_WJb) hash.pose(*j.def.X_WJb);
  }
  for (const auto& f : scene.forces) {
    hash.word(static_cast<std::uint64_t>(f.bodyA)), hash.word(static_cast<std::uint64_t>(f.bodyB));
    hash.text(f.def.kind);
    for (const auto& anchor : {f.def.anchorA, f.def.anchorB}) {
      if (anchor) hash.numbers(*anchor);
    }
    hash.word(static_cast<std::uint64_t>(f.step)), hash.word(static_cast<std::uint64_t>(f.removeAt));
  }
  for (const auto& e : scene.events) {
    hash.word(static_cast<std::uint64_t>(e.step)), hash.word(static_cast<std::uint64_t>(e.body));
  }
  return hash.hex();
}

// Builds every scene, in each dimension, that is small enough for a test.
template <int D, class See>
void every(const See& see) {
  for (const std::string& path : listToml("scenes")) {
    const SceneFile file = SceneFile::load(path);
    if (!file.has(D) || test::bodiesOf(file.name(), D) > kBodies) continue;
    SCOPED_TRACE(file.name() + " in " + std::to_string(D) + "D");
    see(file, file.build<D>({}, file.defaultSeed()));
  }
}

template <int D>
void build() {
  every<D>([](const SceneFile& file, const SceneSpec<D>& scene) {
    EXPECT_EQ(file.name(), std::filesystem::path(file.path()).stem().string());
    EXPECT_FALSE(file.summary().empty());
    const auto fromTheStart = [](const auto& s) { return s.step == 0; };
    EXPECT_TRUE(std::any_of(scene.spawns.begin(), scene.spawns.end(), fromTheStart));
    const auto pinned = test::sceneStates().find({file.name(), D});
    if (pinned == test::sceneStates().end()) return;  // a new scene is one file: it needs no row
    EXPECT_EQ(scene.spawns.size(), pinned->second.bodies);
    EXPECT_EQ(hashOf(scene), pinned->second.hash) << "is the change meant? Then read the top of scene_states.txt";
  });
}
TEST(SceneStates, areUnchanged) { build<2>(), build<3>(); }

TEST(SceneStates, namesOnlyExistingScenes) {
  EXPECT_GT(test::sceneStates().size(), 40u);
  for (const auto& [key, state] : test::sceneStates()) {
    EXPECT_TRUE(SceneFile::load(findToml("scenes", key.first)).has(key.second)) << key.first;
  }
}

// The check must be able to fail: one bit, one body, one coefficient, one joint.
TEST(SceneStates, aSmallChangeIsSeen) {
  const auto load = [] { return SceneFile::load(findToml("scenes", "bridge")).build<2>({}, 1); };
  const std::string before = hashOf(load());
  EXPECT_EQ(hashOf(load()), before);
  const std::function<void(SceneSpec<2>&)> plants[] = {
      [](auto& s) { s.spawns[3].body.X_WB.p[0] = std::nextafter(s.spawns[3].body.X_WB.p[0], Real(100)); },
      [](auto& s) { s.spawns.pop_back(); },
      [](auto& s) { s.spawns[0].body.shapes[0].friction += Real(0.1); },
      [](auto& s) {
        s.spawns[0].body.shapes[0].shape = Shape<2>::box({Real(0.45), Real(0.06)});
      },
      [](auto& s) { s.joints[2].def.kind = "weld"; },
      [](auto& s) { s.settings.gravity[1] = Real(-9.81); }};
  for (const auto& plant : plants) {
    SceneSpec<2> scene = load();
    plant(scene);
    EXPECT_NE(hashOf(scene), before);
  }
}

// Writes the table again: see its first lines.
template <int D>
void print() {
  every<D>([](const SceneFile& file, const SceneSpec<D>& scene) {
    std::printf("%s %d %zu %s\n", file.name().c_str(), D, scene.spawns.size(), hashOf(scene).c_str());
  });
}
TEST(SceneStates, DISABLED_print) { print<2>(), print<3>(); }

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scene_states_test
