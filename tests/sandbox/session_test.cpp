// SPDX-License-Identifier: Zlib
// Scenes that a user plays and changes, without a window.
#include "experiments/sandbox/session.h"

#include <gtest/gtest.h>

#include <sstream>

#include "experiments/sandbox/competitor_label.h"
#include "experiments/sandbox/equal_cost.h"
#include "framework/math/check.h"
#include "framework/world/invariants.h"
#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace session_test { namespace {

template <int D>
BodyDef<D> ball(Real x, Real y, Real radius = Real(0.5)) {
  BodyDef<D> def;
  def.X_WB.p[0] = x, def.X_WB.p[1] = y;
  def.shapes.push_back({.shape = Shape<D>::sphere(radius)});
  return def;
}

// A floor, and balls that are added one after another.
template <int D>
SceneSpec<D> heap() {
  SceneSpec<D> scene;
  scene.name = "heap";
  scene.settings.model.friction = scene.settings.model.rotation = scene.settings.model.cache = true;
  BodyDef<D> floor = BodyDef<D>::fixed({.shape = Shape<D>::plane()});
  scene.spawns.push_back({.step = 0, .body = floor});
  for (int i = 0; i < 6; ++i) {
    scene.spawns.push_back({.step = 10 * i, .body = ball<D>(Real(0.1) * static_cast<Real>(i), 2)});
  }
  return scene;
}

// Performs a drawn user action. Returns false if it was rejected, which must change nothing.
template <class S, int D>
bool drawAction(Draw& draw, S& session) {
  const int body = draw.below(session.bodies() + 1);
  const auto any = [&] { return draw.real(-3, 3); };
  Vec<D> v = Vec<D>::Zero();
  v[0] = any(), v[1] = any();
  try {
    switch (draw.below(10)) {
      case 0:
        session.perform(AddBody<D>{ball<D>(any(), 3 + any())});
        break;
      case 1:
        session.perform(RemoveBody{body});
        break;
      case 2:
        session.perform(PushBody<D>{body, v});
        break;
      case 3:
        session.perform(PullBody<D>{body, 20 * v, Vec<D>::Constant(Real(0.1))});
        break;
      case 4:
        session.perform(SetBody<D>{.body = body, .position = Vec<D>(v + 3 * Vec<D>::Unit(1))});
        break;
      case 5:
        session.perform(SetBody<D>{.body = body, .velocity = v});
        break;
      case 6:
        session.perform(MergeBodies{body, body + 1});
        break;
      case 7:
        session.perform(SplitByShape{body, 1 + draw.below(2)});
        break;
      case 8:
        session.perform(SetGravity<D>{v});
        break;
      default:
        session.perform(ChangeBody{.body = body, .friction = draw.real(0, 1), .pinned = draw.coin()});
    }
    return true;
  } catch (const UserError&) {
    return false;
  }
}

template <int D>
struct Careful : Session<D> {
  using Session<D>::Session;
};
// Planted bug: an action is performed but not recorded.
template <int D>
struct Forgetful : Session<D> {
  using Session<D>::Session;
  void perform(typename Action<D>::What what) {
    if (const auto* push = std::get_if<PushBody<D>>(&what)) {
      this->world().applyImpulse(this->handle(push->body), {push->impulse, push->angular});
    } else {
      Session<D>::perform(std::move(what));
    }
  }
};

