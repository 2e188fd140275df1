// SPDX-License-Identifier: Zlib
// Several competitors on one scene, without a window: corresponding bodies, and cost.
#include <gtest/gtest.h>

#include "experiments/sandbox/competitor_label.h"
#include "experiments/sandbox/equal_cost.h"
#include "experiments/sandbox/session.h"
#include "framework/math/check.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/engine_bugs.h"
#include "tests/sandbox/box_at.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace compare_test { namespace {

// A floor and a pyramid of three boxes.
template <int D>
SceneSpec<D> pile() {
  SceneSpec<D> scene;
  scene.settings.model.friction = scene.settings.model.rotation = scene.settings.model.cache = true;
  scene.spawns.push_back({.step = 0, .body = BodyDef<D>::fixed({.shape = Shape<D>::plane()})});
  for (const auto& [x, y] : {std::pair(-0.6, 0.5), std::pair(0.6, 0.5), std::pair(0.0, 1.6)}) {
    scene.spawns.push_back({.step = 0, .body = boxAt<D>(Real(x), Real(y))});
  }
  return scene;
}

// An engine that behaves like a world but keeps no states to step back to.
struct StandInParams {
  void visit(ParamVisitor&) {}
};
template <int D>
class StandIn final : public Engine<D> {
 public:
  using Params = StandInParams;
  explicit StandIn(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "stand_in",
            .summary = "for tests",
            .paper = "",
            .complexity = "n",
            .guarantee = Guarantee::approximate,
            .role = AlgorithmRole::engine};
  }
  std::unique_ptr<Simulation<D>> start(const WorldSettings<D>& settings) const override {
    return std::make_unique<Twin<D>>(std::make_unique<World<D>>(Pipeline(), settings), Changes<D>());
  }
  std::string differences() const override { return ""; }
};
LPC_REGISTER(Engine, StandIn, 2, 3);

template <int D>
void steps(Session<D>& session, int n) {
  for (int i = 0; i < n; ++i) session.step();
}

// --- corresponding bodies -------------------------------------------------------------------------------------------

template <int D>
bool allCorrespond(const Session<D>& session) {
  for (int body = 0; body < session.bodies(); ++body) {
    const BodyHandle first = session.handle(body);
    for (std::size_t competitor = 1; competitor < session.competitors().size(); ++competitor) {
      const BodyHandle h = session.handle(body, competitor);
      if (h.slot != first.slot || session.world(competitor).valid(h) != session.world().valid(first)) return false;
    }
  }
  return true;
}

template <int D>
void bodiesComeAndGoInAll() {
  Session<D> session(pile<D>(), {"", "", "solver=soft_step", "engine=stand_in"});
  steps(session, 20);
  session.perform(RemoveBody{2});
  session.perform(AddBody<D>{boxAt<D>(2, 3)});  // into the free slot
  steps(session, 20);
  session.perform(AddBody<D>{boxAt<D>(-2, 3)});
  session.perform(RemoveBody{4});
  steps(session, 30);
  EXPECT_TRUE(allCorrespond(session));
  EXPECT_EQ(session.competitors()[1].partedAt, -1);
  EXPECT_EQ(session.competitors()[3].partedAt, -1) << "an engine that plays as the first does";
  for (const Sample& s : session.competitors()[1].samples) EXPECT_EQ(s.error, 0);
  EXPECT_EQ(session.world(1).hash(), session.world().hash());
  EXPECT_GT(session.competitors()[2].samples.back().error, 0);

  // A displacement of 1.5 mm in one competitor is reported at the step at which it happened, and only for that
  // competitor.
  Pose<D> X = session.world(1).pose(session.handle(1, 1));
  X.p[0] += Real(1.5e-3);
  session.world(1).setPose(session.handle(1, 1), X);
  session.step();
  EXPECT_EQ(session.competitors()[1].partedAt, session.steps());
  EXPECT_EQ(session.competitors()[3].partedAt, -1);
  session.world(1).remove(session.handle(3, 1));
  expectCaught("a body that goes in one alone", allCorrespond(session));
}
TEST(Compare, BodiesComeAndGoInAll) { bodiesComeAndGoInAll<2>(), bodiesComeAndGoInAll<3>(); }

