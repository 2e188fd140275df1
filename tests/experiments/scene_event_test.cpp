// SPDX-License-Identifier: Zlib
// What a script does between steps, compared with closed forms; and its mistakes, reported with file and line.
#include "experiments/trial/scene/scene_event.h"

#include <gtest/gtest.h>

#include "experiments/trial/scene/scene_file.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scene_event_test { namespace {

using test::expectCaught;
using test::Workspace;

// A box of 2 kg without forces, and a peg; events follow.
const std::string kHead = R"(name = "t"
summary = "s"
dimensions = [2, 3]
needs = ["joints", "rotation"]
gravity = [0, 0, 0]
dt = 0.125
[[body]]
name = "box"
position = [1, 2, 3]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5], density = 2, offset = [0.25, 0, 0] }]
[[body]]
name = "peg"
type = "fixed"
position = [9, 9, 9]
shapes = [{ kind = "circle", radius = 0.5 }]
)";

template <int D>
SceneSpec<D> scene(const std::string& events) {
  return SceneFile::parse(kHead + events, "t.toml").build<D>({}, 1);
}

template <int D>
struct Played {
  World<D> world;
  Director<D> director;
  explicit Played(const SceneSpec<D>& spec, int steps) : world({}, spec.settings), director(spec) {
    for (int i = 0; i < steps; ++i) director.advance(world), world.step(spec.dt);
  }
  Pose<D> pose(int spawn) const { return world.pose(director.body(spawn)); }
  Motion<D> motion(int spawn) const { return world.motion(director.body(spawn)); }
};

// Forces of the file start and end at their steps. The first acts in three of eight steps. Two copies of the second,
// with -1 and -2 N m, act in the first step only.
template <int D>
bool forcesComeAndGo(const std::string& until) {
  const std::string torque = "[[force]]\nkind = \"torque\"\nb = \"box\"\n";
  const Played<D> p(scene<D>(torque + "parameters = { torque = \"4 / 2\" }\nfrom = 2\n" + until + torque +
                             "repeat = 2\nparameters = { torque = \"-(k + 1)\" }\nuntil = 1\n"),
                    8);
  const auto i = static_cast<std::size_t>(p.director.body(0).slot);
  constexpr int kLast = kAngDim<D> - 1;
  const Real expected = Real(0.125) * (3 * 2 - 1 - 2) * p.world.bodies().invInertiaBody[i](kLast, kLast);
  return std::abs(p.motion(0).w[kLast] - expected) < Real(1e-5);
}
TEST(SceneForces, ComeAndGo) {
  EXPECT_TRUE(forcesComeAndGo<2>("until = 5\n") && forcesComeAndGo<3>("until = 5\n"));
  expectCaught("a force that stays", forcesComeAndGo<2>(""));
  const SceneSpec<2> pulls = scene<2>("[[force]]\nkind = \"attraction\"\na = \"peg\"\nuntil = 3\n");
  EXPECT_EQ(pulls.forces.at(0).bodyB, -1);
  EXPECT_EQ(census(pulls).at("force attraction"), 1);
}

template <int D>
Vec<D> vec(Real x, Real y, Real z) {
  Vec<D> v = Vec<D>::Zero();
  v[0] = x, v[1] = y;
  if constexpr (D == 3) v[2] = z;
  return v;
}

// --- push -----------------------------------------------------------------------------------------------------------

// v = J / m and w = r x J / I from the step of the push on; I = m (1 + 1) / 12 about z.
template <int D>
bool pushed(const SceneSpec<D>& spec) {
  const Motion<D> before = Played<D>(spec, 3).motion(0), after = Played<D>(spec, 4).motion(0);
  const Real w = after.w[kAngDim<D> - 1], expected = (Real(0.5) * 4) / (Real(2) / 6);
  return before.v.norm() == 0 && (after.v - vec<D>(0, 2, 0)).norm() < 1e-12 && std::abs(w - expected) < 1e-12;
}
template <int D>
void push() {
  const SceneSpec<D> right = scene<D>(R"(
[[event]]
do = "push"
step = 3
body = "box"
impulse = [0, 4, 0]
at = [0.75, 0, 0]
)");
  EXPECT_TRUE(pushed(right));
  SceneSpec<D> wrong = right;
  wrong.events[0].step = 4;
  expectCaught("a blow one step late", pushed(wrong));
  wrong = right;
  wrong.events.push_back(right.events[0]);
  expectCaught("a blow twice", pushed(wrong));
  wrong = scene<D>("[[event]]\ndo = \"push\"\nstep = 3\nbody = \"box\"\nimpulse = [0, 4, 0]\nat = [0.5, 0, 0]\n");
  expectCaught("a blow with the arm from the body's origin", pushed(wrong));
}
TEST(SceneEvent, PushIsABlow) { push<2>(), push<3>(); }

