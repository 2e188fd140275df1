// SPDX-License-Identifier: Zlib
// Every competing pair query against the referee, on pairs of all families: the error measure of all accuracy claims.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "framework/math/check.h"
#include "framework/math/tolerances.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/corpus/hard_pairs.h"
#include "oracles/referee/referee.h"
#include "tests/check_property.h"
#include "tests/generators.h"
#include "tests/kept_failures.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace pair_query_truth_test {

// |phi - phi_ref| / s, and by how much the separation along the returned normal is less than phi_ref.
constexpr double kBound = sizeof(Real) == 8 ? 1e-12 : 1e-5;

struct Tally {
  std::vector<double> errors;  // the larger error of distance and normal
  int wrongSigns = 0, unanswered = 0;
  std::string worst;

  bool right() const { return wrongSigns == 0 && unanswered == 0 && errors.back() <= kBound; }
};

template <int D>
struct JudgedPair {
  ShapePairCase<D> c;
  Pose<D> X_AB;
  RefereeAnswer<D> truth;
  double s = 0;
};

// Methods are queried with X_AB. The referee judges that same input, not the world poses that were rounded to it.
template <int D>
std::vector<JudgedPair<D>> judgedPairs(int count) {
  PlainDraw draw(17);
  std::vector<JudgedPair<D>> out;
  int refused = 0;  // slivers that are flat in single precision: the hull refuses them
  while (static_cast<int>(out.size()) < count) {
    JudgedPair<D> p;
    try {
      p.c = drawShapePair<D>(draw);
    } catch (const UserError&) {
      ++refused;
      continue;
    }
    p.X_AB = p.c.X_AB();
    p.truth = referee(p.c.a.view(), Pose<D>{}, p.c.b.view(), p.X_AB);
    p.s = errorScale(p.c.a.view(), Pose<D>{}, p.c.b.view(), p.X_AB, p.truth.lo);
    out.push_back(std::move(p));
  }
  EXPECT_LE(refused, 1 + count / 1000);
  return out;
}

// `errors` is sorted. For an approximate method, an error is the excess of its distance over the truth, or over the
// separation along its own normal. The side is judged for every method.
template <int D>
Tally against(PairQuery<D>& method, QueryNeed need, const std::vector<JudgedPair<D>>& pairs,
              Guarantee guarantee = Guarantee::exact) {
  Tally tally;
  double largest = -1;
  for (const JudgedPair<D>& p : pairs) {
    const ShapeView<D>&a = p.c.a.view(), &b = p.c.b.view();
    if (!method.supports(std::min(a.kind, b.kind), std::max(a.kind, b.kind))) continue;
    const PairAnswer<D> answer = queryPair(method, a, b, p.X_AB, need);
    const double distance = static_cast<double>(answer.distance);
    const bool answered = answer.status != QueryStatus::refused && answer.status != QueryStatus::failed;
    if (!p.truth.decided || !answered || !std::isfinite(distance)) {
      ++tally.unanswered;
      continue;
    }
    const Interval phi = p.truth.interval();
    if ((distance < 0) != (phi.lo < 0) && std::abs(phi.middle()) > kBound * p.s) ++tally.wrongSigns;
    double error = 0;  // a boolean query has only a sign
    if (need != QueryNeed::boolean) {
      const Vecd<D> n = answer.normal.template cast<double>();
      const bool unit = std::abs(n.norm() - 1) <= static_cast<double>(kUnitTolerance);
      const double along = unit ? separationAlong(a, Pose<D>{}, b, p.X_AB, n).hi : distance - p.s;
      error = guarantee == Guarantee::approximate ? std::max({distance - phi.hi, distance - along, 0.0}) / p.s
                                                  : std::max(phi.distanceTo(distance), phi.lo - along) / p.s;
    }
    if (error > largest) {
      std::ostringstream text;
      text << p.c << "  answer " << distance << " truth " << phi.lo;
      largest = error, tally.worst = text.str();
    }
    tally.errors.push_back(error);
  }
  std::sort(tally.errors.begin(), tally.errors.end());
  return tally;
}

