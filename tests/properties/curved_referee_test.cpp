// SPDX-License-Identifier: Zlib
// The referee of curved cores and planes, against closed forms, against an independent branch and bound over
// directions, and against its promised width. Every method that supports such a pair is tested against it.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "framework/shape/curved_core.h"
#include "oracles/corpus/hard_pairs.h"
#include "oracles/referee/referee.h"
#include "oracles/referee/support_sweep.h"
#include "oracles/verify/verify.h"
#include "tests/check_property.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace curved_referee_test { namespace {

// Calls f(kindA, kindB) for every two bounded kinds with a curved one among them.
template <int D, class F>
void forCurvedPairs(F&& f) {
  for (int b = 0; b < kShapeKinds; ++b) {
    for (int a = 0; a <= b; ++a) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      const bool curved = coreClass(kindA) == CoreClass::curved || coreClass(kindB) == CoreClass::curved;
      const bool plane = coreClass(kindA) == CoreClass::plane || coreClass(kindB) == CoreClass::plane;
      if (curved && !plane && kindExists(kindA, D) && kindExists(kindB, D)) f(kindA, kindB);
    }
  }
}

Shape<3> cylinder(Real halfLength, Real radius) {
  const Real sizes[2] = {halfLength, radius};
  return Shape<3>::curved(ShapeKind::cylinder, sizes);
}
Shape<3> ellipsoid(Real x, Real y, Real z) {
  const Real sizes[3] = {x, y, z};
  return Shape<3>::curved(ShapeKind::ellipsoid, sizes);
}

void expectPhi(const Shape<3>& a, const Shape<3>& b, const Pose<3>& X_AB, double phi, double width) {
  const RefereeAnswer<3> answer = referee<3>(a.view(), Pose<3>{}, b.view(), X_AB);
  ASSERT_TRUE(answer.decided);
  EXPECT_LE(answer.lo, phi + 1e-15);
  EXPECT_GE(answer.hi, phi - 1e-15);
  EXPECT_LE(answer.hi - answer.lo, width);
}

TEST(CurvedReferee, ClosedForms) {
  const double pi = 3.14159265358979323846;
  // End on end, side beside side, overlapping along the axis and across it.
  expectPhi(cylinder(1, 0.5), cylinder(2, 0.5), {{3.25, 0.125, 0}, {}}, 0.25, 1e-13);
  expectPhi(cylinder(1, 0.5), cylinder(2, 0.5), {{0, 0, 1.25}, {}}, 0.25, 1e-13);
  expectPhi(cylinder(1, 0.5), cylinder(1, 0.5), {{1.75, 0.125, 0}, {}}, -0.25, 1e-6);
  expectPhi(cylinder(1, 0.5), cylinder(1, 0.5), {{0.125, 0, 0.75}, {}}, -0.25, 1e-6);
  // Crossed sides: the distance of the axes less the radii.
  expectPhi(cylinder(2, 0.5), cylinder(2, 0.25), {{0, 0, 1}, Rot<3>::vector({0, 0, Real(pi / 2)})}, 0.25, 1e-13);
  // A ball beside the end's rim.
  expectPhi(cylinder(1, 0.5), Shape<3>::sphere(0.5), {{4, 4.5, 0}, {}}, 4.5, 1e-13);
  // An ellipsoid with equal axes is a ball; an ellipsoid on a box touches with its pole.
  expectPhi(ellipsoid(1, 1, 1), ellipsoid(0.5, 0.5, 0.5), {{0, 2, 0}, {}}, 0.5, 1e-13);
  expectPhi(ellipsoid(1, 1, 1), ellipsoid(0.5, 0.5, 0.5), {{0, 1.25, 0}, {}}, -0.25, 1e-6);
  expectPhi(Shape<3>::box(Vec<3>(4, 1, 4)), ellipsoid(3, 0.5, 2), {{0.5, 1.75, 0.25}, {}}, 0.25, 1e-13);
  expectPhi(Shape<3>::box(Vec<3>(4, 1, 4)), ellipsoid(3, 0.5, 2), {{0.5, 1.25, 0.25}, {}}, -0.25, 1e-6);
  // A plane below shapes, as A and as B.
  expectPhi(Shape<3>::box(Vec<3>(1, 2, 3)), Shape<3>::plane(), {{7, -2.5, 1}, {}}, 0.5, 1e-15);
  expectPhi(Shape<3>::plane(), ellipsoid(3, 0.5, 2), {{9, 0.25, 9}, {}}, -0.25, 1e-15);
  expectPhi(Shape<3>::plane(), Shape<3>::sphere(0.5), {{0, -3, 0}, {}}, -3.5, 1e-15);
  EXPECT_FALSE(referee<3>(Shape<3>::plane().view(), Pose<3>{}, Shape<3>::plane().view(), Pose<3>{}).decided);
}

