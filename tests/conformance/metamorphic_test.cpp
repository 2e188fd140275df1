// SPDX-License-Identifier: Zlib
// Relations between two answers of one pair query. The images of a pair must be what they claim, our methods must
// satisfy each relation, and each relation must catch a planted bug.
#include "oracles/verify/metamorphic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "oracles/verify/verify.h"
#include "tests/check_property.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/pair_query_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace metamorphic_test {

using namespace wrong_queries;

template <class F>
void forKinds(int dimension, ShapeKind last, const F& f) {
  for (int a = 0; a <= static_cast<int>(last); ++a) {
    for (int b = a; b <= static_cast<int>(last); ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (!kindExists(kindA, dimension) || !kindExists(kindB, dimension)) continue;
      if (coreClass(kindA) == CoreClass::plane && coreClass(kindB) == CoreClass::plane) continue;  // never meet
      f(kindA, kindB);
    }
  }
}
constexpr auto kLastKind = static_cast<ShapeKind>(kShapeKinds - 1);

// The referee has no method's faults: its interval for the image must be that for the pair, in the image's unit. So
// this test finds a wrong image, not a wrong method.
template <int D>
std::string imageFault(const RelatedPairs<D>& pairs) {
  const PairTruth<D> before = pairTruth(pairs.before.view()), after = pairTruth(pairs.after.view());
  if (!before.answer.decided || !after.answer.decided) return "";
  const double s = before.s + after.s / pairs.factor;
  const double lo = after.answer.lo / pairs.factor, hi = after.answer.hi / pairs.factor;
  const double apart = std::max({0.0, lo - before.answer.hi, before.answer.lo - hi});
  const double allowed = 16 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * s;
  if (apart <= allowed) return "";
  std::ostringstream text;
  text << before.answer.lo << " becomes " << lo << ", s " << s;
  return text.str();
}

template <int D>
void imagesAreRight() {
  std::map<Relation, int> drawn;
  forKinds(D, kLastKind, [&](ShapeKind a, ShapeKind b) {
    const bool curved = coreClass(a) == CoreClass::curved || coreClass(b) == CoreClass::curved;
    for (int i = 0; i < (curved ? 6 : 40); ++i) {
      const HardPair<D> pair = hardPair<D>(a, b, 11, i);
      for (std::size_t r = 0; r < kRelations; ++r) {
        const auto pairs = relatedPairs(static_cast<Relation>(r), pair, static_cast<std::uint64_t>(i));
        if (!pairs) continue;
        ++drawn[static_cast<Relation>(r)];
        ASSERT_EQ(imageFault(*pairs), "") << kRelationNames[r] << ' ' << shapeKindName(a) << ' ' << shapeKindName(b)
                                          << " pair " << i << ", " << pair.family;
      }
    }
  });
  for (std::size_t r = 0; r < kRelations; ++r) EXPECT_GE(drawn[static_cast<Relation>(r)], 100) << kRelationNames[r];
}
TEST(Metamorphic, ImagesAreRight2) { imagesAreRight<2>(); }
TEST(Metamorphic, ImagesAreRight3) { imagesAreRight<3>(); }

TEST(Metamorphic, WrongImagesAreSeen) {
  const HardPair<3> pair = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 11, 1);
  for (const Relation relation : {Relation::mirror, Relation::scale, Relation::translation, Relation::motion}) {
    auto pairs = *relatedPairs(relation, pair, 1);
    ASSERT_EQ(imageFault(pairs), "");
    pairs.after.X_AB.p *= 1 + std::sqrt(std::numeric_limits<Real>::epsilon());
    expectCaught("an image in the wrong place", imageFault(pairs).empty());
  }
}

// To the last bit: the mirror rounds nothing, so no tolerance is needed.
TEST(Metamorphic, MirroringTwiceRestoresThePair) {
  const HardPair<3> pair = hardPair<3>(ShapeKind::polytope, ShapeKind::polytope, 11, 2);
  for (std::uint64_t choice = 0; choice < 20; ++choice) {
    HardPair<3> image = pair;
    for (int turn = 0; turn < 2; ++turn) {
      const auto pairs = *relatedPairs(Relation::mirror, image, choice);
      image.a = pairs.after.a, image.b = pairs.after.b, image.X_AB = pairs.after.X_AB;
      EXPECT_EQ(pairs.after.a.view().hull->vertices != pair.a.view().hull->vertices, turn == 0);
    }
    EXPECT_EQ(image.b.view().hull->vertices, pair.b.view().hull->vertices);
    EXPECT_EQ(image.X_AB.p, pair.X_AB.p);
    EXPECT_EQ(image.X_AB.q.imag(), pair.X_AB.q.imag());
  }
}

