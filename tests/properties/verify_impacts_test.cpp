// SPDX-License-Identifier: Zlib
// `lpc verify --stage time_of_impact`: methods on drawn motions of every kind of shape. Late, blind and early methods
// must be found. The referee's own interval is held to roots in closed form.
#include <gtest/gtest.h>

#include "framework/math/random.h"
#include "oracles/referee/impact_bracket.h"
#include "oracles/verify/verify.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/time_of_impact_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace verify_impacts_test { namespace {

using namespace test::wrong_casts;

template <int D>
using Method = Candidate<TimeOfImpact<D>>;

template <int D>
Verified asked(const std::vector<Method<D>>& methods, int count) {
  Verified out;
  for (int a = 0; a < kShapeKinds; ++a) {
    for (int b = a; b < kShapeKinds; ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (!kindExists(kindA, D) || !kindExists(kindB, D)) continue;
      verifyImpacts<D>(kindA, kindB, {.seed = 1, .first = 0, .count = count}, methods, out);
    }
  }
  return out;
}
LedgerEntry sumOf(const Verified& v, const std::string& method, const std::string& axis = "all",
                  const std::string& value = "") {
  LedgerEntry sum;
  for (const auto& [key, entry] : v.ledger) {
    if (key.method == method && key.axis == axis && (value.empty() || key.value == value)) sum.add(entry);
  }
  return sum;
}

// No method is late or blind, for any kinds; errors are within the band; every family and speed is drawn.
template <int D>
void oursAreRight() {
  std::vector<Method<D>> methods;
  for (const Registered* r : Registry::instance().list(StageKind::timeOfImpact, D)) {
    const Spec spec{r->info.name, {}};
    if (r->info.role == AlgorithmRole::competitor) {
      methods.push_back({r->info.name, r->info, [spec] { return createStage<TimeOfImpact<D>>(spec); }});
    }
  }
  ASSERT_GE(methods.size(), 2u);
  const Verified v = asked<D>(methods, 12);
  for (const Method<D>& m : methods) {
    const LedgerEntry row = sumOf(v, m.name);
    EXPECT_GT(row[Tally::asked], D == 3 ? 300 : 200) << m.name;
    EXPECT_EQ(row.faults(), 0) << m.name;
    EXPECT_LE(20 * row[Tally::undecided], row[Tally::asked]) << m.name;
    EXPECT_LE(row.maxError, sizeof(Real) == 8 ? 1e-9 : 1e-4) << m.name;
    long hits = 0;
    for (const auto& [decade, count] : row.histogram) hits += count;
    EXPECT_GT(4 * hits, row[Tally::asked]) << m.name << ": most motions meet nothing";
    for (const char* family : {"straight", "turning", "carried along"}) {
      EXPECT_GT(sumOf(v, m.name, "family", family)[Tally::asked], 0) << family;
    }
    EXPECT_GT(sumOf(v, m.name, "regime", "100 to 1000 sizes/s")[Tally::asked], 0);
  }
}
TEST(VerifyImpacts, OursAreRight2) { oursAreRight<2>(); }
TEST(VerifyImpacts, OursAreRight3) { oursAreRight<3>(); }

template <template <int> class Twin>
void isFound(const std::string& name) {
  const std::vector<Method<2>> methods = {{"planted", {}, [] { return std::make_unique<Twin<2>>(); }}};
  test::expectCaught("VerifyImpacts " + name, sumOf(asked<2>(methods, 6), "planted")[Tally::wrong] == 0);
}
TEST(VerifyImpacts, PlantedBugsAreFound) {
  isFound<LooksAtTheEnds>("who looks at the ends");
  const std::vector<Method<2>> blind = {{"blind", {}, [] { return std::make_unique<LooksAtTheEnds<2>>(); }}};
  EXPECT_GT(sumOf(asked<2>(blind, 6), "blind")[Tally::wrongSide], 0) << "who misses an impact is on the wrong side";
  isFound<WaitsForOverlap>("who waits for overlap");
  isFound<SpeedWithoutSign>("speed without sign");
  isFound<ForgetsTheFirst>("who forgets the first's motion");
  isFound<ForgetsTurning>("who forgets turning");
}

// --- roots in closed form -------------------------------------------------------------------------------------------

/// A turning body that meets another at a known time, at a known closing speed.
template <int D>
struct KnownImpact {
  Shape<D> a = Shape<D>::sphere(1), b = a;
  ShapeMotion<D> A, B;
  double t = 0;
  bool first = true;  // no earlier contact

  MovingPair<D> pair() const { return {a.view(), b.view(), A, B}; }
};
template <int D>
void turnTo(ShapeMotion<D>& m, double angle, double w, double t) {
  m.motion.w[kAngDim<D> - 1] = static_cast<Real>(w);
  Ang<D> start = Ang<D>::Zero();
  start[kAngDim<D> - 1] = static_cast<Real>(angle - w * t);
  m.X_WC.q = integrateRotation({}, start);
}
template <int D>
Vec<D> inPlane(double x, double y) {
  Vec<D> out = Vec<D>::Zero();
  out[0] = static_cast<Real>(x), out[1] = static_cast<Real>(y);
  return out;
}

