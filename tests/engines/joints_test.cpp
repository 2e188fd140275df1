// SPDX-License-Identifier: Zlib
// Joints of engines. Signs, zeros and units of stops, motors, springs and ropes are LPC's; an engine refuses what it
// lacks. Each check also runs on our own world, and fails for its planted adapter.
#include "framework/world/invariants.h"
#include "tests/engines/engine_checks.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace engine_joints_test { namespace {

constexpr double kPi = 3.14159265358979;

Rot<2> turned(const Rot<2>&, double angle) { return Rot<2>::angle(Real(angle)); }
Rot<3> turned(const Rot<3>&, double angle) { return Rot<3>::vector(Vec<3>(0, 0, Real(angle))); }
template <int D>
Rot<D> aboutZ(double angle) {
  return turned(Rot<D>{}, angle);
}
// The rotation about z, seen from the origin, of a point that began on the x axis; within half a turn.
template <int D>
double angleOfPlace(const Simulation<D>& s, BodyHandle h) {
  return std::atan2(double(s.pose(h).p[1]), double(s.pose(h).p[0]));
}
template <int D>
JointDef<D> joint(const std::string& kind, BodyHandle a, BodyHandle b, const Vec<D>& place = Vec<D>::Zero()) {
  return {.kind = kind, .bodyA = a, .bodyB = b, .X_WJ = {place, {}}};
}
// A ball of 1 kg, 0.5 m wide.
template <int D>
BodyDef<D> ball(const Vec<D>& p) {
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.25)), p);
  def.shapes[0].density = Real(D == 2 ? 1 / 0.19634954 : 1 / 0.06544985);
  return def;
}

// --- checks ----------------------------------------------------------------------------------------------------------

// An arm hinged to the world falls onto its lower stop, or onto its upper one if gravity points up.
template <int D>
bool stops(const Start<D>& start) {
  for (const bool up : {false, true}) {
    const auto s = start(gravity<D>(0, up ? kG : -kG));
    const BodyHandle arm = s->add(ball<D>(at<D>(1, 0)));
    s->add(joint<D>("hinge{lower=-0.4,upper=0.6}", BodyHandle{}, arm));
    run(*s, 3);
    if (!near(angleOfPlace(*s, arm), up ? 0.6 : -0.4, 0.02) || stateInvariants<D>(*s).maxSpeed > 0.05) return false;
  }
  return true;
}

// Bodies and frames are all rotated: B's frame starts 0.5 rad ahead of A's and may fall back to 0.2.
template <int D>
bool stopsFromZero(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  BodyDef<D> post = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(0, 0), BodyType::fixed), arm = ball<D>(at<D>(1, 0));
  post.X_WB.q = aboutZ<D>(0.7), arm.X_WB.q = aboutZ<D>(-0.4);
  const BodyHandle a = s->add(post), b = s->add(arm);
  JointDef<D> hinge = joint<D>("hinge{lower=0.2,upper=0.9}", a, b);
  hinge.X_WJ.q = aboutZ<D>(0.3), hinge.X_WJb = Pose<D>{Vec<D>::Zero(), aboutZ<D>(0.8)};
  s->add(hinge);
  run(*s, 3);
  return near(angleOfPlace(*s, b), -0.3, 0.02);
}

// Two free cubes: a strong motor turns B relative to A at its speed, and the total momentum stays zero. A weak motor
// gives its torque and no more.
template <int D>
bool drives(const Start<D>& start) {
  for (const double speed : {2.0, -2.0}) {
    const auto s = start(gravity<D>(0, 0));
    const BodyHandle a = s->add(body<D>(cube<D>(), at<D>(0, 0))), b = s->add(body<D>(cube<D>(), at<D>(2, 0)));
    s->add(joint<D>("hinge{motor_speed=" + std::to_string(speed) + ",motor_torque=1000}", a, b, at<D>(1, 0)));
    run(*s, 1);
    const auto& m = s->bodies().motion;
    const double relative = double(m[1].w[kAngDim<D> - 1] - m[0].w[kAngDim<D> - 1]);
    if (!near(relative, speed, 0.02) || stateInvariants<D>(*s).momentum.norm() > 0.01) return false;
  }
  const auto s = start(gravity<D>(0, 0));
  const BodyHandle wheel = s->add(body<D>(cube<D>(), at<D>(0, 0)));  // 1/6 kg m^2
  s->add(joint<D>("hinge{motor_speed=1000,motor_torque=0.05}", BodyHandle{}, wheel));
  run(*s, 1);
  return near(double(s->bodies().motion[0].w[kAngDim<D> - 1]), 0.05 * 6, 0.005);
}

