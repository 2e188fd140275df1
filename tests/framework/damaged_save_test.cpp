// SPDX-License-Identifier: Zlib
// A damaged saved world is rejected with a one-line message, or it is still valid: no index read from it may be out of
// range. Rejection leaves the world unchanged.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "framework/world/saved_state.h"
#include "tests/check_property.h"
#include "tests/fuzz/damaged_world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace damaged_save_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN();
constexpr char kPipeline[] = "contacts=query_clip sleep=split_average";

template <int D>
std::string filledAndSaved() {
  World<D> world(Pipeline::parse(kPipeline));
  addEverything(world);
  EXPECT_GT(world.manifolds().size(), 2u);
  return saved(world);
}

// Empty if the bytes were loaded; otherwise the message.
template <int D>
std::string refusal(World<D>& world, const std::string& bytes) {
  std::istringstream in(bytes);
  try {
    world.load(in);
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

template <int D>
void truncate() {
  const std::string bytes = filledAndSaved<D>();
  World<D> world(Pipeline::parse(kPipeline));
  addEverything(world);
  world.step(kDt);
  const std::string before = saved(world);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_EQ(refusal(world, bytes.substr(0, length)), "load: the saved world ends early") << length;
  }
  EXPECT_EQ(saved(world), before);
  EXPECT_EQ(refusal(world, bytes), "");
  EXPECT_EQ(saved(world), bytes);
}
TEST(DamagedSave, EveryTruncationIsRefused) { truncate<2>(), truncate<3>(); }

template <int D>
void everyFlipIsTold() {
  const std::string bytes = filledAndSaved<D>();
  ASSERT_EQ(sealed(bytes), bytes);
  World<D> world(Pipeline::parse(kPipeline));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    ASSERT_TRUE(refusal(world, damaged).starts_with("load: ")) << i;
  }
  ASSERT_EQ(world.bodyCount(), 0);
}
TEST(DamagedSave, EveryFlippedByteIsDetected) { everyFlipIsTold<2>(), everyFlipIsTold<3>(); }

#if defined(LPC_SANITIZED)
constexpr std::size_t kEvery = 5;  // neighbouring bytes behave alike, and sanitizers are slow
#else
constexpr std::size_t kEvery = 1;
#endif

template <int D>
void flip() {
  const std::string bytes = filledAndSaved<D>();
  World<D> world(Pipeline::parse(kPipeline));
  addEverything(world);
  int refused = 0, loaded = 0;
  for (std::size_t i = 0; i < bytes.size(); i += kEvery) {
    for (const int mask : {0x01, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ mask);
      if (i >= kSavedBody) damaged = sealed(damaged);
      const std::uint64_t hash = world.hash();
      const std::string what = refusal(world, damaged);
      if (what.empty()) {
        ++loaded;
        world.step(kDt);
      } else {
        ++refused;
        ASSERT_TRUE(what.starts_with("load: ")) << what;
        ASSERT_EQ(what.find('\n'), what.npos) << what;
        ASSERT_EQ(world.hash(), hash) << what;
      }
    }
  }
  EXPECT_GT(refused, 1000 / static_cast<int>(kEvery));
  EXPECT_GT(loaded, 1000 / static_cast<int>(kEvery));
}
TEST(DamagedSave, EveryFlippedByteIsRefusedOrHarmless2) { flip<2>(); }
TEST(DamagedSave, EveryFlippedByteIsRefusedOrHarmless3) { flip<3>(); }

// Extreme values replace one or a few numbers, in every pipeline that keeps data.
template <int D>
void edges() {
  Random random(seedOf("edges in a saved world"));
  const int cases = caseCount(200);
  std::filesystem::create_directories(LPC_BINARY_DIR "/failures");
  for (std::size_t k = 0; k < kDamagedPipelines.size(); ++k) {
    const std::string whole = payloadOf<D>(k);
    const Life sound = livesOn<D>(whole, kDamagedPipelines[k], true);
    EXPECT_TRUE(sound.loaded) << kDamagedPipelines[k];
    EXPECT_EQ(sound.fault, "");
    int refused = 0, loaded = 0;
    for (int i = 0; i < cases; ++i) {
      std::string payload = whole;
      do putEdge(payload, random);
      while (random.below(3) == 0);
      const std::string kept = LPC_BINARY_DIR "/failures/saved_world_" + std::to_string(D);
      std::ofstream(kept) << payload;  // stays if the program crashes
      const Life life = livesOn<D>(payload, kDamagedPipelines[k], true);
      ASSERT_EQ(life.fault, "") << kDamagedPipelines[k] << ", " << kept;
      std::filesystem::remove(kept);
      ++(life.loaded ? loaded : refused);
    }
    EXPECT_GT(refused, 0) << kDamagedPipelines[k];
    EXPECT_GT(loaded, 0) << kDamagedPipelines[k];
  }
}
TEST(DamagedSave, NumbersAtTheEdgesAreRefusedOrHarmless2) { edges<2>(); }
TEST(DamagedSave, NumbersAtTheEdgesAreRefusedOrHarmless3) { edges<3>(); }