/// A ball meets the side of a rod that turns about its middle. The ball's height over the side is the cross product of
/// the rod's direction and the ball's place, less both radii.
template <int D>
KnownImpact<D> ballMeetsRod(Random& random, double closing) {
  const double w = random.uniform(1, 10), angle = random.uniform(-3, 3), along = random.uniform(0.3, 0.8);
  const double radius = random.uniform(0.05, 0.3), thick = 0.1, height = radius + thick;
  const double up = w * along - closing,
               aside = -w * height * random.uniform(0.55, 1.5);  // velocity in the rod's frame
  KnownImpact<D> out{Shape<D>::sphere(static_cast<Real>(radius)),
                     Shape<D>::capsule(1, static_cast<Real>(thick)),
                     {},
                     {},
                     random.uniform(0.05, 0.9)};
  const double c = std::cos(angle), s = std::sin(angle), x = along * c - height * s, y = along * s + height * c;
  const double vx = aside * c - up * s, vy = aside * s + up * c;
  out.A.X_WC.p = inPlane<D>(x - vx * out.t, y - vy * out.t), out.A.motion.v = inPlane<D>(vx, vy);
  turnTo(out.B, angle, w, out.t);
  for (int k = 1; k <= 1000; ++k) {
    const double back = out.t * k / 1000, turned = angle - w * back;
    const double cross = std::cos(turned) * (y - vy * back) - std::sin(turned) * (x - vx * back);
    out.first = out.first && cross > height;
  }
  return out;
}

/// A turning box meets a floor with a corner, at a height of a sin + b cos of its angle.
template <int D>
KnownImpact<D> boxMeetsFloor(Random& random, double closing) {
  const double a = random.uniform(0.2, 1), b = random.uniform(0.2, 1), w = random.uniform(1, 10);
  const double angle = random.uniform(0.05, 1.5);
  const auto height = [&](double at) { return a * std::abs(std::sin(at)) + b * std::abs(std::cos(at)); };
  Vec<D> half = Vec<D>::Constant(Real(0.3));
  half[0] = static_cast<Real>(a), half[1] = static_cast<Real>(b);
  KnownImpact<D> out{Shape<D>::box(half), Shape<D>::plane(), {}, {}, random.uniform(0.05, 0.9)};
  const double up = w * (a * std::cos(angle) - b * std::sin(angle)) - closing;
  turnTo(out.A, angle, w, out.t);
  out.A.motion.v = inPlane<D>(0, up), out.A.X_WC.p = inPlane<D>(0, height(angle) - up * out.t);
  for (int k = 1; k <= 1000; ++k) {
    const double back = out.t * k / 1000;
    out.first = out.first && height(angle) - up * back > height(angle - w * back);
  }
  return out;
}

struct RootsSeen {
  int asked = 0, missed = 0, wide = 0, early = 0;  // early: outside the time at which the gap enters the band
};
template <int D>
void lookAtRoots(RootsSeen& seen, KnownImpact<D> (*draw)(Random&, double), int count) {
  constexpr double kEps = static_cast<double>(std::numeric_limits<Real>::epsilon());
  Random random(317);
  for (const double closing : {3.0, 0.1, 1e-3}) {
    if (sizeof(Real) == 4 && closing < 1) continue;  // a float of this time moves the shapes by more
    for (int k = 0; k < count;) {
      const KnownImpact<D> known = draw(random, closing);
      if (!known.first) continue;
      ++k, ++seen.asked;
      const Interval touch = firstTouch(known.pair(), Real(1));
      const double given = 16 * kEps / closing;  // s: the rounding of the numbers given
      seen.missed += !(touch.distanceTo(known.t) <= given);
      seen.wide += !(touch.width() <= 2000 * kEps / closing);
      seen.early += std::abs(impactBracket(known.pair(), Real(1)).free - known.t) > touch.width() + given;
    }
  }
}

// Times of first contact with a closing speed of 3 m/s to 1 mm/s, at surface speeds of up to 10 m/s.
TEST(VerifyImpacts, FirstTouchIsTheRoot) {
  RootsSeen seen;
  constexpr int kCount = 5;
  lookAtRoots<2>(seen, ballMeetsRod<2>, kCount), lookAtRoots<3>(seen, ballMeetsRod<3>, kCount);
  lookAtRoots<2>(seen, boxMeetsFloor<2>, kCount), lookAtRoots<3>(seen, boxMeetsFloor<3>, kCount);
  EXPECT_EQ(seen.missed, 0) << "of " << seen.asked;
  EXPECT_EQ(seen.wide, 0) << "of " << seen.asked;
  if (sizeof(Real) == 8) test::expectCaught("VerifyImpacts first time within the band as the root", seen.early == 0);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::verify_impacts_test
