// SPDX-License-Identifier: Zlib
// The velocity problem as a whole: its matrix, its residual at right and wrong impulses, and the solutions of the
// methods that see all of it.
#include "framework/problem/contact_problem.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "algorithms/solver/island/anderson.h"
#include "algorithms/solver/island/dense.h"
#include "algorithms/solver/island/lemke.h"
#include "tests/check_property.h"
#include "tests/conformance/contact_problem.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_problem_test {

using solver::Lemke;

// W by its product equals W assembled.
template <int D>
void productIsTheMatrix(Draw& draw) {
  auto s = drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .gap = Real(0.1), .joints = 2});
  Whole<D> whole(s);
  const int n = whole.problem.size();
  std::vector<std::int32_t> all(whole.problem.grouped().begin(), whole.problem.grouped().end());
  std::vector<double> w, x(static_cast<std::size_t>(n)), y;
  whole.problem.assemble(all, w);
  for (double& value : x) value = double(draw.signedUnit());
  whole.problem.multiply(x, y);
  for (std::size_t i = 0; i < all.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < all.size(); ++j) sum += w[i * all.size() + j] * x[static_cast<std::size_t>(all[j])];
    RC_ASSERT(std::abs(sum - y[static_cast<std::size_t>(all[i])]) < kRounding * (1 + std::abs(sum)));
    RC_ASSERT(std::abs(w[i * all.size() + i] * whole.problem.row(all[i]).mass - 1) < kRounding);
  }
}
TEST(ContactProblem, ProductIsTheMatrix2) {
  check("W x in 2D", [] {
    RapidCheckDraw draw;
    productIsTheMatrix<2>(draw);
  });
}
TEST(ContactProblem, ProductIsTheMatrix3) {
  check("W x in 3D", [] {
    RapidCheckDraw draw;
    productIsTheMatrix<3>(draw);
  });
}

/// A body that cannot turn, on a slope, after one step of gravity. The right impulses are known.
template <int D>
struct OnSlope {
  static constexpr double kMass = 2, kSpeed = 9.81 / 60;
  ImpactScene<D> scene;
  double down, into;  // of the velocity that gravity caused
  OnSlope(double angle, double mu, double before)
      : down(kSpeed * std::sin(angle) + before), into(kSpeed * std::cos(angle)) {
    scene.add(0, Ang<D>::Zero(), {});
    Vec<D> v = Vec<D>::Zero();
    v[0] = static_cast<Real>(down), v[1] = static_cast<Real>(-into);
    scene.add(Real(kMass), Ang<D>::Zero(), {Vec<D>::Unit(1), {}}, {v, Ang<D>::Zero()});
    scene.touch(0, 1, Vec<D>::Unit(1), Vec<D>::Zero(), 0, static_cast<Real>(mu), 0);
  }
  /// Residual at an impulse along the normal and one against the sliding.
  ProblemResidual left(double push, double friction, bool corrected = true) {
    Whole<D> whole(scene);
    std::vector<double> x(D, 0);
    x[0] = push;
    for (int k = 1; k < D; ++k) {
      x[static_cast<std::size_t>(k)] = -friction * double(tangents(Vec<D>(Vec<D>::Unit(1)))(0, k - 1));
    }
    return whole.problem.naturalMap(x, whole.freeVelocity, corrected);
  }
};

template <int D>
void residualIsZeroAtTheAnswerAlone() {
  const double rounding = kDouble ? 1e-15 : 1e-7;
  OnSlope<D> sticks(0.5, 0.7, 0), slides(0.5, 0.3, 1);
  const double m = OnSlope<D>::kMass, n = m * slides.into;
  EXPECT_LT(sticks.left(n, m * sticks.down).natural, rounding);
  EXPECT_LT(slides.left(n, 0.3 * n).natural, rounding);
  // An error of one per cent leaves a residual of about a hundredth of the velocity that the impulse causes.
  for (const double wrong : {0.99, 1.01}) {
    EXPECT_GT(sticks.left(wrong * n, m * sticks.down).natural, 0.004 * n / m);
    EXPECT_GT(sticks.left(n, wrong * m * sticks.down).natural, 0.004 * sticks.down);
    EXPECT_GT(slides.left(wrong * n, wrong * 0.3 * n).natural, 0.004 * n / m);
    EXPECT_GT(slides.left(n, wrong * 0.3 * n).natural, 0.001 * n / m);
  }
  EXPECT_GT(slides.left(0, 0).natural, 0.5 * n / m);
  EXPECT_LT(slides.left(n, 0.3 * n).cone, rounding);
  EXPECT_GT(slides.left(n, 0.31 * n).cone, 0.004 * n / m);
  EXPECT_GT(slides.left(-n, 0).cone, 0.5 * n / m);
  // Planted: without the correction, the natural map has a residual for a sliding contact. For a sticking contact both
  // agree.
  expectCaught("ContactProblem a natural map without De Saxce's correction " + std::to_string(D) + 'D',
               slides.left(n, 0.3 * n, false).natural < rounding);
  EXPECT_LT(sticks.left(n, m * sticks.down, false).natural, rounding);
}
TEST(ContactProblem, ResidualIsZeroAtTheSolutionOnly2) { residualIsZeroAtTheAnswerAlone<2>(); }
TEST(ContactProblem, ResidualIsZeroAtTheSolutionOnly3) { residualIsZeroAtTheAnswerAlone<3>(); }