// --- force ----------------------------------------------------------------------------------------------------------

// Four steps of F = 16 N give 2 kg the speed 16 * 4 * 0.125 / 2.
template <int D>
bool driven(const SceneSpec<D>& spec) {
  const auto speed = [&](int steps) { return Played<D>(spec, steps).motion(0).v[0]; };
  return speed(2) == 0 && speed(3) == 1 && speed(6) == 4 && speed(9) == 4;
}
template <int D>
void force() {
  const std::string text = "[[event]]\ndo = \"force\"\nstep = 2\nbody = \"box\"\nforce = [16, 0, 0]\nuntil = ";
  EXPECT_TRUE(driven(scene<D>(text + "6\n")));
  expectCaught("a force for one step too many", driven(scene<D>(text + "7\n")));
  SceneSpec<D> lasting = scene<D>(text + "6\n");
  for (long step = 6; step < 9; ++step) lasting.events.push_back(lasting.events[0]), lasting.events.back().step = step;
  expectCaught("a force that does not end", driven(lasting));
}
TEST(SceneEvent, ForceLastsItsSteps) { force<2>(), force<3>(); }

TEST(SceneEvent, TorqueTurns) {
  const auto spec = scene<2>("[[event]]\ndo = \"force\"\nstep = 0\nbody = \"box\"\ntorque = 4\n");
  EXPECT_NEAR(Played<2>(spec, 2).motion(0).w[0], 4 * 0.125 / (2.0 / 6), 1e-12);
  EXPECT_EQ(Played<2>(spec, 2).motion(0).v.norm(), 0);
}

