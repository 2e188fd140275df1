// SPDX-License-Identifier: Zlib
// The referee against independent methods: closed forms, a branch and bound over directions, the published corpus.
// These checks must catch wrong referees.
#include "oracles/referee/referee.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "oracles/corpus/cases.h"
#include "oracles/referee/support_sweep.h"
#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace referee_test { namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

template <int D>
using Judge = std::function<RefereeAnswer<D>(const ShapePairCase<D>&)>;

template <int D>
RefereeAnswer<D> exactly(const ShapePairCase<D>& c) {
  return refereeExactly(c.a.view(), c.X_WA, c.b.view(), c.X_WB);
}
template <int D>
RefereeAnswer<D> anyWay(const ShapePairCase<D>& c) {
  return referee(c.a.view(), c.X_WA, c.b.view(), c.X_WB);
}

// The fault of an answer; empty if there is none.
template <int D>
std::string faultOf(const ShapePairCase<D>& c, const RefereeAnswer<D>& r) {
  if (!r.decided) return "undecided";
  const ShapeView<D>&a = c.a.view(), &b = c.b.view();
  const double s = errorScale(a, c.X_WA, b, c.X_WB, r.lo);
  if (!(r.lo <= r.hi)) return "empty interval";
  if (r.hi - r.lo > 2 * kUnit * std::abs(r.lo) + kUnit * s) return "wide interval";
  if (!(r.lo > 0 || r.hi < 0 || (r.lo == 0 && r.hi == 0))) return "undecided sign";
  const Interval along = separationAlong(a, c.X_WA, b, c.X_WB, r.normal);
  if (r.interval().distanceTo(along.middle()) > 8 * kUnit * s) return "the normal does not give the distance";
  const Interval sweep = sweepDirections(a, c.X_WA, b, c.X_WB, {1e-4 * s, 1500});
  if (sweep.lo > r.hi + 64 * kUnit * s) return "a sampled direction separates more";
  if (sweep.hi < r.lo - 64 * kUnit * s) return "no direction separates as much";
  // The distance known by construction holds within the rounding of sizes and positions.
  if (c.distance && r.interval().distanceTo(static_cast<double>(*c.distance)) > 64 * kUnit * s) {
    return "not the distance of the construction";
  }
  return "";
}

template <int D>
void holds(const Judge<D>& judge) {
  const auto c = *shapePairs<D>();
  const auto answer = judge(c);
  const std::string fault = faultOf<D>(c, answer);
  if (!fault.empty()) {
    RC_LOG() << fault << ": [" << answer.lo << ", " << answer.hi << "] by " << answer.method;
    RC_FAIL();
  }
}

TEST(Referee, ExactAnswersHold2) {
  check(
      "exact referee, 2D", [] { holds<2>(exactly<2>); }, 2000);
}
TEST(Referee, ExactAnswersHold3) {
  check(
      "exact referee, 3D", [] { holds<3>(exactly<3>); }, 1000);
}
TEST(Referee, QuickAnswersHold2) {
  check(
      "quick referee, 2D", [] { holds<2>(anyWay<2>); }, 2000);
}
TEST(Referee, QuickAnswersHold3) {
  check(
      "quick referee, 3D", [] { holds<3>(anyWay<3>); }, 1000);
}

// The proofs of certificate.cpp share the search of the exact referee but not its numbers; both intervals hold phi.
template <int D>
void certificatesAgree(int n) {
  PlainDraw draw(11);
  std::map<std::string, std::array<int, 2>> shares;  // by pair of kinds: proved, all
  for (int i = 0; i < n; ++i) {
    const auto c = drawShapePair<D>(draw);
    const auto exact = exactly<D>(c);
    const auto quick = refereeByCertificate(c.a.view(), c.X_WA, c.b.view(), c.X_WB);
    ASSERT_TRUE(exact.decided) << c;
    const std::pair kinds(std::min(c.a.kind(), c.b.kind()), std::max(c.a.kind(), c.b.kind()));
    auto& share = shares[std::string(shapeKindName(kinds.first)) + "-" + std::string(shapeKindName(kinds.second))];
    ++share[1];
    if (!quick.decided) continue;
    ++share[0];
    EXPECT_TRUE(quick.lo <= exact.hi && exact.lo <= quick.hi) << c;
  }
  int proved = 0;
  for (const auto& [kinds, share] : shares) {
    std::printf("%dD %-20s %5d pairs, %5.1f %% by certificate, the rest exactly, undecidable 0\n", D, kinds.c_str(),
                share[1], 100.0 * share[0] / share[1]);
    proved += share[0];
  }
  EXPECT_GE(proved, n / 2);  // otherwise certificates would not be worth their code
}
TEST(Referee, CertificatesAgreeWithExactAnswers2) { certificatesAgree<2>(caseCount(20000)); }
TEST(Referee, CertificatesAgreeWithExactAnswers3) { certificatesAgree<3>(caseCount(10000)); }

