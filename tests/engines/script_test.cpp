// SPDX-License-Identifier: Zlib
// Actions of a script on bodies between steps, in engines as in our worlds.
#include "framework/world/invariants.h"
#include "tests/engines/engine_checks.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace engine_script_test { namespace {

// A cube of 2 kg with its frame off its centre.
template <int D>
BodyDef<D> block() {
  BodyDef<D> def = body<D>(cube<D>(), at<D>(0, 0));
  def.shapes[0].density = 2, def.shapes[0].X_BS.p = at<D>(0.25, 0);
  return def;
}
template <int D>
Ang<D> spin(double about) {
  Ang<D> w = Ang<D>::Zero();
  w[kAngDim<D> - 1] = Real(about);
  return w;
}
template <int D>
const Motion<D>& motion(const Simulation<D>& s, BodyHandle h) {
  return s.bodies().motion[static_cast<std::size_t>(h.slot)];
}

// 3 N for 12 steps, along a line half a metre from the centre of mass: v = F t / m, w = r F t / I; no change
// afterwards. A torque of 0.5 N m gives T t / I.
template <int D>
bool forces(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  const BodyHandle h = s->add(block<D>());
  const double t = 12 * double(kDt), inertia = 2.0 / 6;
  for (int i = 0; i < 12; ++i) {
    s->applyForce(h, at<D>(0, 3), at<D>(0.75, 0));
    s->step(kDt);
  }
  run(*s, 0.5);
  const Motion<D> pushed = motion(*s, h);
  if (!near(double(pushed.v[1]), 3 * t / 2, 1e-3)) return false;
  if (!near(double(pushed.w[kAngDim<D> - 1]), 0.5 * 3 * t / inertia, 1e-3)) return false;

  const auto other = start(gravity<D>(0, 0));
  const BodyHandle b = other->add(block<D>());
  for (int i = 0; i < 12; ++i) {
    other->applyTorque(b, spin<D>(0.5));
    other->step(kDt);
  }
  run(*other, 0.5);
  return near(double(motion(*other, b).w[kAngDim<D> - 1]), 0.5 * t / inertia, 1e-3) &&
         near(double(motion(*other, b).v.norm()), 0, 1e-5);
}

// Two forces in one step add up. A force on a removed body does not act on the body that reuses its slot.
template <int D>
bool forcesAddUp(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  const BodyHandle gone = s->add(block<D>());
  s->applyForce(gone, at<D>(100, 0), at<D>(0, 0));
  s->remove(gone);
  const BodyHandle h = s->add(block<D>());
  s->step(kDt);
  if (motion(*s, h).v.norm() > 1e-6) return false;
  s->applyForce(h, at<D>(3, 0), at<D>(0.25, 0)), s->applyForce(h, at<D>(3, 0), at<D>(0.25, 0));
  s->step(kDt);
  return near(double(motion(*s, h).v[0]), 6.0 / 2 / 60, 1e-4);
}

// Velocities are those of the centre of mass. A body that may not turn does not turn.
template <int D>
bool moves(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  const BodyHandle h = s->add(block<D>());
  BodyDef<D> stiff = block<D>();
  stiff.X_WB.p = at<D>(0, 9), stiff.rotatable = false, stiff.angularVelocity = spin<D>(1);
  const BodyHandle rigid = s->add(stiff);
  run(*s, 0.1);
  s->setMotion(h, {at<D>(2, 1), spin<D>(1)});
  s->setMotion(rigid, {at<D>(1, 0), spin<D>(1)});
  run(*s, 0.5);
  const Vec<D> center = s->pose(h) * at<D>(0.25, 0);
  return (center - at<D>(0.25 + 2 * 0.5, 0.5)).norm() < 0.01 && near(double(turnOf(s->pose(h).q).norm()), 0.5, 0.01) &&
         near(double(s->pose(rigid).p[0]), 0.5, 0.01) && turnOf(s->pose(rigid).q).norm() < 1e-5;
}