// The contents of a saved world, to be damaged in one place.
template <int D>
struct Damaged : SavedState<D> {
  std::string contacts = "query_clip";

  explicit Damaged(const World<D>& w)
      : SavedState<D>{w.settings(),
                      w.bodies(),
                      {w.shapes().begin(), w.shapes().end()},
                      {w.joints().begin(), w.joints().end()},
                      {w.manifolds().begin(), w.manifolds().end()},
                      std::vector<Wrench<D>>(w.bodies().pose.size()),
                      {{SleepEvent::userChange, 0, -1}},
                      1,
                      kDt,
                      kDt,
                      1,
                      {w.pairRecords().begin(), w.pairRecords().end()},
                      {w.forces().begin(), w.forces().end()}} {}

  std::string refusal() const {
    try {
      requireValidState<D>(*this, *createStage<ContactGenerator<D>>(Spec::parse(contacts)));
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  }
  // The first shape of this kind, with its own hull or sizes.
  ShapeRecord<D>& shape(ShapeKind kind) {
    for (ShapeRecord<D>& s : this->shapes) {
      if (s.body >= 0 && s.shape.convex() && s.shape.kind() == kind) return s;
    }
    ADD_FAILURE() << "no " << shapeKindName(kind);
    return this->shapes[0];
  }
  template <class Spoil>
  void hull(const Spoil& spoil) {
    Polytope<D> hull = *shape(ShapeKind::polytope).shape.view().hull;
    spoil(hull);
    shape(ShapeKind::polytope).shape = Shape<D>::polytope(std::make_shared<const Polytope<D>>(hull));
  }
};

template <int D>
struct Damage {
  const char* says;
  std::function<void(Damaged<D>&)> spoil;
};

constexpr std::int32_t kFreeSlot = 1;  // of the removed body

template <int D>
std::vector<Damage<D>> damages() {
  using P = Damaged<D>&;
  std::vector<Damage<D>> list = {
      {"a setting", [](P p) { p.settings.gravity[0] = kNan; }},
      {"a setting", [](P p) { p.settings.margin = -1; }},
      {"the time", [](P p) { p.time = kNan; }},
      {"the time", [](P p) { p.lastDt = -1; }},
      {"the time", [](P p) { p.sinceContacts = -1; }},
      {"the number of steps", [](P p) { p.steps = -1; }},
      {"the number of steps", [](P p) { p.steps = std::numeric_limits<std::int64_t>::max(); }},
      {"unequal lengths", [](P p) { p.bodies.sleep.pop_back(); }},
      {"unequal lengths", [](P p) { p.bodies.solver.pop_back(); }},
      {"unequal lengths", [](P p) { p.bodies.pose.emplace_back(); }},
      {"unequal lengths", [](P p) { p.userForces.pop_back(); }},
      {"of unknown type", [](P p) { p.bodies.type[0] = static_cast<BodyType>(3); }},
      {"a body's flag", [](P p) { p.bodies.awake[0] = 2; }},
      {"a mass", [](P p) { p.bodies.mass[2] = kNan; }},
      {"without mass", [](P p) { p.bodies.mass[2] = 0; }},
      {"a centre of mass", [](P p) { p.bodies.center[2][0] = kNan; }},
      {"a shape refers to an invalid body", [](P p) { p.shapes[0].body = p.bodies.size(); }},
      {"a shape refers to an invalid body", [](P p) { p.shapes[0].body = kFreeSlot; }},
      {"a shape refers to an invalid body", [](P p) { p.shapes[0].body = -2; }},
      {"a shape's pose", [](P p) { p.shapes[0].X_CS.p[0] = kNan; }},
      {"a shape's pose", [](P p) { p.shapes[0].X_CS.q = Rot<D>{0}; }},
      {"friction", [](P p) { p.shapes[0].friction = -1; }},
      {"a plane on a body", [](P p) { p.shape(ShapeKind::plane).body = 2; }},
      {"does not support", [](P p) { p.contacts = "query_clip{query=closed_form}"; }},
      {"a joint refers to an invalid body", [](P p) { p.joints[0].bodyB = -1; }},
      {"a joint refers to an invalid body", [](P p) { p.joints[0].bodyA = -7; }},
      {"a joint refers to an invalid body", [](P p) { p.joints[0].bodyB = p.bodies.size(); }},
      {"a joint refers to an invalid body", [](P p) { p.joints[0].bodyB = kFreeSlot; }},
      {"a joint refers to an invalid body", [](P p) { p.joints[0].bodyB = p.joints[0].bodyA; }},
      {"a joint's flag", [](P p) { p.joints[0].collide = 2; }},
      {"a joint's flag", [](P p) { p.joints[0].broken = 2; }},
      {"break force or torque", [](P p) { p.joints[0].breakTorque = kNan; }},
      {"not a rotation", [](P p) { p.joints[0].X_CbJ.q = Rot<D>{0}; }},
      {"a force refers to an invalid body",
       [](P p) { p.forces[1].bodyA = p.bodies.size(); }},  // a spring's; 0 is a free slot
      {"a force refers to an invalid body", [](P p) { p.forces[1].bodyB = kFreeSlot; }},
      {"a force refers to an invalid body", [](P p) { p.forces[1].bodyB = -1; }},
      {"a force refers to an invalid body", [](P p) { p.forces[1].bodyB = p.forces[1].bodyA; }},
      {"a force refers to an invalid body", [](P p) { p.forces[2].bodyA = 0; }},
      {"a force refers to an invalid body", [](P p) { p.forces[2].bodyB = -2; }},
      {"a force's anchor", [](P p) { p.forces[1].localB[0] = kNan; }},
      {"a contact refers to an invalid body", [](P p) { p.manifolds[0].bodyB = p.bodies.size(); }},
      {"a contact refers to an invalid body", [](P p) { p.manifolds[0].bodyA = -1; }},
      {"a contact refers to an invalid body", [](P p) { std::swap(p.manifolds[0].bodyA, p.manifolds[0].bodyB); }},
      {"a contact refers to an invalid shape",
       [](P p) { p.manifolds[0].shapeB = static_cast<std::int32_t>(p.shapes.size()); }},
      {"a contact refers to an invalid shape", [](P p) { p.manifolds[0].shapeB = p.manifolds[0].shapeA; }},
      {"a contact has a negative part number", [](P p) { p.manifolds[0].partA = -1; }},
      {"number of points", [](P p) { p.manifolds[0].count = kManifoldPoints<D> + 1; }},
      {"number of points", [](P p) { p.manifolds[0].count = 0; }},
      {"a contact's flag", [](P p) { p.manifolds[0].ignored = 2; }},
      {"out of order", [](P p) { std::swap(p.manifolds[0], p.manifolds[1]); }},
      {"a record refers to an invalid body", [](P p) { p.records[0].bodyB = p.bodies.size(); }},
      {"a record refers to an invalid body", [](P p) { std::swap(p.records[0].bodyA, p.records[0].bodyB); }},
      {"a record refers to an invalid shape", [](P p) { p.records[0].shapeA = -1; }},
      {"a record has a negative part number", [](P p) { p.records[0].partB = -1; }},
      {"pair records out of order", [](P p) { std::swap(p.records[0], p.records[1]); }},
      {"pair records out of order", [](P p) { p.records[1] = p.records[0]; }},
      {"of unknown kind", [](P p) { p.events[0].kind = static_cast<SleepEvent::Kind>(7); }},
      {"an event refers to an invalid body", [](P p) { p.events[0].body = -1; }},
      {"an event refers to an invalid body", [](P p) { p.events[0].other = p.bodies.size(); }},
      {"vertex is not finite", [](P p) { p.hull([](auto& h) { h.vertices[1][0] = kNan; }); }},
      {"vertex is not finite",
       [](P p) { p.hull([](auto& h) { h.vertices[1][0] = std::numeric_limits<Real>::max(); }); }},
  };
  const auto hull = [&](const char* says, const std::function<void(Polytope<D>&)>& spoil) {
    list.push_back({says, [spoil](P p) { p.hull(spoil); }});
  };
  if constexpr (D == 2) {
    hull("missing edges", [](auto& h) { h.normals.pop_back(); });
    hull("missing edges", [](auto& h) { h.vertices.resize(2), h.normals.resize(2); });
    hull("not a unit vector", [](auto& h) { h.normals[0] *= 2; });
  } else {
    hull("not closed", [](auto& h) { h.edges.pop_back(); });
    hull("not closed", [](auto& h) { h.loop.push_back(0); });
    hull("a polytope's face refers to an invalid vertex", [](auto& h) { h.loop[0] = -1; });
    hull("a polytope's face refers to an invalid vertex",
         [](auto& h) { h.loop[3] = static_cast<int>(h.vertices.size()); });
    hull("fewer than three corners", [](auto& h) { h.faces[0].end = h.faces[0].begin; });
    hull("fewer than three corners", [](auto& h) { h.faces[0].begin = -1; });
    hull("do not use all its corners", [](auto& h) { h.faces.back().end += 1; });
    hull("with an invalid plane", [](auto& h) { h.faces[0].normal *= 2; });
    hull("with an invalid plane", [](auto& h) { h.faces[0].offset = kNan; });
    hull("an invalid vertex or face", [](auto& h) { h.edges[0].v1 = static_cast<int>(h.vertices.size()); });
    hull("an invalid vertex or face", [](auto& h) { h.edges[0].v1 = h.edges[0].v0; });
    hull("an invalid vertex or face", [](auto& h) { h.edges[0].faceB = -1; });
  }
  return list;
}

template <int D>
void name() {
  World<D> world(Pipeline::parse(kPipeline));
  addEverything(world);
  EXPECT_EQ(Damaged<D>(world).refusal(), "");
  for (const Damage<D>& damage : damages<D>()) {
    Damaged<D> parts(world);
    damage.spoil(parts);
    EXPECT_NE(parts.refusal().find(damage.says), std::string::npos) << damage.says << ": " << parts.refusal();
  }
}
TEST(DamagedSave, EachDamageIsNamed) { name<2>(), name<3>(); }

// A kind that is not registered is no damage: the message says what the saved world needs.
template <int D>
void lacksAKind() {
  const std::string bytes = filledAndSaved<D>();
  const auto renamed = [&](const std::string& name) {
    std::string other = bytes;
    const std::size_t at = other.find(name);
    EXPECT_NE(at, other.npos) << name;
    other.replace(at, name.size(), std::string(name.size(), 'x'));
    World<D> world(Pipeline::parse(kPipeline));
    return refusal(world, sealed(other));
  };
  const std::string rest =
      "', which is not registered in " + std::to_string(D) + "D; valid: load the plugin that defines it";
  EXPECT_EQ(renamed("rolling_resistance"), "load: the saved world has the force 'xxxxxxxxxxxxxxxxxx" + rest);
  EXPECT_EQ(renamed("pivot"), "load: the saved world has the joint 'xxxxx" + rest);
}
TEST(DamagedSave, AKindThatIsNotRegisteredIsNamed) { lacksAKind<2>(), lacksAKind<3>(); }

// A world that has exploded is saved and loaded unchanged.
template <int D>
void explode() {
  World<D> world(Pipeline::parse(kPipeline)), copy(Pipeline::parse(kPipeline));
  addEverything(world);
  world.setMotion(world.handle(2), {Vec<D>::Constant(std::numeric_limits<Real>::max()), Ang<D>::Zero()});
  for (int i = 0; i < 3; ++i) world.step(1);
  EXPECT_FALSE(world.bodies().pose[2].p.allFinite());
  const std::string bytes = saved(world);
  EXPECT_EQ(refusal(copy, bytes), "");
  world.step(kDt), copy.step(kDt);
  EXPECT_EQ(saved(copy), saved(world));
}
TEST(DamagedSave, AnExplodedWorldIsNotDamaged) { explode<2>(), explode<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::damaged_save_test