template <int D>
void competitorsAgree() {
  const auto pairs = judgedPairs<D>(caseCount(10000));
  for (const Registered* entry : Registry::instance().list(StageKind::pairQuery, D)) {
    if (entry->info.role != AlgorithmRole::competitor) continue;
    const auto method = createStage<PairQuery<D>>(Spec{entry->info.name, {}});
    for (const QueryNeed need : {QueryNeed::closestPoints, QueryNeed::distance, QueryNeed::boolean}) {
      const Tally tally = against<D>(*method, need, pairs, entry->info.guarantee);
      if (entry->info.guarantee == Guarantee::approximate && need != QueryNeed::boolean) {
        EXPECT_FALSE(against<D>(*method, need, pairs).right()) << entry->info.name << " is exact, and may say so";
      }
      ASSERT_FALSE(tally.errors.empty()) << entry->info.name;
      const std::size_t n = tally.errors.size();
      std::printf("%dD %-12s %-9s %6zu pairs, error/s median %.1e, 99.9 %% %.1e, worst %.1e; wrong signs %d\n", D,
                  entry->info.name.c_str(),
                  need == QueryNeed::closestPoints ? "witnesses"
                  : need == QueryNeed::distance    ? "distance"
                                                   : "boolean",
                  n, tally.errors[n / 2], tally.errors[n * 999 / 1000], tally.errors.back(), tally.wrongSigns);
      EXPECT_TRUE(tally.right()) << entry->info.name << ", unanswered " << tally.unanswered << ", wrong signs "
                                 << tally.wrongSigns << "\n"
                                 << tally.worst;
    }
  }
}
TEST(PairQueryTruth, CompetitorsAgreeWithTheReferee2) { competitorsAgree<2>(); }
TEST(PairQueryTruth, CompetitorsAgreeWithTheReferee3) { competitorsAgree<3>(); }

// In f32, a box and a far larger hull that overlap by some roundings of the hull's size. GJK places the origin outside,
// and EPA's thin triangles end at a depth a third too large; only the edges at the contact give the right depth.
TEST(PairQueryTruth, RoundingDoesNotDecideTheSide) {
  const HardPair<3> c = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 7001, 13658);
  const auto truth = referee(c.a.view(), Pose<3>{}, c.b.view(), c.X_AB);
  ASSERT_TRUE(truth.decided);
  const double drawn = sizeof(Real) == 4 ? -2.4753415597e-4 : truth.lo;
  ASSERT_NEAR(truth.lo, drawn, 1e-12) << "another pair is drawn: find that one again";
  const double s = errorScale(c.a.view(), Pose<3>{}, c.b.view(), c.X_AB, truth.lo);
  const auto answer = queryPair(*createStage<PairQuery<3>>(Spec{"gjk_epa", {}}), c.a.view(), c.b.view(), c.X_AB);
  EXPECT_LE(truth.interval().distanceTo(static_cast<double>(answer.distance)), kBound / 10 * s);
}

// Planted bugs around a right method: each must be found within the usual number of pairs.
template <int D>
class Spoiled final : public PairQuery<D> {
 public:
  enum Way { offByMore, flippedNormal, missedTouch, neverAnswers, leaningNormal, halfTheDigits };
  Spoiled(PairQuery<D>& method, Way way) : m_method(method), m_way(way) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_method.supports(a, b); }
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_method.query(pairs, need, answers, memory, work);
    for (PairAnswer<D>& answer : answers) {
      if (m_way == offByMore) answer.distance *= 1 + static_cast<Real>(50 * kBound);
      if (m_way == flippedNormal) answer.normal = -answer.normal;
      if (m_way == missedTouch && answer.distance < 0 && answer.distance > Real(-0.01)) answer.distance = Real(0.01);
      if (m_way == neverAnswers && answer.distance == 0) answer.status = QueryStatus::failed;
      if (m_way == halfTheDigits) {  // as if computed in a lower precision
        int exponent = 0;
        const Real kept = std::ldexp(Real(1), std::numeric_limits<Real>::digits / 2);
        const Real mantissa = std::round(std::frexp(answer.distance, &exponent) * kept) / kept;
        answer.distance = std::ldexp(mantissa, exponent);
      }
      if (m_way == leaningNormal) {
        answer.normal += static_cast<Real>(50 * kBound) * tangents(answer.normal).col(0);
        answer.normal /= answer.normal.norm();
      }
    }
  }

 private:
  PairQuery<D>& m_method;
  Way m_way;
};

