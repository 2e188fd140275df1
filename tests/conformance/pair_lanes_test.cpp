// SPDX-License-Identifier: Zlib
// Many pairs at once, with each instruction set of this processor, give the same bits and the same work as the pairs
// one after the other. The lanes must answer most pairs themselves; otherwise the test would prove nothing about them.
#include "algorithms/pair_query/lanes/pair_lanes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>

#include "oracles/corpus/hard_pairs.h"
#include "tests/draw.h"
#include "tests/each_target.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace pair_lanes_test {

using Kinds = std::pair<ShapeKind, ShapeKind>;
constexpr Kinds kOfLanes[] = {
    {ShapeKind::sphere, ShapeKind::sphere}, {ShapeKind::capsule, ShapeKind::capsule}, {ShapeKind::box, ShapeKind::box}};

// Shapes and views of pairs of two kinds: hard ones, and every eighth degenerate for any formula.
class PairPool {
 public:
  PairPool(Kinds kinds, int count) {
    PlainDraw draw(7);
    for (int i = 0; i < count; ++i) {
      const HardPair<3> pair = hardPair<3>(kinds.first, kinds.second, 7, i);
      m_a.push_back(pair.a), m_b.push_back(pair.b), m_X.push_back(pair.X_AB);
      if (i % 8 != 0) continue;
      constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
      const Real factor = draw.pick({Real(0), std::numeric_limits<Real>::min(), std::sqrt(kEps), 1 / kEps, kInfinity,
                                     std::numeric_limits<Real>::max(), std::numeric_limits<Real>::quiet_NaN()});
      m_X.back().p *= factor;
      if (draw.coin()) m_X.back().q = {};
    }
    for (std::size_t i = 0; i < m_X.size(); ++i) m_views.push_back({m_a[i].view(), m_b[i].view(), m_X[i]});
  }
  std::span<const PairView<3>> views() const { return m_views; }

 private:
  std::vector<Shape<3>> m_a, m_b;
  std::vector<Pose<3>> m_X;
  std::vector<PairView<3>> m_views;
};

bool sameBits(const PairAnswer<3>& a, const PairAnswer<3>& b) {
  using Bits = std::conditional_t<sizeof(Real) == 8, std::uint64_t, std::uint32_t>;
  const auto same = [](Real x, Real y) { return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y); };
  bool all = a.status == b.status && same(a.distance, b.distance);
  for (int k = 0; k < 3; ++k) {
    all = all && same(a.normal[k], b.normal[k]) && same(a.pA[k], b.pA[k]) && same(a.pB[k], b.pB[k]);
  }
  return all;
}

// Batches of 1, 2, 3 and so on, as many as the pairs allow. Returns how many pairs or batch counts of work differ.
int differences(PairQuery<3>& many, PairQuery<3>& one, std::span<const PairView<3>> pairs, QueryNeed need) {
  int out = 0;
  std::vector<PairAnswer<3>> answers, wanted;
  for (std::size_t begin = 0, size = 1; begin + size <= pairs.size(); begin += size, size = size % 100 + 1) {
    answers.assign(size, {}), wanted.assign(size, {});
    WorkDone work, wantedWork;
    many.query(pairs.subspan(begin, size), need, answers, {}, work);
    one.query(pairs.subspan(begin, size), need, wanted, {}, wantedWork);
    out += work.counts != wantedWork.counts;
    for (std::size_t i = 0; i < size; ++i) out += !sameBits(answers[i], wanted[i]);
  }
  return out;
}

constexpr QueryNeed kNeeds[] = {QueryNeed::boolean, QueryNeed::distance, QueryNeed::closestPoints};

