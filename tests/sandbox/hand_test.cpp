// SPDX-License-Identifier: Zlib
// Mouse input on a scene, without a window.
#include "experiments/sandbox/hand.h"

#include <gtest/gtest.h>

#include "framework/math/check.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace hand_test { namespace {

template <int D>
struct Table {
  static SceneSpec<D> empty() {
    SceneSpec<D> scene;
    scene.settings.model.joints = true;
    return scene;
  }
  Session<D> session{empty(), {""}};
  ViewCamera<D> camera;
  Hand<D> hand{session, camera};

  Table() {
    camera.resize(800, 600);
    camera.look(Vec<D>::Constant(-5), Vec<D>::Constant(5));
    session.perform(SetGravity<D>{Vec<D>::Zero()});
  }
  static Vec<D> at(Real x, Real y) {
    Vec<D> p = Vec<D>::Zero();
    p[0] = x, p[1] = y;
    return p;
  }
  int add(Real x, Real y) {
    BodyDef<D> def;
    def.X_WB.p = at(x, y);
    def.shapes.push_back({.shape = Shape<D>::sphere(Real(0.5))});
    session.perform(AddBody<D>{def});
    return session.bodies() - 1;
  }
  Vec<2> pixel(Real x, Real y) const { return camera.toPixel(at(x, y)); }
  void drag(const Vec<2>& from, const Vec<2>& to, bool more = false) {
    hand.press(from, more), hand.move(to), hand.release(to);
  }
  Vec<D> place(int body) const { return session.world().pose(session.handle(body)).p; }
};

template <int D>
void picks() {
  Table<D> t;
  const int a = t.add(0, 0);
  EXPECT_EQ(t.session.bodyAt(pick(t.session.world(), t.camera, t.pixel(0, 0)).slot), a);
  EXPECT_EQ(pick(t.session.world(), t.camera, Vec<2>(1, 1)).slot, -1);
  expectCaught("nobody is ever under the cursor", pick(t.session.world(), t.camera, t.pixel(0, 0)).slot == -1);
}
TEST(SandboxHand, PicksTheBodyUnderTheCursor) { picks<2>(), picks<3>(); }

// In 2D a dynamic body is picked before static ones; in 3D the nearer body.
TEST(SandboxHand, PicksTheBodyInFront) {
  Table<2> plane;
  plane.session.perform(AddBody<2>{BodyDef<2>::fixed({.shape = Shape<2>::box({4, 4})})});
  const int ball = plane.add(1, 1);
  plane.session.perform(AddBody<2>{BodyDef<2>::fixed({.shape = Shape<2>::box({4, 4})})});
  EXPECT_EQ(plane.session.bodyAt(pick(plane.session.world(), plane.camera, plane.pixel(1, 1)).slot), ball);
  Table<3> space;
  space.add(0, 0);
  const Vec<3> nearer = 3 * space.camera.towards();
  BodyDef<3> def;
  def.X_WB.p = nearer, def.shapes.push_back({.shape = Shape<3>::sphere(Real(0.5))});
  space.session.perform(AddBody<3>{def});
  const Picked<3> picked = pick(space.session.world(), space.camera, space.camera.toPixel(Vec<3>::Zero()));
  EXPECT_EQ(space.session.bodyAt(picked.slot), 1);
  EXPECT_NEAR((picked.point - nearer).norm(), 0.5, 1e-9);

  // A static body in front of them is not picked, and nothing is drawn on it.
  BodyDef<3> wall = BodyDef<3>::fixed({.shape = Shape<3>::sphere(2)});
  wall.X_WB.p = 6 * space.camera.towards();
  space.session.perform(AddBody<3>{wall});
  const Picked<3> through = pick(space.session.world(), space.camera, space.camera.toPixel(Vec<3>::Zero()));
  EXPECT_EQ(space.session.bodyAt(through.slot), 1);
  EXPECT_NEAR((through.point - nearer).norm(), 0.5, 1e-9);
  const Vec<2> aside = space.camera.toPixel(wall.X_WB.p + Real(1.2) * space.camera.up());
  EXPECT_EQ(space.session.bodyAt(pick(space.session.world(), space.camera, aside).slot), 2);
  const Vec<3> drawn = freePoint(space.session.world(), space.camera, aside);
  EXPECT_NEAR((drawn - space.camera.origin()).dot(space.camera.towards()), 0, 1e-9);
}

