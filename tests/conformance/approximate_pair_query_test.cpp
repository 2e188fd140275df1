// SPDX-License-Identifier: Zlib
// An approximate pair query must still give the right side, and a depth that separates the shapes. Also: how `lpc
// verify` counts its other errors.
#include <gtest/gtest.h>

#include <cstdio>

#include "oracles/verify/case_run.h"
#include "oracles/verify/verify.h"
#include "tests/check_property.h"
#include "tests/expect_caught.h"
#include "tests/pair_query_properties.h"
#include "tests/planted_bugs/pair_query_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace approximate_pair_query_test {

using namespace wrong_queries;

struct Seen {
  int pairs = 0, overlaps = 0, wrongSides = 0, tooShallow = 0, notMinimal = 0;
  double deepest = 1;  // largest ratio of a depth to the least depth
};

enum class Of { boxes, ellipsoids };

// Shapes of 0.5 to 1.5 m, turned at random, 0 to 1.5 m apart along each axis.
template <int D>
Seen onPairs(PairQuery<D>& method, int count, Of of = Of::boxes) {
  const auto right = createStage<PairQuery<D>>(Spec{"gjk_epa", {}});
  PlainDraw draw(seedOf("approximate queries on boxes"));
  Seen seen;
  for (; seen.pairs < count; ++seen.pairs) {
    Vec<D> a, b;
    for (int k = 0; k < D; ++k) {
      a[k] = draw.real(0.25, 0.75), b[k] = draw.real(0.25, 0.75);
    }
    const auto shape = [&](const Vec<D>& half) {
      return of == Of::boxes ? Shape<D>::box(half, 0)
                             : Shape<D>::curved(ShapeKind::ellipsoid, std::span<const Real>(half.data(), D));
    };
    const Asked<D> pair{shape(a), shape(b), Pose<D>{Real(1.5) * drawVector<D>(draw), drawRotation<D>(draw)}};
    const auto ask = [&](PairQuery<D>& query, QueryNeed need) {
      return static_cast<double>(queryPair<D>(query, pair.a.view(), pair.b.view(), pair.X_AB, need).distance);
    };
    const double truth = ask(*right, QueryNeed::distance), value = ask(method, QueryNeed::distance);
    const double T = kPairTolerance * sizeOf(pair, truth);
    for (const double said : {value, ask(method, QueryNeed::boolean)}) {
      seen.wrongSides += (said < 0) != (truth < 0) && std::abs(truth) > T;
    }
    if (!(truth < -T)) continue;
    ++seen.overlaps;
    seen.tooShallow += value > truth + T;
    seen.notMinimal += value < truth - 1e-3 * std::abs(truth) - 1e-5;
    if (truth < -0.01) seen.deepest = std::max(seen.deepest, value / truth);
  }
  return seen;
}

template <int D>
void boxes() {
  constexpr int kPairs = 20000;
  int methods = 0;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role != AlgorithmRole::competitor || r->info.guarantee != Guarantee::approximate) continue;
    const Seen seen = onPairs<D>(*createStage<PairQuery<D>>(Spec{r->info.name, {}}), caseCount(kPairs));
    std::printf(
        "%dD %s: %d boxes, %d overlap: %d wrong sides, %d too shallow, off by more than 0.1 %% + 1e-5 m on %.1f %%, "
        "at most %.2f times too deep\n",
        D, r->info.name.c_str(), seen.pairs, seen.overlaps, seen.wrongSides, seen.tooShallow,
        100.0 * seen.notMinimal / seen.overlaps, seen.deepest);
    EXPECT_GT(seen.overlaps, seen.pairs / 5);
    EXPECT_EQ(seen.wrongSides, 0) << r->info.name;
    EXPECT_EQ(seen.tooShallow, 0) << r->info.name;
    ++methods;
  }
  EXPECT_GE(methods, 1);
  SphereBoolean<D> spheres;
  EXPECT_GT(onPairs<D>(spheres, 200).wrongSides, 0) << "the planted bug was not caught";
  HalfDepth<D> half;
  EXPECT_GT(onPairs<D>(half, 200).tooShallow, 0) << "the planted bug was not caught";
  recordPlantedBug("approximate: bounding spheres tell the side", 1, 200);
  recordPlantedBug("approximate: half the depth", 1, 200);
}
TEST(ApproximatePairQuery, SideAndDepthOfBoxes2) { boxes<2>(); }
TEST(ApproximatePairQuery, SideAndDepthOfBoxes3) { boxes<3>(); }