// However one steps forward and back, the same step with the same actions gives the same bits.
template <template <int> class S, int D>
void backIsWhereItWas() {
  RapidCheckDraw draw;
  S<D> session(heap<D>(), {""});
  std::vector<std::uint64_t> seen = {session.world().hash()};  // by step, after its actions
  for (int i = 0, n = 20 + draw.below(80); i < n; ++i) {
    const int what = draw.below(8);
    const auto step = static_cast<std::size_t>(session.steps());
    if (what == 0 && session.steps() > 0) {
      RC_ASSERT(session.back());
      RC_ASSERT(session.world().hash() == seen[step - 1]);
    } else if (what == 1) {
      if (drawAction<S<D>, D>(draw, session)) seen.resize(step + 1);  // later steps differ now
      seen[step] = session.world().hash();
    } else {
      session.step();
      RC_ASSERT(!session.fallen());
      if (step + 1 < seen.size()) {
        RC_ASSERT(session.world().hash() == seen[step + 1]);  // the same actions were replayed
      } else {
        seen.push_back(session.world().hash());
      }
    }
  }
}

TEST(Sandbox, SteppingBackRestoresTheState) {
  check("2D", backIsWhereItWas<Careful, 2>, 40);
  check("3D", backIsWhereItWas<Careful, 3>, 40);
  expectFalsified("deeds that are not remembered", backIsWhereItWas<Forgetful, 2>);
}

TEST(Sandbox, EqualCompetitorsNeverDivergeAndOthersAreMeasured) {
  Session<2> equal(heap<2>(), {"", "sleep=none"});
  Session<2> others(heap<2>(), {"", "solver=soft_step"});
  for (int i = 0; i < 120; ++i) equal.step(), others.step();
  EXPECT_EQ(equal.competitors()[1].partedAt, -1);
  EXPECT_EQ(equal.competitors()[1].samples.back().error, 0);
  const auto& competitor = others.competitors()[1];
  ASSERT_GT(competitor.partedAt, 0);
  const auto at = static_cast<std::size_t>(competitor.partedAt);
  EXPECT_GT(competitor.samples[at - 1].error, Session<2>::kParted);
  for (std::size_t i = 0; i + 1 < at; ++i) EXPECT_LE(competitor.samples[i].error, Session<2>::kParted);
  expectCaught("lanes that part are not told apart", competitor.samples.back().error == 0);
}

// Values that no view shows are not computed.
TEST(Sandbox, EnergyAndPenetrationAreComputedOnlyWhenShown) {
  Session<2> session(heap<2>(), {"", "solver=soft_step"});
  for (int i = 0; i < 90; ++i) {
    session.measure(i >= 60);
    session.step();
    for (std::size_t competitor = 0; competitor < 2; ++competitor) {
      const Sample& sample = session.competitors()[competitor].samples.back();
      const Invariants<2> seen = invariants(session.world(competitor));
      EXPECT_EQ(std::isnan(sample.energy), i < 60);
      EXPECT_EQ(std::isnan(sample.penetration), i < 60);
      if (i < 60) continue;
      EXPECT_EQ(sample.energy, seen.kinetic + seen.potential);
      EXPECT_EQ(sample.penetration, seen.maxPenetration);
    }
  }
}

// A competitor that diverges stops there, says why, and can be stepped back.
TEST(Sandbox, AFailedCompetitorCanBeSteppedBack) {
  Session<2> session(heap<2>(), {""});
  session.step();
  const std::uint64_t before = session.world().hash();
  session.perform(PushBody<2>{1, Vec<2>::Constant(1.7e308)});
  session.step(), session.step();
  ASSERT_TRUE(session.fallen());
  EXPECT_NE(session.competitors()[0].fallen.find("diverged at step"), std::string::npos)
      << session.competitors()[0].fallen;
  EXPECT_THROW(session.perform(RemoveBody{1}), UserError);
  while (session.fallen()) ASSERT_TRUE(session.back());
  while (session.steps() > 1) ASSERT_TRUE(session.back());
  session.perform(RemoveBody{1});
  EXPECT_NE(session.world().hash(), before);
  for (int i = 0; i < 10; ++i) session.step();
  EXPECT_FALSE(session.fallen());
}