// The referee's interface, also for wrong referees.
template <int D>
using Referee = RefereeAnswer<D> (*)(const ShapeView<D>&, const Pose<D>&, const ShapeView<D>&, const Pose<D>&);

// The number of pairs that contradict the sweep over directions: both intervals contain phi, so they must overlap.
template <int D>
int contradictions(Referee<D> judge, int count) {
  int found = 0;
  forCurvedPairs<D>([&](ShapeKind a, ShapeKind b) {
    for (int i = 0; i < count; ++i) {
      const HardPair<D> pair = hardPair<D>(a, b, 21, i);
      const RefereeAnswer<D> answer = judge(pair.a.view(), {}, pair.b.view(), pair.X_AB);
      if (!answer.decided) continue;
      const double s = errorScale<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB, answer.interval().middle());
      const SweepLimits limits{.width = 1e-3 * s, .maxCells = 4000};
      const Interval sweep = sweepDirections<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB, limits);
      const double rounding = 1e-14 * s;
      found += answer.lo > sweep.hi + rounding || answer.hi < sweep.lo - rounding;
    }
  });
  return found;
}

template <int D>
RefereeAnswer<D> forgetsTheRounding(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                    const Pose<D>& X_WB) {
  ShapeView<D> bare = b;
  bare.radius = 0;
  return referee<D>(a, X_WA, bare, X_WB);
}
template <int D>
RefereeAnswer<D> shallow(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB) {
  RefereeAnswer<D> answer = referee<D>(a, X_WA, b, X_WB);
  if (answer.hi < 0) answer.lo *= 0.9, answer.hi *= 0.9;
  return answer;
}

template <int D>
void agreesWithTheSweep() {
  EXPECT_EQ(contradictions<D>(&referee<D>, 20), 0);
  EXPECT_GT(contradictions<D>(&forgetsTheRounding<D>, 20), 0);
  EXPECT_GT(contradictions<D>(&shallow<D>, 20), 0);
}
TEST(CurvedReferee, AgreesWithASweepOverDirections2) { agreesWithTheSweep<2>(); }
TEST(CurvedReferee, AgreesWithASweepOverDirections3) { agreesWithTheSweep<3>(); }

