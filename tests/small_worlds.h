// SPDX-License-Identifier: Zlib
// Worlds that several tests share: small and fast, with everything that a step can meet.
#pragma once

#include <charconv>
#include <initializer_list>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "framework/math/random.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D>
Vec<D> at(double x, double y, double z = 0) {
  Vec<D> p = Vec<D>::Zero();
  p[0] = static_cast<Real>(x), p[1] = static_cast<Real>(y);
  if constexpr (D == 3) p[2] = static_cast<Real>(z);
  return p;
}

template <int D>
BodyDef<D> body(const Shape<D>& shape, const Vec<D>& position, BodyType type = BodyType::dynamic) {
  BodyDef<D> def;
  def.type = type;
  def.X_WB.p = position;
  def.shapes.push_back({.shape = shape});
  return def;
}

template <int D>
JointDef<D> pivot(BodyHandle bodyA, BodyHandle bodyB, const Vec<D>& anchor) {
  return {.kind = "pivot", .bodyA = bodyA, .bodyB = bodyB, .X_WJ = {anchor, {}}};
}

/// A force kind with these parameters, each as the shortest text that reads back as the same number.
inline std::string forceKind(std::string name, std::initializer_list<std::pair<const char*, double>> numbers) {
  Spec spec{std::move(name), {}};
  for (const auto& [key, value] : numbers) {
    char text[32];
    spec.set(key, {{text, std::to_chars(text, text + sizeof text, static_cast<Real>(value)).ptr}, {}});
  }
  return spec.text();
}
inline std::string springKind(double stiffness, double restLength = 0, double damping = 0) {
  return forceKind("spring", {{"stiffness", stiffness}, {"rest_length", restLength}, {"damping", damping}});
}
/// As in the 2009 report: both velocities use the same two coefficients.
inline std::string dragKind(double linear, double quadratic) {
  return forceKind(
      "drag",
      {{"linear", linear}, {"quadratic", quadratic}, {"angular_linear", linear}, {"angular_quadratic", quadratic}});
}

template <int D>
BodyHandle addGround(World<D>& world, const Vec<D>& place = Vec<D>::Zero()) {
  Vec<D> half = Vec<D>::Constant(20);
  half[1] = 1;
  return world.add(body<D>(Shape<D>::box(half), place - Vec<D>::Unit(1), BodyType::fixed));
}

/// A ground with a row of n boxes on it; the boxes touch only the ground.
template <int D>
std::vector<BodyHandle> addRow(World<D>& world, int n) {
  Vec<D> half = Vec<D>::Constant(1);
  half[0] = static_cast<Real>(2 * n);
  world.add(body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed));
  std::vector<BodyHandle> row;
  for (int i = 0; i < n; ++i) {
    row.push_back(world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(2 * i - n, 0.5))));
  }
  return row;
}

template <int D>
std::string saved(const World<D>& world) {
  std::ostringstream out;
  world.save(out);
  return out.str();
}

/// Boxes, balls and capsules fall on a floor and into each other; a pendulum swings above them. n + 3 bodies.
template <int D>
void addHeap(World<D>& world, int n, std::uint64_t seed, const Vec<D>& place = Vec<D>::Zero()) {
  addGround(world, place);
  Random random(seed);
  for (int i = 0; i < n; ++i) {
    const double z = random.uniform(-1, 1), x = random.uniform(-2, 2);  // separate: argument order is unspecified
    const Vec<D> p = place + at<D>(x, 1 + 0.7 * i, z);
    const Shape<D> shapes[] = {Shape<D>::box(Vec<D>::Constant(Real(0.4))), Shape<D>::sphere(Real(0.4)),
                               Shape<D>::capsule(Real(0.3), Real(0.25))};
    BodyDef<D> def = body<D>(shapes[random.below(3)], p);
    def.shapes[0].restitution = Real(0.2);
    def.angularVelocity = Ang<D>::Constant(static_cast<Real>(random.uniform(-2, 2)));
    world.add(def);
  }
  const Vec<D> hook = place + at<D>(0, 12);
  const BodyHandle post = world.add(body<D>(Shape<D>::sphere(Real(0.1)), hook, BodyType::fixed));
  const BodyHandle bob = world.add(body<D>(Shape<D>::sphere(Real(0.3)), hook + at<D>(2, 0)));
  world.add(pivot<D>(post, bob, hook));
}

/// One pair of bodies for each kind and state of joint memory, in a row. The joint of the last pair breaks.
template <int D>
void addJointed(World<D>& world, const Vec<D>& place) {
  const char* const kinds[] = {"pivot",
                               "weld",
                               "hinge{upper=0.3}",
                               "hinge{motor_speed=9,motor_torque=8}",
                               "hinge{stiffness=5,damping=0.1}",
                               "distance",
                               "distance{mode=rope,length=0.4}",
                               "distance{mode=spring}",
                               "pivot"};
  Real x = 0;
  for (const char* kind : kinds) {
    const Vec<D> top = place + x * Vec<D>::Unit(0), bottom = top - Vec<D>::Unit(1) / 2;
    const BodyHandle a = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.2))), top));
    const BodyHandle b = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.1))), bottom));
    world.add(pivot<D>(BodyHandle{}, a, top + Vec<D>::Unit(0) / 10));
    JointDef<D> def{.kind = kind, .bodyA = a, .bodyB = b, .X_WJ = {top, {}}, .collide = true};
    if (std::string(kind).starts_with("distance")) def.X_WJb = Pose<D>{bottom, {}};
    if (x == 8) def.breakForce = Real(0.05);
    world.add(def);
    x += 1;
  }
}

}}}  // namespace lpc::LPC_PRECISION::test