// A NaN impulse or velocity in any row is no solution.
template <int D>
void whatIsNoNumberIsNoAnswer() {
  OnSlope<D> two(0.5, 0.3, 1);
  two.scene.add(Real(1), Ang<D>::Zero(), {Vec<D>::Unit(1), {}});
  two.scene.touch(0, 2, Vec<D>::Unit(1), Vec<D>::Zero(), 0, Real(0.3), 0);
  Whole<D> whole(two.scene);
  for (std::size_t i = 0; i < whole.freeVelocity.size(); ++i) {
    std::vector<double> x(whole.freeVelocity.size(), 0), u = whole.freeVelocity;
    x[i] = std::nan("");
    const ProblemResidual pushed = whole.problem.naturalMap(x, u);
    EXPECT_TRUE(std::isnan(pushed.natural) && std::isnan(pushed.cone)) << i;
    x[i] = 0, u[i] = std::nan("");
    EXPECT_TRUE(std::isnan(whole.problem.naturalMap(x, u).natural)) << i;
  }
}
TEST(ContactProblem, NanIsNoSolution2) { whatIsNoNumberIsNoAnswer<2>(); }
TEST(ContactProblem, NanIsNoSolution3) { whatIsNoNumberIsNoAnswer<3>(); }

// Methods that see the whole problem leave no residual. direct_lcp is exact in 2D only, where its friction pyramid is
// the cone.
template <int D>
void nothingIsLeft(const std::string& spec, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = true, .friction = true, .gap = Real(0.05), .joints = draw.below(2)});
  for (Manifold<D>& m : before.manifolds) m.friction = std::min(m.friction, Real(0.3));
  const auto resolver = createStage<VelocityResolver<D>>(Spec::parse(spec));
  auto after = solved(before, *resolver);
  const ProblemResidual left = Whole<D>::left(before, after);
  if (!(left.natural < (kDouble ? 1e-6 : 1e-3) * double(before.speed())))
    RC_LOG() << left.natural << '\n' << before << after;
  RC_ASSERT(left.natural < (kDouble ? 1e-6 : 1e-3) * double(before.speed()));
}
TEST(ContactProblem, ResidualVanishes2) {
  for (const char* spec : {"nncg{iterations=2000}", "direct_lcp{cfm=1e-5}", "admm{iterations=1000}"}) {
    check(
        std::string("2D ") + spec,
        [&] {
          RapidCheckDraw draw;
          nothingIsLeft<2>(spec, draw);
        },
        30);
  }
}
TEST(ContactProblem, ResidualVanishes3) {
  for (const char* spec : {"nncg{iterations=2000}", "admm{iterations=1000}"}) {
    check(
        std::string("3D ") + spec,
        [&] {
          RapidCheckDraw draw;
          nothingIsLeft<3>(spec, draw);
        },
        30);
  }
}