// A small swing about an axis tilted by 30 degrees in 3D: 2 pi sqrt(I / (m g cos(lean) l)).
template <int D>
bool keepsTime(const Start<D>& start) {
  const double lean = D == 3 ? kPi / 6 : 0, amplitude = 0.2, inertia = 1 + (D == 2 ? 0.5 : 0.4) * 0.25 * 0.25;
  const double period = 2 * kPi * std::sqrt(inertia / (kG * std::cos(lean))) * (1 + amplitude * amplitude / 16);
  const auto s = start(gravity<D>(0, -kG));
  Rot<D> tilt{};
  if constexpr (D == 3) tilt = Rot<3>::vector(Vec<3>(Real(lean), 0, 0));
  const BodyHandle bob = s->add(ball<D>(tilt * at<D>(std::sin(amplitude), -std::cos(amplitude))));
  JointDef<D> hinge = joint<D>("hinge", BodyHandle{}, bob);
  hinge.X_WJ.q = tilt;
  s->add(hinge);
  const double dt = 1.0 / 240;
  double first = 0, previous = 1;
  while (s->time() < 8) {
    s->step(Real(dt));
    const Vec<D> p = tilt.inverse() * s->pose(bob).p;
    if (D == 3 && std::abs(p[D - 1]) > 0.02) return false;  // off its plane
    const double x = double(p[0]);
    if (previous > 0 && x <= 0) {
      const double t = double(s->time()) - x / (x - previous) * dt;
      if (first > 0) return near(t - first, period, 0.02 * period);
      first = t;
    }
    previous = x;
  }
  return false;
}

// Three cubes in a row with different rotations, welded to the world at one end; and two that tumble as one.
template <int D>
bool welds(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  BodyHandle last{};
  for (int i = 0; i < 3; ++i) {
    BodyDef<D> def = body<D>(cube<D>(), at<D>(i + 0.5, 0));
    def.X_WB.q = aboutZ<D>(0.5 * i);
    const BodyHandle next = s->add(def);
    s->add(joint<D>("weld", last, next, at<D>(i, 0)));
    last = next;
  }
  run(*s, 3);
  if (!near(double(s->pose(last).p[1]), 0, 0.1) || !near(double(s->pose(last).p[0]), 2.5, 0.05)) return false;
  if ((turnOf(s->pose(last).q * aboutZ<D>(1).inverse())).norm() > 0.1) return false;

  const auto free = start(gravity<D>(0, 0));
  BodyDef<D> left = body<D>(cube<D>(), at<D>(0, 0)), right = body<D>(cube<D>(), at<D>(2, 0));
  right.velocity = at<D>(0, 2), right.X_WB.q = aboutZ<D>(1);
  const BodyHandle a = free->add(left), b = free->add(right);
  free->add(joint<D>("weld", a, b, at<D>(1, 0)));
  run(*free, 2);
  const Pose<D> X_AB = free->pose(a).inverse() * free->pose(b);
  const double turn = double(turnOf(free->pose(a).q).norm());
  return (X_AB.p - at<D>(2, 0)).norm() < 0.03 && turnOf(X_AB.q * aboutZ<D>(1).inverse()).norm() < 0.03 && turn > 0.5;
}

