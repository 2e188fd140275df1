// SPDX-License-Identifier: Zlib
// What a listener may change of one contact, and which events it receives.
#include <gtest/gtest.h>

#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

constexpr Real kDt = Real(1) / 60;

template <class T>
struct ListenerTest : testing::Test {};
template <int Dim>
struct In {
  static constexpr int D = Dim;
};
using Dimensions = testing::Types<In<2>, In<3>>;
TYPED_TEST_SUITE(ListenerTest, Dimensions);

template <int D>
struct Mixer final : ContactListener<D> {
  std::int32_t of = -1;  // only contacts of this body
  PairMaterial to, came;
  int mixed = 0, begun = 0, persisted = 0;
  bool forgets = false;  // a planted bug: writes only in the first step
  void mix(const World<D>&, const Manifold<D>& m, PairMaterial& material) override {
    if (of >= 0 && m.bodyA != of && m.bodyB != of) return;
    came = material;
    if (forgets && mixed++ > 0) return;
    ++mixed;
    material = to;
  }
  bool begin(const World<D>&, const Manifold<D>&) override { return ++begun, true; }
  bool persist(const World<D>&, const Manifold<D>&) override { return ++persisted, true; }
};

// Two boxes slide on one floor. A listener removes the friction of one: only that box keeps sliding.
template <int D>
bool oneSlides(bool forgets) {
  World<D> world;
  addGround(world);
  std::array<BodyHandle, 2> boxes;
  for (std::size_t i = 0; i < 2; ++i) {
    BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(-15, 0.5, 4 * double(i)));
    if (D == 2 && i == 1) def.X_WB.p[0] = 0;
    def.velocity = at<D>(3, 0);
    boxes[i] = world.add(def);
  }
  Mixer<D> slippery;
  slippery.of = boxes[1].slot, slippery.forgets = forgets;
  world.addListener(&slippery);
  for (int i = 0; i < 90; ++i) world.step(kDt);
  EXPECT_NEAR(double(slippery.came.friction), 0.5, 1e-6);  // the shapes' value, in every step
  return std::abs(world.motion(boxes[0]).v[0]) < 0.01 && world.motion(boxes[1]).v[0] > 2.99;
}

TYPED_TEST(ListenerTest, ChangesTheFrictionOfOneContact) {
  EXPECT_TRUE(oneSlides<TypeParam::D>(false));
  expectCaught("a friction that is changed in the first step alone", oneSlides<TypeParam::D>(true));
}

TYPED_TEST(ListenerTest, ChangesTheRestitutionOfOneContact) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addGround(world);
  const BodyHandle dead = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-3, 3)));
  const BodyHandle lively = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(3, 3)));
  Mixer<D> bouncy;
  bouncy.to = {.friction = 0, .restitution = 1};
  world.addListener(lively, &bouncy);
  Real highest = 0;
  bool hit = false;
  for (int i = 0; i < 120; ++i) {
    world.step(kDt);
    hit = hit || bouncy.begun > 0;
    if (hit && bouncy.begun == 1) highest = std::max(highest, world.pose(lively).p[1]);
  }
  EXPECT_LT(world.pose(dead).p[1], 0.6);
  EXPECT_GT(highest, 2.7);
}

TYPED_TEST(ListenerTest, BodyListenersReceiveOnlyTheirBody) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle ground = addGround(world);
  std::vector<BodyHandle> balls;
  for (int i = 0; i < 3; ++i) balls.push_back(world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(3 * i, 0.5))));
  Mixer<D> one, all, twice;
  one.to = all.to = twice.to = {Real(0.5), 0};
  world.addListener(balls[1], &one), world.addListener(balls[1], &one);
  world.addListener(ground, &all);
  world.addListener(ground, &twice), world.addListener(balls[0], &twice), world.addListener(&twice);
  world.step(kDt);
  EXPECT_EQ(one.begun, 1);
  EXPECT_EQ(all.begun, 3);
  EXPECT_EQ(twice.begun, 3);  // once per pair, however often it is registered
  world.removeListener(&all);
  world.remove(balls[1]);  // with its listeners
  const BodyHandle next = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(3, 0.5)));
  EXPECT_EQ(next.slot, balls[1].slot);
  world.step(kDt);
  EXPECT_EQ(one.begun + one.persisted, 1);
  EXPECT_EQ(all.begun + all.persisted, 3);
  EXPECT_THROW(world.addListener(balls[1], &one), UserError);
  EXPECT_THROW(world.addListener(balls[0], nullptr), UserError);
}

