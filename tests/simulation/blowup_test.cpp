// SPDX-License-Identifier: Zlib
// Unphysical forces from a user's generator: NaN, infinity and 1e30 N. Every stage survives them, the next state
// reports them, and distant bodies are unaffected.
#include <gtest/gtest.h>

#include <limits>

#include "framework/world/invariants.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace blowup_test { namespace {

constexpr int kSick = 8, kFrom = 5;  // body slot after a heap of five; first step with the force

template <int D>
struct Blow final : ForceGenerator<D> {
  Real force;
  explicit Blow(Real f) : force(f) {}
  void apply(const ForceState<D>&, Real t, std::span<Wrench<D>> out) const override {
    if (t < (kFrom - Real(0.5)) / 60) return;
    out[kSick].force[0] += force;
    out[kSick].torque[0] += force;
  }
};

template <int D>
bool survives(const std::string& pipeline, Real force, double where) {
  World<D> well(Pipeline::parse(pipeline)), sick(Pipeline::parse(pipeline));
  for (World<D>* w : {&well, &sick}) {
    addHeap(*w, 5, 2);
    w->add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.3))), at<D>(where, 0.6)));
  }
  sick.add(std::make_shared<const Blow<D>>(force));
  for (int i = 0; i < 20; ++i) {
    well.step(Real(1) / 60), sick.step(Real(1) / 60);
    if (i < kFrom - 1 && sick.hash() != well.hash()) return false;
    if (i < kFrom) continue;  // solvers that ask for forces at the end of a step get it one step earlier
    const Invariants<D> now = invariants(sick);
    if (stateIsFinite(sick) != now.finite) return false;
    if (now.finite && !(std::isfinite(force) && now.maxSpeed > 1e25)) return false;
    if (where < 100) continue;  // near the heap the body hits others
    for (std::size_t b = 0; b < kSick; ++b) {
      if (sick.bodies().pose[b].p != well.bodies().pose[b].p) return false;
    }
  }
  // Later queries terminate and find the other bodies.
  sick.rayAll(at<D>(-50, 0.3), at<D>(1, 0), 1000);
  return !sick.at(at<D>(0, -0.5)).empty() && !sick.overlap({at<D>(-30, -30, -30), at<D>(30, 30, 30)}).empty();
}

template <int D>
void everyStageSurvives() {
  for (const Real force : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity(), Real(1e30)}) {
    for (const std::string& pipeline : everyPipeline<D>()) {
      for (double where : {300.0, 1.5}) EXPECT_TRUE(survives<D>(pipeline, force, where)) << pipeline << force << where;
    }
    const char* bug = "solver=planted_solver{bug=shares}";
    expectCaught("Blowup " + std::string(bug) + ' ' + std::to_string(force), survives<D>(bug, force, 300));
  }
}
TEST(Blowup, EveryStageSurvives2) { everyStageSurvives<2>(); }
TEST(Blowup, EveryStageSurvives3) { everyStageSurvives<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::blowup_test
