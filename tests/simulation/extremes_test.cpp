// SPDX-License-Identifier: Zlib
// Unphysical but valid scenes: every solver keeps all numbers finite.
#include <gtest/gtest.h>

#include <iomanip>
#include <sstream>

#include "framework/world/invariants.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace extremes_test { namespace {

/// Whether all bodies and all impulses of contacts and joints stay finite.
template <int D>
bool staysFinite(World<D>& world, Real dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    world.step(dt);
    if (!invariants(world).finite || !stateIsFinite(world)) return false;
  }
  return true;
}

// Three boxes in one place, half in the ground, and below them three balls 1 um apart.
template <int D>
bool survivesOverlap(const std::string& solver) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  for (int i = 0; i < 3; ++i) world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0)));
  for (int i = 0; i < 3; ++i) world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(1e-6 * i, -0.4)));
  return staysFinite(world, Real(1) / 60, 30);
}

template <int D>
bool survivesStep(const std::string& solver, double dt) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  for (int i = 0; i < 3; ++i) world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5 + i)));
  const BodyHandle bob = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(5, 5)));
  world.add(pivot<D>(world.handle(0), bob, at<D>(4, 5)));
  return staysFinite(world, static_cast<Real>(dt), 20);
}

// A joint of each kind that has a spring, with stiffness zero or 1e12.
template <int D>
bool survivesStiffness(const std::string& solver, bool stiff) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  int n = 0;
  for (const Registered* kind : Registry::instance().list(StageKind::joint, D)) {
    Spec spec{kind->info.name, {}};
    for (const ParamInfo& p : kind->params) {
      if (!p.name.ends_with("stiffness")) continue;
      if (kind->info.name == "distance") spec.set("mode", {"spring", {}});
      spec.set(p.name, {stiff ? "1e12" : "0", {}});
    }
    if (spec.fields.empty()) continue;
    const double x = 3 * n++;
    const BodyHandle b = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(x, 5)));
    JointDef<D> joint{.kind = spec.text(), .bodyA = world.handle(0), .bodyB = b};
    joint.X_WJ.p = at<D>(x, 5.5), joint.X_WJb = Pose<D>{at<D>(x + 1, 5), {}};
    world.add(joint);
  }
  return n > 1 && staysFinite(world, Real(1) / 60, 20);
}

template <int D>
void survives(const std::string& solver) {
  EXPECT_TRUE(survivesOverlap<D>(solver)) << solver;
  for (const double dt : {10.0, 1e-9}) EXPECT_TRUE(survivesStep<D>(solver, dt)) << solver << ' ' << dt;
  for (const bool stiff : {false, true}) EXPECT_TRUE(survivesStiffness<D>(solver, stiff)) << solver << ' ' << stiff;
}

template <int D>
void everySolverSurvives() {
  for (const std::string& solver : everySolver<D>(true)) survives<D>(solver);
}
TEST(Extremes, EverySolverSurvives2) { everySolverSurvives<2>(); }
TEST(Extremes, EverySolverSurvives3) { everySolverSurvives<3>(); }

std::string text(double x) {
  std::ostringstream out;
  out << std::setprecision(17) << x;
  return out.str();
}

/// The method with its real parameters at the ends of their ranges: each alone, and all together in every combination.
/// The other parameters have their defaults; in addition each other choice and each least iteration count is tried. The
/// greatest counts only cost time and are no edge case.
std::vector<Spec> edges(const Registered& method, const Spec& plain) {
  std::vector<const ParamInfo*> reals;
  std::vector<Spec> beside = {plain}, out;
  for (const ParamInfo& p : method.params) {
    if (plain.find(p.name)) continue;
    const bool counts = p.type == "integer" || p.name == "iteration_factor";
    if (p.type == "real" && !counts) reals.push_back(&p);
    std::vector<std::string> others = p.choices;
    if (counts) others = {text(p.range->lo)};
    for (const std::string& other : others) {
      if (p.stage || other == p.defaultText) continue;
      beside.push_back(plain);
      beside.back().set(p.name, {other, {}});
    }
  }
  const auto end = [](const ParamInfo& p, bool largest) { return Spec{text(largest ? p.range->hi : p.range->lo), {}}; };
  for (const Spec& spec : beside) {
    for (const ParamInfo* p : reals) {
      for (const bool largest : {false, true}) out.push_back(spec), out.back().set(p->name, end(*p, largest));
    }
    if (reals.size() < 2) continue;
    for (std::size_t way = 0; way < std::size_t{1} << reals.size(); ++way) {
      out.push_back(spec);
      for (std::size_t k = 0; k < reals.size(); ++k) out.back().set(reals[k]->name, end(*reals[k], way >> k & 1));
    }
  }
  return out;
}

/// Every solver, and split_solver with every part, at the ends of their parameter ranges.
template <int D>
std::vector<Spec> everyEdge() {
  std::vector<Spec> out;
  for (const Registered* solver : Registry::instance().list(StageKind::solver, D)) {
    if (!competes(*solver)) continue;
    for (Spec& spec : edges(*solver, {solver->info.name, {}})) out.push_back(std::move(spec));
    for (const ParamInfo& p : solver->params) {
      if (!p.stage) continue;
      for (const Registered* part : Registry::instance().list(p.stage->kind, D)) {
        if (!competes(*part)) continue;
        for (Spec& spec : edges(*part, {part->info.name, {}})) {
          out.push_back({solver->info.name, {}});
          out.back().set(p.name, std::move(spec));
        }
      }
    }
  }
  return out;
}

// Contradictory parameters (penalties that cross) are rejected with a one-line message. All others give finite results.
template <int D>
void everyParameterSurvives() {
  int refused = 0;
  const std::vector<Spec> specs = everyEdge<D>();
  for (const Spec& spec : specs) {
    try {
      createStage<Solver<D>>(spec);
    } catch (const UserError& e) {
      const std::string why = e.what();
      EXPECT_TRUE(!why.empty() && why.find('\n') == why.npos) << spec.text() << ": " << why;
      ++refused;
      continue;
    }
    survives<D>(spec.text());
  }
  EXPECT_LT(refused, static_cast<int>(specs.size()) / 4);
  bool all = true;
  const Registered& planted = Registry::instance().find(StageKind::solver, D, "planted_solver");
  for (const Spec& spec : edges(planted, Spec::parse("planted_solver{bug=divides}"))) {
    all = all && survivesOverlap<D>(spec.text());
  }
  expectCaught("Extremes divides by a parameter " + std::to_string(D) + 'D', all);
}
TEST(Extremes, EveryParameterSurvives2) { everyParameterSurvives<2>(); }
TEST(Extremes, EveryParameterSurvives3) { everyParameterSurvives<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::extremes_test
