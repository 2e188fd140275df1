// SPDX-License-Identifier: Zlib
// What the user changes near sleeping bodies (S5): from the step of the change on, they move as if they had been awake.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "framework/shape/surface.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace sleep_changes_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
Shape<D> cube(double half = 0.5) {
  return Shape<D>::box(Vec<D>::Constant(Real(half)));
}

template <int D>
Shape<D> wide(double halfHeight) {
  Vec<D> half = Vec<D>::Constant(5);
  half[1] = Real(halfHeight);
  return Shape<D>::box(half);
}

// A level surface at height y, of segments or triangles.
template <int D>
Shape<D> sheet(double y) {
  if constexpr (D == 2) {
    const Vec<2> points[] = {at<2>(6, y), at<2>(0.2, y), at<2>(-6, y)};
    return Shape<2>::chain(points, false);
  } else {
    const Vec<3> points[] = {at<3>(-6, y, -6), at<3>(6, y, -6), at<3>(6, y, 6), at<3>(-6, y, 6)};
    const std::array<int, 3> triangles[] = {{{0, 2, 1}}, {{0, 3, 2}}};
    return Shape<3>::mesh(points, triangles);
  }
}

// Vetoes the contacts of one body, or their end.
template <int D>
struct Gate final : ContactListener<D> {
  BodyHandle of;
  bool open = false;
  bool solves(const Manifold<D>& m) const { return !open || (m.bodyA != of.slot && m.bodyB != of.slot); }
  bool begin(const World<D>&, const Manifold<D>& m) override { return solves(m); }
  bool persist(const World<D>&, const Manifold<D>& m) override { return solves(m); }
};

// Two boxes sleep on a floor, one on the other, and a third one beside them. A fixed and a kinematic block are far
// away.
template <int D>
struct Yard {
  World<D> world;
  BodyHandle floor, low, top, third, block, lift;
  JointHandle joint;
  ForceHandle force;
  Gate<D> gate;

  Yard(const std::string& pipeline, const WorldSettings<D>& settings) : world(Pipeline::parse(pipeline), settings) {}
  void place(BodyHandle body, double x, double y) { world.setPose(body, {at<D>(x, y), {}}); }
  void change(BodyHandle body, const std::function<void(BodyDef<D>&)>& by) {
    BodyDef<D> def = world.definition(body);
    by(def);
    world.change(body, def);
  }
  bool allSleep() const {
    for (const BodyHandle b : {low, top, third}) {
      if (world.awake(b)) return false;
    }
    return true;
  }
};

enum class On { box, plane, sheet, lift, slope };

template <int D>
BodyDef<D> groundOn(On on) {
  switch (on) {
    case On::plane:
      return body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed);
    case On::sheet:
      return body<D>(sheet<D>(0), at<D>(0, 0), BodyType::fixed);
    case On::lift:
      return body<D>(wide<D>(1), at<D>(0, -1), BodyType::kinematic);
    case On::box:
    case On::slope:
      break;
  }
  return body<D>(wide<D>(1), at<D>(0, -1), BodyType::fixed);
}

template <int D>
struct Change {
  const char* name;
  On on;
  std::function<void(Yard<D>&, int)> perform;       // before each step from the change on; the step counts from 0
  std::function<void(Yard<D>&)> prepare = nullptr;  // before the first step
  double third = 3;                                 // x of the third box, m
  // Whether the boxes move slower than the 1.5 m/s at which split_average lets sliders sleep
  // (Sleep.SlowSliderStaysAwake).
  bool slides = false;
  bool falls = false;  // Whether both boxes of the stack fall freely.
};

// Wraps a change that happens once.
template <int D, class F>
std::function<void(Yard<D>&, int)> once(F f) {
  return [f](Yard<D>& y, int step) {
    if (step == 0) f(y);
  };
}