// The tolerance concerns the depth: the side must be right at any tolerance.
template <int D>
void looselyOnEllipsoids() {
  for (const char* spec : {"mpr", "mpr{tolerance=0.01}", "mpr{tolerance=0.1}"}) {
    const Seen seen = onPairs<D>(*createStage<PairQuery<D>>(Spec::parse(spec)), 1000, Of::ellipsoids);
    EXPECT_GT(seen.overlaps, 100) << spec;
    EXPECT_LT(seen.overlaps, 900) << spec;
    EXPECT_EQ(seen.wrongSides, 0) << spec;
  }
  SphereBoolean<D> spheres;
  EXPECT_GT(onPairs<D>(spheres, 200, Of::ellipsoids).wrongSides, 0) << "the planted bug was not caught";
}
TEST(ApproximatePairQuery, SideOfEllipsoidsWhateverTheTolerance) { looselyOnEllipsoids<2>(), looselyOnEllipsoids<3>(); }

// Boxes that penetrate by less than both margins. The faces of their cores give the depth, without an expansion.
std::uint64_t facesOnContacts(const std::string& spec) {
  const auto method = createStage<PairQuery<3>>(Spec::parse(spec));
  PlainDraw draw(seedOf("margins on contacts"));
  WorkDone work;
  for (int i = 0; i < 200; ++i) {
    const auto half = [&] { return Vec<3>(draw.real(0.25, 0.75), draw.real(0.25, 0.75), draw.real(0.25, 0.75)); };
    const Vec<3> a = half(), b = half();
    const Real depth = Real(0.04) * draw.real(0.01, 1);  // a tenth of the least half extent is 0.025
    const Shape<3> A = Shape<3>::box(a, 0), B = Shape<3>::box(b, 0);
    const Pose<3> X_AB{{Real(0.2) * draw.real(-1, 1), a[1] + b[1] - depth, 0}, Rot<3>::vector({0, draw.real(0, 3), 0})};
    const std::array pair{PairView<3>{A.view(), B.view(), X_AB}};
    std::array<PairAnswer<3>, 1> answer;
    method->query(pair, QueryNeed::closestPoints, answer, {}, work);
    EXPECT_NEAR(answer[0].distance, -depth, kPairTolerance * 4) << spec;
  }
  return work[WorkCount::polytopeFaces];
}
TEST(ApproximatePairQuery, MarginsSpareExpansions) {
  EXPECT_EQ(facesOnContacts("core_margin"), 0u);
  EXPECT_GT(facesOnContacts("gjk_epa"), 0u);
  expectCaught("approximate: a margin that is not there", facesOnContacts("core_margin{margin=0.01}") == 0);
}

// A verification fails by a wrong side or a missing answer only. Wrong distances are recorded, but are no fault.
TEST(ApproximatePairQuery, FailsAVerificationByItsSideAlone) {
  LedgerKey key = subjectOf(StageKind::pairQuery, 3, "mpr{tolerance=1e-9}");
  LedgerEntry entry;
  entry[Tally::asked] = 10, entry[Tally::agree] = 5, entry[Tally::wrong] = 4, entry[Tally::hung] = 1;
  entry[Tally::wrongSide] = 2;
  EXPECT_EQ(faultsOfOurs(key, entry), 3);
  for (const char* exact : {"gjk_epa", "of_a_plugin_that_is_not_here"}) {
    key.method = exact;
    EXPECT_EQ(faultsOfOurs(key, entry), 5) << exact;
  }
  EXPECT_EQ(faultsOfOurs(subjectOf(StageKind::velocity, 3, "catto"), entry), 5) << "approximate, and no pair query";
  entry.role = AlgorithmRole::witness;
  EXPECT_EQ(faultsOfOurs(key, entry), 0);

  const VerifyTask task{.kindA = ShapeKind::box,
                        .kindB = ShapeKind::box,
                        .range = {.seed = 2, .first = 0, .count = 100},
                        .methods = {"mpr"}};
  const Verified booked = verify(task);
  long wrong = 0, faults = 0;
  for (const auto& [of, e] : booked.ledger) {
    if (of.axis == "all") wrong += e[Tally::wrong], faults += faultsOfOurs(of, e);
  }
  EXPECT_GT(wrong, 10) << "depths along another normal than the deepest are booked";
  EXPECT_EQ(faults, 0);
}