template <int D>
struct Sides final : ContactListener<D> {
  std::vector<std::array<bool, 2>> heard;
  bool hear(const World<D>& world, const Manifold<D>& m) {
    heard.push_back({world.isListenerOf(m.bodyA, this), world.isListenerOf(m.bodyB, this)});
    return true;
  }
  bool begin(const World<D>& world, const Manifold<D>& m) override { return hear(world, m); }
  void end(const World<D>& world, const Manifold<D>& last) override { hear(world, last); }
};

TYPED_TEST(ListenerTest, KnowsWhichBodyItListensTo) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle ground = addGround(world);  // the lower slot: A of all pairs
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0.5)));
  Sides<D> a, b, both, all;
  world.addListener(ground, &a), world.addListener(ball, &b), world.addListener(&all);
  world.addListener(ground, &both), world.addListener(ball, &both);
  world.step(kDt);
  world.remove(ball);  // a listener still belongs to the body when it receives the end
  using Heard = std::vector<std::array<bool, 2>>;
  EXPECT_EQ(a.heard, (Heard{{true, false}, {true, false}}));
  EXPECT_EQ(b.heard, (Heard{{false, true}, {false, true}}));
  EXPECT_EQ(both.heard, (Heard{{true, true}, {true, true}}));
  EXPECT_EQ(all.heard, (Heard{{false, false}, {false, false}}));
  EXPECT_FALSE(world.isListenerOf(ball.slot, &b)) << "the body has gone, and its listeners with it";
  EXPECT_FALSE(world.isListenerOf(-1, &b));
  EXPECT_FALSE(world.isListenerOf(1000, &b));
}

TYPED_TEST(ListenerTest, InvalidMaterialsAreRefused) {
  constexpr int D = TypeParam::D;
  for (const Real bad : {Real(-1), std::numeric_limits<Real>::quiet_NaN()}) {
    World<D> world;
    addGround(world);
    world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0.5)));
    Mixer<D> mixer;
    mixer.to.friction = bad;
    world.addListener(&mixer);
    EXPECT_THROW(world.step(kDt), UserError);
  }
}

// Recycled contacts come from an earlier step, with the values that a listener wrote then.
TYPED_TEST(ListenerTest, MaterialOfKeptContactsIsThatOfTheirShapes) {
  constexpr int D = TypeParam::D;
  World<D> world(Pipeline::parse("cache=recycling"));
  addGround(world);
  const BodyHandle box = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5)));
  Mixer<D> mixer;
  mixer.to = {Real(0.9), 0};
  world.addListener(&mixer);
  for (int i = 0; i < 5; ++i) {
    world.step(kDt);
    EXPECT_EQ(mixer.came.friction, Real(0.5));
    EXPECT_EQ(world.manifolds()[0].friction, Real(0.9));
  }
  BodyDef<D> def = world.definition(box);
  def.shapes[0].friction = Real(0.02);
  world.change(box, def);
  world.step(kDt);
  EXPECT_EQ(mixer.came.friction, std::sqrt(Real(0.5) * Real(0.02)));
  world.removeListener(&mixer);
  world.step(kDt);
  EXPECT_EQ(world.manifolds()[0].friction, std::sqrt(Real(0.5) * Real(0.02)));
}