TEST(PairLanes, HaveTheBitsOfTheScalarCode) {
  for (const char* name : {"closed_form", "sat"}) {
    const auto many = createStage<PairQuery<3>>(Spec{name, {}});
    const auto one = createStage<PairQuery<3>>(Spec::parse(std::string(name) + "{lanes=scalar}"));
    for (int a = 0; a < kShapeKinds; ++a) {
      for (int b = a; b < kShapeKinds; ++b) {
        const Kinds kinds{static_cast<ShapeKind>(a), static_cast<ShapeKind>(b)};
        if (!kindExists(kinds.first, 3) || !kindExists(kinds.second, 3)) continue;
        if (!many->supports(kinds.first, kinds.second)) continue;
        const bool ofLanes = std::find(std::begin(kOfLanes), std::end(kOfLanes), kinds) != std::end(kOfLanes);
        const PairPool pool(kinds, ofLanes ? 11000 : 500);
        forEachTarget([&](std::int64_t target) {
          for (const QueryNeed need : kNeeds) {
            EXPECT_EQ(differences(*many, *one, pool.views(), need), 0)
                << name << ' ' << shapeKindName(kinds.first) << ' ' << shapeKindName(kinds.second) << " by "
                << hwy::TargetName(target) << ", need " << static_cast<int>(need);
          }
        });
      }
    }
  }
}

TEST(PairLanes, AnswerMostPairs) {
  WorkDone work;
  std::vector<PairAnswer<3>> answers(pair_query::kMostLanePairs);
  for (const Kinds& kinds : kOfLanes) {
    const PairPool pool(kinds, 100 * static_cast<int>(answers.size()));
    forEachTarget([&](std::int64_t target) {
      int answered = 0;
      for (std::size_t begin = 0; begin < pool.views().size(); begin += answers.size()) {
        const auto pairs = pool.views().subspan(begin, answers.size());
        const std::uint64_t left = kinds.first == ShapeKind::sphere ? pair_query::ballsInLanes(pairs, answers)
                                   : kinds.first == ShapeKind::capsule
                                       ? pair_query::segmentsInLanes(pairs, QueryNeed::closestPoints, answers, work)
                                       : pair_query::boxesInLanes(pairs, QueryNeed::closestPoints, answers, work);
        answered += 64 - std::popcount(left);
      }
      std::printf("%s by %s: %d of %zu\n", std::string(shapeKindName(kinds.first)).c_str(), hwy::TargetName(target),
                  answered, pool.views().size());
      // At least a third, on the hardest pairs. No answers where the target has one lane, or where a wider one is not
      // compiled.
      if (target == HWY_AVX2 || target == HWY_SSE4 || target == HWY_NEON) {
        EXPECT_GT(3 * answered, static_cast<int>(pool.views().size()));
      }
    });
  }
}

// Planted bugs, each in one pair of a batch that lanes would answer. Either the last bit differs, as by a fused
// multiply-add. Or the answer is the neighbour's, as by a lane stored one off. Or the work is not counted.
class Spoiled final : public PairQuery<3> {
 public:
  enum Way { lastBit, neighbour, uncounted };
  Spoiled(PairQuery<3>& right, Way way) : m_right(right), m_way(way) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right.supports(a, b); }
  void query(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_right.query(pairs, need, answers, memory, work);
    if (pairs.size() < pair_query::kFewestLanePairs) return;
    if (m_way == lastBit) answers[3].pB[1] = std::nextafter(answers[3].pB[1], Real(0));
    if (m_way == neighbour) answers[3] = answers[4];
    if (m_way == uncounted) work[WorkCount::axisTests] -= 1;
  }

 private:
  PairQuery<3>& m_right;
  Way m_way;
};
TEST(PairLanes, PlantedBugsAreSeen) {
  const auto right = createStage<PairQuery<3>>(Spec{"sat", {}});
  const PairPool pool({ShapeKind::box, ShapeKind::box}, 100);
  for (const auto& [way, bug] : {std::pair(Spoiled::lastBit, "last bit"),
                                 {Spoiled::neighbour, "neighbour"},
                                 {Spoiled::uncounted, "uncounted"}}) {
    Spoiled twin(*right, way);
    expectCaught(std::string("pair lanes: ") + bug,
                 differences(twin, *right, pool.views(), QueryNeed::closestPoints) == 0);
  }
}

}  // namespace pair_lanes_test
}}}  // namespace lpc::LPC_PRECISION::test