// 16 N towards a point 3 m above the centre of mass. A force from a point towards itself has no direction.
template <int D>
void pulled() {
  const auto at = [](const std::string& towards) {
    return Played<D>(
               scene<D>("[[event]]\ndo = \"force\"\nstep = 0\nbody = \"box\"\nstrength = 16\ntowards = " + towards), 1)
        .motion(0);
  };
  EXPECT_LT((at("[1.25, 5, 3]").v - vec<D>(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(at("[1.25, 5, 3]").w.norm(), 0);
  EXPECT_LT((at("[-2.75, -1, 3]").v - vec<D>(Real(-0.8), Real(-0.6), 0)).norm(), 1e-12);
  EXPECT_EQ(at("[1.25, 2, 3]").v.norm(), 0);
}
TEST(SceneEvent, StrengthIsTowardsAPoint) { pulled<2>(), pulled<3>(); }

// --- set ------------------------------------------------------------------------------------------------------------

template <int D>
bool isSet(const SceneSpec<D>& spec) {
  const Played<D> played(spec, 3);
  const Vec<D> ahead = played.pose(0).q * vec<D>(1, 0, 0);
  return (played.pose(0).p - vec<D>(5, Real(6.125), 7)).norm() < 1e-12 && (ahead - vec<D>(0, 1, 0)).norm() < 1e-6 &&
         played.motion(0).v == vec<D>(0, 1, 0) && played.pose(1).p == vec<D>(9, 8, 9);
}
template <int D>
void set() {
  const std::string text = R"(
[[event]]
do = "set"
step = 2
body = "box"
position = [5, 6, 7]
angle = "pi / 2"
velocity = [0, 1, 0]
)",
                    peg = "[[event]]\ndo = \"set\"\nstep = 1\nbody = \"peg\"\nposition = [9, 8, 9]\n";
  EXPECT_TRUE(isSet(scene<D>(text + peg)));
  SceneSpec<D> wrong = scene<D>(text + peg);
  for (auto& e : wrong.events) e.body = 0;
  expectCaught("another body is set", isSet(wrong));
}
TEST(SceneEvent, SetSetsPoseAndMotion) { set<2>(), set<3>(); }

// --- add, joint, remove ---------------------------------------------------------------------------------------------

TEST(SceneEvent, BodiesAreAddedJoinedAndRemoved) {
  const auto spec = scene<2>(R"(
[[event]]
do = "add"
step = 2
name = "late"
repeat = { i = 2 }
position = ["20 + 4 * i", 0]
shapes = [{ kind = "circle", radius = 1 }]
[[event]]
do = "joint"
step = 4
kind = "pivot"
a = "box"
b = "late[1]"
anchor = [3, 3, 3]
[[event]]
do = "remove"
step = 6
body = "late[0]"
[[event]]
do = "remove"
step = 7
body = "late[1]"
)");
  EXPECT_EQ(census(spec).at("removed"), 2);
  std::vector<std::pair<int, int>> seen;  // bodies, joints
  World<2> world({}, spec.settings);
  Director<2> director(spec);
  for (int i = 0; i < 9; ++i) {
    director.advance(world);
    seen.emplace_back(world.bodyCount(), std::count_if(world.joints().begin(), world.joints().end(),
                                                       [](const auto& j) { return j.active(); }));
    world.step(spec.dt);
  }
  EXPECT_EQ(seen,
            (std::vector<std::pair<int, int>>{{2, 0}, {2, 0}, {4, 0}, {4, 0}, {4, 1}, {4, 1}, {3, 1}, {2, 0}, {2, 0}}));
}

// --- in the order of the file ---------------------------------------------------------------------------------------

const std::string kRemove = "[[event]]\ndo = \"remove\"\nstep = 2\nbody = \"box\"\n",
                  kAdd =
                      "[[event]]\ndo = \"add\"\nstep = 2\nname = \"new\"\nposition = [20, 20, 20]\n"
                      "shapes = [{ kind = \"circle\", radius = 1 }]\n";
// The added body takes the lowest free slot: that of the removed one.
template <int D>
bool takesItsSlot(const SceneSpec<D>& spec) {
  const Played<D> p(spec, 3);
  return p.world.bodyCount() == 2 && p.director.body(2).slot == 0;
}
template <int D>
void inOrder() {
  EXPECT_TRUE(takesItsSlot(scene<D>(kRemove + kAdd)));
  EXPECT_FALSE(takesItsSlot(scene<D>(kAdd + kRemove))) << "who comes first cannot take it";
  SceneSpec<D> wrong = scene<D>(kRemove + kAdd);
  std::swap(wrong.events[0], wrong.events[1]);
  expectCaught("two events of a step in the other order", takesItsSlot(wrong));
  // Blocks not in the order of their steps, and one that repeats.
  const std::string set = "[[event]]\ndo = \"set\"\nbody = \"box\"\n";
  const Played<D> last(scene<D>(set + "step = 3\nvelocity = [1, 0]\n" + set +
                                "step = 1\nuntil = 4\nvelocity = [2, 0]\n" + set + "step = 2\nvelocity = [3, 0]\n"),
                       4);
  EXPECT_EQ(last.motion(0).v[0], 2);
  // Bodies outside events are added before all events of their step, and removed after them.
  const std::string late =
      "[[body]]\nname = \"late\"\nfrom = 2\nremove = 2\nposition = [20, 20]\n"
      "shapes = [{ kind = \"circle\", radius = 1 }]\n";
  EXPECT_EQ(Played<D>(scene<D>(kAdd + late), 3).world.bodyCount(), 3);
  EXPECT_FALSE(takesItsSlot(scene<D>(kRemove + late + kAdd)));
}
TEST(SceneEvent, TheyHappenInTheOrderOfTheFile) { inOrder<2>(), inOrder<3>(); }

// A block's joint to a body that an event adds is made after that step's events.
TEST(SceneEvent, JointsWaitForTheBodiesOfEvents) {
  const std::string joint = "[[joint]]\nkind = \"pivot\"\na = \"peg\"\nb = \"new\"\nanchor = [9, 9]\n";
  const Played<2> p(scene<2>(joint + kAdd), 3);
  EXPECT_TRUE(p.world.joints()[0].active());
  EXPECT_EQ(p.world.joints()[0].bodyB, p.director.body(2).slot);
}

// --- a user's actions on a world ------------------------------------------------------------------------------------

template <int D>
void merged() {
  const std::string add =
                        "[[event]]\ndo = \"add\"\nstep = 1\nname = \"ball\"\nposition = [3, 2, 3]\n"
                        "shapes = [{ kind = \"circle\", radius = 0.5 }]\n",
                    merge = "[[event]]\ndo = \"merge\"\nstep = 2\ninto = \"box\"\nother = \"ball\"\n",
                    apart =
                        "[[event]]\ndo = \"take_apart\"\nstep = 4\nbody = \"box\"\n"
                        "names = [\"box\", \"second\"]\n",
                    push = "[[event]]\ndo = \"push\"\nstep = 5\nbody = \"second\"\nimpulse = [0, 1]\n";
  const auto spec = scene<D>(add + merge + apart + push);
  EXPECT_EQ(census(spec).at("dynamic"), 2) << "a part is nobody new";
  const Played<D> one(spec, 3), two(spec, 6);
  EXPECT_EQ(one.world.bodyCount(), 2);
  EXPECT_GT(one.world.mass(one.director.body(0)), 2);
  EXPECT_EQ(two.world.bodyCount(), 3);
  EXPECT_EQ(two.world.mass(two.director.body(0)), 2);
  EXPECT_GT(two.world.motion(two.director.body(3)).v[1], 0) << "the part has its name";
  EXPECT_EQ(two.motion(0).v.norm(), 0);
  EXPECT_THROW(Played<D>(scene<D>(apart), 5), UserError) << "one shape, two names";
}
TEST(SceneEvent, BodiesAreMergedAndTakenApart) { merged<2>(), merged<3>(); }

// The script continues with its own steps, and the world restarts at 0.
template <int D>
void cleared() {
  const auto spec = scene<D>("[[event]]\ndo = \"clear\"\nstep = 2\n" + kAdd +
                             "[[event]]\ndo = \"set\"\nstep = 4\nbody = \"new\"\nvelocity = [1, 0]\n");
  const Played<D> before(spec, 4), after(spec, 5);
  EXPECT_EQ(before.world.bodyCount(), 1);
  EXPECT_EQ(before.world.stepCount(), 2);
  EXPECT_EQ(before.director.body(2).slot, 0);
  EXPECT_EQ(before.motion(2).v[0], 0);
  EXPECT_EQ(after.motion(2).v[0], 1);
}
TEST(SceneEvent, AClearedWorldPlaysOn) { cleared<2>(), cleared<3>(); }

template <int D>
void ofTheWorld() {
  const std::string joint =
                        "[[event]]\ndo = \"joint\"\nstep = 1\nname = \"string\"\nkind = \"pivot\"\na = \"peg\"\n"
                        "b = \"box\"\nanchor = [9, 9]\n[[event]]\ndo = \"unjoin\"\nstep = 3\njoint = \"string\"\n",
                    force =
                        "[[event]]\ndo = \"add_force\"\nstep = 1\nname = \"wind\"\nkind = \"wind\"\n"
                        "[[event]]\ndo = \"remove_force\"\nstep = 3\nforce = \"wind\"\n";
  const auto inUse = [](const auto& records) {
    return std::count_if(records.begin(), records.end(), [](const auto& r) { return r.kind != nullptr; });
  };
  const auto joints = scene<D>(joint), forces = scene<D>(force);
  EXPECT_EQ(inUse(Played<D>(joints, 3).world.joints()), 1);
  EXPECT_EQ(inUse(Played<D>(joints, 4).world.joints()), 0);
  EXPECT_EQ(inUse(Played<D>(forces, 3).world.forces()), 1);
  EXPECT_EQ(inUse(Played<D>(forces, 4).world.forces()), 0);

  const Played<D> fallen(scene<D>("[[event]]\ndo = \"gravity\"\nstep = 1\ngravity = [0, -8]\n"), 3);
  EXPECT_EQ(fallen.motion(0).v[1], -2);
  const Played<D> pinned(scene<D>("[[event]]\ndo = \"gravity\"\nstep = 0\ngravity = [0, -8]\n"
                                  "[[event]]\ndo = \"pin\"\nstep = 0\nbody = \"box\"\n"
                                  "[[event]]\ndo = \"pin\"\nstep = 2\nbody = \"box\"\npinned = false\n"),
                         3);
  EXPECT_EQ(pinned.motion(0).v[1], -1) << "one step of three";
  const Played<D> soft(
      scene<D>("[[event]]\ndo = \"material\"\nstep = 1\nbody = \"#0\"\ndensity = 4\nfriction = 0.25\n"), 2);
  EXPECT_EQ(soft.world.mass(soft.director.body(0)), 4);
  EXPECT_EQ(soft.world.shapes()[0].friction, Real(0.25));
  const Played<D> other(scene<D>("[[event]]\ndo = \"exchange\"\nstep = 1\npipeline = \"broadphase=naive\"\n"
                                 "[[event]]\ndo = \"exchange\"\nstep = 2\npipeline = \"cache=none\"\n"),
                        3);
  EXPECT_EQ(other.world.pipeline().text(), Pipeline::parse("broadphase=naive cache=none").text());
}
TEST(SceneEvent, OfTheWorldAsAWhole) { ofTheWorld<2>(), ofTheWorld<3>(); }

TEST(SceneEvent, WakesOneOrAll) {
  const auto awake = [](const std::string& wake) {
    SceneSpec<2> spec = scene<2>(
        "[[body]]\nname = \"other\"\nposition = [-5, 0]\nawake = false\nshapes = [{ kind = \"circle\", "
        "radius = 1 }]\n[[event]]\ndo = \"wake\"\nstep = 1\n" +
        wake);
    spec.spawns[0].body.awake = false;
    spec.settings.model.sleeping = true;
    World<2> world(Pipeline::parse("sleep=timer_island"), spec.settings);
    Director<2> director(spec);
    for (int i = 0; i < 2; ++i) director.advance(world), world.step(spec.dt);
    return std::pair(world.awake(director.body(0)), world.awake(director.body(2)));
  };
  EXPECT_EQ(awake("body = \"box\"\n"), std::pair(true, false));
  EXPECT_EQ(awake(""), std::pair(true, true));
}

// A rotation by its numbers, exact to the last bit; an angle costs some bits.
template <int D>
void rotated() {
  Rot<D> q;
  if constexpr (D == 2) q = {Real(0.6), Real(0.8)};
  if constexpr (D == 3) q = {Real(0.5), Real(0.5), Real(-0.5), Real(-0.5)};
  const std::string list = D == 2 ? "rotation = [0.6, 0.8]\n" : "rotation = [0.5, 0.5, -0.5, -0.5]\n";
  const Played<D> p(scene<D>("[[event]]\ndo = \"set\"\nstep = 0\nbody = \"box\"\n" + list), 1);
  EXPECT_EQ(p.pose(0).q.matrix(), q.matrix());
  // A rotation written in single precision has rounding error and is normalised.
  const std::string rounded =
      D == 2 ? "rotation = [0.600000024, 0.800000012]\n" : "rotation = [0.600000024, 0, 0, -0.800000012]\n";
  const Played<D> written(scene<D>("[[event]]\ndo = \"set\"\nstep = 0\nbody = \"box\"\n" + rounded), 1);
  const Mat<D> turn = written.pose(0).q.matrix();
  EXPECT_LT((turn.transpose() * turn - Mat<D>(Mat<D>::Identity())).norm(), 1e-14);
  EXPECT_NEAR(turn(0, 0), D == 2 ? 0.6 : -0.28, 1e-7);
}
TEST(SceneEvent, RotationsAreTakenAsTheyAre) { rotated<2>(), rotated<3>(); }

// The shipped scene uses each kind of event, and each has an effect.
TEST(SceneEvent, TheShippedSceneUsesEach) {
  const std::string text = readFile(LPC_SOURCE_DIR "/experiments/scenes/script_events.toml");
  for (const auto& kind : eventKinds<2>()) {
    EXPECT_NE(text.find("do = \"" + std::string(kind.name) + "\""), text.npos) << kind.name;
    EXPECT_FALSE(kind.meaning.empty());
  }
  const auto spec = SceneFile::parse(text, "s").build<2>({}, 1);
  const Played<2> before(spec, 30), after(spec, 235);
  EXPECT_GT(after.pose(1).p[0], before.pose(1).p[0] + 1) << "the box was pushed";
  EXPECT_GT(after.pose(3).p[1], 1) << "the lift goes up";
  EXPECT_NEAR((after.pose(4).p - Vec<2>(6, 5)).norm(), 2, 0.05) << "the ball hangs on its peg";
  EXPECT_EQ(Played<2>(spec, 250).world.bodyCount(), 4);
  EXPECT_EQ(Played<2>(spec, 257).world.bodyCount(), 5) << "two more, which are one";
  EXPECT_EQ(Played<2>(spec, 271).world.bodyCount(), 6) << "and two again";
  EXPECT_EQ(Played<2>(spec, 300).world.bodyCount(), 1);
}

TEST(SceneEvent, MistakesAreOneLine) {
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {"do = \"pusch\"\nstep = 3\n",
       {"t.toml:17: ",
        "unknown event 'pusch'; did you mean 'push'? valid: add, add_force, clear, exchange, "
        "force, gravity, joint, material, merge, pin, push, remove, remove_force, set, take_apart, type, unjoin, "
        "wake"}},
      {"step = 3\n", {"t.toml:16: ", "'do' is missing"}},
      {"do = \"push\"\nbody = \"box\"\nimpulse = [1, 0]\n", {"t.toml:16: ", "'step' is missing"}},
      {"do = \"push\"\nstep = -3\nbody = \"box\"\n", {"t.toml:18: ", "'step' is -3", "valid: 0 to"}},
      {"do = \"push\"\nstep = 1.5\nbody = \"box\"\n", {"t.toml:18: ", "'step' is 1.5", "whole numbers"}},
      {"do = \"push\"\nstep = 3\nbody = \"bax\"\nimpulse = [1, 0]\n", {"t.toml:19: ", "'bax'", "valid: box, peg"}},
      {"do = \"push\"\nstep = 3\nbody = \"box[1]\"\nimpulse = [1, 0]\n", {"t.toml:19: ", "'box' has 1 bodies"}},
      {"do = \"force\"\nstep = 3\nbody = \"box\"\nstrength = 1\n", {"t.toml:16: ", "'towards' is missing"}},
      {"do = \"force\"\nstep = 3\nbody = \"box\"\nstrength = -1\ntowards = [0, 0]\n",
       {"t.toml:20: ", "'strength' is -1", "valid: 0 or more"}},
      {"do = \"push\"\nstep = 3\nbody = \"peg\"\nimpulse = [1, 0]\n", {"t.toml:19: ", "valid: a dynamic body"}},
      {"do = \"push\"\nstep = 3\nbody = \"box\"\n", {"t.toml:16: ", "without effect", "impulse, angular_impulse"}},
      {"do = \"push\"\nstep = 3\nbody = \"box\"\nimpulse = [1, 0]\nspeed = 3\n", {"t.toml:21: ", "'speed'", "impulse"}},
      {"do = \"set\"\nstep = 3\nbody = \"peg\"\nvelocity = [1, 0]\n",
       {"t.toml:20: ", "fixed", "valid: position, angle"}},
      {"do = \"force\"\nstep = 3\nevery = 2\nbody = \"box\"\nforce = [1, 0]\n",
       {"t.toml:16: ", "'every' needs 'until'"}},
      {"do = \"joint\"\nstep = 3\nkind = \"pivot\"\na = \"box\"\nb = \"peg\"\n",
       {"t.toml:16: ", "'anchor' is missing"}},
      {"do = \"remove\"\nstep = 3\nbody = \"box\"\n[[event]]\ndo = \"remove\"\nstep = 4\nbody = \"box\"\n",
       {"t.toml:23: ", "already removed at step 3"}},
      {"do = \"remove\"\nstep = 3\nbody = \"box\"\n[[event]]\ndo = \"push\"\nstep = 4\nbody = \"box\"\nimpulse = "
       "[1, 0]\n",
       {"t.toml:20: ", "at step 4 'box' does not exist: it is removed at 3"}},
      {"do = \"add\"\nstep = 5\nname = \"late\"\nshapes = [{ kind = \"circle\", radius = 1 }]\n"
       "[[event]]\ndo = \"push\"\nstep = 4\nbody = \"late\"\nimpulse = [1, 0]\n",
       {"t.toml:21: ", "at step 4 'late' does not exist: it is added at 5"}},
      {"do = \"remove\"\nstep = 3\nbody = \"box\"\n[[body]]\nname = \"late\"\nfrom = 5\nposition = [3, 3]\nshapes = [{ "
       "kind = \"circle\", radius = 1 }]\n[[joint]]\nkind = \"pivot\"\na = \"box\"\nb = \"late\"\nanchor = [2, 2]\n",
       {"t.toml:25: ", "at step 5 'box' does not exist: it is removed at 3"}},
      {"do = \"merge\"\nstep = 3\ninto = \"box\"\nother = \"peg\"\n",
       {"t.toml:20: ", "valid: both dynamic, or both fixed"}},
      {"do = \"merge\"\nstep = 3\ninto = \"box\"\nother = \"box\"\n", {"t.toml:20: ", "valid: two different bodies"}},
      {"do = \"take_apart\"\nstep = 3\nbody = \"box\"\n", {"t.toml:16: ", "'names' is missing"}},
      {"do = \"take_apart\"\nstep = 3\nbody = \"box\"\nnames = [\"a[0]\"]\n", {"t.toml:20: ", "'a[0]'", "without '['"}},
      {"do = \"push\"\nstep = 3\nbody = \"#2\"\nimpulse = [1, 0]\n",
       {"t.toml:19: ", "'body' is '#2', and the scene has 2 bodies of its own"}},
      {"do = \"push\"\nstep = 3\nbody = \"##0\"\nimpulse = [1, 0]\n",
       {"t.toml:19: ", "'body' is '##0', and the script has 0 bodies of its own"}},
      {"do = \"unjoin\"\nstep = 3\njoint = \"string\"\n", {"t.toml:19: ", "unknown joint 'string'"}},
      {"do = \"remove_force\"\nstep = 3\nforce = \"wind\"\n", {"t.toml:19: ", "unknown force 'wind'"}},
      {"do = \"add_force\"\nstep = 3\nkind = \"winde\"\n", {"t.toml:16: ", "'winde'", "wind"}},
      {"do = \"gravity\"\nstep = 3\n", {"t.toml:16: ", "'gravity' is missing"}},
      {"do = \"exchange\"\nstep = 3\npipeline = \"solver=nobody\"\n", {"t.toml:19: ", "nobody"}},
      {"do = \"material\"\nstep = 3\nbody = \"box\"\n", {"t.toml:16: ", "friction, restitution, density"}},
      {"do = \"material\"\nstep = 3\nbody = \"box\"\nfriction = -1\n", {"t.toml:20: ", "'friction' is -1"}},
      {"do = \"set\"\nstep = 3\nbody = \"box\"\nrotation = [1, 1]\n", {"t.toml:20: ", "does not have length 1"}},
      {"do = \"set\"\nstep = 3\nbody = \"box\"\nrotation = [1, 0, 0, 0]\n", {"t.toml:20: ", "cosine and sine"}},
      {"do = \"set\"\nstep = 3\nbody = \"box\"\nangle = 1\nrotation = [1, 0]\n",
       {"t.toml:21: ", "'angle' are both given"}},
      {"do = \"clear\"\nstep = 3\n[[event]]\ndo = \"push\"\nstep = 4\nbody = \"box\"\nimpulse = [1, 0]\n",
       {"t.toml:19: ", "at step 4 'box' does not exist: it is cleared at 3"}},
      {"do = \"push\"\nstep = 5\nbody = \"new\"\nimpulse = [1, 0]\n[[event]]\ndo = \"add\"\nstep = 5\nname = \"new\"\n"
       "shapes = [{ kind = \"circle\", radius = 1 }]\n",
       {"t.toml:16: ", "'new' does not exist: it is added at 5, by a later event of the file"}},
  };
  for (const auto& [event, parts] : cases) {
    std::string message = "no error";
    try {
      scene<2>("[[event]]\n" + event);
    } catch (const UserError& e) {
      message = e.what();
    }
    for (const std::string& part : parts) EXPECT_NE(message.find(part), message.npos) << event << "\n" << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
  // Faults that only the run detects are reported with line and step.
  try {
    Played<2>(scene<2>("[[event]]\ndo = \"take_apart\"\nstep = 2\nbody = \"box\"\nnames = [\"a\", \"b\"]\n"), 4);
    FAIL();
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(),
                 "t.toml:16: at step 2: the body has 1 shapes, but the number of 'names' is 2; valid: one for each");
  }
  Workspace w;
  w.write("t.toml", kHead + "[[event]]\ndo = \"pusch\"\nstep = 3\n");
  const test::Outcome run = w.lpc("run t.toml --profile p.csv");
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(std::count(run.text.begin(), run.text.end(), '\n'), 1) << run.text;
  EXPECT_FALSE(std::filesystem::exists(w.path("p.csv"))) << "half-written";
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scene_event_test
