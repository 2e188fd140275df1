// SPDX-License-Identifier: Zlib
// Galilean invariance at contacts: on a level ground without friction or end, a body falls, tips and is pushed out of
// the ground alike at every sideways speed. With every position resolver, and every solver without one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "framework/math/worse.h"
#include "tests/draw.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/planted_stages.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace sliding_test {

constexpr int kSteps = 40;
constexpr std::uint64_t kSeed = 1;
constexpr Real kDt = Real(0.008), kSpeed = 46, kHalf = Real(0.05);
// A hundredth of the half size. Where rounding decides the sign of a separation, heights differ by up to 0.15 mm.
constexpr Real kTolerance = Real(0.0005);

enum class Ground { plane, box, surface, slab, heavySlab };
constexpr Ground kGrounds[] = {Ground::plane, Ground::box, Ground::surface, Ground::slab, Ground::heavySlab};

template <int D>
BodyDef<D> groundOf(Ground kind) {
  constexpr Real kLong = 64;
  switch (kind) {
    case Ground::plane:
      return body<D>(Shape<D>::plane(), Vec<D>::Zero(), BodyType::fixed);
    case Ground::box:
    case Ground::slab:
    case Ground::heavySlab: {
      Vec<D> half = Vec<D>::Constant(1);
      half[0] = kLong;
      BodyDef<D> def = body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed);
      if (kind == Ground::box) return def;
      def.type = BodyType::dynamic, def.rotatable = false, def.gravityScale = 0;
      def.shapes[0].density = Real(kind == Ground::slab ? 1e-4 : 1);
      return def;
    }
    case Ground::surface:
      break;
  }
  Shape<D> surface = Shape<D>::sphere(1);
  if constexpr (D == 2) {
    surface = Shape<2>::chain(std::vector<Vec<2>>{{kLong, 0}, {-kLong, 0}}, false);
  } else {
    const std::vector<Vec<3>> corners = {{kLong, 0, -9}, {kLong, 0, 30}, {-kLong, 0, -9}, {-kLong, 0, 30}};
    surface = Shape<3>::mesh(corners, std::vector<std::array<int, 3>>{{0, 2, 3}, {0, 3, 1}});
  }
  return body<D>(surface, Vec<D>::Zero(), BodyType::fixed);
}

// A box, ball, capsule or polytope at any angle, that overlaps the ground or falls on it.
template <int D>
BodyDef<D> slider(int kind, Draw& draw) {
  std::vector<Vec<D>> corners(D + 1, Vec<D>::Constant(-kHalf));
  for (int i = 0; i < D; ++i) corners[static_cast<std::size_t>(i)][i] = kHalf;
  const Shape<D> shapes[] = {Shape<D>::box(Vec<D>::Constant(kHalf)), Shape<D>::sphere(kHalf),
                             Shape<D>::capsule(kHalf, kHalf / 2), Shape<D>::polytope(corners)};
  BodyDef<D> def = body<D>(shapes[kind], at<D>(0, draw.real(0.2, 1.5) * double(kHalf)));
  def.X_WB.q = drawRotation<D>(draw);
  return def;
}

// Heights above the ground after each step, without friction.
template <int D>
std::vector<Real> heights(const std::string& solver, BodyDef<D> ground, BodyDef<D> def, Real speed) {
  World<D> world(Pipeline::parse("solver=" + solver));
  ground.shapes[0].friction = def.shapes[0].friction = 0;
  def.velocity[0] = speed;
  const BodyHandle floor = world.add(ground), body = world.add(def);
  std::vector<Real> out;
  for (int i = 0; i < kSteps; ++i) {
    world.step(kDt);
    out.push_back(world.pose(body).p[1] - world.pose(floor).p[1]);
  }
  return out;
}

// The largest difference of heights that the speed makes, m.
template <int D>
Real apart(const std::string& solver, Ground ground, int kind, std::uint64_t seed) {
  PlainDraw draw(seed);
  const BodyDef<D> def = slider<D>(kind, draw);
  const auto slow = heights<D>(solver, groundOf<D>(ground), def, 0);
  const auto fast = heights<D>(solver, groundOf<D>(ground), def, -kSpeed);
  Real worst = 0;
  for (std::size_t i = 0; i < slow.size(); ++i) worst = worse(worst, std::abs(slow[i] - fast[i]));
  return worst;
}
template <int D>
Real worst(const std::string& solver, std::uint64_t seed) {
  Real out = 0;
  for (const Ground ground : kGrounds) {
    for (int kind = 0; kind < 4; ++kind) out = worse(out, apart<D>(solver, ground, kind, seed));
  }
  return out;
}

template <int D>
void everySolver(std::uint64_t seed) {
  for (const std::string& solver : test::everySolver<D>(true)) {
    const bool plain = solver.find('{') == solver.npos, position = solver.find("{position=") != solver.npos;
    if (!plain && !position) continue;
    EXPECT_LT(worst<D>(solver, seed), kTolerance) << solver << ", " << D << 'D';
  }
  EXPECT_GT(worst<D>("planted_solver{bug=turns}", seed), kTolerance);
}
TEST(Sliding, HeightIgnoresSpeed2) { everySolver<2>(kSeed); }
TEST(Sliding, HeightIgnoresSpeed3) { everySolver<3>(kSeed); }

}}}}  // namespace lpc::LPC_PRECISION::test::sliding_test
