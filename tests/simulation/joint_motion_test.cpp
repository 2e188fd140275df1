// SPDX-License-Identifier: Zlib
// Joints over time, for every registered kind under every solver: joints at rest stay at rest (R14), and half the step
// gives half the error (R17).
#include <gtest/gtest.h>

#include "tests/conformance/joined_bodies.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/joint_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joint_motion_test { namespace {

#if defined(LPC_SANITIZED)
constexpr int kSeconds = 5;
#else
constexpr int kSeconds = 60;
#endif

/// Two bodies of 1 kg, side by side: the first hangs on the world, the second on the first.
template <int D>
ImpactScene<D> shelf(const Kind<D>& kind, Real dt) {
  ImpactScene<D> s;
  s.dt = dt;
  s.field.gravity = Real(-9.81) * Vec<D>::Unit(1);
  const Vec<D> x = Vec<D>::Unit(0);
  for (int i = 0; i < 2; ++i) {
    s.add(1, Ang<D>::Constant(Real(0.5)), {(Real(1) + Real(1.5) * static_cast<Real>(i)) * x, {}});
    join<D>(s, kind, i - 1, i, {Real(1.5) * static_cast<Real>(i) * x, {}}, x / 2);
  }
  return s;
}

struct Unrest {
  double way = 0, energy = 0;  // m, J: maxima over a minute
};

// First damps the bodies strongly for half a minute, until the joint has found its rest position.
template <int D>
Unrest unrestOf(const Kind<D>& kind, const std::string& text) {
  const auto solver = createStage<Solver<D>>(Spec::parse(text));
  auto s = shelf(kind, Real(1) / 60);
  s.field.spring = 4;  // without it a body on a level rail has no rest position
  for (int i = 0; i < 1800; ++i) {
    stepJoined(s, *solver);
    for (Motion<D>& m : s.bodies.motion) m.v *= Real(0.95), m.w *= Real(0.95);
  }
  const auto from = s.bodies.pose;
  Unrest worst;
  for (int i = 0; i < 60 * kSeconds; ++i) {
    stepJoined(s, *solver);
    worst.energy = std::max(worst.energy, double(s.energy()));
    for (int b = 0; b < 2; ++b) {
      worst.way = std::max(worst.way, double((s.pose(b).p - from[static_cast<std::size_t>(b)].p).norm()));
    }
  }
  return worst;
}
bool rests(const Unrest& u) { return u.way <= 1e-3 && u.energy <= 1e-5; }

// Tests a third of the kinds under each solver; the next solver and the other dimension get other kinds. LPC_TEST_CASES
// below 100 tests fewer, above 100 all.
class Share {
 public:
  explicit Share(int dimension) : m_from(dimension) {}
  bool takes() { return m_next++ % m_of == 0; }
  void next() { ++m_from, m_next = m_from; }

 private:
  const int m_of = std::max(caseCount(kCases) > kCases ? 1 : 3, kCases / caseCount(kCases));
  int m_next = 0, m_from;
};

template <int D>
void everyKindRests() {
  Share among(D);
  for (const std::string& solver : everySolverOfJoints<D>()) {
    // The order of operations of 2009 ends each step with a fall of g dt^2.
    if (solver.find("resolve_then_force_move") != solver.npos) continue;
    among.next();
    int restless = 0;
    const bool declared = declares<D>(solver, "Rest.Stays") || declares<D>(solver, "JointMotion.Rests");
    for (const std::string& kind : everyKind<D>()) {
      if (!passive(kindOf<D>(kind)) || (!declared && !among.takes())) continue;
      const Unrest u = unrestOf<D>(kindOf<D>(kind), solver);
      EXPECT_TRUE(declared || rests(u)) << kind << ' ' << solver << ' ' << D << "D: " << u.way << " m, " << u.energy
                                        << " J";
      restless += !rests(u);
    }
    EXPECT_EQ(restless > 0, declared) << solver;
  }
  EXPECT_TRUE(rests(unrestOf<D>(kindOf<D>("hinge{lower=-0.1,upper=0.2}"), "tgs_ngs{stop_factor=0.2}")));
  const auto bug = std::make_shared<WrongJoint<D>>(kindOf<D>("weld"), JointBug::drives);
  expectCaught("JointMotion.Rests a weld that drives " + std::to_string(D) + 'D',
               rests(unrestOf<D>(bug, "split_solver")));
}
TEST(JointMotion, Rests2) { everyKindRests<2>(); }
TEST(JointMotion, Rests3) { everyKindRests<3>(); }