// Answers of mpr about hard pairs that are apart: how many are wrong, and how many of them have an error of the value.
struct JudgedApart {
  int asked = 0, wrong = 0, values = 0, wrongSides = 0;
};
JudgedApart judgedApart(ShapeKind a, ShapeKind b, bool claimsGap, bool turned = false) {
  const auto mpr = createStage<PairQuery<3>>(Spec{"mpr", {}});
  JudgedApart out;
  for (int i = 0; i < 200; ++i) {
    const HardPair<3> pair = hardPair<3>(a, b, 3, i);
    const PairView<3> view{pair.a.view(), pair.b.view(), pair.X_AB};
    const PairTruth<3> truth = pairTruth(view);
    if (!(truth.answer.interval().lo > pairTolerance() * truth.s)) continue;
    PairAnswer<3> answer = queryPair<3>(*mpr, view.a, view.b, view.X_AB);
    if (turned) answer.distance = -answer.distance;
    const Verdict v =
        judge(view, truth, answer, AlgorithmRole::competitor, Ending::answered, pairTolerance(), claimsGap);
    if (v.end == Tally::undecided) continue;
    ++out.asked, out.wrong += v.end == Tally::wrong, out.values += v.error.has_value(), out.wrongSides += v.wrongSide;
    EXPECT_EQ(v.sideAlone, !v.error.has_value());
  }
  return out;
}

// A method that claims no distance may give a lower bound of it for separated shapes.
TEST(ApproximatePairQuery, IsJudgedByWhatItClaims) {
  const auto mpr = createStage<PairQuery<3>>(Spec{"mpr", {}});
  for (const ShapeKind b : {ShapeKind::box, ShapeKind::ellipsoid}) {
    EXPECT_FALSE(mpr->claimsGap(ShapeKind::box, b));
    const JudgedApart seen = judgedApart(ShapeKind::box, b, false);
    EXPECT_GE(seen.asked, 50);
    EXPECT_EQ(seen.wrong + seen.values, 0);
    const JudgedApart turned = judgedApart(ShapeKind::box, b, false, true);
    EXPECT_EQ(turned.wrongSides, turned.asked) << "the side is claimed";
    expectCaught("approximate: judged by a gap that it does not claim",
                 judgedApart(ShapeKind::box, b, true).wrong == 0);
  }
  EXPECT_TRUE(mpr->claimsGap(ShapeKind::box, ShapeKind::plane));
  for (const char* other : {"gjk_epa", "core_margin", "sat"}) {
    EXPECT_TRUE(createStage<PairQuery<3>>(Spec{other, {}})->claimsGap(ShapeKind::box, ShapeKind::box)) << other;
  }
}

TEST(ApproximatePairQuery, FailsACaseByItsSideAlone) {
  CaseResult row{.id = "x", .method = "mpr", .verdict = CaseVerdict::wrong, .reason = "distance"};
  EXPECT_TRUE(isOurFault(row));
  row.sideAlone = true;
  EXPECT_FALSE(isOurFault(row));
  for (const char* side : {"side", "wrong_side"}) {  // of a published case; of a found case
    row.reason = side;
    EXPECT_TRUE(isOurFault(row));
  }
  row.verdict = CaseVerdict::failed, row.reason = "not_finite";
  EXPECT_TRUE(isOurFault(row));
}

// NaN and infinity end with QueryStatus::failed.
TEST(ApproximatePairQuery, NanAndInfinityFail) {
  const auto mpr = createStage<PairQuery<3>>(Spec{"mpr", {}});
  const Shape<3> box = Shape<3>::box({1, 1, 1}, 0), capsule = Shape<3>::capsule(1, Real(0.5));
  for (const Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
    for (const QueryNeed need : {QueryNeed::boolean, QueryNeed::distance, QueryNeed::closestPoints}) {
      for (const Shape<3>* other : {&box, &capsule}) {
        const Pose<3> X{{bad, 0, 0}, {}};
        EXPECT_EQ(queryPair<3>(*mpr, box.view(), other->view(), X, need).status, QueryStatus::failed) << bad;
      }
    }
  }
}

}  // namespace approximate_pair_query_test
}}}  // namespace lpc::LPC_PRECISION::test
