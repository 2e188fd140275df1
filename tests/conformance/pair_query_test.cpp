// SPDX-License-Identifier: Zlib
// Every competing pair query on generated pairs: it must satisfy every property.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "tests/check_property.h"
#include "tests/pair_query_properties.h"
#include "tests/planted_bugs/pair_query_twins.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

using namespace wrong_queries;

template <int D>
struct Method {
  std::string name;
  AlgorithmRole role;
  std::unique_ptr<PairQuery<D>> query;
};

template <int D>
std::vector<Method<D>> methods(AlgorithmRole role) {
  std::vector<Method<D>> out;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role == role) out.push_back({r->info.name, role, createStage<PairQuery<D>>(Spec{r->info.name, {}})});
  }
  return out;
}

template <int D>
Asked<D> asked(const ShapePairCase<D>& c) {
  return {c.a, c.b, c.X_AB()};
}

constexpr int kRuns = 2000;  // cases of the properties, and of each bug that one of them must catch

/// All properties, or the one with that name.
template <int D>
auto holdsFor(PairQuery<D>& query, const std::string& only = "") {
  return [&query, only] {
    const auto c = *shapePairs<D>();
    PairQueryProperties<D> properties(query);
    if (!properties.takes(c.a, c.b)) return;
    RapidCheckDraw draw;
    const std::string fault = properties.fault(asked<D>(c), draw, only);
    if (!fault.empty()) {
      RC_LOG() << c;
      RC_FAIL(fault);
    }
  };
}

template <int D>
void properties() {
  const auto all = methods<D>(AlgorithmRole::competitor);
  ASSERT_GE(all.size(), 3u);
  for (const Method<D>& m : all) {
    SCOPED_TRACE(m.name);
    check("pair query " + m.name + " in " + std::to_string(D) + "D", holdsFor<D>(*m.query), kRuns);
  }
}
TEST(PairQuery, Properties2) { properties<2>(); }
TEST(PairQuery, Properties3) { properties<3>(); }

// Each property alone sees the bug that was planted for it.
template <int D>
void bugsAreCaught() {
  std::map<std::string, std::unique_ptr<PairQuery<D>>> twins;
  twins["N1 swap"] = std::make_unique<ForgetsRounding<D>>();
  twins["N2 motion of both"] = std::make_unique<AxisAlignedShortcut<D>>();
  twins["N3 scale"] = std::make_unique<AbsoluteTolerance<D>>();
  twins["N4 mirror"] = std::make_unique<NeverTurnsBack<D>>();
  twins["N5 depth is minimal"] = std::make_unique<CentreRayDepth<D>>();
  twins["N5 depth suffices"] = std::make_unique<HalfDepth<D>>();
  twins["N6 Lipschitz"] = std::make_unique<RoundingTwiceInside<D>>();
  twins["N6 convex along lines"] = std::make_unique<ReportsItsCutOff<D>>();
  twins["N7 witnesses"] = std::make_unique<CentreWitness<D>>();
  twins["N8 certificate"] = std::make_unique<FlippedNormal<D>>();
  twins["N9 boolean"] = std::make_unique<SphereBoolean<D>>();
  twins["N10 always a normal"] = std::make_unique<NoNormalAtTouch<D>>();
  twins["N11 rounding"] = std::make_unique<ForgetsRounding<D>>();
  twins["N16 memory"] = std::make_unique<TrustsItsMemory<D>>();
  twins["N16 vertex order"] = std::make_unique<FirstPeak<D>>();
  const auto caught = [](const std::string& property, const std::string& bug, PairQuery<D>& twin) {
    expectFalsified(property + ": " + bug + std::to_string(D) + "D", holdsFor<D>(twin, property), kRuns);
  };
  for (const auto& property : PairQueryProperties<D>::all()) {
    ASSERT_TRUE(twins.contains(property.name)) << property.name << " has no planted bug";
    caught(property.name, "", *twins[property.name]);
  }
  NoEdgeAxes<D> noEdges;  // the 2009 engine's mistake; without edges in 2D it is none
  if (D == 3) caught("N5 depth is minimal", "no edge axes, ", noEdges);
}
TEST(PairQuery, PlantedBugs2) { bugsAreCaught<2>(); }
TEST(PairQuery, PlantedBugs3) { bugsAreCaught<3>(); }

// Each method's answer against the best bound that any of them proves: no two may differ, and none may be wrong.
template <int D>
void agreement() {
  const auto all = methods<D>(AlgorithmRole::competitor);
  std::map<std::string, double> worst;
  PlainDraw draw(seedOf("agreement"));
  for (int n = caseCount(20000); n > 0; --n) {
    const auto c = drawShapePair<D>(draw);
    const Asked<D> pair = asked<D>(c);
    double best = -std::numeric_limits<double>::infinity();
    std::vector<std::pair<const Method<D>*, PairAnswer<D>>> answers;
    for (const Method<D>& m : all) {
      const PairAnswer<D> answer = queryPair<D>(*m.query, pair.a.view(), pair.b.view(), pair.X_AB, QueryNeed::distance);
      if (answer.status == QueryStatus::refused) continue;
      answers.emplace_back(&m, answer);
      ASSERT_TRUE(std::isfinite(answer.distance) && answer.normal.allFinite()) << m.name << "\n" << c;
      best = std::max(best, static_cast<double>(boundAlong(pair, answer.normal)));
    }
    const double size = sizeOf(pair, best);
    if (c.distance) best = std::max(best, double(*c.distance) - 64 * double(kEps) * size);
    for (const auto& [m, answer] : answers) {
      const double error = std::abs(answer.distance - best) / size;
      double& most = worst[m->name];
      most = std::max(most, error);
      ASSERT_LE(error, kPairTolerance) << m->name << "\n" << c;
    }
  }
  for (const auto& [name, error] : worst) std::printf("%dD %-12s largest error %.1e\n", D, name.c_str(), error);
}
TEST(PairQuery, Agreement2) { agreement<2>(); }
TEST(PairQuery, Agreement3) { agreement<3>(); }

// N17: running into the cap is a status, not a silent answer, and the work until then is bounded and counted.
int answersWithStatusOfLimit(PairQuery<3>& method) {
  PlainDraw draw(5);
  int limited = 0;
  for (int i = 0; i < 200; ++i) {
    const auto a = drawSketch<3>(draw, ShapeKind::box).build(1), b = drawSketch<3>(draw, ShapeKind::polytope).build(1);
    const Pose<3> X{2 * drawVector<3>(draw), drawRotation<3>(draw)};
    const PairAnswer<3> answer = queryPair<3>(method, a.view(), b.view(), X);
    EXPECT_TRUE(std::isfinite(answer.distance) && answer.normal.allFinite());
    limited += answer.status == QueryStatus::iterationLimit;
  }
  return limited;
}
TEST(PairQuery, CapIsAStatus) {
  const auto capped = createStage<PairQuery<3>>(Spec::parse("gjk_epa{iterations=1,faces=8}"));
  EXPECT_GT(answersWithStatusOfLimit(*capped), 100);
  SilentLimit<3> silent(*capped);
  EXPECT_EQ(answersWithStatusOfLimit(silent), 0) << "the planted bug was not caught";
  recordPlantedBug("N17: silent limit", 1, 200);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
