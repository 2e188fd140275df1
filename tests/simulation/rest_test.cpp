// SPDX-License-Identifier: Zlib
// R14: bodies at rest stay at rest, for every solver.
#include <gtest/gtest.h>

#include "framework/world/invariants.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace rest_test { namespace {

constexpr Real kDt = Real(1) / 60;
#if defined(LPC_SANITIZED)
constexpr int kSeconds = 10;
#else
constexpr int kSeconds = 60;
#endif

// Three stacked cubes, after a second to settle. The top cube stays within a millimetre, the kinetic energy below that
// of a fall of 1 um, and penetration within the slop.
template <int D>
bool stays(const std::string& solver) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  BodyHandle top;
  for (int i = 0; i < 3; ++i) top = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5 + i)));
  for (int i = 0; i < 60; ++i) world.step(kDt);
  const Pose<D> from = world.pose(top);
  for (int i = 60; i < 60 * kSeconds; ++i) {
    world.step(kDt);
    const Invariants<D> now = invariants(world);
    if (now.kinetic > 1e-5 || now.maxPenetration > double(kLinearSlop)) return false;
    if ((world.pose(top).p - from.p).norm() > Real(1e-3)) return false;
  }
  return true;
}

template <int D>
void everySolverStays() {
  for (const std::string& solver : everySolver<D>(true)) {
    // The order of operations of 2009: contacts first, so each step ends with a fall of g dt^2.
    const bool sinks = solver.find("resolve_then_force_move") != solver.npos;
    const bool declared = declares<D>(solver, "Rest.Stays") || declares<D>(solver, "Rest.StackStays");
    EXPECT_EQ(stays<D>(solver), !sinks && !declared) << solver << ' ' << D << 'D';
  }
  // Ablation of the failure that shock_propagation declares.
  EXPECT_TRUE(stays<D>("split_solver{velocity=shock_propagation{warm_start=true}}"));
  EXPECT_TRUE(stays<D>("planted_solver"));
  for (const char* bug : {"planted_solver{bug=creeps}", "planted_solver{bug=hops}"}) {
    expectCaught("Rest.Stays " + std::string(bug) + ' ' + std::to_string(D) + 'D', stays<D>(bug));
  }
}
TEST(Rest, EverySolverStays2) { everySolverStays<2>(); }
TEST(Rest, EverySolverStays3) { everySolverStays<3>(); }

// A pyramid of base 4 with boxes that overlap by a quarter. Within a second no body exceeds 20 m/s, the speed of a
// throw 20 m high.
template <int D>
bool comesApart(const std::string& solver) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i < 4 - row; ++i) {
      const Vec<D> p = at<D>(0.75 * (0.5 * row + i), 0.5 + 0.75 * row);
      world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), p));
    }
  }
  for (int i = 0; i < 60; ++i) {
    world.step(kDt);
    if (!(invariants(world).maxSpeed < 20)) return false;
  }
  return true;
}
template <int D>
void everySolverComesApart() {
  for (const Registered* r : Registry::instance().list(StageKind::solver, D)) {
    if (!competes(*r)) continue;
    EXPECT_EQ(comesApart<D>(r->info.name), !declares<D>(r->info.name, "Overlap.ComesApartOrSaysThatItDoesNot"))
        << r->info.name << ' ' << D << 'D';
  }
}
TEST(Overlap, ComesApartOrSaysThatItDoesNot) { everySolverComesApart<2>(), everySolverComesApart<3>(); }

// A pyramid of base 10 falls 20 cm, each row 5 cm more than the row below, and lands within 30 steps. Returns the
// number of steps in which `position` reaches its limit of moves, four per contact.
int stepsAtTheLimit(const std::string& position) {
  World<3> world(Pipeline::parse("solver=split_solver{velocity=catto{iterations=10},position=" + position + "}"));
  addGround(world);
  for (int row = 0; row < 10; ++row) {
    for (int i = 0; i < 10 - row; ++i) {
      const Vec<3> p = at<3>(0.5 * (row + 1) + i - 5, 0.7 + 1.05 * row);
      world.add(body<3>(Shape<3>::box(Vec<3>::Constant(Real(0.5))), p));
    }
  }
  int atLimit = 0;
  for (int i = 0; i < 30; ++i) {
    world.step(kDt);
    long contacts = 0;
    for (const Manifold<3>& m : world.manifolds()) contacts += m.count;
    const auto rows = static_cast<long>(world.profiler().frame().work[WorkCount::rowUpdates]);
    const long moves = rows - 10 * 3 * contacts;  // without the row updates of the velocity resolver
    EXPECT_GE(moves, 0);
    atLimit += contacts > 0 && moves >= 4 * contacts;
  }
  return atLimit;
}
TEST(Rest, NonlinearEndsBeforeItsLimit) {
  EXPECT_EQ(stepsAtTheLimit("nonlinear"), 0);
  EXPECT_GT(stepsAtTheLimit("nonlinear{tolerance=0}"), 0);  // it endlessly corrects its own changes
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::rest_test
