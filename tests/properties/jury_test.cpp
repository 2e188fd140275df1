// SPDX-License-Identifier: Zlib
// Each competing pair query agrees with FCL, libccd and Bullet within both error bars. Where they differ, the referee
// must have the competitor right: the witnesses find, the referee decides.
#include <gtest/gtest.h>

#include <cstdio>

#include "oracles/error_bars.h"
#include "oracles/referee.h"
#include "oracles/witness.h"
#include "tests/check_property.h"
#include "tests/pair_query_properties.h"
#include "tests/planted_bugs/pair_query_twins.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

using namespace wrong_queries;

struct Juror {
  std::string name;
  std::unique_ptr<PairQuery<3>> query;
};
std::vector<Juror> registered(Role role) {
  std::vector<Juror> out;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, 3)) {
    if (r->info.role == role) out.push_back({r->info.name, createStage<PairQuery<3>>(Spec{r->info.name, {}})});
  }
  return out;
}

PairAnswer<3> ask(PairQuery<3>& query, const Asked<3>& pair) {
  return queryPair(query, pair.a.view(), pair.b.view(), pair.X_AB);
}

struct Finding {
  int agreements = 0, disagreements = 0;  // witnesses with an opinion
  bool candidateWrong = false;            // at least one differs, and the referee is with it
  std::string accusers;
};

class Jury {
 public:
  void hear(const Asked<3>& pair) {
    m_pair = pair;
    m_opinions.clear();
    for (const Juror& w : m_witnesses) m_opinions.push_back(ask(*w.query, pair));
  }

  Finding judge(const PairAnswer<3>& candidate) const {
    const ShapeView<3>&a = m_pair.a.view(), &b = m_pair.b.view();
    const double s = errorScale(a, Pose<3>{}, b, m_pair.X_AB, candidate.distance);
    Finding finding;
    for (std::size_t i = 0; i < m_witnesses.size(); ++i) {
      const PairAnswer<3>& opinion = m_opinions[i];
      double off = 0, bar = kPairTolerance;
      if (opinion.status == QueryStatus::converged) {
        off = std::abs(candidate.distance - opinion.distance) / s;
        bar += errorBar(m_witnesses[i].name, a.kind, b.kind);
      } else if (opinion.status == QueryStatus::degenerate) {  // the side is all there is
        off = (candidate.distance < 0) != (opinion.distance < 0) ? std::abs(candidate.distance) / s : 0;
      } else {
        continue;
      }
      ++(off <= bar ? finding.agreements : finding.disagreements);
      if (off > bar) finding.accusers += m_witnesses[i].name + " ";
    }
    if (finding.disagreements > 0) {
      const RefereeAnswer<3> truth = referee(a, Pose<3>{}, b, m_pair.X_AB);
      finding.candidateWrong = !(truth.interval().distanceTo(candidate.distance) <= kPairTolerance * s);
    }
    return finding;
  }

 private:
  std::vector<Juror> m_witnesses = registered(Role::witness);
  Asked<3> m_pair{Shape<3>::sphere(1), Shape<3>::sphere(1), {}};
  std::vector<PairAnswer<3>> m_opinions;
};

Asked<3> asked(const ShapePairCase<3>& c) { return {c.a, c.b, c.X_AB()}; }

constexpr int kCases = 100;

TEST(Jury, CompetitorsAgreeWithFclLibccdAndBullet) {
  Jury jury;
  const std::vector<Juror> competitors = registered(Role::competitor);
  int agreements = 0, disagreements = 0;
  check(
      "pair queries agree with the witnesses within both error bars, or the referee is with them",
      [&] {
        const Asked<3> pair = asked(*shapePairs<3>());
        jury.hear(pair);
        for (const Juror& c : competitors) {
          const PairAnswer<3> answer = ask(*c.query, pair);
          if (answer.status == QueryStatus::refused) continue;
          const Finding finding = jury.judge(answer);
          agreements += finding.agreements, disagreements += finding.disagreements;
          RC_LOG() << c.name << " against " << finding.accusers;
          RC_ASSERT(!finding.candidateWrong);
        }
      },
      kCases);
  std::printf("%d opinions agree, %d differ and the referee is with the competitor\n", agreements, disagreements);
  EXPECT_GT(agreements, disagreements);
}

// A candidate with a bug is accused by a witness, and the referee confirms it, within the property's number of cases.
TEST(Jury, FindsWrongCandidates) {
  struct Suspect {
    const char* name;
    std::unique_ptr<PairQuery<3>> query;
    int accused = 0, foundAt = 0;
  };
  std::vector<Suspect> suspects;
  suspects.push_back({"boxes without edge axes", std::make_unique<NoEdgeAxes<3>>()});
  suspects.push_back({"depth along the line of centres", std::make_unique<CentreRayDepth<3>>()});
  suspects.push_back({"forgotten rounding", std::make_unique<ForgetsRounding<3>>()});
  const auto atLarge = [](const Suspect& s) { return s.foundAt == 0; };
  Jury jury;
  PlainDraw draw(1);
  for (int i = 1; i <= kCases && std::any_of(suspects.begin(), suspects.end(), atLarge); ++i) {
    const Asked<3> pair = asked(drawShapePair<3>(draw));
    jury.hear(pair);
    for (Suspect& s : suspects) {
      const Finding finding = jury.judge(ask(*s.query, pair));
      s.accused += finding.disagreements > 0;
      if (finding.candidateWrong && atLarge(s)) s.foundAt = i;
    }
  }
  for (const Suspect& s : suspects) {
    std::printf("%s: found on pair %d, accused on %d\n", s.name, s.foundAt, s.accused);
    EXPECT_FALSE(atLarge(s)) << s.name;
    if (!atLarge(s)) recordPlantedBug(s.name, s.foundAt, kCases);
  }
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