// --- properties of phi that exact arithmetic must keep to the bit ----------------------------------------------------

template <int D>
void swapsAndScales() {
  auto c = *shapePairs<D>();
  const auto ab = exactly<D>(c);
  const auto ba = refereeExactly(c.b.view(), c.X_WB, c.a.view(), c.X_WA);
  RC_ASSERT(ab.lo == ba.lo);
  RC_ASSERT(ab.hi == ba.hi);
  const Interval back = separationAlong(c.a.view(), c.X_WA, c.b.view(), c.X_WB, Vecd<D>(-ba.normal));
  const double s = errorScale(c.a.view(), c.X_WA, c.b.view(), c.X_WB, ab.lo);
  RC_ASSERT(ab.interval().distanceTo(back.middle()) <= 8 * kUnit * s);
  // A scale of a power of two changes exponents only. Polytopes are excluded: their hulls are rebuilt from scaled
  // points.
  RC_PRE(c.a.kind() != ShapeKind::polytope && c.b.kind() != ShapeKind::polytope);
  ShapeView<D> a = c.a.view(), b = c.b.view();
  a.half *= 1024, a.radius *= 1024, b.half *= 1024, b.radius *= 1024;
  c.X_WA.p *= 1024, c.X_WB.p *= 1024;
  const auto large = refereeExactly(a, c.X_WA, b, c.X_WB);
  RC_ASSERT(large.lo == 1024 * ab.lo);
  RC_ASSERT(large.hi == 1024 * ab.hi);
}
TEST(Referee, SwapAndScaleChangeNoBit) {
  check("swap and scale, 2D", swapsAndScales<2>, 500);
  check("swap and scale, 3D", swapsAndScales<3>, 500);
}

template <int D>
RefereeAnswer<D> boxesAt(const Vec<D>& p) {
  const auto box = Shape<D>::box(Vec<D>::Constant(Real(0.5)));
  return refereeExactly(box.view(), Pose<D>{}, box.view(), Pose<D>{p, {}});
}

TEST(Referee, SignsAreExact) {
  const double ulp = kUnit;
  EXPECT_EQ(boxesAt<3>({1, 0.25, 0}).interval().lo, 0);
  EXPECT_EQ(boxesAt<3>({1, 0.25, 0}).interval().hi, 0);
  EXPECT_EQ(boxesAt<3>({1, 1, 1}).hi, 0);  // corner on corner
  EXPECT_EQ(boxesAt<3>({1 + ulp, 0.25, 0}).lo, ulp);
  EXPECT_EQ(boxesAt<3>({1 + ulp, 0.25, 0}).hi, ulp);
  EXPECT_EQ(boxesAt<3>({1 - ulp, 0.25, 0}).hi, -ulp);
  EXPECT_EQ(boxesAt<3>({0, 0, 0}).lo, -1);
  EXPECT_EQ(boxesAt<3>({0, 0, 0}).hi, -1);
  EXPECT_EQ(boxesAt<2>({1, 1}).lo, 0);
  EXPECT_EQ(boxesAt<2>({1, 1 - ulp}).hi, 0);
  EXPECT_EQ(boxesAt<2>({1 - ulp, 1 - ulp}).hi, -ulp);
  // sqrt(2) lies between two neighbouring numbers.
  const auto corner = boxesAt<2>({2, 2});
  EXPECT_LT(corner.lo, std::sqrt(2.0) + kUnit);
  EXPECT_EQ(std::nextafter(corner.lo, 2.0), corner.hi);
  // The last digit of a sum: 1e-30 next to 1 counts.
  const auto point = Shape<3>::sphere(0), ball = Shape<3>::sphere(1);
  const auto near = refereeExactly(ball.view(), Pose<3>{}, point.view(), Pose<3>{{1, Real(1e-30), 0}, {}});
  EXPECT_GT(near.lo, 0);
  EXPECT_NEAR(near.hi, 5e-61, 1e-75);
}

