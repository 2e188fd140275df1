// SPDX-License-Identifier: Zlib
// Methods that factorise: their counts of work, the sparse matrices that they solve, and their solutions.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "algorithms/solver/island/block_matrix.h"
#include "algorithms/solver/island/dense.h"
#include "tests/check_property.h"
#include "tests/conformance/contact_problem.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_problem_test {

/// A tower of `n` boxes after one step of gravity.
template <int D>
ImpactScene<D> tower(int n) {
  ImpactScene<D> s;
  s.add(0, Ang<D>::Zero(), {});
  for (int i = 0; i < n; ++i) {
    Vec<D> middle = Vec<D>::Zero(), v = Vec<D>::Zero();
    middle[1] = Real(0.5) + static_cast<Real>(i), v[1] = Real(-9.81 / 60);
    s.add(1, Ang<D>::Constant(Real(1) / 6), {middle, {}}, {v, Ang<D>::Zero()});
    for (const double x : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) {
        if (D == 2 && z > 0) continue;
        Vec<D> p = middle;
        p[0] = static_cast<Real>(x), p[1] = static_cast<Real>(i);
        if constexpr (D == 3) p[2] = static_cast<Real>(z);
        s.touch(i, i + 1, Vec<D>::Unit(1), p, 0, Real(0.5), 0);
      }
    }
  }
  return s;
}

// Work counts are true: each method that is given rows counts multiply-adds. A method that factorises counts
// proportionally to the height of a tower, or to the cube of a dense matrix.
template <int D>
void countsAreWhatIsDone() {
  for (const Registered* r : Registry::instance().list(StageKind::velocity, D)) {
    if (!competes(*r)) continue;
    const auto resolver = createStage<VelocityResolver<D>>(Spec{r->info.name, {}});
    auto before = tower<D>(3);
    auto after = solved(before, *resolver);
    EXPECT_GT(after.work[WorkCount::multiplyAdds], 0u) << r->info.name;
    const bool factorises =
        std::any_of(r->params.begin(), r->params.end(), [](const ParamInfo& p) { return p.name == "max_bodies"; });
    EXPECT_EQ(after.work[WorkCount::rowUpdates] == 0, factorises) << r->info.name;
  }
  for (const char* spec : {"admm{iterations=3}", "direct_lcp"}) {
    const auto of = [&](int n) {
      const auto resolver = createStage<VelocityResolver<D>>(Spec::parse(spec));
      auto scene = tower<D>(n);
      scene.manifolds = solved(scene, *resolver).manifolds,
      scene.lastDt = scene.dt;  // warm: the pushing contacts are known
      auto end = solved(scene, *resolver);
      EXPECT_EQ(end.work[WorkCount::fallbacks], 0u) << spec;
      return static_cast<double>(end.work[WorkCount::multiplyAdds]);
    };
    EXPECT_NEAR(of(40) / of(20), 2, 0.3) << spec;
  }
  const auto ofMatrix = [&](int n) {
    auto scene = tower<D>(n);
    Given<D> given(scene);
    ImpactScene<D> none;
    VelocityInput<D> in = inputOf(none);
    in.given = &given.matrix;
    createStage<VelocityResolver<D>>(Spec::parse("admm{iterations=3,max_rows=1000}"))->solve(in);
    return static_cast<double>(none.work[WorkCount::multiplyAdds]);
  };
  expectCaught("Counts a tower as a dense matrix " + std::to_string(D) + 'D',
               std::abs(ofMatrix(40) / ofMatrix(20) - 2) < 0.3);
}
TEST(Counts, EqualTheWorkDone2) { countsAreWhatIsDone<2>(); }
TEST(Counts, EqualTheWorkDone3) { countsAreWhatIsDone<3>(); }