template <int D>
void draws() {
  Table<D> t;
  t.hand.tool = Tool::circle;
  t.drag(t.pixel(1, 1), t.pixel(1, 2));
  ASSERT_EQ(t.session.bodies(), 1);
  const auto& record = t.session.world().shapes()[0];
  const Vec<2> seen = t.camera.toPixel(t.place(0));
  EXPECT_NEAR((seen - t.pixel(1, 1)).norm(), 0, 1e-6);
  EXPECT_EQ(record.shape.kind(), ShapeKind::sphere);
  if (D == 2) {
    EXPECT_NEAR(double(record.shape.view().radius), 1, 1e-9);
  }

  t.hand.tool = Tool::box;
  t.drag(t.pixel(-3, -3), t.pixel(-1, -2));
  EXPECT_EQ(t.session.bodies(), 2);
  t.hand.tool = Tool::capsule;
  t.drag(t.pixel(-3, 3), t.pixel(-1, 3));
  EXPECT_EQ(t.session.bodies(), 3);
  t.hand.tool = Tool::polygon;
  for (const Vec<2>& p : {t.pixel(3, -3), t.pixel(4, -3), t.pixel(4, -2)}) t.hand.press(p, false), t.hand.release(p);
  t.hand.finish();
  EXPECT_EQ(t.session.bodies(), 4);
  t.hand.tool = Tool::compound;
  t.drag(t.pixel(3, 3), t.pixel(4, 4)), t.drag(t.pixel(4, 3), t.pixel(5, Real(3.5)));
  t.hand.finish();
  ASSERT_EQ(t.session.bodies(), 5);
  const BodyHandle h = t.session.handle(4);
  int shapes = 0;
  for (const auto& s : t.session.world().shapes()) shapes += s.body == h.slot;
  EXPECT_EQ(shapes, 2);
  // A drag of zero length draws nothing; drawn bodies can be static.
  t.hand.tool = Tool::circle;
  t.drag(t.pixel(0, 0), t.pixel(0, 0));
  EXPECT_EQ(t.session.bodies(), 5);
  t.hand.drawsStatic = true;
  t.drag(t.pixel(0, -4), t.pixel(0, Real(-4.5)));
  ASSERT_EQ(t.session.bodies(), 6);
  EXPECT_EQ(t.session.world().bodies().type[static_cast<std::size_t>(t.session.handle(5).slot)], BodyType::fixed);
}
TEST(SandboxHand, ToolsDrawWhatTheyAreNamedAfter) { draws<2>(), draws<3>(); }

// While paused, the body follows the cursor exactly; otherwise a spring pulls it, and its motion stays finite.
template <int D>
void carries() {
  Table<D> t;
  const int a = t.add(0, 0);
  t.hand.setPaused(true);
  const Vec<2> grip = t.pixel(Real(0.2), 0);
  const Vec<D> held = pick(t.session.world(), t.camera, grip).point;
  t.drag(grip, t.camera.toPixel(held + Table<D>::at(2, 1)));
  const Vec<2> moved = t.camera.toPixel(t.place(a)) - t.camera.toPixel(Vec<D>::Zero());
  EXPECT_GT(moved.norm(), 20);
  EXPECT_EQ(t.session.actions().size(), 3u);  // gravity, the body, and one move
  t.hand.setPaused(false);
  const Vec<D> from = t.place(a);
  const Vec<2> at = t.camera.toPixel(from);
  t.hand.press(at, false);
  t.hand.move(at - Vec<2>(100, 0));
  for (int i = 0; i < 240; ++i)
    t.hand.pull(D == 3), t.session.step();  // a ball held at its surface keeps turning about that point
  EXPECT_FALSE(t.session.fallen());
  EXPECT_NEAR((t.camera.toPixel(t.place(a)) - (at - Vec<2>(100, 0))).norm(), 0, 5);
  EXPECT_LT(double(t.session.world().bodies().motion[0].v.norm()), 1e-2);
  t.hand.release(at);
  expectCaught("the spring does not pull", (t.place(a) - from).norm() < 0.1);
}
TEST(SandboxHand, CarriesExactlyOrByASpring) { carries<2>(), carries<3>(); }

template <int D>
void selectsByShapes() {
  Table<D> t;
  const int a = t.add(0, 0);
  const Vec<2> middle = t.pixel(0, 0), right = t.pixel(1, 0);
  const Vec<2> across = right - middle;  // px of a metre
  const auto selected = [&](Real from, Real to) {
    t.drag(middle + from * across + Vec<2>(0, -2), middle + to * across + Vec<2>(0, 2));
    return t.hand.selected();
  };
  EXPECT_EQ(selected(Real(0.3), 3), std::vector<int>{a}) << D << "D, the right rim";
  EXPECT_EQ(selected(-3, Real(-0.3)), std::vector<int>{a}) << D << "D, the left rim";
  EXPECT_EQ(selected(Real(-0.1), Real(0.1)), std::vector<int>{a}) << D << "D, inside";
  EXPECT_EQ(selected(Real(0.8), 3), std::vector<int>{}) << D << "D, beside";
}