// Widths: at most 1e-13 s if apart. If overlapping, at most 1e-6 s, or undecided. Only rings of minima are undecided;
// the families of ties, core contacts and shared planes draw them on purpose.
template <int D>
void widths() {
  int narrow = 0, undecided = 0, strays = 0;
  std::vector<double> apart, overlapping;
  forCurvedPairs<D>([&](ShapeKind a, ShapeKind b) {
    for (int i = 0; i < 60; ++i) {
      const HardPair<D> pair = hardPair<D>(a, b, 22, i);
      const RefereeAnswer<D> answer = referee<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB);
      const double s = errorScale<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB, answer.interval().middle());
      const double width = answer.interval().width() / s;
      const bool ring = pair.family == "ties" || pair.family == "core_contact" || pair.family == "shared_planes";
      if (!answer.decided) {
        ++undecided, strays += !ring;
      } else if (answer.hi > 0) {
        apart.push_back(width);
        EXPECT_LE(width, 1e-13);
      } else {
        overlapping.push_back(width), narrow += width <= 1e-9;
        EXPECT_LE(width, 1e-6);
      }
    }
  });
  const double both = static_cast<double>(apart.size() + overlapping.size()), asked = both + undecided;
  EXPECT_GE(static_cast<double>(apart.size()), asked / 4);
  EXPECT_GE(narrow, 0.98 * static_cast<double>(overlapping.size())) << narrow << " of " << overlapping.size();
  EXPECT_LE(undecided, 0.05 * asked) << undecided << " of " << asked;
  EXPECT_LE(strays, 0.01 * asked) << strays << " of " << asked;
  const auto line = [](const char* what, std::vector<double>& w) {
    std::sort(w.begin(), w.end());
    std::cout << "  " << what << ' ' << w.size() << ": median " << w[w.size() / 2] << ", 99 % "
              << w[w.size() * 99 / 100] << ", most " << w.back() << '\n';
  };
  std::cout << D << "D, width / s, undecided " << undecided << " of " << asked << '\n';
  line("apart", apart), line("overlapping", overlapping);
}
TEST(CurvedReferee, WidthIsAsPromised2) { widths<2>(); }
TEST(CurvedReferee, WidthIsAsPromised3) { widths<3>(); }

// Every competitor on every two kinds with a curved one, a plane or a triangle among them: no wrong answers, no
// refusals. An approximate pair query must only give the right side.
template <int D>
void methodsAreRight(StageKind stage, int count) {
  std::map<std::string, LedgerEntry> sums;
  std::map<std::string, long> faults;
  for (int b = 0; b < kShapeKinds; ++b) {
    for (int a = 0; a <= b; ++a) {
      VerifyTask task{.stage = stage,
                      .dimension = D,
                      .kindA = static_cast<ShapeKind>(a),
                      .kindB = static_cast<ShapeKind>(b),
                      .range = {.seed = 23, .first = 0, .count = count}};
      const bool late = static_cast<ShapeKind>(b) > ShapeKind::polytope;
      if (!late || !kindExists(task.kindA, D) || !kindExists(task.kindB, D)) continue;
      const bool planes = coreClass(task.kindA) == CoreClass::plane && coreClass(task.kindB) == CoreClass::plane;
      if (planes) continue;  // they never meet
      for (const Registered* r : Registry::instance().list(stage, D)) {
        if (r->info.role == AlgorithmRole::competitor) task.methods.push_back(r->info.name);
      }
      const Verified verified = verify(task);
      for (const auto& [key, entry] : verified.ledger) {
        if (key.axis == "all") sums[key.method].add(entry), faults[key.method] += faultsOfOurs(key, entry);
      }
      for (const auto& [name, c] : verified.found) {
        const bool side = c.failure != "wrong_distance" && c.failure != "wrong_normal";
        if (!side && owesSideAlone(stage, Registry::instance().find(stage, D, name.first).info)) continue;
        ADD_FAILURE() << name.first << ' ' << c.failure << ": " << c.text;
      }
    }
  }
  ASSERT_FALSE(sums.empty());
  for (const auto& [method, sum] : sums) {
    EXPECT_EQ(faults[method], 0) << method << " of " << sum[Tally::asked] << ", worst " << sum.maxError;
    EXPECT_LE(sum[Tally::undecided], 0.1 * static_cast<double>(sum[Tally::asked])) << method;
    ::testing::Test::RecordProperty(method, std::to_string(sum.maxError));
  }
}
TEST(CurvedPairs, QueriesAreRight2) { methodsAreRight<2>(StageKind::pairQuery, 100); }
TEST(CurvedPairs, QueriesAreRight3) { methodsAreRight<3>(StageKind::pairQuery, 60); }
TEST(CurvedPairs, ContactsAreRight2) { methodsAreRight<2>(StageKind::contacts, 60); }
TEST(CurvedPairs, ContactsAreRight3) { methodsAreRight<3>(StageKind::contacts, 30); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::curved_referee_test