// Position of the second body at eight times within half a second.
template <int D>
std::vector<Vec<D>> track(const Kind<D>& kind, const std::string& text, int stepsPerSecond) {
  const auto solver = createStage<Solver<D>>(Spec::parse(text));
  auto s = shelf(kind, Real(1) / static_cast<Real>(stepsPerSecond));
  std::vector<Vec<D>> out;
  for (int k = 0; k < 8; ++k) {
    for (int i = 0; i < stepsPerSecond / 16; ++i) stepJoined(s, *solver);
    out.push_back(s.pose(1).p);
  }
  return out;
}
template <int D>
double apart(const std::vector<Vec<D>>& a, const std::vector<Vec<D>>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, double((a[i] - b[i]).norm()));
  return worst;
}

// Error ratio for a quarter of the step, against a run with a sixteenth. A first-order method gives 0.2.
template <int D>
double gain(const Kind<D>& kind, const std::string& solver) {
  const auto limit = track<D>(kind, solver, 3840);
  const double coarse = apart<D>(track<D>(kind, solver, 240), limit);
  const double fine = apart<D>(track<D>(kind, solver, 960), limit);
  return fine < 1e-5 ? 0 : fine / coarse;
}
template <int D>
bool converges(const Kind<D>& kind, const std::string& solver, double share = 0.4) {
  return gain<D>(kind, solver) <= share;
}

template <int D>
void everyKindConverges() {
  Share among(D);
  for (const std::string& solver : everySolverOfJoints<D>()) {
    const bool declared = declares<D>(solver, "JointMotion.Converges");
    among.next();
    for (const std::string& kind : everyKind<D>()) {
      if (!among.takes()) continue;
      const double share = !declared ? 0.4 : solver.starts_with("pgs_soft") ? 1 : 0.7;
      EXPECT_LE(gain<D>(kindOf<D>(kind), solver), share) << kind << ' ' << solver << ' ' << D << 'D';
    }
    if (declared) {
      const bool right = converges<D>(kindOf<D>("hinge{lower=-0.1,upper=0.2}"), solver) &&
                         converges<D>(kindOf<D>("cone_twist{swing=0.1,twist=0.1,friction=2}"), solver);
      EXPECT_FALSE(right) << solver;
    }
  }
  // Ablations of the failures that tgs_ngs and pgs_soft declare.
  EXPECT_TRUE(converges<D>(kindOf<D>("hinge{lower=-0.1,upper=0.2}"), "tgs_ngs{position_iterations=8}"));
  const std::string rigid = "pgs_soft{joints=rigid}";
  EXPECT_TRUE(converges<D>(kindOf<D>("hinge{lower=-0.1,upper=0.2}"), rigid));
  EXPECT_TRUE(converges<D>(kindOf<D>("prismatic{lower=-0.1,upper=0.2}"), rigid));
  const auto bug = std::make_shared<WrongJoint<D>>(kindOf<D>("distance"), JointBug::ages);
  expectCaught("JointMotion.Converges a rod that grows with every step " + std::to_string(D) + 'D',
               converges<D>(bug, "split_solver"));
}
TEST(JointMotion, Converges2) { everyKindConverges<2>(); }
TEST(JointMotion, Converges3) { everyKindConverges<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::joint_motion_test