template <int D>
std::vector<Change<D>> changes() {
  using Y = Yard<D>;
  const auto add = [](BodyType type, double x, double y) {
    return once<D>([=](Y& yard) { yard.world.add(body<D>(cube<D>(), at<D>(x, y), type)); });
  };
  const auto fixed = BodyType::fixed, kinematic = BodyType::kinematic, dynamic = BodyType::dynamic;
  const auto drive = [](Motion<D> motion) { return once<D>([=](Y& y) { y.world.setMotion(y.floor, motion); }); };
  const auto velocity = [](double x, double y) { return Motion<D>{at<D>(x, y), Ang<D>::Zero()}; };
  std::vector<Change<D>> out = {
      // a body that is put or moved into them
      {"fixed body created beside", On::box, add(fixed, 0.9, 0.5)},
      {"kinematic body created beside", On::box, add(kinematic, 0.9, 0.5)},
      {"fixed body created on top", On::box, add(fixed, 0.93, 1.5)},
      {"fixed body created on a plane", On::plane, add(fixed, 0.9, 0.5)},
      {"fixed body created on a sheet", On::sheet, add(fixed, 0.9, 0.5)},
      {"fixed body created into a row", On::box, add(fixed, -0.9, 0.5), nullptr, 1.0},
      {"dynamic body created beside", On::box, add(dynamic, 0.9, 0.51)},
      {"pinned body created beside", On::box, once<D>([](Y& y) {
         auto def = body<D>(cube<D>(), at<D>(0.9, 0.51));
         def.pinned = true;
         y.world.add(def);
       })},
      {"fixed body set beside", On::box, once<D>([](Y& y) { y.place(y.block, 0.9, 0.5); })},
      {"fixed body set there, and a query", On::box, once<D>([](Y& y) {
         y.place(y.block, 0.9, 0.5);
         EXPECT_EQ(y.world.at(at<D>(0.9, 0.5)).size(), 1u);
         y.change(y.lift, [](BodyDef<D>& def) { def.userData = 1; });
       })},
      {"fixed body set there, and saved", On::box, once<D>([](Y& y) {
         y.place(y.block, 0.9, 0.5);
         std::istringstream bytes(saved(y.world));
         y.world.load(bytes);
       })},
      {"fixed body created, and saved", On::box, once<D>([](Y& y) {
         y.world.add(body<D>(cube<D>(), at<D>(0.9, 0.5), BodyType::fixed));
         std::istringstream bytes(saved(y.world));
         y.world.load(bytes);
       })},
      {"kinematic body set beside", On::box, once<D>([](Y& y) { y.place(y.lift, 0.9, 0.5); })},
      {"fixed body set nearer each step", On::box,
       [](Y& y, int step) { y.place(y.block, 1.2 - 0.02 * std::min(step, 20), 0.5); }},
      {"kinematic body drives in", On::box, once<D>([=](Y& y) {
         y.place(y.lift, 1.03, 0.5), y.world.setMotion(y.lift, velocity(-0.1, 0));
       })},
      {"kinematic body drives in fast", On::box, once<D>([=](Y& y) {
         y.place(y.lift, 1.3, 0.5), y.world.setMotion(y.lift, velocity(-3, 0));
       })},
      {"shape added to the ground", On::box, once<D>([](Y& y) {
         y.change(y.floor, [](BodyDef<D>& def) {
           def.shapes.push_back({.shape = cube<D>(), .X_BS = {at<D>(0.9, 1.5), {}}});
         });
       })},
      {"ground raised", On::box, once<D>([](Y& y) { y.place(y.floor, 0, -0.95); })},
      {"plane raised", On::plane, once<D>([](Y& y) { y.place(y.floor, 0, 0.05); })},
      {"plane created", On::box, once<D>([](Y& y) {
         y.world.add(body<D>(Shape<D>::plane(), at<D>(0, 0.05), BodyType::fixed));
       })},
      {"filter of a fixed body set", On::box,
       once<D>([](Y& y) { y.change(y.block, [](BodyDef<D>& def) { def.shapes[0].mask = ~0u; }); }),
       [](Y& y) {
         y.place(y.block, 0.9, 0.5);
         y.change(y.block, [](BodyDef<D>& def) { def.shapes[0].mask = 0; });
       }},
      {"veto lifted", On::box, once<D>([](Y& y) { y.gate.open = false; }),
       [](Y& y) {
         y.place(y.lift, 0.9, 0.5);
         y.gate.of = y.lift, y.gate.open = true, y.world.addListener(&y.gate);
       }},
      // a support that goes
      {"ground removed", On::box, once<D>([](Y& y) { y.world.remove(y.floor); })},
      {"middle removed", On::box, once<D>([](Y& y) { y.world.remove(y.low); })},
      {"ground set away", On::box, once<D>([](Y& y) { y.place(y.floor, 0, -1000); })},
      {"ground set aside", On::box, once<D>([](Y& y) { y.place(y.floor, 5.4, -1); })},
      {"ground set 1 cm lower", On::box, once<D>([](Y& y) { y.place(y.floor, 0, -1.01); })},
      {"ground set 5 cm lower", On::box, once<D>([](Y& y) { y.place(y.floor, 0, -1.05); })},
      {"plane set away", On::plane, once<D>([](Y& y) { y.place(y.floor, 0, -3); })},
      {"plane set 1 cm lower", On::plane, once<D>([](Y& y) { y.place(y.floor, 0, -0.01); })},
      {"sheet set away", On::sheet, once<D>([](Y& y) { y.place(y.floor, 0, -3); })},
      {"sheet replaced by a lower one", On::sheet,
       once<D>([](Y& y) { y.change(y.floor, [](BodyDef<D>& def) { def.shapes[0].shape = sheet<D>(-1); }); })},
      {"sheet replaced by a higher one", On::sheet,
       once<D>([](Y& y) { y.change(y.floor, [](BodyDef<D>& def) { def.shapes[0].shape = sheet<D>(0.05); }); })},
      {"ground made lower", On::box,
       once<D>([](Y& y) { y.change(y.floor, [](BodyDef<D>& def) { def.shapes[0].shape = wide<D>(0.5); }); })},
      {"ground made dynamic", On::box,
       once<D>([=](Y& y) { y.change(y.floor, [=](BodyDef<D>& def) { def.type = dynamic; }); })},
      {"ground made a ghost", On::box,
       once<D>([](Y& y) { y.change(y.floor, [](BodyDef<D>& def) { def.shapes[0].mask = 0; }); })},
      {"box made a ghost", On::box,
       once<D>([](Y& y) { y.change(y.low, [](BodyDef<D>& def) { def.shapes[0].mask = 0; }); })},
      {"lift sinks", On::lift, drive(velocity(0, -3))},
      {"lift sinks slowly", On::lift, drive(velocity(0, -0.03))},
      {"lift rises", On::lift, drive(velocity(0, 1))},
      {"lift turns", On::lift, drive({Vec<D>::Zero(), Ang<D>::Unit(kAngDim<D> - 1) / 2})},
      {"conveyor starts", On::lift,
       [=](Y& y, int) { y.place(y.floor, 0, -1), y.world.setMotion(y.floor, velocity(1, 0)); }},
      {"lift set away", On::lift, once<D>([](Y& y) { y.place(y.floor, 0, -3); })},
      {"lift removed", On::lift, once<D>([](Y& y) { y.world.remove(y.floor); })},
      {"support vetoed", On::lift, once<D>([](Y& y) { y.gate.of = y.floor, y.gate.open = true; }),
       [](Y& y) { y.world.addListener(&y.gate); }},
      {"ground tilts", On::box, once<D>([](Y& y) {
         y.world.setPose(y.floor, {at<D>(0, -1), integrateRotation(Rot<D>{}, Ang<D>(Ang<D>::Unit(kAngDim<D> - 1) / 10))});
       })},
      {"ground under bodies added asleep removed", On::box, once<D>([](Y& y) { y.world.remove(y.floor); }),
       [](Y& y) {
         for (const BodyHandle b : {y.low, y.top, y.third}) y.change(b, [](BodyDef<D>& def) { def.awake = false; });
       }},
      // everything else
      {"gravity turned", On::box, once<D>([](Y& y) { y.world.setGravity(at<D>(9.81, 0)); })},
      {"friction of the ground", On::slope,
       once<D>([](Y& y) { y.change(y.floor, [](BodyDef<D>& def) { def.shapes[0].friction = 0; }); })},
      {"friction of the box", On::slope,
       once<D>([](Y& y) { y.change(y.third, [](BodyDef<D>& def) { def.shapes[0].friction = 0; }); })},
      {"joint added", On::box, once<D>([](Y& y) {
         y.world.add(JointDef<D>{.kind = "distance{mode=spring,stiffness=200}", .bodyB = y.third,
                                 .X_WJ = {at<D>(3, 5), {}}, .X_WJb = Pose<D>{at<D>(3, 1), {}}});
       })},
      {"joint removed", On::slope, once<D>([](Y& y) { y.world.remove(y.joint); }),
       [](Y& y) {
         y.place(y.block, 5, 3);
         y.change(y.third, [](BodyDef<D>& def) { def.shapes[0].friction = 0; });
         y.joint = y.world.add(JointDef<D>{.kind = "weld", .bodyA = y.block, .bodyB = y.third, .X_WJ = {at<D>(5, 3), {}}});
       }},
      {"force added", On::box, once<D>([](Y& y) {
         y.world.add(ForceDef<D>{.kind = "spring{stiffness=100}", .bodyB = y.third, .anchorA = at<D>(6, 3)});
       })},
      {"force removed", On::slope, once<D>([](Y& y) { y.world.remove(y.force); }),
       [](Y& y) {
         y.force = y.world.add(ForceDef<D>{.kind = "spring{stiffness=0.6667}", .bodyB = y.third, .anchorA = at<D>(0, 0.5)});
         y.change(y.third, [](BodyDef<D>& def) { def.shapes[0].friction = Real(0.01); });
       }},
      {"pushed", On::box, once<D>([=](Y& y) { y.world.applyImpulse(y.third, Wrench<D>{at<D>(2, 0), Ang<D>::Zero()}); })},
      {"set into another", On::box, once<D>([](Y& y) { y.place(y.third, 0.9, 0.5); })},
      {"exchanged", On::box, once<D>([](Y& y) { y.world.setPipeline(y.world.pipeline()); })},
      {"ground merged with a block", On::box, once<D>([](Y& y) {
         y.place(y.block, 0.9, 0.5), y.world.merge(y.floor, y.block);
       })},
  };
  for (Change<D>& c : out) {
    const std::string name = c.name;
    for (const char* fall : {"ground removed", "lift removed", "asleep removed", "set away", "by a lower one",
                             "ground made a ghost", "support vetoed"}) {
      c.falls = c.falls || name.ends_with(fall);
    }
    c.slides = name.starts_with("friction") || name == "joint removed" || name == "force removed" || name == "pushed";
  }
  return out;
}

