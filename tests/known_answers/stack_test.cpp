// SPDX-License-Identifier: Zlib
// Weights under stacks, and the rate at which Gauss-Seidel finds them.
#include <array>
#include <memory>

#include "framework/world/invariants.h"
#include "tests/conformance/impact_scene.h"
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace stack_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
double normalImpulse(const Manifold<D>& m) {
  double sum = 0;
  for (int k = 0; k < m.count; ++k) sum += double(m.points[static_cast<std::size_t>(k)].impulse[0]);
  return sum;
}

// Boxes of 1 m at rest, bottom first: a step's impulses under box i are the weights from that box up, times dt. Returns
// the ratio with the largest deviation from 1.
template <int D>
double worstForce(const std::string& solver, const std::vector<double>& masses, double seconds) {
  World<D> world = worldOf<D>(solver);
  addGround(world);
  std::vector<double> above(masses.size() + 1, 0);
  for (std::size_t i = masses.size(); i-- > 0;) above[i] = above[i + 1] + masses[i];
  for (std::size_t i = 0; i < masses.size(); ++i) {
    BodyDef<D> box = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5 + static_cast<double>(i)));
    box.shapes[0].density = Real(masses[i]);
    world.add(box);
  }
  for (int i = 0; i < static_cast<int>(seconds * 60); ++i) world.step(kDt);
  EXPECT_EQ(world.manifolds().size(), masses.size()) << solver;
  double worst = 1;
  for (const Manifold<D>& m : world.manifolds()) {
    worst = worse(normalImpulse(m) / (above[static_cast<std::size_t>(m.bodyA)] * kG * double(kDt)), worst, 1);
  }
  return worst;
}

template <int D>
void stackForces() {
  for (const auto& [name, solvers] : andOthers({{"split_solver", {"split_solver"}},
                                                {"split_solver{order=reverse}", {"split_solver{order=reverse}"}},
                                                {"soft_step", {"soft_step"}}})) {
    if (name == "xpbd") continue;  // its tower falls within this time
    known(in<D>("worst force over weight"), name, 1, worstForce<D>(solvers[0], std::vector<double>(10, 1.0), 10));
  }
}
TEST_F(KnownAnswer, stack_forces) { stackForces<2>(), stackForces<3>(); }

// Two boxes in free space, pressed together by a spring, F = k d, turn as one: angular momentum is conserved. If arms
// lag behind the bodies by an angle, they cause a moment of -F d sin(angle). Arms from the start of a step lag by (n -
// 1) / (2 n) of the step's rotation with n sub-steps: L shrinks by e^(-F d (n - 1) / (2 n) dt t / I). Arms kept as
// made, for recycled points, lag by the whole rotation: the pair swings like a pendulum for ever.
template <int D>
void pressedPair() {
  const double stiffness = 20, swing = 0.2, inertia = 2 * (1.0 / 6 + 1.0 / 4), rate = std::sqrt(stiffness / inertia);
  const double spin = 2 * rate * std::sin(swing / 2), period = 4 * ellipticK(std::pow(std::sin(swing / 2), 2)) / rate;
  const double shrunk = std::exp(-stiffness * 3 / 8 * double(kDt) * 5 / inertia);  // with four sub-steps, after 5 s
  const Ang<D> axis = Ang<D>::Unit(D == 2 ? 0 : 2);
  for (const char* name :
       {"split_solver", "soft_step", "soft_step{arms=as_made}", "tgs", "tgs_ngs", "pgs_soft", "xpbd", "avbd"}) {
    const std::string solver = name;
    WorldSettings<D> settings;
    settings.gravity.setZero();
    World<D> world(Pipeline::parse("cache=recycling solver=" + solver), settings);
    std::array<BodyHandle, 2> boxes;
    for (int i = 0; i < 2; ++i) {
      BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, i - 0.5));
      def.shapes[0].friction = 1;
      def.angularVelocity = Real(spin) * axis, def.velocity = cross(def.angularVelocity, def.X_WB.p);
      boxes[static_cast<std::size_t>(i)] = world.add(def);
    }
    world.add(ForceDef<D>{.kind = springKind(stiffness), .bodyA = boxes[0], .bodyB = boxes[1]});
    const auto momentum = [&] { return double(invariants(world).angularMomentum[D == 2 ? 0 : 2]); };
    const double from = momentum();
    double least = from, back = 0, last = from;
    for (int i = 0; i < 300; ++i) {
      world.step(kDt);
      const double now = momentum();
      if (last > 0 && now <= 0 && back == 0) back = double(world.time()) - double(kDt) * now / (now - last);
      least = std::min(least, now), last = now;
    }
    if (solver == "soft_step{arms=as_made}") {
      known(in<D>("turns back after, s"), solver, period / 4, back);
      known(in<D>("least L of 5 s over L"), solver, -1, least / from);
    } else {
      known(in<D>("L after 5 s over L"), solver, 1, last / from);
    }
    if (solver == "soft_step") known(in<D>("L after 5 s, with arms that lag, over L"), solver, shrunk, last / from);
  }
}
TEST_F(KnownAnswer, pressed_pair) { pressedPair<2>(), pressedPair<3>(); }

