// SPDX-License-Identifier: Zlib
// Each stopping rule of gjk_epa, as a parameter: it saves work, and the remaining error is within its tolerance.
#include <gtest/gtest.h>

#include <algorithm>

#include "framework/stage/stage_narrowphase.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace stopping_rules_test {

template <int D>
struct Pairs {
  std::vector<Shape<D>> a, b;
  std::vector<PairView<D>> views;
  std::vector<PairAnswer<D>> truth;  // within roundings
};

template <int D>
std::unique_ptr<PairQuery<D>> made(const std::string& spec) {
  return createStage<PairQuery<D>>(Spec::parse(spec));
}

// Polytopes and cylinders, apart or deep in each other. Closer to touching, rounding alone decides when to stop.
template <int D>
Pairs<D> drawPairs(bool apart) {
  PlainDraw draw(11);
  Pairs<D> out;
  while (out.views.size() < 200) {
    const ShapeKind kind = D == 3 && out.views.size() % 4 == 0 ? ShapeKind::cylinder : ShapeKind::polytope;
    const Shape<D> a = drawSketch<D>(draw, ShapeKind::polytope).build(1), b = drawSketch<D>(draw, kind).build(1);
    const Real size = sizeOf(a) + sizeOf(b);
    const PairView<D> view{
        a.view(), b.view(), {draw.real(0, 1) * size * drawDirection<D>(draw), drawRotation<D>(draw)}};
    PairAnswer<D> answer = queryPair<D>(*made<D>("gjk_epa"), view.a, view.b, view.X_AB);
    const Real core = answer.distance + view.a.radius + view.b.radius;
    if (answer.status != QueryStatus::converged || (apart ? core < size / 100 : core > -size / 100)) continue;
    out.a.push_back(a), out.b.push_back(b), out.truth.push_back(answer);
    out.views.push_back({out.a.back().view(), out.b.back().view(), view.X_AB});
  }
  return out;
}

// Results of a method on all pairs.
struct Outcome {
  std::uint64_t supports = 0, faces = 0;
  int limited = 0;   // ended at a limit and reported it
  int tooShort = 0;  // below the truth by more than `error` of the measure
  int tooLong = 0;   // above the truth by more than rounding: never
};

template <int D>
Outcome ask(PairQuery<D>& method, const Pairs<D>& pairs, Real error, bool ofDistance) {
  Outcome out;
  WorkDone work;
  std::vector<PairAnswer<D>> answers(pairs.views.size());
  method.query(pairs.views, QueryNeed::distance, answers, {}, work);
  out.supports = work[WorkCount::supportCalls], out.faces = work[WorkCount::polytopeFaces];
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const PairView<D>& v = pairs.views[i];
    const Real scale = std::max({v.a.half.maxCoeff(), v.b.half.maxCoeff(), v.X_AB.p.cwiseAbs().maxCoeff()});
    const Real truth = pairs.truth[i].distance, core = std::abs(truth + v.a.radius + v.b.radius);
    const Real rounding = (sizeof(Real) == 8 ? Real(1e-12) : Real(1e-5)) * scale;
    // The tolerance is relative to the result, which may exceed the true depth.
    const Real left = error * (ofDistance ? core / (1 - error) : scale) + rounding;
    out.limited += answers[i].status == QueryStatus::iterationLimit;
    out.tooShort += !(answers[i].distance >= truth - left);
    out.tooLong += !(answers[i].distance <= truth + rounding);
  }
  return out;
}

constexpr Real kLoose = Real(0.03);

// The rule saves work (of `spared`), and no error exceeds its tolerance.
template <int D>
bool sparesWithin(PairQuery<D>& method, const Pairs<D>& pairs, bool ofDistance, std::uint64_t Outcome::*spared) {
  const Outcome exact = ask<D>(*made<D>("gjk_epa"), pairs, 0, false);
  const Outcome loose = ask<D>(method, pairs, kLoose, ofDistance);
  EXPECT_EQ(exact.tooShort + exact.tooLong + exact.limited, 0);
  return loose.*spared < exact.*spared && loose.tooShort + loose.tooLong + loose.limited == 0;
}

// A limit ends some searches, which report it. Their result is a bound, and they do less of the work `spared`.
template <int D>
bool endsAtLimit(PairQuery<D>& method, const Pairs<D>& pairs, std::uint64_t Outcome::*spared) {
  const Outcome exact = ask<D>(*made<D>("gjk_epa"), pairs, 0, false);
  const Outcome limited = ask<D>(method, pairs, 0, false);
  return limited.limited > 20 && limited.tooLong == 0 && limited.tooShort <= limited.limited &&
         limited.*spared < exact.*spared;
}