// Largest difference of a box's position after a third of a second (m) to the same world without sleeping, and how
// much deeper the deepest contact is a second later (m).
template <int D>
std::array<Real, 2> differences(const Change<D>& c, const std::string& pipeline) {
  std::vector<Vec<D>> places[2];
  Real deepest[2] = {0, 0};
  int steps = 0;  // until all sleep; both worlds take as many
  for (const bool sleeps : {true, false}) {
    WorldSettings<D> settings;
    if (c.on == On::slope) settings.gravity = at<D>(2, -9.81);
    Yard<D> y(sleeps ? pipeline : "sleep=none", settings);
    y.floor = y.world.add(groundOn<D>(c.on));
    y.low = y.world.add(body<D>(cube<D>(), at<D>(0, 0.5)));
    y.top = y.world.add(body<D>(cube<D>(), at<D>(0, 1.5)));
    y.third = y.world.add(body<D>(cube<D>(), at<D>(c.third, 0.5)));
    y.block = y.world.add(body<D>(cube<D>(), at<D>(50, 0), BodyType::fixed));
    y.lift = y.world.add(body<D>(cube<D>(), at<D>(-50, 0), BodyType::kinematic));
    if (c.prepare) c.prepare(y);
    for (int i = 0; sleeps ? i < 240 && !(i > 3 && y.allSleep()) : i < steps; ++i) {
      y.world.step(kDt);
      if (sleeps) steps = i + 1;
    }
    if (sleeps) {
      EXPECT_TRUE(y.allSleep()) << c.name << ' ' << pipeline;
    }
    for (int step = 0; step < 80; ++step) {
      c.perform(y, step);
      y.world.step(kDt);
      if (step != 19) continue;
      for (const BodyHandle b : {y.low, y.top, y.third}) {
        if (y.world.valid(b)) places[sleeps].push_back(y.world.pose(b).p);
      }
    }
    for (const Manifold<D>& m : y.world.manifolds()) {
      for (int k = 0; k < m.count; ++k) deepest[sleeps] = std::max(deepest[sleeps], -m.points[k].separation);
    }
  }
  Real worst = 0;
  for (std::size_t i = 0; i < places[0].size(); ++i) worst = std::max(worst, (places[0][i] - places[1][i]).norm());
  return {worst, deepest[1] - deepest[0]};
}