template <int D>
JointDef<D> hanging(const std::string& kind, BodyHandle b, double hook, double end) {
  JointDef<D> def = joint<D>(kind, BodyHandle{}, b, at<D>(0, hook));
  def.X_WJb = Pose<D>{at<D>(0, end), {}};
  return def;
}
// 1 m below its hook, on 2 m of rope: it falls freely, and then hangs.
template <int D>
bool ropes(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle h = s->add(ball<D>(at<D>(0, -1)));
  s->add(hanging<D>("distance{mode=rope,length=2}", h, 0, -1));
  run(*s, 0.4);
  const double fallen = kG * 24 * 25 / 2 / 3600;
  if (!near(double(s->pose(h).p[1]), -1 - fallen, 1e-3)) return false;
  double lowest = 0;
  for (int i = 0; i < 240; ++i) {
    s->step(kDt);
    lowest = std::min(lowest, double(s->pose(h).p[1]));
  }
  return near(lowest, -2, 0.03) && near(double(s->pose(h).p[1]), -2, 0.02);
}
// A rod keeps its length through two swings.
template <int D>
bool rods(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle h = s->add(ball<D>(at<D>(1, 0)));
  JointDef<D> def = joint<D>("distance", BodyHandle{}, h);
  def.X_WJb = Pose<D>{at<D>(1, 0), {}};
  s->add(def);
  double lowest = 0, off = 0;
  for (int i = 0; i < 180; ++i) {
    s->step(kDt);
    off = std::max(off, std::abs(double(s->pose(h).p.norm()) - 1));
    lowest = std::min(lowest, double(s->pose(h).p[1]));
  }
  return off < 0.02 && near(lowest, -1, 0.03);
}
// A damped spring, k = 50 N/m, c = 4 N s/m, 1 kg. The first swing reaches (1 + exp(-pi z / sqrt(1 - z^2))) m g / k,
// with z = c / (2 sqrt(k m)). The ball comes to rest m g / k below the rest length.
template <int D>
bool springs(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle h = s->add(ball<D>(at<D>(0, -1)));
  s->add(hanging<D>("distance{mode=spring,length=1,stiffness=50,damping=4}", h, 0, -1));
  double lowest = 0;
  for (int i = 0; i < 2400; ++i) {
    s->step(Real(1) / 240);
    lowest = std::min(lowest, double(s->pose(h).p[1]));
  }
  const double z = 4 / (2 * std::sqrt(50.0)), sag = kG / 50;
  return near(double(s->pose(h).p[1]), -1 - sag, 2e-3) &&
         near(lowest, -1 - sag * (1 + std::exp(-kPi * z / std::sqrt(1 - z * z))), 0.01);
}

// A body hangs by a joint that breaks at `share` of its weight. Returns whether it holds.
template <int D>
bool hangs(const Start<D>& start, const std::string& kind, double share) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle h = s->add(ball<D>(at<D>(0, 0)));
  JointDef<D> def =
      kind.starts_with("distance") ? hanging<D>(kind, h, 1, 0) : joint<D>(kind, BodyHandle{}, h, at<D>(0, 1));
  def.breakForce = Real(share * kG);
  const JointHandle hook = s->add(def);
  run(*s, 1);
  const bool broken = s->joints()[0].broken;
  const double y = double(s->pose(h).p[1]);
  EXPECT_TRUE(broken ? y < -4.5 : y > -0.02) << kind << ": the record says what happened, y = " << y;
  s->remove(hook);
  EXPECT_THROW(s->remove(hook), UserError);
  return !broken;
}
template <int D>
bool breaks(const Start<D>& start, std::initializer_list<const char*> kinds) {
  for (const char* kind : kinds) {
    if (!hangs<D>(start, kind, 1.1) || hangs<D>(start, kind, 0.9)) return false;
  }
  // A weld with a lever: the force is within its limit, the torque is not.
  for (const double share : {0.8, 1.2}) {
    const auto s = start(gravity<D>(0, -kG));
    const BodyHandle h = s->add(body<D>(cube<D>(), at<D>(0.5, 0)));  // 1 kg
    JointDef<D> def = joint<D>("weld", BodyHandle{}, h);
    def.breakTorque = Real(share * 0.5 * kG);
    s->add(def);
    run(*s, 0.5);
    if (bool(s->joints()[0].broken) != (share < 1)) return false;
  }
  // A hinge has no torque about its axis, at any distance of the body's centre and any speed.
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle h = s->add(ball<D>(at<D>(2, 0)));
  JointDef<D> def = joint<D>("hinge", BodyHandle{}, h);
  def.breakTorque = Real(0.05 * 2 * kG);
  s->add(def);
  run(*s, 2);
  if (s->joints()[0].broken) return false;
  s->remove(h);  // and its joint
  s->step(kDt);
  return s->bodyCount() == 0;
}
template <int D>
bool breaksAll(const Start<D>& start) {
  return breaks<D>(start, {"pivot", "hinge", "weld"});
}
bool breaksDistances(const Start<2>& start) {
  return breaks<2>(start, {"distance", "distance{mode=rope}", "distance{mode=spring,stiffness=100000,damping=1000}"});
}

// With the feature off, a scene has no joints, and does not need what an engine lacks.
template <int D>
bool switchesOff(const Start<D>& start, const std::string& kind) {
  WorldSettings<D> settings = gravity<D>(0, -kG);
  settings.model.joints = false;
  const auto s = start(settings);
  const BodyHandle h = s->add(ball<D>(at<D>(1, 0)));
  const JointHandle gone = s->add(joint<D>("pivot", BodyHandle{}, h));
  s->add(joint<D>(kind, BodyHandle{}, h));
  run(*s, 0.5);
  s->remove(gone);
  run(*s, 0.5);
  const bool fell = near(double(s->pose(h).p[1]), -kG * 60 * 61 / 2 / 3600, 1e-3);
  s->remove(h);
  s->step(kDt);
  return fell;
}
template <int D>
bool switchesAllOff(const Start<D>& start) {
  return switchesOff<D>(start, "hinge") && switchesOff<D>(start, "hinge{stiffness=5}");
}