// Moves bodies in two half steps and detects contacts again after each.
template <int D>
class LooksAgain final : public Solver<D> {
 public:
  struct Params {
    bool forgets = false;
    void visit(ParamVisitor& v) { v.flag("forgets", forgets, "a planted bug: does not look"); }
  };
  explicit LooksAgain(const Params& params) : m_params(params) {}
  static AlgorithmInfo info() {
    return {
        .name = "looks_again", .summary = "of a test", .paper = "", .complexity = "n", .role = AlgorithmRole::witness};
  }
  void step(const StepInput<D>& in) override {
    for (int half = 0; half < 2; ++half) {
      for (std::size_t i = 0; i < in.bodies.pose.size(); ++i) {
        if (in.bodies.active(static_cast<int>(i))) in.bodies.pose[i].p += in.dt / 2 * in.bodies.motion[i].v;
      }
      if (!m_params.forgets) in.detect.again();
    }
  }

 private:
  Params m_params;
};
LPC_REGISTER(Solver, LooksAgain, 2, 3);

template <int D>
struct Story final : ContactListener<D> {
  std::string told;
  void mix(const World<D>&, const Manifold<D>&, PairMaterial& material) override { material.friction = Real(0.9); }
  bool begin(const World<D>&, const Manifold<D>&) override { return told += 'b', false; }
  bool persist(const World<D>&, const Manifold<D>&) override { return told += 'p', false; }
  void end(const World<D>&, const Manifold<D>&) override { told += 'e'; }
};

// A ball approaches another diagonally, so that their boxes overlap first. It comes within contact range in the middle
// of one step and leaves it in the middle of another.
template <int D>
std::string storyOfAgain(const std::string& pipeline) {
  World<D> world(Pipeline::parse(pipeline + " continuous=none"));
  world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0), BodyType::fixed));
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0.8, 0.8)));
  Story<D> story;
  world.addListener(&story);
  const auto step = [&](double velocity) {
    world.setMotion(ball, {at<D>(velocity, velocity), Ang<D>::Zero()});
    world.step(Real(0.1));
    story.told += '/';
    for (const Manifold<D>& m : world.manifolds()) {
      if (!m.ignored || m.friction != Real(0.9)) story.told += '?';
    }
  };
  step(-2), step(-1), step(5), step(0), step(-4);
  return story.told;
}

TYPED_TEST(ListenerTest, ContactsThatBeginOrEndWithinAStepGiveEvents) {
  constexpr int D = TypeParam::D;
  for (const std::string cache : {"by_feature", "recycling"}) {
    EXPECT_EQ(storyOfAgain<D>("solver=looks_again cache=" + cache), "b/p/pe//b/") << cache;
  }
  expectCaught("a solver that does not look again",
               storyOfAgain<D>("solver=looks_again{forgets=true}") == "b/p/pe//b/");
}

// Contacts of sleeping bodies that are generated again in each step: the bodies stay asleep, listeners receive nothing,
// and changes to the contacts stay.
TYPED_TEST(ListenerTest, SleepersContactsCanBeGeneratedEachStep) {
  constexpr int D = TypeParam::D;
  std::array<std::uint64_t, 2> tests{};
  std::array<std::uint64_t, 2> hashes{};
  for (const bool anew : {false, true}) {
    WorldSettings<D> settings;
    settings.sleepingContacts = anew;
    World<D> world(Pipeline::parse("sleep=split_average"), settings);
    addGround(world);
    for (int i = 0; i < 4; ++i) {
      world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5 + i)));
    }
    Mixer<D> mixer;
    mixer.to = {Real(0.9), 0};
    world.addListener(&mixer);
    for (int i = 0; i < 240; ++i) world.step(kDt);
    ASSERT_EQ(world.profiler().frame().awake, 0);
    const int heard = mixer.mixed;
    world.step(kDt);
    EXPECT_EQ(mixer.mixed, heard);
    EXPECT_EQ(world.profiler().frame().awake, 0);
    ASSERT_EQ(world.manifolds().size(), 4u);
    for (const Manifold<D>& m : world.manifolds()) EXPECT_EQ(m.friction, Real(0.9));
    tests[anew] = static_cast<std::uint64_t>(world.profiler().frame().pairs);
    hashes[anew] = world.hash();
  }
  EXPECT_EQ(tests[0], 0u);
  EXPECT_EQ(tests[1], 4u);
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