// `delay`: steps (1) by which the upper box may fall later.
template <int D>
bool movesAsIfAwake(const Change<D>& c, const std::string& pipeline, int delay = 0) {
  const auto [place, depth] = differences<D>(c, pipeline);
  return place < Real(0.02) + static_cast<Real>(delay) * Real(9.81) * 20 * kDt * kDt && depth < Real(0.002);
}

template <int D>
void everyPolicy() {
  for (const Change<D>& c : changes<D>()) {
    for (const Registered* r : Registry::instance().list(StageKind::sleep, D)) {
      if (!competes(*r) || r->info.name == "none") continue;
      const std::string slow = c.slides && r->info.name == "split_average" ? "{linear=0.02}" : "";
      const Spec spec = Spec::parse(r->info.name + slow);
      const bool wave = c.falls && declares(*r, spec, "Sleep.StackWakesAsAWhole");
      EXPECT_TRUE(movesAsIfAwake<D>(c, "sleep=" + r->info.name + slow, wave))
          << c.name << ' ' << r->info.name << ' ' << D;
    }
    const std::string name = c.name;
    if (name == "fixed body created beside" || name == "ground set away") {
      const char* deaf = "sleep=planted_sleep{bug=deaf}";
      expectCaught(name + " with " + deaf, movesAsIfAwake<D>(c, deaf));
    }
  }
}
TEST(SleepChanges, EveryPolicy2) { everyPolicy<2>(); }
TEST(SleepChanges, EveryPolicy3) { everyPolicy<3>(); }

