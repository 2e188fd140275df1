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
  Role role;
  std::unique_ptr<PairQuery<D>> query;
};

template <int D>
std::vector<Method<D>> methods(Role role) {
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

template <int D>
auto holdsFor(PairQuery<D>& query) {
  return [&query] {
    const auto c = *shapePairs<D>();
    PairQueryProperties<D> properties(query);
    if (!properties.takes(c.a, c.b)) return;
    RapidCheckDraw draw;
    const std::string fault = properties.fault(asked<D>(c), draw);
    if (!fault.empty()) {
      RC_LOG() << c;
      RC_FAIL(fault);
    }
  };
}

template <int D>
void properties() {
  const auto all = methods<D>(Role::competitor);
  ASSERT_GE(all.size(), 3u);
  for (const Method<D>& m : all) {
    SCOPED_TRACE(m.name);
    check("pair query " + m.name + " in " + std::to_string(D) + "D", holdsFor<D>(*m.query), 2000);
  }
}
TEST(PairQuery, Properties2) { properties<2>(); }
TEST(PairQuery, Properties3) { properties<3>(); }

template <int D, template <int> class Twin>
void caught(const std::string& name) {
  Twin<D> twin;
  expectFalsified("pair query " + name + " in " + std::to_string(D) + "D", holdsFor<D>(twin), 2000);
}
template <template <int> class Twin>
void caughtInBoth(const std::string& name) {
  caught<2, Twin>(name);
  caught<3, Twin>(name);
}
TEST(PairQuery, SeesFlippedNormal) { caughtInBoth<FlippedNormal>("flipped normal"); }
TEST(PairQuery, SeesMissingEdgeAxes) { caught<3, NoEdgeAxes>("no edge axes"); }
TEST(PairQuery, SeesCentreRayDepth) { caughtInBoth<CentreRayDepth>("centre ray"); }
TEST(PairQuery, SeesAbsoluteTolerance) { caughtInBoth<AbsoluteTolerance>("absolute tolerance"); }
TEST(PairQuery, SeesForgottenRounding) { caughtInBoth<ForgetsRounding>("forgets rounding"); }
TEST(PairQuery, SeesTrustedMemory) { caughtInBoth<TrustsItsMemory>("trusts its memory"); }
TEST(PairQuery, SeesCentreWitness) { caughtInBoth<CentreWitness>("centre witness"); }

// Each method's answer against the best bound that any of them proves: no two may differ, and none may be wrong.
template <int D>
void agreement() {
  const auto all = methods<D>(Role::competitor);
  std::map<std::string, double> worst;
  PlainDraw draw(seedOf("agreement"));
  for (int n = caseCount(20000); n > 0; --n) {
    const auto c = drawShapePair<D>(draw);
    const Asked<D> pair = asked<D>(c);
    double best = -std::numeric_limits<double>::infinity();
    std::vector<std::pair<const Method<D>*, PairAnswer<D>>> answers;
    for (const Method<D>& m : all) {
      const PairAnswer<D> answer = queryPair<D>(*m.query, pair.a.view(), pair.b.view(), pair.X_AB, Need::distance);
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

// N14: the same cube as a box and as a hull.
template <int D>
void boxAsHull() {
  check("a box is its hull in " + std::to_string(D) + "D", [] {
    const auto c = *shapePairs<D>();
    RC_PRE(c.a.kind() == ShapeKind::box || c.b.kind() == ShapeKind::box);
    const auto hullOf = [](const Shape<D>& shape) {
      if (shape.kind() != ShapeKind::box) return shape;
      std::vector<Vec<D>> points;
      for (int bits = 0; bits < 1 << D; ++bits) {
        Vec<D> p = shape.view().half;
        for (int k = 0; k < D; ++k) p[k] = (bits >> k) & 1 ? p[k] : -p[k];
        points.push_back(p);
      }
      return Shape<D>::polytope(std::span<const Vec<D>>(points), shape.view().radius);
    };
    for (const Method<D>& m : methods<D>(Role::competitor)) {
      const auto ask = [&](const Shape<D>& a, const Shape<D>& b) {
        return queryPair<D>(*m.query, a.view(), b.view(), c.X_AB(), Need::distance);
      };
      const PairAnswer<D> box = ask(c.a, c.b), hull = ask(hullOf(c.a), hullOf(c.b));
      if (box.status == QueryStatus::refused || hull.status == QueryStatus::refused) continue;
      const double T = 2 * kPairTolerance * sizeOf(asked<D>(c), box.distance);
      RC_ASSERT(std::abs(box.distance - hull.distance) <= T);
    }
  });
}
TEST(PairQuery, BoxAsHull2) { boxAsHull<2>(); }
TEST(PairQuery, BoxAsHull3) { boxAsHull<3>(); }

// N17: running into the cap is a status, not a silent answer.
TEST(PairQuery, CapIsAStatus) {
  const auto capped = createStage<PairQuery<3>>(Spec::parse("gjk_epa{iterations=1,faces=8}"));
  PlainDraw draw(5);
  int limited = 0;
  for (int i = 0; i < 200; ++i) {
    const auto a = drawSketch<3>(draw, ShapeKind::box).build(1), b = drawSketch<3>(draw, ShapeKind::polytope).build(1);
    const Pose<3> X{2 * drawVector<3>(draw), drawRotation<3>(draw)};
    const PairAnswer<3> answer = queryPair<3>(*capped, a.view(), b.view(), X);
    EXPECT_TRUE(std::isfinite(answer.distance) && answer.normal.allFinite());
    limited += answer.status == QueryStatus::iterationLimit;
  }
  EXPECT_GT(limited, 100);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
