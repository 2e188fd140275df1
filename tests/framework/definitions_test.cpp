// SPDX-License-Identifier: Zlib
#include "framework/world/definitions.h"

#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace definitions_test { namespace {

template <class T>
struct DefinitionsTest : testing::Test {};
TYPED_TEST_SUITE(DefinitionsTest, BothDimensions);

template <int D>
struct Momenta {
  Real mass;
  Vec<D> linear;
  Ang<D> angular;  // about the world's origin
};
template <int D>
Momenta<D> momentaOf(const BodyDef<D>& def) {
  const MassProperties<D> m = transformed(checkBody(def).mass, def.X_WB);
  const Vec<D> p = m.mass * def.velocity;
  return {m.mass, p, Ang<D>(m.inertia * def.angularVelocity) + cross(m.center, p)};
}

template <int D>
BodyDef<D> turning(const Shape<D>& shape, const Vec<D>& place, const Vec<D>& velocity, Real w) {
  BodyDef<D> def = body<D>(shape, place);
  def.velocity = velocity;
  def.angularVelocity[kAngDim<D> - 1] = w;
  return def;
}

TYPED_TEST(DefinitionsTest, TheWeightIsThatOfAllShapes) {
  constexpr int D = TypeParam::D;
  BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(0, 0));
  def.shapes.push_back({.shape = Shape<D>::box(Vec<D>::Constant(1)), .X_BS = {at<D>(2, 0), {}}, .density = 3});
  const CheckedBody<D> w = checkBody(def);
  const Real one = D == 2 ? 4 : 8;
  EXPECT_NEAR(w.mass.mass, 4 * one, 1e-5);
  EXPECT_NEAR(w.mass.center[0], 1.5, 1e-6);
  EXPECT_TRUE(w.kinds[static_cast<std::size_t>(ShapeKind::box)]);
  EXPECT_FALSE(w.kinds[static_cast<std::size_t>(ShapeKind::sphere)]);
  const Inertia<D> unit = w.invInertia * w.mass.inertia;
  EXPECT_NEAR((unit - Inertia<D>::Identity()).norm(), 0, 1e-5);
  def.rotatable = false;
  EXPECT_EQ(checkBody(def).invInertia, Inertia<D>(Inertia<D>::Zero()));
}

TYPED_TEST(DefinitionsTest, InvalidBodiesAreRefusedByName) {
  constexpr int D = TypeParam::D;
  const auto refusal = [](const auto& spoil) {
    BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(0, 0));
    def.name = "it";
    spoil(def);
    const std::string message = refusalOf([&] { checkBody(def); });
    EXPECT_TRUE(message.starts_with("body 'it'")) << message;
    return message;
  };
  const auto says = [](const std::string& message, const char* what) { return message.find(what) != message.npos; };
  EXPECT_TRUE(says(refusal([](auto& d) { d.shapes[0].density = 0; }), "without mass"));
  EXPECT_TRUE(says(refusal([](auto& d) { d.shapes[0].density = -1; }), "density"));
  EXPECT_TRUE(says(refusal([](auto& d) { d.shapes[0].shape = Shape<D>::plane(); }), "plane"));
  EXPECT_TRUE(says(refusal([](auto& d) { d.gravityScale = std::numeric_limits<Real>::infinity(); }), "gravity"));
  EXPECT_TRUE(says(refusal([](auto& d) { d.shapes[0].density = std::numeric_limits<Real>::max(); }), "too large"));
  EXPECT_TRUE(says(refusal([](auto& d) { d.shapes[0].density = std::numeric_limits<Real>::denorm_min(); }),
                   "too small to invert"));
}

TYPED_TEST(DefinitionsTest, TwoMergedHaveTheMomentaOfBoth) {
  constexpr int D = TypeParam::D;
  const BodyDef<D> a = turning<D>(Shape<D>::sphere(1), at<D>(1, 2), at<D>(3, -1), 2);
  BodyDef<D> b = turning<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(3, 1), at<D>(-2, 4), -5);
  b.X_WB.q = integrateRotation(Rot<D>{}, Ang<D>(Ang<D>::Constant(1)));
  const BodyDef<D> both = merged(a, b);
  const Momenta<D> A = momentaOf(a), B = momentaOf(b), all = momentaOf(both);
  EXPECT_EQ(both.shapes.size(), 2u);
  EXPECT_NEAR(all.mass, A.mass + B.mass, 1e-4);
  EXPECT_NEAR((all.linear - A.linear - B.linear).norm(), 0, 1e-3);
  EXPECT_NEAR((all.angular - A.angular - B.angular).norm(), 0, 1e-3);
  BodyDef<D> fixed = a;
  fixed.type = BodyType::fixed;
  EXPECT_NE(refusalOf([&] { merged(a, fixed); }), "");
}

TYPED_TEST(DefinitionsTest, SplitPartsKeepTheMotionOfTheirPoints) {
  constexpr int D = TypeParam::D;
  BodyDef<D> whole = turning<D>(Shape<D>::sphere(1), at<D>(0, 0), at<D>(1, 0), 2);
  whole.shapes.push_back({.shape = Shape<D>::sphere(1), .X_BS = {at<D>(4, 0), {}}});
  whole.mass = checkBody(whole).mass;
  const std::vector<BodyDef<D>> parts = splitDefinition<D>(whole, checkBody(whole).mass.center);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_FALSE(parts[0].mass || parts[1].mass);
  EXPECT_EQ(parts[0].velocity, whole.velocity);  // a change of the body keeps its motion about the new centre
  EXPECT_NEAR(parts[1].velocity[1], 2 * 2, 1e-5);
  whole.pinned = true;
  EXPECT_EQ(splitDefinition<D>(whole, at<D>(2, 0))[1].velocity, at<D>(0, 0));
}

}}}}}  // namespace lpc::LPC_PRECISION::test::definitions_test