TEST(SandboxHand, ARectangleSelectsAndKeysActOnAll) {
  Table<2> t;
  const int a = t.add(-2, 0), b = t.add(0, 0), c = t.add(4, 4);
  t.drag(t.pixel(-3, 1), t.pixel(1, -1));
  EXPECT_EQ(t.hand.selected(), (std::vector<int>{a, b}));
  t.drag(t.pixel(4, 4), t.pixel(4, 4), true);
  EXPECT_EQ(t.hand.selected(), (std::vector<int>{a, b, c}));
  t.hand.pin();
  for (const int body : {a, b, c}) {
    EXPECT_TRUE(t.session.world().bodies().pinned[static_cast<std::size_t>(t.session.handle(body).slot)]);
  }
  t.hand.pin(), t.hand.merge();
  EXPECT_EQ(t.session.world().bodyCount(), 1);
  t.hand.splitByShape();
  EXPECT_EQ(t.session.world().bodyCount(), 3);
  t.hand.makeStatic();
  t.hand.removeSelected();
  EXPECT_EQ(t.session.world().bodyCount(), 2);
}

// By its shape, as in 2009: a rectangle over the rim of a circle, without its centre, selects it; one beside it does
// not.
TEST(SandboxHand, ARectangleSelectsByShapes) { selectsByShapes<2>(), selectsByShapes<3>(); }

TEST(SandboxHand, JoinsTwoBodiesOrOneWithTheWorld) {
  Table<2> t;
  t.add(-1, 0), t.add(1, 0);
  t.hand.tool = Tool::joint;
  const auto click = [&](const Vec<2>& at) { t.hand.press(at, false), t.hand.release(at); };
  t.hand.joint = "distance";  // its ends may be apart
  click(t.pixel(-1, 0)), click(t.pixel(1, 0));
  ASSERT_EQ(t.session.world().joints().size(), 1u);
  t.hand.joint = "pivot";  // its ends coincide: at the first click
  click(t.pixel(1, 0)), click(t.pixel(1, 3));
  ASSERT_EQ(t.session.world().joints().size(), 2u);
  const auto& pivot = t.session.world().joints()[1];
  EXPECT_EQ(pivot.bodyA, -1);
  EXPECT_NEAR((pivot.X_CaJ.p - Vec<2>(1, 0)).norm(), 0, 1e-6);
  for (int i = 0; i < 60; ++i) t.session.step();
  EXPECT_NEAR((t.place(1) - Vec<2>(1, 0)).norm(), 0, 1e-6);

  // Nor is the world joined instead of a body that a step back removed.
  t.session.step();
  t.add(3, 0);
  click(t.pixel(3, 0));
  ASSERT_TRUE(t.session.back());
  EXPECT_THROW(click(t.pixel(1, 0)), UserError);
  EXPECT_EQ(t.session.world().joints().size(), 2u);
}

Rot<2> turnedBy(const ViewCamera<2>&, Real angle) { return Rot<2>::angle(angle); }
Rot<3> turnedBy(const ViewCamera<3>& camera, Real angle) { return Rot<3>::vector(angle * camera.towards()); }

Ang<2> inItsFrame(const Rot<2>&, const Ang<2>& w) { return w; }
Ang<3> inItsFrame(const Rot<3>& q, const Ang<3>& w) { return q.inverse() * w; }

// Three dynamic bodies with different masses, centres and motions, and one static body.
template <int D>
struct Group {
  Table<D> t;
  std::vector<int> bodies;
  std::vector<Pose<D>> before;
  Vec<D> center = Vec<D>::Zero(), momentum = center;
  Real energy = 0;