TEST(Counts, OfDenseFactorsGrowAsTheCube) {
  const auto counts = [](std::size_t n) {
    std::vector<double> a(n * n);
    for (std::size_t i = 0; i < n * n; ++i) a[i] = 1.0 / static_cast<double>(1 + i % n + i / n);
    for (std::size_t i = 0; i < n; ++i) a[i * n + i] += static_cast<double>(n);
    solver::SymmetricFactor symmetric;
    solver::GeneralFactor general;
    symmetric.factor(n, a);
    EXPECT_TRUE(general.factor(n, a));
    return std::array{static_cast<double>(symmetric.multiplyAdds), static_cast<double>(general.multiplyAdds),
                      static_cast<double>(symmetric.multiplyAddsOfSolve()),
                      static_cast<double>(general.multiplyAddsOfSolve())};
  };
  const auto one = counts(60), two = counts(120);
  const double n3 = 120.0 * 120 * 120, n2 = 120.0 * 120;
  EXPECT_NEAR(two[0] / n3, 1.0 / 6, 0.02);
  EXPECT_NEAR(two[1] / n3, 1.0 / 3, 0.02);
  EXPECT_NEAR(two[2] / n2, 1, 0.02);
  EXPECT_NEAR(two[3] / n2, 1, 0.02);
  EXPECT_NEAR(two[0] / one[0], 8, 0.5);
  EXPECT_NEAR(two[1] / one[1], 8, 0.5);
}

// A x = b with blocks between bodies, symmetric or not, equals the solution of the dense matrix.
void blocksAreSolved(Draw& draw) {
  constexpr std::size_t kBlock = 3;
  using Block = std::array<double, kBlock * kBlock>;
  const int nodes = 2 + draw.below(12);
  std::vector<std::pair<int, int>> edges;
  for (int i = 1; i < nodes; ++i) edges.push_back({draw.below(i), i});
  for (int k = draw.below(6); k > 0; --k) {
    const int a = draw.below(nodes), b = draw.below(nodes);
    if (a != b) edges.push_back({a, b});
  }
  solver::BlockLu<kBlock> general;
  solver::BlockCholesky<kBlock> symmetric;
  general.analyse(static_cast<std::size_t>(nodes), edges), symmetric.analyse(static_cast<std::size_t>(nodes), edges);
  general.set(8), symmetric.set(40);
  const auto n = static_cast<Eigen::Index>(kBlock) * nodes;
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n) * 8, s = Eigen::MatrixXd::Identity(n, n) * 40;
  const auto put = [&](Eigen::MatrixXd& to, int i, int j, const Block& block) {
    for (std::size_t r = 0; r < kBlock; ++r) {
      for (std::size_t c = 0; c < kBlock; ++c) {
        to(static_cast<Eigen::Index>(kBlock) * i + static_cast<Eigen::Index>(r),
           static_cast<Eigen::Index>(kBlock) * j + static_cast<Eigen::Index>(c)) += block[r * kBlock + c];
      }
    }
  };
  const auto sum = [](Block& to, const Block& block, bool turned) {
    for (std::size_t r = 0; r < kBlock; ++r) {
      for (std::size_t c = 0; c < kBlock; ++c) to[r * kBlock + c] += block[turned ? c * kBlock + r : r * kBlock + c];
    }
  };
  for (const auto& [i, j] : edges) {
    Block first, second;
    for (double& v : first) v = double(draw.signedUnit());
    for (double& v : second) v = double(draw.signedUnit());
    put(a, i, j, first), put(a, j, i, second);
    const auto at = general.between(i, j);
    sum(general.below(at.at), at.turned ? second : first, false);
    sum(general.above(at.at), at.turned ? first : second, false);
    Block back{};
    sum(back, first, true);
    put(s, i, j, first), put(s, j, i, back);
    sum(symmetric.below(symmetric.between(i, j).at), first, symmetric.between(i, j).turned);
  }
  std::vector<double> x(static_cast<std::size_t>(n));
  for (double& v : x) v = double(draw.signedUnit());
  const Eigen::VectorXd b = Eigen::Map<Eigen::VectorXd>(x.data(), n);
  std::vector<double> y = x;
  RC_ASSERT(general.factor());
  symmetric.factor();
  general.solve(x), symmetric.solve(y);
  RC_ASSERT((a * Eigen::Map<Eigen::VectorXd>(x.data(), n) - b).norm() < 1e-9 * b.norm());
  RC_ASSERT((s * Eigen::Map<Eigen::VectorXd>(y.data(), n) - b).norm() < 1e-9 * b.norm());
  RC_ASSERT(general.multiplyAdds > symmetric.multiplyAdds);
}
TEST(BlockMatrix, IsSolved) {
  check(
      "blocks between bodies",
      [] {
        RapidCheckDraw draw;
        blocksAreSolved(draw);
      },
      100);
}