// The session's actions do not contain this impulse: only the competitor's own world changes.
TEST(Compare, OneFailureDoesNotStopTheOthers) {
  Session<2> session(pile<2>(), {"", "", "solver=soft_step"}), whole(pile<2>(), {"", "", "solver=soft_step"});
  steps(session, 10), steps(whole, 30);
  session.world(1).applyImpulse(session.handle(3, 1), {Vec<2>(1.7e308, 0), {}});
  steps(session, 20);
  const auto& competitors = session.competitors();
  EXPECT_TRUE(competitors[1].fallen.starts_with("diverged at step 1")) << competitors[1].fallen;
  EXPECT_LT(competitors[1].samples.size(), 13u);
  EXPECT_FALSE(session.fallen());
  EXPECT_EQ(competitors[2].samples.size(), 30u);
  EXPECT_EQ(session.world().hash(), whole.world().hash());
  EXPECT_EQ(session.world(2).hash(), whole.world(2).hash());
  EXPECT_EQ(competitors[2].samples.back().error, whole.competitors()[2].samples.back().error);
  EXPECT_EQ(competitorState(session, 1), competitors[1].fallen);
  while (session.steps() > 9) ASSERT_TRUE(session.back());
  EXPECT_EQ(competitors[1].fallen, "");  // before the failure it runs again
  steps(session, 21);
  EXPECT_EQ(session.world(1).hash(), whole.world(1).hash());
}

// --- engines: their states are not kept -----------------------------------------------------------------------------

template <int D>
void enginesBeginAnew() {
  Session<D> session(pile<D>(), {"engine=stand_in", "", "engine=stand_in"});
  session.perform(SetGravity<D>{Vec<D>(-5 * Vec<D>::Unit(1))});  // before the first step
  std::vector<std::uint64_t> seen = {session.world().hash()};
  for (int i = 0; i < 40; ++i) {
    if (i == 20) session.perform(PushBody<D>{2, Vec<D>(3 * Vec<D>::Unit(0))});
    seen.back() = session.world().hash();
    session.step();
    seen.push_back(session.world().hash());
  }
  double last = 0;
  int asked = 0;
  const auto patient = [&](std::size_t competitor, double part) {
    EXPECT_TRUE(competitor == 0 || competitor == 2);
    EXPECT_TRUE(part >= 0 && part < 1);
    last = part, ++asked;
    return true;
  };
  for (std::size_t step = 40; step-- > 0;) {
    ASSERT_TRUE(session.back(patient));
    ASSERT_EQ(session.world().hash(), seen[step]) << step;
    ASSERT_EQ(session.world(2).hash(), seen[step]) << step;
  }
  EXPECT_GT(asked, 80);
  expectCaught("a step back that does not go back", seen[39] == seen[0]);
}
TEST(Compare, EnginesStepBackByRestarting) { enginesBeginAnew<2>(), enginesBeginAnew<3>(); }

TEST(Compare, AnEngineThatTakesTooLongIsGivenUp) {
  Session<2> session(pile<2>(), {"", "engine=stand_in"});
  steps(session, 100);
  const std::uint64_t before = session.world().hash();
  session.step();
  int asked = 0;
  ASSERT_TRUE(session.back([&](std::size_t competitor, double part) {
    EXPECT_EQ(competitor, 1u);
    return ++asked < 3 && part < 1;
  }));
  EXPECT_EQ(asked, 3);
  EXPECT_TRUE(session.competitors()[1].fallen.starts_with("step back cancelled")) << session.competitors()[1].fallen;
  EXPECT_LT(session.world(1).stepCount(), 50);
  EXPECT_EQ(session.world().hash(), before);
  ASSERT_TRUE(session.back([&](std::size_t, double) { return ++asked < 3; }));  // it is not tried again
  EXPECT_EQ(asked, 3);
  EXPECT_FALSE(session.competitors()[1].fallen.empty());
  steps(session, 5);
  EXPECT_EQ(session.steps(), 104);
}