template <int D>
void spoiledAreSeen(const char* name) {
  const auto method = createStage<PairQuery<D>>(Spec{name, {}});
  const Guarantee guarantee = Registry::instance().find(StageKind::pairQuery, D, name).info.guarantee;
  const auto pairs = judgedPairs<D>(2000);
  using S = Spoiled<D>;
  for (const auto way :
       {S::offByMore, S::flippedNormal, S::missedTouch, S::neverAnswers, S::leaningNormal, S::halfTheDigits}) {
    S spoiled(*method, way);
    EXPECT_FALSE(against<D>(spoiled, QueryNeed::closestPoints, pairs, guarantee).right())
        << "way " << way << " was not seen of " << name;
  }
}
TEST(PairQueryTruth, SpoiledMethodsAreSeen) {
  for (const char* name : {"gjk_epa", "mpr"}) spoiledAreSeen<2>(name), spoiledAreSeen<3>(name);
}

// --- N21: the same numbers in both precisions -----------------------------------------------------------------------

// Sizes, points, positions and rotations that float holds exactly. Both builds then answer the same query, and differ
// by no more than the sum of their bounds against the referee.
template <int D>
class FloatPairs {
 public:
  JudgedPair<D> draw() {
    JudgedPair<D> p;
    p.c.family = "float numbers";
    p.c.a = shape(), p.c.b = shape();
    for (int k = 0; k < D; ++k) p.X_AB.p[k] = number(-3, 3);
    p.X_AB.q = turn();
    p.c.X_WB = p.X_AB;
    p.truth = referee(p.c.a.view(), Pose<D>{}, p.c.b.view(), p.X_AB);
    p.s = errorScale(p.c.a.view(), Pose<D>{}, p.c.b.view(), p.X_AB, p.truth.lo);
    return p;
  }
  std::uint64_t hash() const { return hashOf(m_numbers.str()); }

 private:
  Real number(double lo, double hi) {
    const auto x = static_cast<float>(lo + (hi - lo) * m_draw.below(1000001) / 1e6);
    m_numbers << std::hexfloat << x << ' ';
    return Real(x);
  }
  Shape<D> shape() {
    const int kind = m_draw.below(4);
    if (kind == 0) return Shape<D>::sphere(number(0.1, 1));
    if (kind == 1) return Shape<D>::capsule(number(0.1, 1), number(0.1, 1));
    if (kind == 2) {
      Vec<D> half;
      for (int k = 0; k < D; ++k) half[k] = number(0.1, 1);
      return Shape<D>::box(half, m_draw.coin() ? number(0.01, 0.1) : Real(0));
    }
    std::vector<Vec<D>> points;  // on both sides of each axis, so that they span a volume, turned at random
    for (int k = 0; k < 2 * D; ++k) {
      Vec<D> p;
      for (int d = 0; d < D; ++d) p[d] = number(-0.3, 0.3);
      p[k / 2] = k % 2 ? number(0.5, 1) : number(-1, -0.5);
      points.push_back(p);
    }
    return Shape<D>::polytope(std::span<const Vec<D>>(points));
  }
  // All components are 0, 1 or 1/2.
  Rot<D> turn() {
    const int k = m_draw.below(D == 2 ? 4 : 12);
    m_numbers << k << ' ';
    if constexpr (D == 2) {
      return std::array<Rot<2>, 4>{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}}[static_cast<std::size_t>(k)];
    } else {
      const auto half = [&](int bit) { return Real(k >> bit & 1 ? -0.5 : 0.5); };
      if (k < 8) return {Real(0.5), half(0), half(1), half(2)};
      return {Real(k == 8), Real(k == 9), Real(k == 10), Real(k == 11)};
    }
  }
  PlainDraw m_draw{21};
  std::ostringstream m_numbers;
};

template <int D>
void bothPrecisions(std::uint64_t inputs) {
  FloatPairs<D> source;
  std::vector<JudgedPair<D>> pairs;
  for (int n = 2000; n > 0; --n) pairs.push_back(source.draw());
  EXPECT_EQ(source.hash(), inputs) << "the other precision is asked something else";
  for (const Registered* entry : Registry::instance().list(StageKind::pairQuery, D)) {
    if (entry->info.role != AlgorithmRole::competitor) continue;
    const auto method = createStage<PairQuery<D>>(Spec{entry->info.name, {}});
    const Tally tally = against<D>(*method, QueryNeed::closestPoints, pairs, entry->info.guarantee);
    EXPECT_TRUE(tally.right()) << entry->info.name << ", worst error " << tally.errors.back() << ":\n" << tally.worst;
  }
}
TEST(PairQueryTruth, BothPrecisions) {
  bothPrecisions<2>(12990664900007743841u);
  bothPrecisions<3>(9946326375794592900u);
}

}  // namespace pair_query_truth_test
}}}  // namespace lpc::LPC_PRECISION::test