// Four corners of a plate that slides and spins share its weight, or the method declares that its forces are not
// unique.
double spreadOfCorners(const std::string& spec) {
  const auto resolver = createStage<VelocityResolver<3>>(Spec::parse(spec));
  const Real dt = Real(1) / 60, fall = 10 * dt, weight = 2 * fall;
  Motion<3> motion{{2, -fall, 0}, {0, 20, 0}};
  std::array<IndexedArray<Real, 3>, 4> impulse{};
  Real angle = 0, lastDt = 0;
  double spread = 0;
  for (int step = 0; step < 20; ++step) {  // each step starts with the last impulses, and gravity
    ImpactScene<3> s;
    s.lastDt = lastDt, lastDt = dt;
    s.add(0, Ang<3>::Zero(), {});
    s.add(2, Ang<3>(Real(0.02 / 3), Real(0.04 / 3), Real(0.02 / 3)), {{0, Real(0.002), 0}, {}}, motion);
    for (std::size_t k = 0; k < 4; ++k) {
      const Real at = angle + (static_cast<Real>(k) + Real(0.5)) * Real(1.5707963267948966);
      const Real reach = Real(0.1) * std::sqrt(Real(2));
      s.touch(0, 1, Vec<3>::Unit(1), {reach * std::cos(at), 0, -reach * std::sin(at)}, 0, Real(0.3), 0);
      s.manifolds[k].points[0].impulse = impulse[k];
    }
    auto after = solved(s, *resolver);
    Real least = weight, most = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      impulse[k] = after.manifolds[k].points[0].impulse;
      least = std::min(least, impulse[k][0]), most = std::max(most, impulse[k][0]);
    }
    spread = std::max(spread, double((most - least) / (weight / 4)));
    motion = after.motion(1), angle += dt * motion.w[1], motion.v[1] -= fall;
  }
  return spread;
}
TEST(Corners, ShareAPlateThatSlides) {
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 3)) {
    if (!competes(*r)) continue;
    const bool said = std::any_of(r->info.failures.begin(), r->info.failures.end(),
                                  [](const FailureMode& f) { return f.test == "Corners.ShareAPlateThatSlides"; });
    const double spread = spreadOfCorners(r->info.name);
    EXPECT_EQ(spread > 0.3, said) << r->info.name << ' ' << spread;
  }
}

// When active sets cycle, path following solves the problem. Without path following and Lemke's method it is left to
// sweeps.
TEST(DirectLcp, PathFollowingSolvesCyclingActiveSets) {
  PlainDraw draw(3);
  const auto whole = createStage<VelocityResolver<2>>(Spec::parse("direct_lcp{cfm=1e-5}"));
  const auto guesses = createStage<VelocityResolver<2>>(Spec::parse("direct_lcp{cfm=1e-5,max_pivots=0}"));
  int reached = 0;
  for (int run = 0; run < 3000 && reached < 5; ++run) {
    auto before = drawImpact<2>(draw, {.fixed = true, .friction = true, .gap = Real(0.05)});
    for (Manifold<2>& m : before.manifolds) m.friction = std::min(m.friction, Real(0.3));
    if (solved(before, *guesses).work[WorkCount::fallbacks] == 0) continue;
    ++reached;
    auto after = solved(before, *whole);
    EXPECT_EQ(after.work[WorkCount::fallbacks], 0u) << before;
    EXPECT_LT(Whole<2>::left(before, after).natural, (kDouble ? 1e-6 : 1e-3) * double(before.speed())) << before;
  }
  EXPECT_EQ(reached, 5);
}

}  // namespace contact_problem_test
}}}  // namespace lpc::LPC_PRECISION::test