// Methods that solve a matrix alone leave no residual in the problem of the bodies. In f32 the default cfm stays: it is
// above the rounding of rows.
template <int D>
void matrixIsSolvedAsItsBodiesAre(const Registered& method, Draw& draw) {
  auto s = drawImpact<D>(draw, {.fixed = true, .friction = true, .gap = Real(0.05), .joints = draw.below(2)});
  for (Manifold<D>& m : s.manifolds) m.friction = std::min(m.friction, Real(0.3));
  if (D == 3 && method.info.friction == FrictionLaw::facets) s.model.friction = false;  // its pyramid is not the cone
  Given<D> given(s);
  Spec spec = withIterations(method, 2000, 0);
  for (const ParamInfo& p : method.params) {
    if (kDouble && p.name == "cfm") spec.set("cfm", Spec::parse("1e-5"));
  }
  RC_ASSERT(given.left(spec, given.matrix) < (kDouble ? 1e-6 : 1e-3) * double(s.speed()));
}
template <int D>
void everyMatrixMethod() {
  for (const Registered* r : Registry::instance().list(StageKind::velocity, D)) {
    if (!r->info.matrixAlone || !competes(*r)) continue;
    const auto property = [&] {
      RapidCheckDraw draw;
      matrixIsSolvedAsItsBodiesAre<D>(*r, draw);
    };
    check("a matrix and its bodies " + std::to_string(D) + "D " + r->info.name, property, 30);
  }
  OnSlope<D> slides(0.5, 0.3, 1);
  Given<D> given(slides.scene);
  const Spec nncg = Spec::parse("nncg{iterations=2000}");
  const double most = kDouble ? 1e-9 : 1e-5;
  EXPECT_LT(given.left(nncg, given.matrix), most);
  GivenProblem warm = given.matrix;  // the solution is the start of the next solve
  Given<D>::solve(nncg, warm);
  warm.velocity = given.matrix.velocity;
  EXPECT_LT(given.left(Spec::parse("nncg{iterations=0}"), warm), most);
  EXPECT_GT(given.left(Spec::parse("nncg{iterations=0}"), given.matrix), 0.01);
  const auto plant = [&](const std::string& what, const auto& change) {
    GivenProblem planted = given.matrix;
    change(planted);
    expectCaught("GivenProblem " + what + ' ' + std::to_string(D) + 'D', given.left(nncg, planted) < most);
  };
  plant("an entry is another", [](GivenProblem& p) { p.value.front() *= 1.01; });
  plant("friction is another", [](GivenProblem& p) { p.friction[0] = 0.31; });
  plant("what is wanted is another", [](GivenProblem& p) { p.velocity[0] *= 1.01; });
}
TEST(GivenProblem, SolutionSolvesItsBodies2) { everyMatrixMethod<2>(); }
TEST(GivenProblem, SolutionSolvesItsBodies3) { everyMatrixMethod<3>(); }

// Without its correction admm solves the convex law: a sliding body lifts off with mu times its speed. With it, the
// body stays down.
template <int D>
void convexLifts() {
  for (const bool corrected : {true, false}) {
    OnSlope<D> before(0, 0.3, 2);
    const auto admm = createStage<VelocityResolver<D>>(Spec::parse(corrected ? "admm" : "admm{correction=none}"));
    auto after = solved(before.scene, *admm);
    const double lift = double(after.motion(1).v[1]), speed = double(after.motion(1).v[0]);
    EXPECT_NEAR(lift, corrected ? 0 : 0.3 * speed, 1e-6);
    EXPECT_GT(speed, 1.5);
    EXPECT_LT(Whole<D>::left(before.scene, after, corrected).natural, 1e-6);
  }
}
TEST(Admm, WithoutCorrectionSlidingBodiesLift2) { convexLifts<2>(); }
TEST(Admm, WithoutCorrectionSlidingBodiesLift3) { convexLifts<3>(); }

// A plate falls on four posts, or is held by four rods. Each of the four pushes back the whole plate, or its share.
double kineticAfter(const std::string& splitting, int iterations, bool rods) {
  ImpactScene<2> s;
  s.add(4, Ang<2>::Constant(1000), {{0, 1}, {}}, {{0, -1}, Ang<2>::Zero()});
  for (const double x : {-1.5, -0.5, 0.5, 1.5}) {
    const int post = s.add(0, Ang<2>::Zero(), {{static_cast<Real>(x), 0}, {}});
    const Vec<2> p(static_cast<Real>(x), 1);
    if (rods) s.join(post, 0, p, Vec<2>::Zero());
    if (!rods) s.touch(post, 0, {0, 1}, p, 0, 0, 0);
  }
  const auto jacobi = createStage<VelocityResolver<2>>(
      Spec::parse("jacobi{splitting=" + splitting + ",iterations=" + std::to_string(iterations) + "}"));
  return double(solved(s, *jacobi).energy());
}
bool keepsEnergy(const std::string& splitting, bool rods) {
  for (const int iterations : {1, 5, 25}) {
    if (kineticAfter(splitting, iterations, rods) > 2 * 1.000001) return false;  // the kinetic energy at the start
  }
  return true;
}
TEST(Jacobi, SplittingKeepsEnergy) {
  for (const bool rods : {false, true}) {
    EXPECT_TRUE(keepsEnergy("mass", rods));
    EXPECT_TRUE(keepsEnergy("averaged", rods));
    expectCaught(std::string("Jacobi.SplittingKeepsEnergy without splitting, ") + (rods ? "rods" : "posts"),
                 keepsEnergy("none", rods));
  }
  EXPECT_GT(kineticAfter("none", 1, false), 2 * 8);  // nearly three times as fast
  EXPECT_GT(kineticAfter("none", 25, true), 1e12);
}