// A ball on an arm swings down past the side of a cube: through the cube, or against it.
template <int D>
double swingsTo(const Start<D>& start, bool collide) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle post = s->add(body<D>(cube<D>(), at<D>(0, 0), BodyType::fixed));
  const BodyHandle bob = s->add(body<D>(Shape<D>::sphere(Real(0.2)), at<D>(1.4, 0.8)));
  JointDef<D> def = joint<D>("hinge", post, bob, at<D>(0.6, 0.8));
  def.collide = collide;
  s->add(def);
  double least = 9;
  for (int i = 0; i < 60; ++i) {
    s->step(kDt);
    least = std::min(least, double(s->pose(bob).p[0]));
  }
  return least;
}
template <int D>
bool passes(const Start<D>& start) {
  return swingsTo<D>(start, false) < 0 && swingsTo<D>(start, true) > 0.6;
}
// A joint between touching bodies stops their collision; when it is removed they collide again.
template <int D>
bool partsWhatTouched(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle floor = s->add(ground<D>()), box = s->add(body<D>(cube<D>(), at<D>(0, 0.5)));
  run(*s, 0.5);
  s->add(joint<D>("hinge", floor, box, at<D>(-0.5, 0.5)));
  run(*s, 0.5);
  if (!(double(s->pose(box).p[1]) < 0.2)) return false;
  const auto again = start(gravity<D>(0, -kG));
  const BodyHandle low = again->add(ground<D>()), high = again->add(body<D>(cube<D>(), at<D>(0, 2)));
  const JointHandle hook = again->add(joint<D>("pivot", low, high, at<D>(0, 2)));
  run(*again, 0.2);
  again->remove(hook);
  run(*again, 3);
  return near(double(again->pose(high).p[1]), 0.5, 0.03);
}

// --- tested engines --------------------------------------------------------------------------------------------------

TEST(EngineJoints, HingesStopWhereOursDo) {
  everywhere("stops", stops<2>, stops<3>);
  everywhere("stopsFromZero", stopsFromZero<2>, stopsFromZero<3>);
}
TEST(EngineJoints, MotorsTurnAsOursDo) { everywhere("drives", drives<2>, drives<3>); }
TEST(EngineJoints, HingesKeepTime) { everywhere("keepsTime", keepsTime<2>, keepsTime<3>); }
TEST(EngineJoints, WeldsHold) { everywhere("welds", welds<2>, welds<3>); }
TEST(EngineJoints, DistancesAreRodsSpringsAndRopes) {
  everyEngine<2>("ropes", ropes<2>), everyEngine<2>("rods", rods<2>), everyEngine<2>("springs", springs<2>);
}
TEST(EngineJoints, BreakAtTheirForceAndTorque) {
  everywhere("breaks", breaksAll<2>, breaksAll<3>);
  everyEngine<2>("breaks", breaksDistances);
}
TEST(EngineJoints, AreOffWhenTheFeatureIsOff) { everywhere("switchesOff", switchesAllOff<2>, switchesAllOff<3>); }
TEST(EngineJoints, LetTheirBodiesPassOrCollide) {
  everywhere("passes", passes<2>, passes<3>);
  everywhere("partsWhatTouched", partsWhatTouched<2>, partsWhatTouched<3>);
}

template <int D>
void worldPasses() {
  const Start<D> start = ownWorld<D>();
  EXPECT_TRUE(stops<D>(start) && stopsFromZero<D>(start) && drives<D>(start) && keepsTime<D>(start));
  EXPECT_TRUE(welds<D>(ownWorld<D>("solver=split_solver{velocity=catto{iterations=30}}")));
  EXPECT_TRUE(ropes<D>(start) && rods<D>(start) && springs<D>(start));
  EXPECT_TRUE(breaksAll<D>(start) && switchesAllOff<D>(start) && passes<D>(start) && partsWhatTouched<D>(start));
  if constexpr (D == 2) {
    EXPECT_TRUE(breaksDistances(start));
  }
}
TEST(EngineJoints, WorldsPassToo) { worldPasses<2>(), worldPasses<3>(); }