// Impulses act immediately and permanently, on bodies that can move: v = J / m, w = L / I.
template <int D>
bool blows(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  BodyDef<D> stiff = block<D>();
  stiff.X_WB.p = at<D>(0, 9), stiff.rotatable = false;
  BodyDef<D> deep = ground<D>();
  deep.X_WB.p = at<D>(0, -9);
  const BodyHandle h = s->add(block<D>()), rigid = s->add(stiff), floor = s->add(deep);
  run(*s, 0.1);
  for (const BodyHandle& b : {h, rigid, floor}) s->applyImpulse(b, {at<D>(0, 3), spin<D>(0.5)});
  const auto moved = [&](const BodyHandle& b, double v, double w) {
    return near(double(motion(*s, b).v[1]), v, 1e-3) && near(double(motion(*s, b).w[kAngDim<D> - 1]), w, 1e-3);
  };
  const auto all = [&] { return moved(h, 1.5, 1.5) && moved(rigid, 1.5, 0) && moved(floor, 0, 0); };
  if (!all()) return false;
  run(*s, 0.5);
  return all() && near(double((s->pose(h) * at<D>(0.25, 0))[1]), 0.75, 0.01);
}

// A kinematic lift carries a box up at its initial velocity, and sideways by friction when its velocity changes.
// Without a load it turns at the angular velocity given.
template <int D>
bool carries(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  Vec<D> half = Vec<D>::Constant(3);
  half[1] = Real(0.25);
  BodyDef<D> plate = body<D>(Shape<D>::box(half), at<D>(0, -0.25), BodyType::kinematic);
  plate.velocity = at<D>(0, 1);
  BodyDef<D> load = body<D>(cube<D>(), at<D>(0, 0.5));
  load.velocity = plate.velocity;
  const BodyHandle lift = s->add(plate), box = s->add(load);
  run(*s, 1);
  if (!near(double(s->pose(lift).p[1]), 0.75, 1e-3) || !near(double(s->pose(box).p[1]), 1.5, 0.03)) return false;
  s->setMotion(lift, {at<D>(0.5, 1), spin<D>(0)});
  run(*s, 2);
  if (!near(double(s->pose(lift).p[0]), 1, 1e-3) || !near(double(s->pose(lift).p[1]), 2.75, 1e-3)) return false;
  if (!near(double(s->pose(box).p[0]), 1, 0.05) || !near(double(s->pose(box).p[1]), 3.5, 0.03)) return false;
  if (!near(double(motion(*s, lift).v[0]), 0.5, 1e-6)) return false;
  s->remove(box);
  s->setMotion(lift, {at<D>(0, 0), spin<D>(1)});
  run(*s, 1);
  return near(double(turnOf(s->pose(lift).q)[kAngDim<D> - 1]), 1, 1e-3);
}

// One radian in one step.
template <int D>
bool spins(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  const BodyHandle wheel = s->add(body<D>(cube<D>(), at<D>(0, 0), BodyType::kinematic));
  Motion<D> turn;
  turn.w[kAngDim<D> - 1] = 60;
  s->setMotion(wheel, turn);
  s->step(kDt);
  return near(double(turnOf(s->pose(wheel).q)[kAngDim<D> - 1]), 1, 1e-3);
}

// Moving a lift up by 2 cm gives it no velocity: its load is pushed out, not thrown.
template <int D>
bool placesGently(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  BodyDef<D> plate = ground<D>();
  plate.type = BodyType::kinematic;
  const BodyHandle lift = s->add(plate), box = s->add(body<D>(cube<D>(), at<D>(0, 0.5)));
  run(*s, 0.5);
  s->setPose(lift, {at<D>(0, -0.98), {}});
  double fastest = 0;
  for (int i = 0; i < 60; ++i) {
    s->step(kDt);
    fastest = std::max(fastest, double(motion(*s, box).v.norm()));
  }
  return fastest < 0.5 && near(double(s->pose(box).p[1]), 0.52, 0.02);
}

// A body is lifted, turned and dropped again, while the ground below is moved down by half a metre.
template <int D>
bool places(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle floor = s->add(ground<D>()), box = s->add(body<D>(cube<D>(), at<D>(0, 0.5)));
  run(*s, 0.5);
  Rot<D> quarter{};
  if constexpr (D == 2) quarter = Rot<2>::angle(Real(1.5707963));
  if constexpr (D == 3) quarter = Rot<3>::vector(Vec<3>(0, 0, Real(1.5707963)));
  s->setPose(box, {at<D>(3, 1.5), quarter});
  if ((s->pose(box).p - at<D>(3, 1.5)).norm() > 1e-6) return false;
  s->setPose(floor, {at<D>(0, -1.5), {}});
  run(*s, 3);
  const StateInvariants<D> now = stateInvariants<D>(*s);
  return near(double(s->pose(box).p[1]), 0, 0.03) && near(double(s->pose(box).p[0]), 3, 0.03) &&
         near(double(turnOf(s->pose(box).q).norm()), 1.5707963, 0.02) && now.maxSpeed < 0.02;
}