// A change beside a sleeper does not wake it through the ground.
template <int D>
void farSleepersStayAsleep() {
  for (const char* policy : {"millington", "split_average", "timer_island"}) {
    World<D> world(Pipeline::parse(std::string("sleep=") + policy), {});
    world.add(groundOn<D>(On::box));
    const BodyHandle sleeper = world.add(body<D>(cube<D>(), at<D>(-3, 0.5)));
    const BodyHandle changed = world.add(body<D>(cube<D>(), at<D>(3, 0.5)));
    const BodyHandle lift = world.add(body<D>(cube<D>(), at<D>(0, 0.5), BodyType::kinematic));
    for (int i = 0; i < 240 && (world.awake(sleeper) || world.awake(changed)); ++i) world.step(kDt);
    world.applyImpulse(changed, Wrench<D>{at<D>(1, 0), Ang<D>::Zero()});
    world.setPose(lift, {at<D>(0, 5), {}});
    for (int i = 0; i < 3; ++i) {
      world.step(kDt);
      EXPECT_FALSE(world.awake(sleeper)) << policy << ' ' << D << "D, step " << i;
    }
  }
}
TEST(SleepChanges, FarSleepersStayAsleep) { farSleepersStayAsleep<2>(), farSleepersStayAsleep<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::sleep_changes_test