// Also before its first step: all competitors step back together, and one that cannot follow stays where it failed.
TEST(Sandbox, ACompetitorThatCannotFollowStaysBehind) {
  Session<2> session(heap<2>(), {"contacts=query_clip", "contacts=rounded_polygon"});
  BodyDef<2> def = ball<2>(1, 2);
  def.shapes[0].shape = Shape<2>::curved(ShapeKind::ellipsoid, std::vector<Real>{Real(0.5), Real(0.25)});
  session.perform(AddBody<2>{def});
  const std::string why = session.competitors()[1].fallen;
  ASSERT_FALSE(why.empty());
  for (int i = 0; i < 3; ++i) session.step();
  ASSERT_TRUE(session.back());
  EXPECT_EQ(session.steps(), 2);
  EXPECT_FALSE(session.fallen());
  EXPECT_EQ(session.competitors()[1].fallen, why);
}

TEST(Sandbox, InvalidActionsAreRefusedAndChangeNothing) {
  Session<2> session(heap<2>(), {""});
  const std::uint64_t before = session.world().hash();
  EXPECT_THROW(session.perform(RemoveBody{99}), UserError);
  EXPECT_THROW(session.perform(MergeBodies{0, 1}), UserError);
  EXPECT_THROW(session.perform(SetPipeline{0, "solver=nobody"}), UserError);
  EXPECT_EQ(session.world().hash(), before);
  EXPECT_TRUE(session.actions().empty());
  EXPECT_FALSE(session.back());
}

// As in `lpc run`: a saved world has its own model, and the scene must agree with it.
TEST(Sandbox, ASavedWorldOfOtherFeaturesIsRefused) {
  Session<2> session(heap<2>(), {""});
  for (int i = 0; i < 10; ++i) session.step();
  std::ostringstream out;
  dynamic_cast<const World<2>&>(session.world()).save(out);
  SceneSpec<2> scene;
  scene.settings = session.scene().settings, scene.saved = out.str();
  EXPECT_EQ(Session<2>(scene, {""}).world().hash(), session.world().hash());
  scene.settings.model.friction = false;
  EXPECT_THROW(Session<2>(scene, {""}), UserError);
}

TEST(Sandbox, StagesChangeInOneCompetitorOnly) {
  Session<2> session(heap<2>(), {"", ""});
  session.perform(SetPipeline{1, "solver=soft_step"});
  EXPECT_EQ(session.competitors()[0].pipeline, "");
  EXPECT_EQ(session.competitors()[1].pipeline, "solver=soft_step");
  for (int i = 0; i < 40; ++i) session.step();
  const std::uint64_t hash = session.world(1).hash();
  session.step();
  ASSERT_TRUE(session.back());
  EXPECT_EQ(session.world(1).hash(), hash);
  EXPECT_EQ(session.competitors()[1].pipeline, "solver=soft_step");
}

TEST(Sandbox, LabelsShowWhatIsNotTheDefault) {
  EXPECT_EQ(competitorLabel("", 2), "the default stages");
  EXPECT_EQ(competitorLabel("solver=soft_step sleep=none", 3), "solver=soft_step");
  EXPECT_EQ(competitorLabel("solver=split_solver{velocity=catto{iterations=20},order=stored} broadphase=naive", 2),
            "broadphase=naive solver=split_solver{velocity=catto{iterations=20}}");
  EXPECT_EQ(competitorLabel("engine=bullet{iterations=10}", 3), "engine=bullet{iterations=10}");
}

TEST(Sandbox, CostFollowsIterations) {
  const auto more = withMoreIterations("", 2, 2);
  ASSERT_TRUE(more);
  EXPECT_NE(more->find("iterations=20"), std::string::npos) << *more;
  const auto fewer = withMoreIterations("solver=soft_step{substeps=4}", 0.5, 3);
  ASSERT_TRUE(fewer);
  EXPECT_NE(fewer->find("substeps=2"), std::string::npos) << *fewer;
  EXPECT_FALSE(withMoreIterations("solver=soft_step{substeps=1}", 0.5, 3));  // there are no fewer
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::session_test