// 1 : 10 : 100 : 1000, heaviest on top: Gauss-Seidel needs warm starting over many steps to carry it.
TEST_F(KnownAnswer, mass_ratio_stack) {
  for (const char* solver :
       {"split_solver", "split_solver{velocity=catto{iterations=100}}", "split_solver{velocity=direct_lcp}",
        "split_solver{velocity=proximal_newton}", "soft_step", "tgs_ngs", "avbd"}) {
    World<2> world = worldOf<2>(solver);
    addGround(world);
    std::vector<BodyHandle> boxes;
    double y = 0.5;
    for (double mass : {1.0, 10.0, 100.0, 1000.0}) {
      BodyDef<2> box = body<2>(Shape<2>::box(Vec<2>::Constant(Real(0.5))), at<2>(0, y));
      box.shapes[0].density = Real(mass);
      boxes.push_back(world.add(box));
      y += 1;
    }
    for (int i = 0; i < 600; ++i) world.step(kDt);
    const double bottom = double(world.pose(boxes[0]).p[1]) - 0.5, second = double(world.pose(boxes[1]).p[1]) - 1.5;
    known("sinking of the lightest, m", solver, 0, bottom);
    known("sinking of the second, m", solver, 0, second);
    std::array<double, 4> force{};  // under each box; fallen boxes lie on the ground, too
    for (const Manifold<2>& m : world.manifolds()) {
      force[static_cast<std::size_t>(m.bodyA)] += normalImpulse(m) / double(kDt);
    }
    known("force on the ground over weight", solver, 1, force[0] / (1111 * kG));
    if (second < -0.5) continue;
    known("force under 10 kg, N", solver, 1110 * kG, force[1]);
    known("force under 100 kg, N", solver, 1100 * kG, force[2]);
    known("force under 1000 kg, N", solver, 1000 * kG, force[3]);
  }
}

// 20 rows: the ground carries n (n + 1) / 2 boxes, the left half as much as the right.
TEST_F(KnownAnswer, pyramid_weight) {
  for (const char* solver : {"split_solver", "soft_step"}) {
    World<2> world = worldOf<2>(solver);
    addGround(world);
    const int rows = 20;
    for (int row = 0; row < rows; ++row) {
      for (int i = 0; i < rows - row; ++i) {
        world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.25)}),
                          at<2>(1.1 * (i + 0.5 * row - 0.5 * (rows - 1)), 0.25 + 0.5 * row)));
      }
    }
    for (int i = 0; i < 300; ++i) world.step(kDt);
    double total = 0, moment = 0;
    for (const Manifold<2>& m : world.manifolds()) {
      if (m.bodyA != 0) continue;
      const double x = double(world.bodies().pose[static_cast<std::size_t>(m.bodyB)].p[0]);
      total += normalImpulse(m), moment += (x > 0 ? 1 : -1) * normalImpulse(m);
    }
    const double weight = rows * (rows + 1) / 2 * 0.5 * kG * double(kDt);  // a box has 0.5 kg
    known("total over weight", solver, 1, total / weight);
    known("right minus left over weight", solver, 0, moment / weight);
  }
}

