// SPDX-License-Identifier: Zlib
// A script of the user's actions replays the session exactly, also in scenes with events and scripts of their own. In
// each step the user's actions come after all events and before the bodies and joints that wait for events.
#include "experiments/sandbox/action_script.h"

#include <gtest/gtest.h>

#include "experiments/sandbox/session.h"
#include "framework/math/check.h"
#include "tests/check_property.h"
#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace action_script_test { namespace {

// Bodies that are added and removed by the scene; one body added by an event, and a joint that waits for it; a body
// with the name that the user's first body might get; and events in most steps.
const std::string kScene = R"TOML(name = "busy"
summary = "s"
dimensions = [2, 3]
needs = ["cache", "friction", "joints", "rotation"]
dt = 0.015625
[[body]]
name = "hand_0"
type = "fixed"
position = [0, -1, 0]
shapes = [{ kind = "box", half = [20, 1, 20] }]
[[body]]
name = "kept"
position = [-4, 0.5, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
[[body]]
every = 2
until = 12
remove = "step + 3"
position = ["0.5 * step", "1 + rand(0, 2)", 0]
shapes = [{ kind = "circle", radius = 0.3 }]
[[event]]
do = "add"
step = 3
name = "kept_too"
position = [-4, 3, 0]
shapes = [{ kind = "circle", radius = 0.3 }]
[[event]]
do = "push"
step = 1
until = 10
body = "kept"
impulse = ["0.1 * step", 0.2, 0]
[[joint]]
kind = "distance"
a = "kept"
b = "kept_too"
anchor = [-4, 1]
anchor_b = [-4, 3]
)TOML";
const std::string kScript = R"TOML(summary = "s"  # of several lines
needs = [
  "joints",  # and no more
  "restitution"
]
steps = "2 * last"
[parameters]
last = { default = 12, min = 1, max = 100, meaning = "step" }
[[body]]
from = 1
every = 3
until = "last"
remove = "step + 4"
position = [3, "2 + 0.1 * step", 0]
shapes = [{ kind = "box", half = [0.2, 0.3, 0.2] }]
[[event]]
do = "add"
step = 2
name = "kept_pair"
repeat = { i = 2 }
position = ["5 + 2 * i", 1, 0]
shapes = [{ kind = "circle", radius = 0.3 }, { kind = "circle", radius = 0.3, offset = [0.5, 0, 0] }]
[[event]]
do = "take_apart"
step = 4
body = "kept_pair[1]"
names = ["kept_left", "kept_part"]
[[event]]
do = "push"
step = 5
until = 9
body = "kept_part"
impulse = [0, 0.3, 0]
)TOML";
constexpr long kSteps = 14;

SceneFile played() { return SceneFile::parse(kScene, "busy.toml", kScript, "script.toml"); }

// Planted bug, the former order: the user's actions come after everything that the scene does before a step.
template <int D>
class LateSession {
 public:
  LateSession(const SceneSpec<D>& scene, const std::vector<std::string>&)
      : m_world(std::make_unique<World<D>>(Pipeline::parse(""), scene.settings)), m_director(scene) {
    m_director.advance(*m_world);
  }
  void step() {
    m_world->step(m_director.scene().dt);
    ++m_steps;
    m_director.advance(*m_world);
  }
  void perform(typename Action<D>::What what) {
    const Action<D> action{m_steps, std::move(what)};
    BodyNumbers<D> numbers(m_director, m_hand);
    play(action, 0, *m_world, numbers);
    m_actions.push_back(action);
  }
  bool fallen() const { return false; }
  long steps() const { return m_steps; }
  const std::vector<Action<D>>& actions() const { return m_actions; }
  const SceneSpec<D>& scene() const { return m_director.scene(); }
  int bodies() const { return static_cast<int>(scene().spawns.size() + m_hand.size()); }
  BodyHandle handle(int body) {
    BodyNumbers<D> numbers(m_director, m_hand);
    return numbers[body];
  }
  const World<D>& world() const { return *m_world; }
  const World<D>* ready() const { return m_world.get(); }

 private:
  std::unique_ptr<World<D>> m_world;
  Director<D> m_director;
  std::vector<BodyHandle> m_hand;
  std::vector<Action<D>> m_actions;
  long m_steps = 0;
};