// Planted bug: errors above the tolerance.
template <int D>
class Careless : public PairQuery<D> {
 public:
  explicit Careless(const std::string& spec) : m_right(made<D>(spec)) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_right->query(pairs, need, answers, memory, work);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      answers[i].distance -= 2 * kLoose * (std::abs(answers[i].distance) + pairs[i].X_AB.p.norm());
    }
  }

 private:
  std::unique_ptr<PairQuery<D>> m_right;
};

template <int D>
void toleranceIsWhatIsLeft() {
  const std::string loose = std::to_string(kLoose);
  const Pairs<D> apart = drawPairs<D>(true), deep = drawPairs<D>(false);
  for (const std::string gap : {"best", "last"}) {
    for (const bool ofDistance : {false, true}) {
      const std::string rest = std::string(",measure=") + (ofDistance ? "distance" : "size") + ",gap=" + gap + "}";
      const std::string spec = "gjk_epa{tolerance=" + loose + rest, depth = "gjk_epa{depth_tolerance=" + loose + rest;
      SCOPED_TRACE(spec);
      EXPECT_TRUE(sparesWithin<D>(*made<D>(spec), apart, ofDistance, &Outcome::supports));
      EXPECT_TRUE(sparesWithin<D>(*made<D>(spec), deep, ofDistance, &Outcome::faces));
      EXPECT_TRUE(sparesWithin<D>(*made<D>(depth), deep, ofDistance, &Outcome::faces));
      Careless<D> careless(spec);
      expectCaught("a tolerance is exceeded, " + spec,
                   sparesWithin<D>(careless, apart, ofDistance, &Outcome::supports));
      expectCaught("a depth's tolerance is exceeded, " + spec,
                   sparesWithin<D>(careless, deep, ofDistance, &Outcome::faces));
    }
  }
  expectCaught("deaf to the tolerance", sparesWithin<D>(*made<D>("gjk_epa"), apart, false, &Outcome::supports));
  // The tolerance of depths does not change distances.
  const Outcome exact = ask<D>(*made<D>("gjk_epa"), apart, 0, false);
  const Outcome same = ask<D>(*made<D>("gjk_epa{depth_tolerance=" + loose + "}"), apart, 0, false);
  EXPECT_EQ(same.tooShort + same.tooLong, 0);
  EXPECT_EQ(same.supports, exact.supports);
}
TEST(StoppingRules, ErrorIsWithinTheTolerance2) { toleranceIsWhatIsLeft<2>(); }
TEST(StoppingRules, ErrorIsWithinTheTolerance3) { toleranceIsWhatIsLeft<3>(); }

// The bound of the last direction is no better than the best one, so waiting for it takes more support points.
TEST(StoppingRules, LastGapIsNoSmaller) {
  const Pairs<3> apart = drawPairs<3>(true);
  const Outcome best = ask<3>(*made<3>("gjk_epa{tolerance=0.03}"), apart, kLoose, false);
  const Outcome last = ask<3>(*made<3>("gjk_epa{tolerance=0.03,gap=last}"), apart, kLoose, false);
  EXPECT_GT(last.supports, best.supports);
}

template <int D>
void limitsAreStatuses() {
  const Pairs<D> apart = drawPairs<D>(true), deep = drawPairs<D>(false);
  EXPECT_TRUE(endsAtLimit<D>(*made<D>("gjk_epa{iterations=1}"), apart, &Outcome::supports));
  EXPECT_TRUE(endsAtLimit<D>(*made<D>("gjk_epa{expansions=1}"), deep, &Outcome::faces));
  EXPECT_TRUE(endsAtLimit<D>(*made<D>("gjk_epa{expansions=0}"), deep, &Outcome::faces));
  if constexpr (D == 3) {
    EXPECT_TRUE(endsAtLimit<D>(*made<D>("gjk_epa{faces=8}"), deep, &Outcome::faces));
  }
  expectCaught("deaf to the limit of iterations", endsAtLimit<D>(*made<D>("gjk_epa"), apart, &Outcome::supports));
  expectCaught("deaf to the limit of expansions", endsAtLimit<D>(*made<D>("gjk_epa"), deep, &Outcome::faces));
}
TEST(StoppingRules, LimitsAreStatuses2) { limitsAreStatuses<2>(); }
TEST(StoppingRules, LimitsAreStatuses3) { limitsAreStatuses<3>(); }

}  // namespace stopping_rules_test
}}}  // namespace lpc::LPC_PRECISION::test
