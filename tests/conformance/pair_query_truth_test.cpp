// SPDX-License-Identifier: Zlib
// Every competing pair query against the referee, on pairs from all families: the error measure of all accuracy claims.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "framework/check.h"
#include "framework/stage_narrowphase.h"
#include "framework/tolerances.h"
#include "oracles/referee.h"
#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

// |phi - phi_ref| / s, and how much less than phi_ref the separation along the returned normal is.
constexpr double kBound = sizeof(Real) == 8 ? 1e-12 : 1e-5;

struct Tally {
  std::vector<double> errors;  // of distance and of normal, the larger one
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

// The methods are asked with X_AB: the referee judges that very input, not the world poses it was rounded from.
template <int D>
std::vector<JudgedPair<D>> judgedPairs(int count) {
  PlainDraw draw(17);
  std::vector<JudgedPair<D>> out;
  int refused = 0;  // slivers that are flat in single precision: the hull says so
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

// `errors` comes out sorted.
template <int D>
Tally against(PairQuery<D>& method, Need need, const std::vector<JudgedPair<D>>& pairs) {
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
    double error = 0;  // of a boolean there is only the sign
    if (need != Need::boolean) {
      const Vecd<D> n = answer.normal.template cast<double>();
      const bool unit = std::abs(n.norm() - 1) <= static_cast<double>(kUnitTolerance);
      const double along = unit ? separationAlong(a, Pose<D>{}, b, p.X_AB, n).hi : distance - p.s;
      error = std::max(phi.distanceTo(distance), phi.lo - along) / p.s;
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
    if (entry->info.role != Role::competitor) continue;
    const auto method = createStage<PairQuery<D>>(Spec{entry->info.name, {}});
    for (const Need need : {Need::witnesses, Need::distance, Need::boolean}) {
      const Tally tally = against<D>(*method, need, pairs);
      ASSERT_FALSE(tally.errors.empty()) << entry->info.name;
      const std::size_t n = tally.errors.size();
      std::printf("%dD %-12s %-9s %6zu pairs, error/s median %.1e, 99.9 %% %.1e, worst %.1e; wrong signs %d\n", D,
                  entry->info.name.c_str(),
                  need == Need::witnesses  ? "witnesses"
                  : need == Need::distance ? "distance"
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

// Wrong twins around a right method: each must be seen within the ordinary number of pairs.
template <int D>
class Spoiled final : public PairQuery<D> {
 public:
  enum Way { offByMore, flippedNormal, missedTouch, neverAnswers, leaningNormal };
  Spoiled(PairQuery<D>& method, Way way) : m_method(method), m_way(way) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_method.supports(a, b); }
  void query(const PairBatch<D>& batch, Need need, PairAnswers<D>& answers, std::span<PairMemory> memory,
             Work& work) override {
    m_method.query(batch, need, answers, memory, work);
    for (int i = 0; i < batch.count; ++i) {
      PairAnswer<D> answer = answers.get(i);
      if (m_way == offByMore) answer.distance *= 1 + static_cast<Real>(50 * kBound);
      if (m_way == flippedNormal) answer.normal = -answer.normal;
      if (m_way == missedTouch && answer.distance < 0 && answer.distance > Real(-0.01)) answer.distance = Real(0.01);
      if (m_way == neverAnswers && answer.distance == 0) answer.status = QueryStatus::failed;
      if (m_way == leaningNormal) {
        answer.normal += static_cast<Real>(50 * kBound) * tangents(answer.normal).col(0);
        answer.normal /= answer.normal.norm();
      }
      answers.set(i, answer);
    }
  }

 private:
  PairQuery<D>& m_method;
  Way m_way;
};

template <int D>
void spoiledAreSeen() {
  const auto method = createStage<PairQuery<D>>(Spec{"gjk_epa", {}});
  const auto pairs = judgedPairs<D>(2000);
  using S = Spoiled<D>;
  for (const auto way : {S::offByMore, S::flippedNormal, S::missedTouch, S::neverAnswers, S::leaningNormal}) {
    S spoiled(*method, way);
    EXPECT_FALSE(against<D>(spoiled, Need::witnesses, pairs).right()) << "way " << way << " was not seen";
  }
}
TEST(PairQueryTruth, SpoiledMethodsAreSeen) { spoiledAreSeen<2>(), spoiledAreSeen<3>(); }

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
