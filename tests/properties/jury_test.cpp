// SPDX-License-Identifier: Zlib
// Each exact competing pair query agrees with FCL, libccd and Bullet within both error bars. Where they differ, the
// referee must confirm the competitor: witnesses find errors, the referee decides.
#include <gtest/gtest.h>

#include <cstdio>

#include "oracles/referee/referee.h"
#include "oracles/witnesses/witness.h"
#include "tests/check_property.h"
#include "tests/pair_query_properties.h"
#include "tests/planted_bugs/pair_query_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace jury_test { namespace {

using namespace wrong_queries;

template <int D>
struct Juror {
  std::string name;
  std::unique_ptr<PairQuery<D>> query;
};
template <int D>
std::vector<Juror<D>> registered(AlgorithmRole role) {
  std::vector<Juror<D>> out;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role != role) continue;
    if (role == AlgorithmRole::competitor && r->info.guarantee != Guarantee::exact) continue;
    out.push_back({r->info.name, createStage<PairQuery<D>>(Spec{r->info.name, {}})});
  }
  return out;
}

template <int D>
PairAnswer<D> ask(PairQuery<D>& query, const Asked<D>& pair) {
  return queryPair(query, pair.a.view(), pair.b.view(), pair.X_AB);
}

struct Finding {
  int agreements = 0, disagreements = 0;  // witnesses that gave an answer
  bool candidateWrong = false;            // at least one differs, and the referee confirms it
  std::string accusers;
};

template <int D>
class Jury {
 public:
  void hear(const Asked<D>& pair) {
    m_pair = pair;
    m_opinions.clear();
    for (const Juror<D>& w : m_witnesses) m_opinions.push_back(ask(*w.query, pair));
  }

  Finding judge(const PairAnswer<D>& candidate) const {
    const ShapeView<D>&a = m_pair.a.view(), &b = m_pair.b.view();
    const double s = errorScale(a, Pose<D>{}, b, m_pair.X_AB, candidate.distance);
    Finding finding;
    for (std::size_t i = 0; i < m_witnesses.size(); ++i) {
      const PairAnswer<D>& opinion = m_opinions[i];
      double off = 0, bar = kPairTolerance;
      if (opinion.status == QueryStatus::converged) {
        off = std::abs(candidate.distance - opinion.distance) / s;
        bar += witness(i).errorBar(a.kind, b.kind);
      } else if (opinion.status == QueryStatus::degenerate) {  // only the side is given
        off = (candidate.distance < 0) != (opinion.distance < 0) ? std::abs(candidate.distance) / s : 0;
      } else {
        continue;
      }
      ++(off <= bar ? finding.agreements : finding.disagreements);
      if (off > bar) finding.accusers += m_witnesses[i].name + " ";
    }
    if (finding.disagreements > 0) {
      const RefereeAnswer<D> truth = referee(a, Pose<D>{}, b, m_pair.X_AB);
      finding.candidateWrong = !(truth.interval().distanceTo(candidate.distance) <= kPairTolerance * s);
    }
    return finding;
  }

 private:
  const Witness<D>& witness(std::size_t i) const { return dynamic_cast<const Witness<D>&>(*m_witnesses[i].query); }

  std::vector<Juror<D>> m_witnesses = registered<D>(AlgorithmRole::witness);
  Asked<D> m_pair{Shape<D>::sphere(1), Shape<D>::sphere(1), {}};
  std::vector<PairAnswer<D>> m_opinions;
};

template <int D>
Asked<D> asked(const ShapePairCase<D>& c) {
  return {c.a, c.b, c.X_AB()};
}

constexpr int kCases = 100;

template <int D>
void competitorsAgree() {
  Jury<D> jury;
  const std::vector<Juror<D>> competitors = registered<D>(AlgorithmRole::competitor);
  int agreements = 0, disagreements = 0;
  check(
      D == 3 ? "pair queries agree with the witnesses within both error bars, or the referee is with them"
             : "pair queries agree with witnesses asked about prisms, or the referee is with them",
      [&] {
        const Asked<D> pair = asked(*shapePairs<D>());
        jury.hear(pair);
        for (const Juror<D>& c : competitors) {
          const PairAnswer<D> answer = ask(*c.query, pair);
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
TEST(Jury, CompetitorsAgreeWithFclLibccdAndBullet) { competitorsAgree<3>(); }
TEST(Jury, CompetitorsAgreeWithLibrariesAskedAboutPrisms) { competitorsAgree<2>(); }

// A witness must accuse a query with a planted bug, and the referee must confirm it, within the property's number of
// cases.
template <int D>
struct Suspect {
  std::string name;
  std::unique_ptr<PairQuery<D>> query;
  int accused = 0, foundAt = 0;
};
template <int D>
void areFound(std::vector<Suspect<D>> suspects) {
  const auto atLarge = [](const Suspect<D>& s) { return s.foundAt == 0; };
  Jury<D> jury;
  PlainDraw draw(1);
  for (int i = 1; i <= kCases && std::any_of(suspects.begin(), suspects.end(), atLarge); ++i) {
    const Asked<D> pair = asked(drawShapePair<D>(draw));
    jury.hear(pair);
    for (Suspect<D>& s : suspects) {
      const Finding finding = jury.judge(ask(*s.query, pair));
      s.accused += finding.disagreements > 0;
      if (finding.candidateWrong && atLarge(s)) s.foundAt = i;
    }
  }
  for (const Suspect<D>& s : suspects) {
    std::printf("%dD %s: found on pair %d, accused on %d\n", D, s.name.c_str(), s.foundAt, s.accused);
    EXPECT_FALSE(atLarge(s)) << s.name;
    if (!atLarge(s)) recordPlantedBug(s.name, s.foundAt, kCases);
  }
}
TEST(Jury, FindsWrongCandidates) {
  std::vector<Suspect<3>> suspects;
  suspects.push_back({"boxes without edge axes", std::make_unique<NoEdgeAxes<3>>()});
  suspects.push_back({"depth along the line of centres", std::make_unique<CentreRayDepth<3>>()});
  suspects.push_back({"forgotten rounding", std::make_unique<ForgetsRounding<3>>()});
  areFound(std::move(suspects));
}
TEST(Jury, FindsWrongCandidates2) {
  std::vector<Suspect<2>> suspects;
  suspects.push_back({"depth along the line of centres", std::make_unique<CentreRayDepth<2>>()});
  suspects.push_back({"forgotten rounding", std::make_unique<ForgetsRounding<2>>()});
  areFound(std::move(suspects));
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::jury_test
