// SPDX-License-Identifier: Zlib
// Errors of a world: a one-line message says what was found and what is valid, and nothing changes.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace refusal_test { namespace {

constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN(), kInf = std::numeric_limits<Real>::infinity();

Rot<2> scaled(const Rot<2>& q, Real k) { return {k * q.c, k * q.s}; }
Rot<3> scaled(const Rot<3>& q, Real k) { return {k * q.w, k * q.x, k * q.y, k * q.z}; }

template <int D>
struct Refusal {
  const char* says;  // part of the message
  std::function<void(World<D>&)> act;
};

// A ball with one error.
template <int D>
Refusal<D> ball(const char* says, const std::function<void(BodyDef<D>&)>& spoil) {
  return {says, [spoil](World<D>& w) {
            BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(9, 9));
            spoil(def);
            w.add(def);
          }};
}

template <int D>
std::vector<Refusal<D>> refusals() {
  using W = World<D>&;
  std::vector<Refusal<D>> list;
  for (const Real bad : {kNan, kInf, Real(-1)}) {
    if (!(bad < 0)) {
      const Vec<D> v = bad * Vec<D>::Unit(D - 1);
      Ang<D> w = Ang<D>::Zero();
      w[0] = bad;
      list.push_back(ball<D>("position", [=](BodyDef<D>& b) { b.X_WB.p = v; }));
      list.push_back(ball<D>("velocity", [=](BodyDef<D>& b) { b.velocity = v; }));
      list.push_back(ball<D>("velocity", [=](BodyDef<D>& b) { b.angularVelocity = w; }));
      list.push_back(ball<D>("shape: the position", [=](BodyDef<D>& b) { b.shapes[0].X_BS.p = v; }));
      const Rot<D> q = scaled(Rot<D>{}, bad);
      list.push_back(ball<D>("rotation", [=](BodyDef<D>& b) { b.X_WB.q = q; }));
      list.push_back({"rotation", [=](W x) { x.setPose(x.handle(1), {Vec<D>::Zero(), q}); }});
      list.push_back({"position", [=](W x) { x.setPose(x.handle(1), {v, {}}); }});
      list.push_back({"velocity", [=](W x) { x.setMotion(x.handle(1), {v, {}}); }});
      list.push_back({"velocity", [=](W x) { x.setMotion(x.handle(1), {Vec<D>::Zero(), w}); }});
      list.push_back({"force", [=](W x) { x.applyForce(x.handle(1), v, Vec<D>::Zero()); }});
      list.push_back({"force", [=](W x) { x.applyForce(x.handle(1), Vec<D>::Zero(), v); }});
      list.push_back({"torque", [=](W x) { x.applyTorque(x.handle(1), w); }});
      list.push_back({"position", [=](W x) { x.add(pivot<D>(x.handle(0), x.handle(1), v)); }});
      list.push_back({"breaks", [=](W x) {
                        x.add(JointDef<D>{.bodyA = x.handle(0), .bodyB = x.handle(1), .breakForce = Real(-1)});
                      }});
    }
    list.push_back(ball<D>("density", [=](BodyDef<D>& b) { b.shapes[0].density = bad; }));
    list.push_back(ball<D>("friction", [=](BodyDef<D>& b) { b.shapes[0].friction = bad; }));
    list.push_back(ball<D>("restitution", [=](BodyDef<D>& b) { b.shapes[0].restitution = bad; }));
    list.push_back({"radius", [=](W) { Shape<D>::sphere(bad); }});
    list.push_back({"capsule", [=](W) { Shape<D>::capsule(bad, 1); }});
    list.push_back({"box", [=](W) { Shape<D>::box(bad * Vec<D>::Ones()); }});
    list.push_back({"dt", [=](W x) { x.step(bad); }});
    list.push_back({"margin", [=](W) {
                      WorldSettings<D> s;
                      s.margin = bad;
                      World<D> w({}, s);
                    }});
    list.push_back({"restitution threshold", [=](W) {
                      WorldSettings<D> s;
                      s.restitutionThreshold = bad;
                      World<D> w({}, s);
                    }});
  }
  const Real most = std::numeric_limits<Real>::max();
  list.push_back(ball<D>("without mass", [](BodyDef<D>& b) { b.shapes[0].density = 0; }));
  list.push_back(ball<D>("without mass", [](BodyDef<D>& b) { b.shapes.clear(); }));
  list.push_back(ball<D>("too small to invert",
                         [](BodyDef<D>& b) { b.shapes[0].density = 8 * std::numeric_limits<Real>::denorm_min(); }));
  if constexpr (D == 3) {  // a needle oblique to the axes: rounding hides the inertia about its own axis
    for (const double angle : {0.3, 0.7853981633974483, 1.2}) {
      list.push_back(ball<D>("too small to invert; valid: larger", [=](BodyDef<D>& b) {
        b.shapes[0].shape = Shape<D>::box(Vec<D>(1, Real(1e-12), Real(1e-12)));
        b.shapes[0].density = Real(1e24), b.shapes[0].X_BS.q = Rot<D>::vector(Ang<D>(0, 0, static_cast<Real>(angle)));
      }));
    }
  }
  list.push_back(ball<D>("too large", [=](BodyDef<D>& b) { b.shapes[0].density = most; }));
  list.push_back({"too large", [=](W x) { x.add(body<D>(Shape<D>::box(most / 4 * Vec<D>::Ones()), at<D>(0, 0))); }});
  list.push_back(ball<D>("rotation", [](BodyDef<D>& b) { b.X_WB.q = scaled(b.X_WB.q, 2); }));
  list.push_back({"rotation", [](W x) { x.setPose(x.handle(1), {Vec<D>::Zero(), scaled(Rot<D>{}, 2)}); }});
  list.push_back({"fixed", [](W x) { x.setMotion(x.handle(0), {}); }});
  list.push_back({"two bodies", [](W x) { x.add(pivot<D>(x.handle(1), x.handle(1), Vec<D>::Zero())); }});
  const auto joint = [&](const char* says, const std::string& kind) {
    list.push_back({says, [=](W x) { x.add(JointDef<D>{.kind = kind, .bodyA = x.handle(1), .bodyB = x.handle(2)}); }});
  };
  joint("pivot", "glue");
  joint("motor_speed", "hinge{speed=1}");
  joint("lower above upper", "hinge{lower=1,upper=-1}");
  joint("a number from", "hinge{motor_torque=-1}");
  joint("mode is not spring", "distance{mode=rope,damping=1}");
  joint("mode is not spring", "distance{stiffness=5}");
  joint("no motor", "hinge{motor_speed=1}");
  joint("no spring", "hinge{rest=1}");
  for (const std::string kind : {"prismatic", "wheel"}) {
    joint("lower above upper", kind + "{lower=1,upper=-1}");
    joint("no motor", kind + "{motor_speed=1}");
    joint("no spring", kind + "{rest=1,stiffness=0}");
  }
  joint("swing 0", "cone_twist{swing=0}");
  joint("ratio 0", "gear{ratio=0}");
  joint("mode=friction", "motor{mode=friction,x=1}");
  joint("mode=friction", "motor{mode=friction,angular_damping=1}");
  joint("length 0", "distance");
  joint("negative length", "distance{length=-0.5}");
  joint("stiffness", "distance{mode=spring,stiffness=inf,damping=1}");
  list.push_back({"cannot move", [](W x) { x.add(JointDef<D>{.bodyB = x.handle(0)}); }});
  list.push_back(
      {"breaks", [](W x) { x.add(JointDef<D>{.bodyA = x.handle(1), .bodyB = x.handle(2), .breakTorque = 0}); }});
  list.push_back({"no body", [](W x) { x.remove(BodyHandle{77, 0}); }});
  list.push_back({"no joint", [](W x) { x.remove(JointHandle{77, 0}); }});
  const auto force = [&](const char* says, const std::string& kind, int a, int b, std::optional<Vec<D>> anchor = {}) {
    list.push_back({says, [=](W x) {
                      const auto of = [&](int slot) { return slot < 0 ? BodyHandle{} : x.handle(slot); };
                      x.add(ForceDef<D>{.kind = kind, .bodyA = of(a), .bodyB = of(b), .anchorB = anchor});
                    }});
  };
  force("rolling_resistance", "rolling", -1, 1);
  force("damping", "spring{dampin=1}", 1, 2);
  force("a number from 0", "drag{linear=-1}", -1, 1);
  force("itself", "spring", 1, 1);
  force("cannot move", "spring", -1, 0);
  force("cannot move", "drag", -1, 0);
  force("needs a body", "spring", 1, -1);
  force("takes no body a", "drag", 1, 2);
  force("has a body a but no body b", "torque", 1, -1);
  force(D == 2 ? "negative limit" : "a zero axis", D == 2 ? "torque{mode=speed,torque=-1}" : "torque{z=0}", -1, 1);
  force("mode=constant ignores it", "torque{speed=3}", -1, 1);
  force("takes no anchors", "wind", -1, 1, Vec<D>(Vec<D>::Zero()));
  force("centres of mass", "attraction", 1, -1, Vec<D>(Vec<D>::Zero()));
  force("not finite", "spring", 1, 2, Vec<D>(Vec<D>::Constant(kNan)));
  list.push_back({"no body", [](W x) { x.add(ForceDef<D>{.bodyB = {77, 0}}); }});
  list.push_back({"no force", [](W x) { x.remove(ForceHandle{77, 0}); }});
  list.push_back({"null", [](W x) { x.add(std::shared_ptr<const ForceGenerator<D>>()); }});
  list.push_back({"null", [](W x) { x.addListener(nullptr); }});
  list.push_back({"naive", [](W) { World<D> w(Pipeline::parse("broadphase=none_such")); }});
  list.push_back(
      {"iterations", [](W) { World<D> w(Pipeline::parse("solver=split_solver{velocity=catto{iterations=-1}}")); }});
  list.push_back({"gravity", [](W) {
                    WorldSettings<D> s;
                    s.gravity[0] = kNan;
                    World<D> w({}, s);
                  }});
  return list;
}

template <int D>
void refuses() {
  World<D> world;
  addHeap(world, 3, 1);
  world.step(Real(1) / 60);
  const auto hash = world.hash();
  const int bodies = world.bodyCount();
  int n = 0;
  for (const Refusal<D>& r : refusals<D>()) {
    SCOPED_TRACE(std::to_string(n++) + ": " + r.says);
    try {
      r.act(world);
      ADD_FAILURE() << "was taken";
    } catch (const UserError& e) {
      const std::string line = e.what();
      EXPECT_NE(line.find(r.says), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
    EXPECT_EQ(world.hash(), hash);
    EXPECT_EQ(world.bodyCount(), bodies);
  }
}
TEST(Refusal, NothingChanges2) { refuses<2>(); }
TEST(Refusal, NothingChanges3) { refuses<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::refusal_test