TEST(Referee, CoresWithoutVolume) {
  const auto segment = Shape<2>::segment(1);
  const Pose<2> aside{{1, 0}, {}}, across{{0, 0}, Rot<2>{0, 1}};
  EXPECT_EQ(refereeExactly(segment.view(), Pose<2>{}, segment.view(), aside).hi, 0);    // on one line
  EXPECT_EQ(refereeExactly(segment.view(), Pose<2>{}, segment.view(), across).hi, -1);  // a cross
  const auto rod = Shape<3>::capsule(1, Real(0.25));
  const Pose<3> turned{{0, 0, 0}, Rot<3>{std::sqrt(Real(0.5)), 0, 0, std::sqrt(Real(0.5))}};
  EXPECT_EQ(refereeExactly(rod.view(), Pose<3>{}, rod.view(), turned).hi, -0.5);
  EXPECT_EQ(refereeExactly(rod.view(), Pose<3>{}, rod.view(), Pose<3>{}).lo, -0.5);
  const auto point = Shape<3>::sphere(0);
  const auto same = refereeExactly(point.view(), turned, point.view(), turned);
  EXPECT_EQ(same.lo, 0);
  EXPECT_EQ(same.hi, 0);
  EXPECT_NEAR(same.normal.norm(), 1, kUnit);
}

TEST(Referee, ExtremeAndBadNumbers) {
  const auto ball = Shape<3>::sphere(1);
  const Real tiny = std::numeric_limits<Real>::denorm_min(), huge = Real(1e300);
  const auto dot = Shape<3>::sphere(tiny);
  EXPECT_EQ(refereeExactly(dot.view(), Pose<3>{}, dot.view(), Pose<3>{{3 * tiny, 0, 0}, {}}).lo, tiny);
  const auto far = referee(ball.view(), Pose<3>{}, dot.view(), Pose<3>{{huge, huge, 0}, {}});
  EXPECT_TRUE(far.decided);
  EXPECT_NEAR(far.lo / std::sqrt(2.0), 1e300, 1e285);
  for (const Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
    EXPECT_FALSE(referee(ball.view(), Pose<3>{}, dot.view(), Pose<3>{{bad, 0, 0}, {}}).decided);
    EXPECT_FALSE(referee(ball.view(), Pose<3>{{0, 0, 0}, {bad, 0, 0, 0}}, dot.view(), Pose<3>{}).decided);
  }
}

// --- closed forms ----------------------------------------------------------------------------------------------------

using Long = long double;

// Point against box in the box's own frame, point against segment, in long double.
template <int D>
Long pointToCore(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p_W) {
  Eigen::Matrix<Long, D, D> r = X_WS.q.matrix().template cast<Long>();
  const Eigen::Matrix<Long, D, 1> p = r.transpose() * (p_W.template cast<Long>() - X_WS.p.template cast<Long>());
  Long outside = 0, inside = -std::numeric_limits<Long>::infinity();
  for (int k = 0; k < D; ++k) {
    const Long beyond =
        std::abs(p[k]) - (shape.kind == ShapeKind::box || k == 0 ? static_cast<Long>(shape.half[k]) : 0);
    outside += std::max(beyond, Long(0)) * std::max(beyond, Long(0));
    inside = std::max(inside, beyond);
  }
  return std::sqrt(outside) + std::min(inside, Long(0));
}

template <int D>
void agreesWithClosedForms() {
  RapidCheckDraw draw;
  const auto kind = draw.pick({ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box});
  const Shape<D> ball = drawSketch<D>(draw, ShapeKind::sphere).build(1), other = drawSketch<D>(draw, kind).build(1);
  const Pose<D> X_WA = drawPose<D>(draw, 2), X_WB = drawPose<D>(draw, 2);
  const Long radii = static_cast<Long>(ball.view().radius) + static_cast<Long>(other.view().radius);
  const double expected = static_cast<double>(pointToCore(other.view(), X_WB, X_WA.p) - radii);
  const auto answer = referee(ball.view(), X_WA, other.view(), X_WB);
  RC_ASSERT(answer.decided);
  // The stored rotation is one up to rounding; the closed form takes it as exact.
  RC_ASSERT(answer.interval().distanceTo(expected) <=
            16 * kUnit * errorScale(ball.view(), X_WA, other.view(), X_WB, 0));
}
TEST(Referee, ClosedForms) {
  check("point against point, segment, box, 2D", agreesWithClosedForms<2>, 1000);
  check("point against point, segment, box, 3D", agreesWithClosedForms<3>, 1000);
}

// --- the corpus ------------------------------------------------------------------------------------------------------

