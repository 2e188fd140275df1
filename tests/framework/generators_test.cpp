// SPDX-License-Identifier: Zlib
// Tests of the generators: a family that is never drawn, or pairs that never touch, would test nothing.
#include "tests/generators.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/check_property.h"
#include "tests/direction_search.h"
#include "tests/run_property.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace generators_test { namespace {

// The separation along d (unit, from A to B). In no direction does it exceed the true distance.
template <int D>
Real along(const ShapePairCase<D>& c, const Vec<D>& d) {
  const Pose<D> X = c.X_AB();
  const Vec<D> local = X.q.inverse() * Vec<D>(-d);
  return X.p.dot(d) - supportValue(c.a.view(), d) - supportValue(c.b.view(), local);
}

template <int D>
void familiesAndHits() {
  PlainDraw draw(1);
  std::map<std::string, int> drawn, hits;
  const int n = 3200;
  int hit = 0, known = 0;
  for (int i = 0; i < n; ++i) {
    const auto c = drawShapePair<D>(draw);
    const Real scale = sizeOf(c.a) + sizeOf(c.b) + c.X_AB().p.norm();
    const Real distance = maxOverDirections<D>([&](const Vec<D>& d) { return along(c, d); });
    ++drawn[c.family];
    if (distance < 0) ++hit, ++hits[c.family];
    if (c.distance) {
      ++known;
      // The search does not know the direction of the construction: it may find less, but never more.
      EXPECT_LE(distance, *c.distance + 64 * kEps * (scale + c.X_WA.p.norm())) << c;
    }
  }
  for (const std::string_view family : kFamilies) {
    EXPECT_GE(drawn[std::string(family)], n / 32) << family;
    std::printf("%dD %-16s %5d drawn, %3d %% hit\n", D, std::string(family).c_str(), drawn[std::string(family)],
                100 * hits[std::string(family)] / std::max(1, drawn[std::string(family)]));
  }
  EXPECT_LE(2 * drawn["random"], n) << "families must be at least half";
  std::printf("%dD all %d, %.1f %% hit, %d with known distance\n", D, n, 100.0 * hit / n, known);
  EXPECT_GE(hit, n * 30 / 100);
  EXPECT_LE(hit, n * 70 / 100);
  EXPECT_GE(known, n / 10);
}

TEST(Generators, FamiliesAndHits2) { familiesAndHits<2>(); }
TEST(Generators, FamiliesAndHits3) { familiesAndHits<3>(); }

// Each kind, alone and in pairs, occurs at least half as often as in a uniform draw.
template <int D>
void everyKind() {
  PlainDraw draw(3);
  constexpr int n = 2000, kinds = D == 2 ? 5 : 4;
  std::map<std::string_view, int> alone;
  std::map<std::pair<ShapeKind, ShapeKind>, int> pairs;
  for (int i = 0; i < n; ++i) {
    ++alone[shapeKindName(drawShape<D>(draw).kind())];
    const auto c = drawShapePair<D>(draw);
    ++pairs[std::minmax({c.a.kind(), c.b.kind()})];
  }
  EXPECT_EQ(alone.size(), std::size_t{kinds});
  for (const auto& [kind, count] : alone) {
    std::printf("%dD %-8s %d of %d\n", D, std::string(kind).c_str(), count, n);
    EXPECT_GE(count, n / kinds / 2) << kind;
  }
  EXPECT_EQ(pairs.size(), std::size_t{kinds * (kinds + 1) / 2});
  for (const auto& [kind, count] : pairs) {
    std::printf("%dD %-8s %-8s %d of %d\n", D, std::string(shapeKindName(kind.first)).c_str(),
                std::string(shapeKindName(kind.second)).c_str(), count, n);
    EXPECT_GE(count, n / kinds / kinds / 4) << shapeKindName(kind.first) << ", " << shapeKindName(kind.second);
  }
}
TEST(Generators, EveryKind2) { everyKind<2>(); }
TEST(Generators, EveryKind3) { everyKind<3>(); }

// A wrong property must shrink to a simple counterexample: no polytopes, no rotation.
TEST(Generators, CounterexamplesShrink) {
  const auto result = runProperty(
      "no pair lies apart along x", [] { RC_ASSERT((*shapePairs<3>()).X_AB().p[0] <= Real(2)); }, 500);
  ASSERT_TRUE(result.is<rc::detail::FailureResult>());
  const auto& failure = result.get<rc::detail::FailureResult>();
  ASSERT_FALSE(failure.counterExample.empty());
  const std::string text = failure.counterExample.front().second;
  EXPECT_EQ(text.find("polytope"), std::string::npos) << text;
  EXPECT_NE(text.find("name = \"A\"\nposition = [0, 0, 0]\nangle = [0, 0, 0]\nshapes = [{ kind = \""),
            std::string::npos)
      << text;
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::generators_test