template <int D>
void oursPass() {
  VerifyTask task{.dimension = D, .range = {.seed = 4}, .relations = true};
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role == AlgorithmRole::competitor) task.methods.push_back(r->info.name);
  }
  std::map<std::string, long> asked;
  forKinds(D, kLastKind, [&](ShapeKind a, ShapeKind b) {
    const bool curved = coreClass(a) == CoreClass::curved || coreClass(b) == CoreClass::curved;
    task.kindA = a, task.kindB = b, task.range.count = caseCount(curved ? 8 : 100);
    for (const auto& [key, entry] : verify(task).ledger) {
      EXPECT_EQ(key.axis, kRelationAxis);
      EXPECT_EQ(faultsOfOurs(key, entry), 0) << key.method << ' ' << key.value << ' ' << key.kindA << ' ' << key.kindB
                                             << ": " << entry[Tally::wrong] << " violated, by " << entry.maxError;
      // Rounding does not depend on the unit of length, except in single precision, which underflows sooner.
      const bool isScale = sizeof(Real) == 8 && key.value == kRelationNames[static_cast<std::size_t>(Relation::scale)];
      EXPECT_TRUE(!isScale || entry[Tally::tie] == 0) << key.method << ' ' << key.kindA << ' ' << key.kindB;
      asked[key.value] += entry[Tally::asked];
    }
  });
  EXPECT_EQ(asked.size(), kRelations);
}
TEST(Metamorphic, OursPass2) { oursPass<2>(); }
TEST(Metamorphic, OursPass3) { oursPass<3>(); }

template <int D, class Twin>
LedgerEntry violations(Relation relation) {
  const Candidate<PairQuery<D>> twin{"planted", {}, [] { return std::make_unique<Twin>(); }};
  Verified out;
  forKinds(D, ShapeKind::polytope, [&](ShapeKind a, ShapeKind b) {
    verifyRelations<D>(a, b, {.seed = 5, .first = 0, .count = D == 2 ? 200 : 40}, {&twin, 1}, out);
  });
  LedgerEntry sum;
  for (const auto& [key, entry] : out.ledger) {
    if (key.value == kRelationNames[static_cast<std::size_t>(relation)]) sum.add(entry);
  }
  EXPECT_GT(sum[Tally::asked], 0);
  return sum;
}

template <int D>
class Right final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>&, PairMemory*) override {}
};
/// Planted bug: no answer for some orders of the vertices.
template <int D>
class RefusesSomeOrders final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (pair.b.hull && pair.b.hull->vertices[0][0] > pair.b.hull->vertices[1][0]) answer.status = QueryStatus::failed;
  }
};

template <int D, class Twin>
void isCaught(const char* bug, Relation relation) {
  const LedgerEntry entry = violations<D, Twin>(relation);
  const std::string name(kRelationNames[static_cast<std::size_t>(relation)]);
  expectCaught(name + ", " + std::to_string(D) + "D: " + bug, entry[Tally::wrong] == 0);
  EXPECT_EQ((violations<D, Right<D>>(relation)[Tally::wrong]), 0) << name;
}
template <int D>
void bugsAreCaught() {
  isCaught<D, ForgetsRounding<D>>("B's rounding forgotten", Relation::swap);
  isCaught<D, NeverTurnsBack<D>>("a search that never turns back", Relation::mirror);
  isCaught<D, LikesOneAxis<D>>("one axis is not as the others", Relation::permutation);
  isCaught<D, AbsoluteTolerance<D>>("absolute tolerance", Relation::scale);
  isCaught<D, CoarsePoints<D>>("points with half the digits", Relation::translation);
  isCaught<D, AxisAlignedShortcut<D>>("short cut for boxes that are not turned", Relation::motion);
  if (sizeof(Real) == 4) return;
  const std::string bits = "scale, " + std::to_string(D) + "D: the last bits hang on the unit";
  expectCaught(bits, violations<D, RoundsInMetres<D>>(Relation::scale)[Tally::tie] == 0);
  EXPECT_EQ((violations<D, Right<D>>(Relation::scale)[Tally::tie]), 0);
}
TEST(Metamorphic, PlantedBugsAreCaught2) { bugsAreCaught<2>(); }
TEST(Metamorphic, PlantedBugsAreCaught3) {
  bugsAreCaught<3>();
  // In 2D the hull is sorted: queries do not see the original order of its points.
  isCaught<3, EverySecondVertex<3>>("every second vertex", Relation::extraVertices);
  const LedgerEntry entry = violations<3, RefusesSomeOrders<3>>(Relation::extraVertices);
  EXPECT_GT(entry[Tally::notFinite], 0);
  expectCaught("extra_vertices, 3D: one answer of two", entry[Tally::wrong] == 0);
}

}}}}  // namespace lpc::LPC_PRECISION::test::metamorphic_test
