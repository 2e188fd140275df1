// SPDX-License-Identifier: Zlib
// Bodies of several convex parts: several shapes on a body behave like one compound shape, and hollows stay hollow.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "framework/shape/curved_core.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace compound_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
Pose<D> turned(const Vec<D>& p, double radians) {
  if constexpr (D == 2) {
    return {p, Rot<2>::angle(radians)};
  } else {
    return {p, Rot<3>::vector({0, 0, static_cast<Real>(radians)})};
  }
}
template <int D>
ShapePart<D> box(double x, double y, double halfX, double halfY, double radians = 0) {
  Vec<D> half = Vec<D>::Constant(Real(0.3));
  half[0] = static_cast<Real>(halfX), half[1] = static_cast<Real>(halfY);
  return {Shape<D>::box(half), turned<D>(at<D>(x, y), radians)};
}
template <int D>
std::vector<ShapePart<D>> letterL() {
  return {box<D>(0, 0.4, 0.2, 0.4), box<D>(0.4, -0.2, 0.6, 0.2)};
}
template <int D>
std::vector<ShapePart<D>> letterU() {
  return {box<D>(0, -0.4, 0.8, 0.2), box<D>(-0.6, 0.3, 0.2, 0.5), box<D>(0.6, 0.3, 0.2, 0.5)};
}
template <int D>
std::vector<ShapePart<D>> gear(int teeth) {
  std::vector<ShapePart<D>> parts = {{Shape<D>::sphere(Real(0.4)), {}}};
  for (int i = 0; i < teeth; ++i) {
    const double turn = 2 * 3.14159265358979323846 * i / teeth;
    const Pose<D> X = turned<D>(Vec<D>::Zero(), turn);
    parts.push_back({box<D>(0, 0, 0.1, 0.06).shape, {X * at<D>(0.45, 0), X.q}});
  }
  return parts;
}

template <int D>
BodyDef<D> bodyOf(const std::vector<ShapePart<D>>& parts, bool compound, const Pose<D>& X) {
  BodyDef<D> def;
  def.X_WB = X;
  if (compound) {
    def.shapes.push_back({.shape = Shape<D>::compound(parts)});
  } else {
    for (const ShapePart<D>& p : parts) def.shapes.push_back({.shape = p.shape, .X_BS = p.X_SP});
  }
  return def;
}

// Letters and gears fall onto a floor and each other.
template <int D>
void addParts(World<D>& world, bool compound, int n, std::uint64_t seed, bool plane = false) {
  if (plane) {
    world.add(body<D>(Shape<D>::plane(), Vec<D>::Zero(), BodyType::fixed));
  } else {
    addGround(world);
  }
  PlainDraw draw(seed);
  for (int i = 0; i < n; ++i) {
    const int which = draw.below(3);
    const auto parts = which == 0 ? letterL<D>() : which == 1 ? letterU<D>() : gear<D>(6);
    const Real x = draw.real(-0.5, 0.5), turn = draw.real(0, 6);
    BodyDef<D> def = bodyOf<D>(parts, compound, turned<D>(at<D>(x, 1 + 1.1 * i), turn));
    def.angularVelocity = Ang<D>::Constant(draw.real(-2, 2));
    world.add(def);
  }
}

// The first step in which two worlds differ, or -1.
template <int D>
int partsFrom(World<D>& a, World<D>& b, int steps) {
  for (int i = 0; i < steps; ++i) {
    a.step(kDt), b.step(kDt);
    if (a.hash() != b.hash()) return i;
  }
  return -1;
}

// Identical to the last bit with two bodies and a floor. With more bodies the manifolds have another order: those of a
// compound with another shape are adjacent.
template <int D>
void sameLife() {
  for (const char* text :
       {"", "contacts=query_clip", "contacts=deepest_point cache=none", "solver=soft_step broadphase=uniform_grid"}) {
    const Pipeline pipeline = Pipeline::parse(text);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      World<D> one(pipeline), other(pipeline);
      addParts(one, true, 2, seed, seed % 2 == 0), addParts(other, false, 2, seed, seed % 2 == 0);
      EXPECT_EQ(partsFrom(one, other, 180), -1) << D << "D " << text << " seed " << seed;
      EXPECT_GE(one.manifolds().size(), 2u);
    }
  }
  // Planted bugs: a missing part, and a part moved by a millionth.
  for (const bool leftOut : {true, false}) {
    World<D> one, other;
    auto parts = letterU<D>();
    addGround(one), addGround(other);
    one.add(bodyOf<D>(parts, true, turned<D>(at<D>(0, 1), 2)));
    if (leftOut) {
      parts.pop_back();
    } else {
      parts.back().X_SP.p[0] *= 1 + Real(1e-6);
    }
    other.add(bodyOf<D>(parts, false, turned<D>(at<D>(0, 1), 2)));
    expectCaught(leftOut ? "Compound a part is left out" : "Compound a part has moved",
                 partsFrom(one, other, 180) == -1);
  }
}
TEST(Compound, EqualsItsPartsOnOneBody) { sameLife<2>(), sameLife<3>(); }