template <int D, class S>
void drawAction(Draw& draw, S& session) {
  const auto& scene = session.scene();
  // Bodies that a later event of the scene names must stay.
  const auto kept = [&](int body) {
    const auto i = static_cast<std::size_t>(body);
    return i < scene.spawns.size() && scene.spawns[i].body.name.starts_with("kept");
  };
  std::vector<int> there, movable;  // of dynamic bodies
  for (int body = 0; body < session.bodies(); ++body) {
    const BodyHandle h = session.handle(body);
    if (!session.world().valid(h)) continue;
    if (session.world().bodies().type[static_cast<std::size_t>(h.slot)] != BodyType::dynamic) continue;
    there.push_back(body);
    if (!kept(body)) movable.push_back(body);
  }
  const auto one = [&](const std::vector<int>& list) {
    return list[static_cast<std::size_t>(draw.below(static_cast<int>(list.size())))];
  };
  Vec<D> v = Vec<D>::Zero();
  v[0] = draw.real(-3, 3), v[1] = draw.real(1, 4);
  BodyDef<D> ball;
  ball.X_WB.p = v;
  for (int i = 0, n = 1 + draw.below(2); i < n; ++i) {
    ball.shapes.push_back({.shape = Shape<D>::sphere(Real(0.2))});
    ball.shapes.back().X_BS.p[0] = Real(0.3 * i);
  }
  const int body = one(there), what = draw.below(8);
  if (what == 0 || (what < 4 && movable.empty())) return session.perform(AddBody<D>{ball});
  switch (what) {
    case 1:
      return session.perform(RemoveBody{one(movable)});
    case 2: {
      const int into = one(movable), other = one(movable);
      if (into != other) session.perform(MergeBodies{into, other});
      return;
    }
    case 3: {
      const int whole = one(movable);
      int shapes = 0;
      for (const ShapeRecord<D>& s : session.world().shapes()) shapes += s.body == session.handle(whole).slot;
      return session.perform(SplitByShape{whole, shapes});
    }
    case 4:
      return session.perform(PushBody<D>{body, v});
    case 5:
      return session.perform(SetBody<D>{.body = body, .position = v});
    case 6: {
      JoinBodies<D> join{-1, body, {}};
      join.def.kind = "spring", join.def.X_WJ.p = v;
      join.def.X_WJb = Pose<D>{session.world().pose(session.handle(body)).p, {}};
      return session.perform(std::move(join));
    }
    default:
      return session.perform(ChangeBody{.body = body, .friction = draw.real(0, 1)});
  }
}

// Names of a scene's bodies in a script.
template <int D>
SceneSpec<D> asTheyAre(SceneSpec<D> scene) {
  return scene;
}
// Planted bug: names by index among all bodies, including those of the script.
template <int D>
SceneSpec<D> byPlace(SceneSpec<D> scene) {
  for (std::size_t i = 0; i < scene.spawns.size(); ++i) scene.spawns[i].called = "#" + std::to_string(i);
  return scene;
}

// Plays the script as `lpc run` does; the world must be the same before each step.
template <int D, class S, auto kNamed>
void isItsScript() {
  RapidCheckDraw draw;
  const SceneFile file = played();
  ParameterValues given;
  if (draw.coin()) given[kPerturbParameter] = 1e-3;
  S session(file.build<D>(given, 1), {""});
  std::vector<std::uint64_t> seen;
  while (session.steps() < kSteps) {
    for (int n = draw.below(3); n > 0; --n) drawAction<D>(draw, session);
    seen.push_back(session.ready()->hash());
    session.step();
    RC_ASSERT(!session.fallen());
  }
  const std::string text = scriptOf<D>(session.actions(), kNamed(session.scene()), file, session.steps());
  SceneSpec<D> again;
  try {
    again = SceneFile::parse(kScene, "busy.toml", text, "by_hand.toml").build<D>(given, 1);
  } catch (const UserError& e) {
    RC_FAIL(std::string(e.what()) + '\n' + text);
  }
  RC_ASSERT(again.steps == kSteps);
  World<D> world(Pipeline::parse(""), again.settings);
  Director<D> director(again);
  for (const std::uint64_t hash : seen) {
    try {
      director.advance(world);
    } catch (const UserError& e) {
      RC_FAIL(std::string(e.what()) + '\n' + text);
    }
    RC_ASSERT(world.hash() == hash);
    world.step(again.dt);
  }
}

TEST(SandboxScript, ReplaysTheSession) {
  check("2D", isItsScript<2, Session<2>, asTheyAre<2>>, 60);
  check("3D", isItsScript<3, Session<3>, asTheyAre<3>>, 40);
  expectFalsified("a hand after all of a step", isItsScript<2, LateSession<2>, asTheyAre<2>>, 60);
  expectFalsified("bodies called by their place among all", isItsScript<2, Session<2>, byPlace<2>>, 60);
}

// Actions before the next step are in the script, which then continues.
TEST(SandboxScript, ActionsBeforeTheNextStepAreIncluded) {
  const SceneFile file = played();
  Session<2> session(file.build<2>({}, 1), {""});
  for (int i = 0; i < 5; ++i) session.step();
  session.perform(SetGravity<2>{Vec<2>(0, -1)});
  const auto steps = [&] {
    const std::string text = scriptOf<2>(session.actions(), session.scene(), file, session.steps());
    return SceneFile::parse(kScene, "busy.toml", text, "by_hand.toml").build<2>({}, 1).steps;
  };
  EXPECT_EQ(steps(), session.scene().steps);
  session.step();
  EXPECT_EQ(steps(), 6);
}

// The playing script may itself have been written by a session: its names never collide with new ones.
TEST(SandboxScript, ContinuesFromItsOwnScript) {
  std::string text = kScript;
  std::uint64_t last = 0;
  for (int round = 0; round < 3; ++round) {
    const SceneFile file = SceneFile::parse(kScene, "busy.toml", text, "by_hand.toml");
    Session<2> session(file.build<2>({}, 1), {""});
    EXPECT_TRUE(round == 0 || session.ready()->hash() == last);
    BodyDef<2> ball;
    ball.X_WB.p = Vec<2>(round, 5), ball.shapes.push_back({.shape = Shape<2>::sphere(Real(0.2))});
    session.perform(AddBody<2>{ball});
    session.perform(PushBody<2>{session.bodies() - 1, Vec<2>(1, 0)});
    last = session.ready()->hash();
    text = scriptOf<2>(session.actions(), session.scene(), file, session.steps());
  }
  EXPECT_NE(text.find("\"hand4_0\""), text.npos) << text;
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::action_script_test