// --- convergence: one sweep after another, cold, on a column after one step of gravity -------------------------------

// Bodies of the given masses, bottom first, that move only up and down.
ImpactScene<2> column(const std::vector<double>& masses) {
  ImpactScene<2> s;
  s.add(0, Ang<2>::Zero(), {});
  for (std::size_t i = 0; i < masses.size(); ++i) {
    s.add(Real(masses[i]), Ang<2>::Zero(), {{0, Real(i + 1)}, {}}, {{0, -1}, Ang<2>::Zero()});
    s.touch(static_cast<int>(i), static_cast<int>(i) + 1, {0, 1}, {0, Real(i) + Real(0.5)}, 0, 0, 0);
  }
  return s;
}

const char* const kJacobi = "jacobi{splitting=none}";

// Error of the impulses after a number of sweeps. The impulses at rest are the weights above.
double impulseError(const std::vector<double>& masses, int sweeps, const char* method = "catto") {
  struct Unbiased final : PositionResolver<2> {};
  auto s = column(masses);
  Spec spec = Spec::parse(method);
  spec.set("warm_start", {"false", {}}), spec.set("iterations", {std::to_string(sweeps), {}});
  s.solve(*createStage<VelocityResolver<2>>(spec), Unbiased{});
  double error = 0, above = 0;
  for (std::size_t i = masses.size(); i-- > 0;) {
    above += masses[i];
    error = std::max(error, std::abs(double(s.manifolds[i].points[0].impulse[0]) - above) / above);
  }
  return error;
}
double sweepFactor(const std::vector<double>& masses, int k) {
  return impulseError(masses, k + 1) / impulseError(masses, k);
}

// Heavy (r m) on light (m) on the ground: each sweep multiplies the error by r / (1 + r); light on heavy by 1 / (1 +
// r).
TEST_F(KnownAnswer, mass_ratio_pgs_rate) {
  for (int r : {1, 10, 100, 1000}) {
    const std::string ratio = "r = " + std::to_string(r) + ": factor";
    known(ratio + ", heavy on light", "catto", r / (1.0 + r), sweepFactor({1, double(r)}, r == 1 ? 8 : 40));
    if (r <= 10) known(ratio + ", light on heavy", "catto", 1 / (1.0 + r), sweepFactor({double(r), 1}, 3));
  }
}

// N equal boxes. Gauss-Seidel on tridiag(-1, 2, -1) with first diagonal 1 has the spectral radius cos^2(pi / 2 N),
// Jacobi its root. Jacobi's errors come in pairs of both signs, so its factor is measured over two sweeps.
TEST_F(KnownAnswer, stack_pgs_rate) {
  for (int n : {2, 5, 10, 20, 50}) {
    if (!kDouble && n > 5) continue;  // smaller than the rounding of a float
    const double rho = std::pow(std::cos(kPi / (2 * n)), 2);
    known("N = " + std::to_string(n) + ": factor", "catto", rho,
          sweepFactor(std::vector<double>(static_cast<std::size_t>(n), 1.0), n == 2 ? 8 : 20 * n));
    const std::vector<double> boxes(static_cast<std::size_t>(n), 1.0);
    const int k = n == 2 ? 16 : 40 * n;
    known("N = " + std::to_string(n) + ": factor", kJacobi, std::sqrt(rho),
          std::sqrt(impulseError(boxes, k + 2, kJacobi) / impulseError(boxes, k, kJacobi)));
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::stack_test