// An action that an engine cannot do: its competitor fails, says why, and fails again when the action is replayed. Such
// an action before the first step, or at a step with a kept world, once aborted the step back half-way.
TEST(Compare, AnUnsupportedActionFailsOneCompetitorOnly) {
  for (const int before : {0, 30}) {
    Session<2> session(pile<2>(), {"", "engine=stand_in", "solver=soft_step"});
    steps(session, before);
    session.perform(ChangeBody{.body = 2, .friction = Real(0.1)});
    EXPECT_NE(session.competitors()[1].fallen.find("an engine cannot change a body"), std::string::npos);
    steps(session, 3);
    EXPECT_EQ(session.competitors()[2].fallen, "");
    const std::uint64_t hash = session.world().hash();
    session.step();
    ASSERT_TRUE(session.back());
    EXPECT_EQ(session.steps(), before + 3);
    EXPECT_EQ(session.world().hash(), hash);
    EXPECT_NE(session.competitors()[1].fallen.find("an engine cannot change a body"), std::string::npos);
    EXPECT_EQ(session.competitors()[2].samples.size(), static_cast<std::size_t>(before) + 3);
  }
}

// --- equal cost -----------------------------------------------------------------------------------------------------

// Time of a step from the work done; no clock is read.
double byWork(Simulation<2>& world, Real dt) {
  world.step(dt);
  return 1e-7 * static_cast<double>(1 + world.profiler().frame().work[WorkCount::multiplyAdds]);
}

double costOf(const Session<2>& session, std::size_t competitor) {
  return medianTime(session.competitors()[competitor].samples) / medianTime(session.competitors()[0].samples);
}

// Calls `equalise` after each step, as the window does.
template <class Equalise>
Session<2> playedAtOneCost(int rounds, const Equalise& equalise) {
  Session<2> session(
      pile<2>(),
      {"solver=split_solver{position=none}", "solver=split_solver{velocity=catto{iterations=90},position=none}",
       "solver=soft_step{substeps=1}", "solver=split_solver{velocity=direct_lcp,position=none}", "engine=stand_in"},
      byWork);
  for (int i = 0; i < rounds * kTimedSteps; ++i) session.step(), equalise(session);
  return session;
}

int pipelineChanges(const Session<2>& session) {
  int n = 0;
  for (const Action<2>& action : session.actions()) n += std::holds_alternative<SetPipeline>(action.what);
  return n;
}

TEST(Compare, CostsComeTogether) {
  Session<2> session = playedAtOneCost(8, [](Session<2>& s) { equaliseCost(s); });
  for (const std::size_t competitor : {1u, 2u}) {
    EXPECT_NEAR(costOf(session, competitor), 1, kSameCost) << session.competitors()[competitor].pipeline;
    EXPECT_EQ(whyCostStays(session, competitor), "");
  }
  EXPECT_EQ(competitorLabel(session.competitors()[1].pipeline, 2),
            competitorLabel("solver=split_solver{position=none}", 2));
  EXPECT_EQ(session.competitors()[3].since, 0);
  EXPECT_EQ(whyCostStays(session, 3), "its solver has no iterations");
  EXPECT_EQ(session.competitors()[4].since, 0);
  // A competitor's time is only used once all its timed steps were made with the new iterations.
  EXPECT_LE(pipelineChanges(session), 2 * 8);
  const Session<2> hasty = playedAtOneCost(1, [](Session<2>& s) {
    for (std::size_t competitor = 1; competitor < 3; ++competitor) {
      const double factor = 1 / costOf(s, competitor);
      const auto other = withMoreIterations(s.competitors()[competitor].pipeline, std::clamp(factor, 0.25, 4.0), 2);
      if (std::abs(factor - 1) >= kSameCost && other) s.perform(SetPipeline{int(competitor), *other});
    }
  });
  expectCaught("times of other iterations are taken for those of the present", pipelineChanges(hasty) <= 2);
}

// Stepping forward again replays the change of iterations once.
TEST(Compare, CostsAreNotChangedTwiceByAStepBack) {
  Session<2> session(pile<2>(), {"", "solver=split_solver{velocity=catto{iterations=90}}"}, byWork);
  const auto go = [&](int n) {
    for (int i = 0; i < n; ++i) session.step(), equaliseCost(session);
  };
  go(kTimedSteps + 2);
  const std::string changed = session.competitors()[1].pipeline;
  EXPECT_NE(changed.find("iterations=2"), std::string::npos) << changed;  // at most a factor of 4 at a time: 22 or 23
  ASSERT_EQ(pipelineChanges(session), 1);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(session.back());
  EXPECT_NE(session.competitors()[1].pipeline, changed);
  go(5);
  EXPECT_EQ(session.competitors()[1].pipeline, changed);
  EXPECT_EQ(pipelineChanges(session), 1);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::compare_test