// Rows that a method leaves to sweeps are counted. Limits: one body exceeds max_bodies=0, three rows exceed max_rows=2.
TEST(Fallback, IsCounted) {
  OnSlope<3> before(0.5, 0.3, 1);
  Given<3> given(before.scene);
  const auto left = [&](const std::string& spec) {
    const auto resolver = createStage<VelocityResolver<3>>(Spec::parse(spec));
    return solved(before.scene, *resolver).work[WorkCount::fallbacks];
  };
  const auto leftOfMatrix = [&](const std::string& spec) {
    ImpactScene<3> none;
    VelocityInput<3> in = inputOf(none);
    GivenProblem matrix = given.matrix;
    in.given = &matrix;
    createStage<VelocityResolver<3>>(Spec::parse(spec))->solve(in);
    return none.work[WorkCount::fallbacks];
  };
  for (const std::string name : {"direct_lcp", "admm", "proximal_newton"}) {
    EXPECT_EQ(left(name), 0u);
    EXPECT_EQ(left(name + "{max_bodies=1}"), 0u);
    EXPECT_EQ(left(name + "{max_bodies=0}"), 3u);
  }
  for (const std::string name : {"direct_lcp", "admm"}) {
    EXPECT_EQ(leftOfMatrix(name + "{max_rows=3}"), 0u);
    EXPECT_EQ(leftOfMatrix(name + "{max_rows=2}"), 3u);
  }
}

// A NaN velocity has no solution and the method returns none: the rows are left to sweeps, and counted.
template <int D>
void noNumberIsNoAnswer() {
  for (int axis = 0; axis < 2; ++axis) {
    OnSlope<D> before(0.5, 0.3, 1);
    const auto newton = createStage<VelocityResolver<D>>(Spec::parse("proximal_newton"));
    EXPECT_EQ(solved(before.scene, *newton).work[WorkCount::fallbacks], 0u);
    before.scene.bodies.motion[1].v[axis] = std::numeric_limits<Real>::quiet_NaN();
    EXPECT_EQ(solved(before.scene, *newton).work[WorkCount::fallbacks], std::uint64_t(D));
  }
}
TEST(ProximalNewton, LeavesNanToSweeps) { noNumberIsNoAnswer<2>(), noNumberIsNoAnswer<3>(); }

// Bodies between others, with friction. Some of a few hundred drawn problems have no solution, or the passes do not
// converge. The others are solved without residual.
template <int D>
int solvedOf(int problems) {
  PlainDraw draw(D);
  const auto newton = createStage<VelocityResolver<D>>(Spec::parse("proximal_newton"));
  int right = 0;
  for (int run = 0; run < problems; ++run) {
    const auto before =
        drawImpact<D>(draw, {.fixed = true, .friction = true, .gap = Real(0.05), .joints = draw.below(2)});
    auto after = solved(before, *newton);
    right += Whole<D>::left(before, after).natural < (kDouble ? 1e-8 : 1e-5) * double(before.speed());
  }
  return right;
}
TEST(ProximalNewton, SolvesMostWedgedProblems) {
  EXPECT_GT(solvedOf<2>(300), 278);
  EXPECT_GT(solvedOf<3>(300), 259);
}