template <int D>
void twinsAreCaught(const std::string& name, const Start<D>& start) {
  SCOPED_TRACE(name);
  EXPECT_FALSE(stops<D>(otherSideOfHinges<D>(start)));
  EXPECT_FALSE(stopsFromZero<D>(anglesOfBodies<D>(start)));
  EXPECT_FALSE(drives<D>(backwardMotors<D>(start)));
  EXPECT_FALSE(drives<D>(impulsiveMotors<D>(start)));
  EXPECT_FALSE(keepsTime<D>(upsideDown<D>(start)));
  EXPECT_FALSE(welds<D>(looseWelds<D>(start)));
  EXPECT_FALSE(breaksAll<D>(unbreakable<D>(start)));
  EXPECT_FALSE(switchesOff<D>(alwaysJoined<D>(start), "hinge"));
  for (const bool collide : {false, true}) EXPECT_FALSE(passes<D>(jointedCollide<D>(start, collide)));
  EXPECT_FALSE(partsWhatTouched<D>(jointedCollide<D>(start, true)));
}
TEST(EngineJoints, PlantedAdaptersAreCaught) {
  twinsAreCaught<2>("ours", ownWorld<2>()), twinsAreCaught<3>("ours", ownWorld<3>());
  for (const auto& e : engines<3>()) twinsAreCaught<3>(e.name, e.start);
  for (const auto& e : engines<2>()) {
    twinsAreCaught<2>(e.name, e.start);
    EXPECT_FALSE(ropes<2>(stiffRopes<2>(e.start)));
    EXPECT_FALSE(springs<2>(undamped<2>(e.start)));
  }
}

// Whole turns are counted: the stop is more than one turn away, and no joint error is reported on the way.
template <int D>
bool countsTurns(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  const BodyHandle wheel = s->add(body<D>(cube<D>(), at<D>(0, 0)));
  s->add(joint<D>("hinge{upper=7,motor_speed=4,motor_torque=5}", BodyHandle{}, wheel));
  for (int i = 0; i < 180; ++i) {
    if (i == 60) s->setPose(wheel, s->pose(wheel));  // at 3.7 rad: setting the pose must not lose the count of turns
    s->step(kDt);
  }
  return near(double(turnOf(s->pose(wheel).q)[kAngDim<D> - 1]), 7 - 2 * kPi, 0.02) &&
         stateInvariants<D>(*s).jointTurn < 0.02;
}
TEST(EngineJoints, WholeTurnsAreCounted) {
  everyEngine<2>("countsTurns", countsTurns<2>);
  EXPECT_TRUE(countsTurns<2>(ownWorld<2>()) && countsTurns<3>(ownWorld<3>()));
}

template <int D>
void refuses(const std::string& name, const JointDef<D>& def, const std::string& why) {
  for (const auto& e : engines<D>()) {
    if (e.name != name) continue;
    const auto s = e.start(gravity<D>(0, -kG));
    JointDef<D> mine = def;
    mine.bodyB = s->add(ball<D>(at<D>(0, 0)));
    try {
      s->add(mine);
      ADD_FAILURE() << name << " took " << def.kind;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
    for (const JointRecord<D>& j : s->joints()) EXPECT_FALSE(j.active());
    run(*s, 1);
    EXPECT_LT(s->pose(mine.bodyB).p[1], -4) << "nothing holds it";
    s->remove(mine.bodyB);
  }
}
TEST(EngineJoints, UnsupportedJointsAreRefusedWithoutTrace) {
  const auto far = [](const std::string& kind, auto place) {
    auto def = joint(kind, BodyHandle{}, BodyHandle{}, place);
    def.X_WJb = decltype(def.X_WJ){};
    return def;
  };
  refuses<2>("box2d", joint<2>("hinge{stiffness=5}", {}, {}),
             "box2d: its hinge joint has no 'stiffness'; valid: stiffness=0");
  refuses<2>("box2d", joint<2>("hinge{damping=5}", {}, {}),
             "box2d: its hinge joint has no 'damping'; valid: damping=0");
  refuses<2>("box2d", far("distance{mode=spring,stiffness=0,damping=3}", at<2>(0, 1)), "has damping but no stiffness");
  refuses<2>("box2d", far("distance{mode=rope,length=0.004}", at<2>(0, 1)), "below 5 mm");
  refuses<3>("bullet", far("distance", at<3>(0, 1)), "bullet: no joint of kind distance");
  refuses<3>("bullet", joint<3>("hinge{stiffness=5}", {}, {}),
             "bullet: its hinge joint has no 'stiffness'; valid: stiffness=0");
  for (const char* kind : {"hinge{upper=1}", "hinge{lower=-1,upper=5}", "hinge{lower=5,upper=6}"}) {
    refuses<3>("bullet", joint<3>(kind, {}, {}), "does not count whole turns");
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::engine_joints_test
