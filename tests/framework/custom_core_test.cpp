// SPDX-License-Identifier: Zlib
// The one kind that a user's support function defines: registered, it works like any shape; an unsound one is rejected.
#include <gtest/gtest.h>

#include "framework/shape/curved_core.h"
#include "framework/world/world.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace custom_core_test { namespace {

enum class Bug { none, notFinite, dented, smallBox, largeBox, otherHalf, noMass, noDirection, manyCorners, farCorner };
Bug g_bug = Bug::none;

// A ball of radius sizes[0], with a bug.
template <int D>
class Ball final : public CurvedBase<D, Ball<D>> {
 public:
  explicit Ball(std::span<const Real> sizes) : m_radius{sizes[0]} {}

  std::span<const Real> sizes() const override { return m_radius; }
  Vec<D> half() const override {
    const Real factor = g_bug == Bug::smallBox ? Real(0.9) : g_bug == Bug::largeBox ? Real(1.1) : Real(1);
    return Vec<D>::Constant(factor * m_radius[0]);
  }

  template <class N>
  std::array<N, D> extreme(const std::array<N, D>& d) const {
    N square = 0;
    for (const N x : d) square += x * x;
    std::array<N, D> p{};
    if (!(square > 0)) {
      if (g_bug == Bug::noDirection) p[0] = std::numeric_limits<N>::quiet_NaN();
      return p;
    }
    // Dented: where all components of d are alike, the point lies closer than convexity allows.
    N least = std::abs(d[0]), length = std::sqrt(square), factor = 1;
    for (const N x : d) least = std::min(least, N(std::abs(x)));
    if (g_bug == Bug::dented && least > N(0.55) * length) factor = N(0.5);
    if (g_bug == Bug::notFinite && d[0] < N(-0.9) * length) factor = std::numeric_limits<N>::quiet_NaN();
    if (g_bug == Bug::otherHalf && sizeof(N) > sizeof(Real) && d[0] < 0) factor = N(0.999);
    for (std::size_t k = 0; k < D; ++k) p[k] = factor * m_radius[0] * (d[k] / length);
    return p;
  }

  void supportFace(const Vec<D>& d, std::vector<Vec<D>>& corners) const override {
    corners.assign(g_bug == Bug::manyCorners ? 65 : 1, this->support(d));
    if (g_bug == Bug::farCorner) corners[0] *= Real(1.5);
  }
  MassProperties<D> massProperties(Real density) const override {
    MassProperties<D> m = lpc::massProperties(Shape<D>::sphere(m_radius[0]).view(), density);
    if (g_bug == Bug::noMass) m.mass = 0;
    return m;
  }

 private:
  std::array<Real, 1> m_radius;
};

// Registered only while the test runs: other tests in this program iterate over all registered kinds.
class Registered {
 public:
  Registered() { const CurvedRegistrar<Ball, 2, 3> registrar{ShapeKind::custom, {{"radius"}, {"radius"}}}; }
  ~Registered() {
    curvedKinds<2>().erase(ShapeKind::custom), curvedKinds<3>().erase(ShapeKind::custom);
    g_bug = Bug::none;
  }
};

constexpr Real kRadius[1] = {Real(0.5)};

template <int D>
std::string refusal() {
  try {
    Shape<D>::curved(ShapeKind::custom, kRadius);
  } catch (const UserError& e) {
    return e.what();
  }
  return "taken";
}

TEST(CustomCore, ExistsWhenItIsRegistered) {
  EXPECT_FALSE(kindExists(ShapeKind::custom, 2) || kindExists(ShapeKind::custom, 3));
  EXPECT_NE(refusal<3>().find("custom: is not a curved shape kind in 3D; valid: "), std::string::npos) << refusal<3>();
  const Registered registered;
  EXPECT_TRUE(kindExists(ShapeKind::custom, 2) && kindExists(ShapeKind::custom, 3));
  EXPECT_EQ(refusal<2>(), "taken");
  EXPECT_EQ(refusal<3>(), "taken");
}

TEST(CustomCore, UnsoundOnesAreRefused) {
  const Registered registered;
  const std::pair<Bug, const char*> bugs[] = {
      {Bug::notFinite, "is not finite"},
      {Bug::dented, "it is not convex: its support point along ("},
      {Bug::smallBox, "outside its half extents (0.45"},
      {Bug::largeBox, "and it reaches 0.5"},
      {Bug::otherHalf, "its two support functions differ along ("},
      {Bug::noMass, "its mass is 0.0"},
      {Bug::manyCorners, "has 65 corners; valid: 1 to 64"},
      {Bug::farCorner, ", outside the core"},
      {Bug::noDirection, "its support point for the zero direction is not finite"}};
  for (const auto& [bug, reason] : bugs) {
    g_bug = bug;
    for (const std::string& told : {refusal<2>(), refusal<3>()}) {
      EXPECT_EQ(told.find("custom: "), 0u) << reason;
      EXPECT_NE(told.find(reason), std::string::npos) << told;
    }
  }
}

TEST(CustomCore, TwoRegistrationsAreRefused) {
  const Registered registered;
  const CurvedRegistrar<Ball, 3> another{ShapeKind::custom, {{"radius"}}};
  EXPECT_EQ(refusal<2>(), "taken");
  EXPECT_EQ(refusal<3>(), "custom: 2 plugins define it; valid: one plugin");
}

// It comes to rest where a sphere of its size does, and a loaded world continues bit for bit.
template <int D>
void restsAsABall() {
  const Registered registered;
  Real height[2] = {};
  for (const bool own : {false, true}) {
    const Pipeline pipeline = Pipeline::parse("contacts=query_clip");
    World<D> world(pipeline);
    world.add(body<D>(Shape<D>::plane(), Vec<D>::Zero(), BodyType::fixed));
    const Shape<D> shape = own ? Shape<D>::curved(ShapeKind::custom, kRadius) : Shape<D>::sphere(kRadius[0]);
    const BodyHandle ball = world.add(body<D>(shape, at<D>(0, Real(0.6))));
    for (int i = 0; i < 60; ++i) world.step(Real(1) / 60);
    std::istringstream file(saved(world));
    World<D> loaded(pipeline);
    loaded.load(file);
    for (int i = 0; i < 60; ++i) world.step(Real(1) / 60), loaded.step(Real(1) / 60);
    EXPECT_EQ(world.hash(), loaded.hash()) << own;
    height[own] = world.pose(ball).p[1];
  }
  EXPECT_NEAR(height[1], height[0], 1e-5) << D;
}
TEST(CustomCore, RestsAsABall) { restsAsABall<2>(), restsAsABall<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::custom_core_test