// s = A s + b, where A is far from a contraction: solved when there is one guess more than unknowns.
TEST(Anderson, SolvesLinearProblems) {
  PlainDraw draw(5);
  solver::Anderson anderson;
  for (int run = 0; run < 100; ++run) {
    const int n = 1 + draw.below(5);
    Eigen::MatrixXd a(n, n);
    Eigen::VectorXd b(n);
    for (int i = 0; i < n; ++i) {
      b[i] = double(draw.signedUnit());
      for (int j = 0; j < n; ++j) a(i, j) = 2 * double(draw.signedUnit());
    }
    const Eigen::VectorXd answer = (Eigen::MatrixXd::Identity(n, n) - a).partialPivLu().solve(b);
    if (answer.norm() > 10) continue;
    std::vector<double> s(static_cast<std::size_t>(n)), to(s.size());
    anderson.begin();
    for (int guess = 0; guess < 2 * n + 6; ++guess) {
      const Eigen::VectorXd now = Eigen::Map<Eigen::VectorXd>(s.data(), n), next = a * now + b;
      std::copy(next.begin(), next.end(), to.begin());
      anderson.next(s, to);
    }
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(s.data(), n) - answer).norm(), 1e-9) << a << '\n' << b.transpose();
  }
}

// Full and banded matrices.
TEST(Dense, SolutionsEqualThoseOfEigen) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  PlainDraw draw(11);
  solver::SymmetricFactor symmetric;
  solver::GeneralFactor general;
  const auto entries = [](const Matrix& m) { return std::vector<double>(m.data(), m.data() + m.size()); };
  for (int run = 0; run < 100; ++run) {
    const int n = 1 + draw.below(20), band = 1 + draw.below(n);
    Matrix a = Matrix::Zero(n, n);
    Eigen::VectorXd b(n);
    for (int i = 0; i < n; ++i) {
      b[i] = double(draw.signedUnit());
      for (int j = std::max(0, i - band); j < std::min(n, i + band); ++j) a(i, j) = double(draw.signedUnit());
    }
    const Matrix w = a * a.transpose() + 1e-3 * Matrix::Identity(n, n);
    Eigen::VectorXd x = b, y = b;
    symmetric.factor(static_cast<std::size_t>(n), entries(w));
    symmetric.solve(x.data());
    const Eigen::VectorXd expected = w.ldlt().solve(b);
    EXPECT_LT((x - expected).norm(), 1e-9 * (1 + expected.norm()));
    ASSERT_TRUE(general.factor(static_cast<std::size_t>(n), entries(a)));
    general.solve(y.data());
    const Eigen::VectorXd other = a.partialPivLu().solve(b);
    EXPECT_LT((y - other).norm(), 1e-9 * (1 + other.norm()));
  }
  // Two identical rows: one of them does the work.
  std::array<double, 2> x = {2, 2};
  symmetric.factor(2, {1, 1, 1, 1});
  symmetric.solve(x.data());
  EXPECT_EQ(x, (std::array<double, 2>{2, 0}));
  EXPECT_FALSE(general.factor(2, {1, 1, 1, 1}));
}

// w = M z + q with M = A A^T + a skew part, which has a solution.
TEST(Lemke, SolutionsAreComplementary) {
  PlainDraw draw(7);
  Lemke lemke;
  for (int run = 0; run < 200; ++run) {
    const auto n = static_cast<std::size_t>(1 + draw.below(12)), rank = static_cast<std::size_t>(1 + draw.below(12));
    std::vector<double> a(n * rank), m(n * n), q(n), z;
    for (double& value : a) value = double(draw.signedUnit());
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = draw.coin() ? double(draw.signedUnit()) : 0;
      for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < rank; ++k) m[i * n + j] += a[i * rank + k] * a[j * rank + k];
        const double skew = j < i ? double(draw.signedUnit()) : 0;
        m[i * n + j] += skew, m[j * n + i] -= skew;
      }
      m[i * n + i] += 1e-3;
    }
    ASSERT_EQ(lemke.solve(n, m, q, 1000, z), Lemke::End::solved);
    for (std::size_t i = 0; i < n; ++i) {
      double w = q[i];
      for (std::size_t j = 0; j < n; ++j) w += m[i * n + j] * z[j];
      EXPECT_GE(z[i], 0);
      EXPECT_GE(w, -1e-9);
      EXPECT_LE(std::min(w, z[i]), 1e-9);
    }
  }
  std::vector<double> z;
  EXPECT_EQ(lemke.solve(1, {-1}, {-1}, 100, z), Lemke::End::noSolution);
  EXPECT_EQ(lemke.solve(2, {1, 0, 0, 1}, {-1, -2}, 1, z), Lemke::End::outOfPivots);
}

}  // namespace contact_problem_test
}}}  // namespace lpc::LPC_PRECISION::test