TEST(EngineScripts, ForcesActWhereTheyAreApplied) {
  everywhere("forces", forces<2>, forces<3>);
  everywhere("forcesAddUp", forcesAddUp<2>, forcesAddUp<3>);
}
TEST(EngineScripts, VelocitiesAreSet) { everywhere("moves", moves<2>, moves<3>); }
TEST(EngineScripts, ImpulsesChangeVelocities) { everywhere("blows", blows<2>, blows<3>); }
TEST(EngineScripts, LiftsCarry) {
  everywhere("carries", carries<2>, carries<3>);
  everywhere("placesGently", placesGently<2>, placesGently<3>);
  everywhere("spins", spins<2>, spins<3>);
}
TEST(EngineScripts, PosesAreSet) { everywhere("places", places<2>, places<3>); }

template <int D>
void worldPasses() {
  const Start<D> start = ownWorld<D>();
  EXPECT_TRUE(forces<D>(start) && forcesAddUp<D>(start) && moves<D>(start) && places<D>(start));
  EXPECT_TRUE(blows<D>(start) && carries<D>(start) && placesGently<D>(start));
}
TEST(EngineScripts, WorldsPassToo) { worldPasses<2>(), worldPasses<3>(); }

template <int D>
void twinsAreCaught(const Start<D>& start) {
  EXPECT_FALSE(forces<D>(centralForces<D>(start)));
  EXPECT_FALSE(forces<D>(noTorques<D>(start)));
  EXPECT_FALSE(forcesAddUp<D>(ownMass<D>(start)));
  EXPECT_FALSE(moves<D>(noTurning<D>(start)));
  EXPECT_FALSE(blows<D>(softBlows<D>(start)));
  EXPECT_FALSE(carries<D>(noTurning<D>(start)));
  EXPECT_FALSE(places<D>(noRotation<D>(start)));
}
TEST(EngineScripts, PlantedAdaptersAreCaught) {
  for (const auto& e : engines<2>()) twinsAreCaught<2>(e.start);
  for (const auto& e : engines<3>()) twinsAreCaught<3>(e.start);
}

template <int D>
void refusesNonsense() {
  std::vector<Named<D>> all = engines<D>();
  all.push_back({"ours", ownWorld<D>()});
  for (const auto& e : all) {
    SCOPED_TRACE(e.name);
    const auto s = e.start(gravity<D>(0, 0));
    BodyDef<D> deep = ground<D>();
    deep.X_WB.p = at<D>(0, -9);
    const BodyHandle h = s->add(block<D>()), floor = s->add(deep), gone = s->add(block<D>());
    s->remove(gone);
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    EXPECT_THROW(s->setPose(gone, {}), UserError);
    EXPECT_THROW(s->setMotion(gone, {}), UserError);
    EXPECT_THROW(s->applyForce(gone, at<D>(1, 0), at<D>(0, 0)), UserError);
    EXPECT_THROW(s->applyTorque(gone, spin<D>(1)), UserError);
    EXPECT_THROW(s->applyImpulse(gone, {at<D>(1, 0), spin<D>(0)}), UserError);
    EXPECT_THROW(s->setMotion(floor, {at<D>(1, 0), spin<D>(0)}), UserError);
    EXPECT_THROW(s->setPose(h, {nan * at<D>(1, 0), {}}), UserError);
    EXPECT_THROW(s->setMotion(h, {nan * at<D>(1, 0), spin<D>(0)}), UserError);
    EXPECT_THROW(s->applyForce(h, nan * at<D>(1, 0), at<D>(0, 0)), UserError);
    EXPECT_THROW(s->applyTorque(h, nan * spin<D>(1)), UserError);
    EXPECT_THROW(s->applyImpulse(h, {at<D>(1, 0), nan * spin<D>(1)}), UserError);
    const std::uint64_t before = s->hash();
    s->step(kDt);
    EXPECT_EQ(s->hash(), before) << "nothing was pushed";
  }
}
TEST(EngineScripts, NonsenseIsRefusedAndChangesNothing) { refusesNonsense<2>(), refusesNonsense<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::engine_script_test