// Queries to static worlds: one with compounds, one with each part as a body. Without `all`, the second world lacks the
// last part of each compound.
struct Answered {
  bool alike = true;
  int inside = 0, overlapping = 0, hits = 0, hollow = 0;
};
template <int D>
Answered ask(bool all) {
  World<D> whole, apart;
  PlainDraw draw(3);
  std::vector<std::int32_t> owner;  // compound of each body of `apart`
  for (std::int32_t i = 0; i < 5; ++i) {
    const Real x = draw.real(-2, 2), y = draw.real(-2, 2), turn = draw.real(0, 6);
    const Pose<D> X = turned<D>(at<D>(x, y), turn);
    const auto parts = i % 2 ? letterU<D>() : gear<D>(5);
    BodyDef<D> def = bodyOf<D>(parts, true, X);
    def.type = BodyType::fixed;
    whole.add(def);
    for (std::size_t p = 0; p < parts.size() - (all ? 0 : 1); ++p) {
      def = bodyOf<D>({parts[p]}, false, X);
      def.type = BodyType::fixed;
      apart.add(def);
      owner.push_back(i);
    }
  }
  const auto owners = [&](const std::vector<BodyHandle>& found, bool parts) {
    std::set<std::int32_t> out;
    for (const BodyHandle& h : found) out.insert(parts ? owner[static_cast<std::size_t>(h.slot)] : h.slot);
    return out;
  };
  // The first hit of each body, by body slot.
  const auto firstHits = [&](const std::vector<BodyRayHit<D>>& hits, bool parts) {
    std::map<std::int32_t, Real> out;
    for (const auto& h : hits) out.emplace(parts ? owner[static_cast<std::size_t>(h.body.slot)] : h.body.slot, h.t);
    return out;
  };
  Answered answered;
  for (int i = 0; i < 500; ++i) {
    Vec<D> p, q;
    for (Vec<D>* v : {&p, &q}) {
      for (int k = 0; k < D; ++k) (*v)[k] = draw.real(-1, 1) * (k < 2 ? Real(3) : Real(0.3));
    }
    const auto inside = owners(whole.at(p), false);
    const Aabb<D> box{p, p + (q - p).cwiseAbs() / 8};
    const auto overlapping = owners(whole.overlap(box), false);
    const auto hits = firstHits(whole.rayAll(p, q - p, 1), false);
    answered.alike = answered.alike && inside == owners(apart.at(p), true) &&
                     overlapping == owners(apart.overlap(box), true) &&
                     hits == firstHits(apart.rayAll(p, q - p, 1), true);
    answered.inside += !inside.empty(), answered.overlapping += !overlapping.empty(), answered.hits += !hits.empty();
    for (ProxyId s = 0; s < whole.proxies().size(); ++s) {
      answered.hollow += !whole.proxies().isFree(s) && whole.proxies().box(s).contains(p) && inside.empty();
    }
  }
  return answered;
}
template <int D>
void sameAnswers() {
  const Answered answered = ask<D>(true);
  EXPECT_TRUE(answered.alike);
  EXPECT_GT(answered.inside, 20);
  EXPECT_GT(answered.overlapping, 50);
  EXPECT_GT(answered.hits, 100);
  EXPECT_GT(answered.hollow, 20);  // points in a part's bounding box but in no part
  expectCaught("Compound answers without its last part", ask<D>(false).alike);
}
TEST(Compound, QueriesEqualThoseOfItsParts) { sameAnswers<2>(), sameAnswers<3>(); }

// A ball dropped into a U comes to rest at the bottom; on the convex hull it would rest on top.
template <int D>
void hollowStaysHollow() {
  const auto dropped = [](const std::vector<ShapePart<D>>& parts) {
    World<D> world;
    BodyDef<D> def = bodyOf<D>(parts, true, Pose<D>{});
    def.type = BodyType::fixed;
    world.add(def);
    const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.35)), at<D>(0, 1.5)));
    for (int i = 0; i < 240; ++i) world.step(kDt);
    return std::abs(world.pose(ball).p[1] - Real(0.15)) <= kLinearSlop;  // the bottom is at -0.2
  };
  EXPECT_TRUE(dropped(letterU<D>()));
  expectCaught("Compound is filled", dropped({box<D>(0, 0.1, 0.8, 0.7)}));
}
TEST(Compound, HollowsStayHollow) { hollowStaysHollow<2>(), hollowStaysHollow<3>(); }