  Group() {
    for (int i = 0; i < 4; ++i) {
      BodyDef<D> def;
      if (i == 3) def.type = BodyType::fixed;
      def.X_WB.p = Table<D>::at(Real(i - 1), Real(i * i) / 2 - 2);
      for (int k = 0; k < 2; ++k) {
        ShapeDef<D> shape{.shape = Shape<D>::sphere(Real(0.2 + 0.1 * i))};
        shape.X_BS.p = Table<D>::at(Real(0.3 * k), Real(0.1 * i));
        def.shapes.push_back(shape);
      }
      if (i < 3) def.velocity = Table<D>::at(Real(i), Real(1 - 2 * i)), def.angularVelocity[0] = Real(i + 1);
      t.session.perform(AddBody<D>{def});
      bodies.push_back(t.session.bodies() - 1);
      before.push_back(t.session.world().pose(t.session.handle(i)));
    }
    measure(center, momentum, energy);
  }
  void measure(Vec<D>& at, Vec<D>& p, Real& kinetic) const {
    at.setZero(), p.setZero(), kinetic = 0;
    Real mass = 0;
    const Bodies<D>& b = t.session.world().bodies();
    for (std::size_t i = 0; i < 3; ++i) {
      mass += b.mass[i], at += b.mass[i] * b.pose[i].p, p += b.mass[i] * b.motion[i].v;
      kinetic += b.mass[i] * b.motion[i].v.squaredNorm() / 2;
      const Ang<D> w = inItsFrame(b.pose[i].q, b.motion[i].w);
      kinetic += w.dot(b.invInertiaBody[i].inverse() * w) / 2;
    }
    at /= mass;
  }
  // Whether all bodies are rotated by the angle about the point, as one rigid body.
  bool turnedAbout(const Vec<D>& about, Real angle) const {
    const Rot<D> q = turnedBy(t.camera, angle);
    Real worst = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Pose<D> X = t.session.world().pose(t.session.handle(bodies[i]));
      const Vec<D> probe = Vec<D>::Constant(Real(0.7));
      worst = std::max(worst, (X * probe - (about + q * Vec<D>(before[i] * probe - about))).norm());
    }
    Vec<D> at, p;
    Real kinetic = 0;
    measure(at, p, kinetic);
    return worst < 1e-12 && (p - momentum).norm() < 1e-12 * momentum.norm() &&
           std::abs(kinetic - energy) < 1e-12 * energy;
  }
};

template <int D>
void turnsAsOne() {
  Group<D> one;
  one.t.hand.select(one.bodies);
  one.t.hand.turn(Real(0.5));
  EXPECT_TRUE(one.turnedAbout(one.center, Real(0.5)));
  // Planted bug: each body rotates about its own centre, as in an early sandbox.
  Group<D> each;
  for (const int body : each.bodies) each.t.hand.select({body}), each.t.hand.turn(Real(0.5));
  expectCaught("each turns about its own centre", each.turnedAbout(each.center, Real(0.5)));
  // A single body rotates in place.
  Group<D> alone;
  alone.bodies = {1}, alone.before = {alone.before[1]};
  alone.t.hand.select({1}), alone.t.hand.turn(Real(0.5));
  EXPECT_TRUE(alone.turnedAbout(alone.t.session.world().bodies().pose[1].p, Real(0.5)));
  // Static bodies rotate about their centre.
  Group<D> fixed;
  fixed.bodies = {3}, fixed.before = {fixed.before[3]};
  const Vec<D> middle = fixed.t.session.world().bodies().pose[3].p;
  fixed.t.hand.select({3}), fixed.t.hand.turn(Real(0.5));
  EXPECT_TRUE(fixed.turnedAbout(middle, Real(0.5)));
}
TEST(SandboxHand, RotatesTheSelectionAsOneBody) { turnsAsOne<2>(), turnsAsOne<3>(); }

// While paused, the held body carries and rotates the whole selection.
template <int D>
void carriesAll() {
  Table<D> t;
  const int a = t.add(0, 0), b = t.add(2, 1), other = t.add(-3, -3);
  t.hand.setPaused(true);
  t.hand.select({a, b});
  const Vec<D> from = t.place(a), apart = t.place(b) - from;
  t.hand.press(t.camera.toPixel(from), false);
  const Vec<D> held = pick(t.session.world(), t.camera, t.camera.toPixel(from)).point;
  const Vec<D> to = held + Table<D>::at(1, 2);
  t.hand.move(t.camera.toPixel(to)), t.hand.move(t.camera.toPixel(to));
  EXPECT_GT((t.place(a) - from).norm(), 1);
  EXPECT_NEAR((t.place(b) - t.place(a) - apart).norm(), 0, 1e-12);
  EXPECT_EQ(t.session.actions().size(), 6u);  // gravity, three bodies, and a place for two
  t.hand.turn(Real(0.5));
  const Vec<D> turned = turnedBy(t.camera, Real(0.5)) * apart;
  EXPECT_NEAR((t.place(b) - t.place(a) - turned).norm(), 0, 1e-12);
  t.hand.move(t.camera.toPixel(held)), t.hand.release(t.camera.toPixel(held));
  EXPECT_NEAR((t.place(b) - t.place(a) - turned).norm(), 0, 1e-12);
  EXPECT_EQ(t.session.actions().size(), 6u);
  EXPECT_EQ(t.place(other), Table<D>::at(-3, -3));
}
TEST(SandboxHand, CarriesTheSelection) { carriesAll<2>(), carriesAll<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::hand_test