TEST(Referee, EveryExpectedValueOfTheCorpus) {
  int compared = 0, curved = 0;
  for (const Case& c : readCases(std::string(LPC_SOURCE_DIR) + "/tests/regressions/hard_cases.json")) {
    if (c.query != CaseQuery::signedDistance) continue;
    std::visit(
        [&](const auto& g) {
          if (!g.a.shape || !g.b.shape) return;
          ++compared;
          const auto answer = referee(g.a.shape->view(), g.a.X_WS, g.b.shape->view(), g.b.X_WS);
          const auto exact = refereeExactly(g.a.shape->view(), g.a.X_WS, g.b.shape->view(), g.b.X_WS);
          const double s = errorScale(g.a.shape->view(), g.a.X_WS, g.b.shape->view(), g.b.X_WS, c.expected.distance);
          ASSERT_TRUE(answer.decided) << c.id;
          EXPECT_LE(answer.interval().distanceTo(c.expected.distance), c.expected.tolerance + 1e-12 * s) << c.id;
          if (!exact.decided) {  // cylinders and ellipsoids
            ++curved;
            return;
          }
          EXPECT_LE(exact.interval().distanceTo(c.expected.distance), c.expected.tolerance + 1e-12 * s) << c.id;
          EXPECT_TRUE(answer.lo <= exact.hi && exact.lo <= answer.hi) << c.id;
        },
        c.geometry);
  }
  EXPECT_EQ(compared, 84);
  EXPECT_EQ(curved, 9);
}

// --- planted wrong referees ------------------------------------------------------------------------------------------

template <int D>
RefereeAnswer<D> claim(const ShapePairCase<D>& c, const Vecd<D>& d) {
  const Interval along = separationAlong(c.a.view(), c.X_WA, c.b.view(), c.X_WB, d);
  return {true, along.lo, along.hi, d.normalized(), "planted"};
}

template <int D>
std::map<std::string, Judge<D>> plantedReferees() {
  std::map<std::string, Judge<D>> planted;
  planted["forgets a radius"] = [](const auto& c) {
    auto r = exactly<D>(c);
    r.lo += static_cast<double>(c.b.view().radius), r.hi += static_cast<double>(c.b.view().radius);
    return r;
  };
  planted["flips the normal"] = [](const auto& c) {
    auto r = exactly<D>(c);
    r.normal = -r.normal;
    return r;
  };
  planted["looks along the line of centres only"] = [](const auto& c) {
    const Vec<D> d = c.X_WB.p - c.X_WA.p;
    return claim<D>(c, d.isZero(0) ? Vecd<D>(Vecd<D>::Unit(0)) : Vecd<D>(d.template cast<double>()));
  };
  planted["rounds its input to float"] = [](const auto& c) {
    Pose<D> X = c.X_WB;
    for (int k = 0; k < D; ++k) X.p[k] = static_cast<Real>(static_cast<float>(X.p[k]));
    return refereeExactly(c.a.view(), c.X_WA, c.b.view(), X);
  };
  planted["treats touching as overlap by 1e-9"] = [](const auto& c) {
    auto r = exactly<D>(c);
    if (std::abs(r.lo) < 1e-9) r.lo = r.hi = -1e-9;
    return r;
  };
  planted["gives up where it is near touching"] = [](const auto& c) {
    auto r = exactly<D>(c);
    r.decided = std::abs(r.lo) > 1e-12;
    return r;
  };
  planted["answers with an interval around zero"] = [](const auto& c) {
    auto r = exactly<D>(c);
    if (std::abs(r.lo) < 1e-12) r.lo -= 1e-17, r.hi += 1e-17;
    return r;
  };
  return planted;
}

// The 2009 engine's mistake: separating axes without cross products of edges.
RefereeAnswer<3> facesOnly(const ShapePairCase<3>& c) {
  RefereeAnswer<3> best;
  const auto take = [&](const Vec<3>& n) {
    for (const double side : {1.0, -1.0}) {
      const auto r = claim<3>(c, side * n.cast<double>());
      if (!best.decided || r.lo > best.lo) best = r;
    }
  };
  const auto faces = [&](const ShapeView<3>& shape, const Pose<3>& X) {
    if (shape.kind == ShapeKind::box) {
      for (int k = 0; k < 3; ++k) take(X.q * Vec<3>(Vec<3>::Unit(k)));
    } else if (shape.hull) {
      for (const auto& face : shape.hull->faces) take(X.q * face.normal);
    }
  };
  faces(c.a.view(), c.X_WA), faces(c.b.view(), c.X_WB);
  const auto right = exactly<3>(c);
  return right.lo < 0 && best.decided ? best : right;  // correct for separated shapes
}

TEST(Referee, PlantedWrongRefereesAreCaught) {
  for (const auto& [name, judge] : plantedReferees<2>()) {
    expectFalsified(
        "2D referee that " + name, [judge = judge] { holds<2>(judge); }, 2000);
  }
  for (const auto& [name, judge] : plantedReferees<3>()) {
    expectFalsified(
        "3D referee that " + name, [judge = judge] { holds<3>(judge); }, 1000);
  }
  expectFalsified(
      "3D referee without edge-edge axes", [] { holds<3>(facesOnly); }, 1000);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::referee_test