// Ten seconds on a floor and on a plane: nothing creeps, tilts or sinks.
template <int D>
void restsTenSeconds() {
  for (const bool plane : {false, true}) {
    World<D> world;
    if (plane) {
      BodyDef<D> floor = body<D>(Shape<D>::plane(), Vec<D>::Zero(), BodyType::fixed);
      world.add(floor);
    } else {
      addGround(world);
    }
    const BodyHandle bodies[] = {world.add(bodyOf<D>(letterL<D>(), true, turned<D>(at<D>(-3, 0.4), 0))),
                                 world.add(bodyOf<D>(letterU<D>(), true, turned<D>(at<D>(0, 0.6), 0))),
                                 world.add(bodyOf<D>(gear<D>(6), true, turned<D>(at<D>(3, 0.51), 0)))};  // on two teeth
    std::vector<Pose<D>> before;
    for (int i = 0; i < 60; ++i) world.step(kDt);
    for (const BodyHandle& h : bodies) before.push_back(world.pose(h));
    for (int i = 0; i < 600; ++i) world.step(kDt);
    for (std::size_t i = 0; i < 3; ++i) {
      const Pose<D> now = world.pose(bodies[i]);
      EXPECT_LE((now.p - before[i].p).norm(), Real(1e-3)) << i << plane;
      EXPECT_GE((now.q * at<D>(1, 0)).dot(before[i].q * at<D>(1, 0)), 1 - Real(1e-6)) << i << plane;
    }
  }
}
TEST(Compound, RestsTenSeconds) { restsTenSeconds<2>(), restsTenSeconds<3>(); }

// A gear with prescribed rotation drives a pinned gear: opposite direction, same speed, up to the backlash.
TEST(Compound, GearsMesh) {
  const auto follows = [](bool meshed) {
    std::vector<ShapePart<2>> parts = {{Shape<2>::sphere(Real(0.8)), {}}};
    const std::vector<Vec<2>> tooth = {
        {Real(0.75), Real(-0.16)}, {Real(1.1), Real(-0.06)}, {Real(1.1), Real(0.06)}, {Real(0.75), Real(0.16)}};
    const double step = 3.14159265358979323846 / 6;
    for (int i = 0; i < 12; ++i) parts.push_back({Shape<2>::polytope(tooth), turned<2>(Vec<2>::Zero(), step * i)});
    if (!meshed) parts.resize(7);  // half of the teeth are missing
    World<2> world;
    BodyDef<2> def = bodyOf<2>(parts, true, Pose<2>{});
    def.type = BodyType::kinematic;
    const BodyHandle driver = world.add(def);
    def = bodyOf<2>(parts, true, turned<2>(at<2>(1.94, 0), step / 2));
    def.pinned = true;
    const BodyHandle follower = world.add(def);
    Real angle = 0, driven = 0, most = 0;
    for (int i = 0; i < 1200; ++i) {
      const Real speed = i / 300 % 2 == 0 ? 1 : -1;  // both directions: a gear that coasts fails
      world.setMotion(driver, {Vec<2>::Zero(), Ang<2>(speed)});
      const Rot<2> before = world.pose(follower).q;
      world.step(kDt);
      angle += (before.inverse() * world.pose(follower).q).radians();
      driven += speed * kDt;
      most = std::max(most, std::abs(angle + driven));
    }
    // Backlash: half of the gap that two teeth of width 0.194 leave in the pitch 2 pi 0.97 / 12, plus the slop.
    const Real play = Real(0.5) * (Real(0.508) - 2 * Real(0.194)) + kLinearSlop;
    return most <= play / Real(0.97);
  };
  EXPECT_TRUE(follows(true));
  expectCaught("Compound gears with half of their teeth", follows(false));
}

// A run that is saved, loaded and continued equals a run that is only continued.
template <int D>
void saves() {
  World<D> one, other;
  addParts(one, true, 6, 11);
  for (int i = 0; i < 90; ++i) one.step(kDt);
  std::stringstream file, again;
  one.save(file);
  other.load(file);
  other.save(again);
  EXPECT_EQ(file.str(), again.str());
  EXPECT_EQ(partsFrom(one, other, 60), -1);
}
TEST(Compound, SavedAndLoaded) { saves<2>(), saves<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::compound_test
