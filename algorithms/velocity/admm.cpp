// SPDX-License-Identifier: Zlib
#include "algorithms/solver/island/island.h"
#include "algorithms/solver/rows/whole_problem.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

enum class Correction { deSaxce, none };

// Alternating direction method of multipliers, island by island: x solves the linear system, y obeys the limits, and a
// multiplier z on their difference brings them together.
//
// x = (W + eta + rho)^-1 (-u(0) + eta x + rho y - z),  y = nearest allowed to x + z / rho,  z += rho (x - y)
//
// so that u = -z at convergence. De Saxce's correction is added to u(0) in each iteration, from the sliding of the
// previous one. Each row is scaled by its own effective mass, so that rho is a pure number; rows without limits have
// none. The system is solved over the bodies, linear for a tower, or as a dense matrix if only a matrix is given.
// Projected Gauss-Seidel solves islands that are too large; they are counted: WorkCount::fallbacks.
template <int D>
class Admm final : public VelocityResolver<D>, private WholeProblem<D> {
 public:
  struct Params {
    int iterations = 100;
    Real tolerance = Real(1e-9);
    Real proximal = 0;
    Correction correction = Correction::deSaxce;
    bool warmStart = true;
    int maxBodies = 1000;
    int maxRows = 200;
    int sweeps = 20;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 1, 100000, "largest number of iterations per island", ParamRole::effort);
      v.real("tolerance", tolerance, 0, 1, "m/s",
             "stop when the errors of the contact law and of limits are below this", ParamRole::tolerance);
      v.real("proximal", proximal, 0, 1, "1",
             "proximal weight over W_ii, which handles redundant contacts; 0: 1e-6, in f32 1e-3");
      v.choice("correction", correction, {"de_saxce", "none"},
               "de_saxce: Coulomb's law; none: the convex law, which lifts sliding bodies");
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.integer("max_bodies", maxBodies, 0, 10000, "bodies of the largest island that this method solves");
      v.integer("max_rows", maxRows, 0, 5000, "rows of the largest matrix without bodies that this method solves");
      v.integer("sweeps", sweeps, 0, 100000, "projected Gauss-Seidel passes over islands larger than max_bodies");
    }
  };
  explicit Admm(const Params& params) : m_params(params) {
    if (m_params.proximal == 0) m_params.proximal = sizeof(Real) == 8 ? Real(1e-6) : Real(1e-3);
  }

  static AlgorithmInfo info() {
    AlgorithmInfo info = {
        .name = "admm",
        .summary = "proximal ADMM with De Saxce's correction; one sparse factorisation per island and penalty",
        .paper = "carpentier2024",
        .complexity =
            "a sparse factorisation of an island's bodies per penalty and a solve per iteration, both linear in a "
            "tower; bodies^2 to order them",
        .guarantee = Guarantee::approximate,
        .failures = {{"a heavy body on a light one, with more and more iterations",
                      "it solves the island at once, so it has no Gauss-Seidel convergence rate",
                      "Joint.ConvergesAsPredicted"},
                     {"a hard problem, with the default of 100 iterations",
                      "it stops before it has converged: 20,000 iterations solve most of those that 100 leave",
                      "VerifyVelocities.AdmmNeedsManyIterations"}},
        .friction = FrictionLaw::coulomb,
        .otherFriction = {{"correction", "none", FrictionLaw::convex}},
        .matrixAlone = true};
    if (sizeof(Real) == 4) {
      info.failures.push_back({"a motor of 1e6 N m at its joint limit, in f32",
                               "each iteration adds at most 1 / proximal, so the motor's limit is never reached",
                               "Joint.StopHoldsAgainstItsMotor"});
    }
    return info;
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      this->prepare(in, m_params.warmStart ? 1 : 0);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    this->eachIsland(in.work, m_params.sweeps, [&](std::span<const std::int32_t> rows) {
      if (!m_island.set(in, m_problem, rows, m_free, m_impulse, m_params.maxBodies, m_params.maxRows)) return false;
      m_island.multiplyAdds = 0;
      iterate();
      in.work[WorkCount::multiplyAdds] += m_island.multiplyAdds;
      m_island.store(m_impulse);
      return true;
    });
    m_problem.apply(in, m_impulse);
  }

 private:
  using WholeProblem<D>::m_problem, WholeProblem<D>::m_free, WholeProblem<D>::m_impulse;
  static constexpr double kPower = 0.05,
                          kRatio = 10;  // of the update of rho: its exponent, and the ratio that triggers it
  static constexpr int kFirstPower = 6, kLastPower = 12, kPatience = 5;
  // Above this coefficient a cone is as good as a half-space, and the correction would make the iteration diverge.
  static constexpr double kSteepest = 10;
  static constexpr double kBetter = 0.9;    // of the smallest residual so far: less gain is rounding
  static constexpr double kDiverged = 1e6;  // residual over the smallest so far, above which the iteration has diverged

  static constexpr std::uint64_t kOfRow = 12;  // multiply-adds per row of an iteration, without the system's

  const ProblemRow<D>& row(std::size_t i) const { return m_island.row(i); }
  bool bound(std::size_t i) const { return row(i).law != ProblemLaw::free; }

  void begin() {
    const std::size_t n = m_island.size();
    for (auto* v : {&m_lifted, &m_x, &m_y, &m_z, &m_change, &m_diagonal, &m_slide}) v->resize(n);
    m_largest = m_factor.set(m_island);
    m_x = m_y = m_island.x;
    multiply();
    lift();
    for (std::size_t i = 0; i < n; ++i) m_z[i] = bound(i) ? m_island.u[i] - m_slide[i] - m_lifted[i] : 0;
  }

  /// Computes W x and its velocities.
  void multiply() {
    m_island.multiply(m_x, m_product);
    for (std::size_t i = 0; i < m_x.size(); ++i) m_slide[i] = m_product[i] + m_island.u[i];
  }

  static double squared(double x) { return x * x; }

  /// u(0) as a contact's law sees it, with the sliding of the last iterate. Returns the largest change, m/s.
  double lift() {
    double change = 0;
    for (std::size_t i = 0; i < m_island.size(); ++i) {
      double wanted = m_island.u[i];
      if (m_params.correction == Correction::deSaxce && row(i).law == ProblemLaw::normal) {
        double slide = 0;
        for (std::size_t k = 1; k < D; ++k) slide += m_slide[i + k] * m_slide[i + k];
        wanted += steepness(i) * std::sqrt(slide);
      }
      change = std::max(change, std::abs(wanted - m_lifted[i]) / m_island.root[i]);
      m_lifted[i] = wanted;
    }
    return change;
  }

  double steepness(std::size_t i) const { return std::min(row(i).friction, kSteepest); }

  void limit(std::size_t i) {
    const ProblemRow<D>& r = row(i);
    if (r.law == ProblemLaw::interval) m_y[i] = std::clamp(m_y[i], r.lo / m_island.root[i], r.hi / m_island.root[i]);
    if (r.law == ProblemLaw::normal) projectOnCone<D>(steepness(i), m_y.data() + i);
  }

  void factor(double rho) {
    for (std::size_t i = 0; i < m_x.size(); ++i) m_diagonal[i] = double(m_params.proximal) + (bound(i) ? rho : 0);
    m_factor.factor(m_island, m_diagonal);
  }

  void iterate() {
    begin();
    const std::size_t n = m_island.size();
    const double eta = double(m_params.proximal);
    int power = kFirstPower;
    // Starts from the geometric mean of the smallest and the largest eigenvalue, adapted by the residuals.
    const auto penalty = [&] { return std::sqrt(eta * m_largest) * std::pow(m_largest / eta, kPower * power); };
    double rho = penalty(), least = std::numeric_limits<double>::infinity();
    factor(rho);
    for (int it = 1; it <= m_params.iterations; ++it) {
      // Solves for the change of x, so that rounding is relative to the change.
      for (std::size_t i = 0; i < n; ++i) {
        m_change[i] = -m_product[i] - m_lifted[i] + (bound(i) ? rho * (m_y[i] - m_x[i]) - m_z[i] : 0);
      }
      m_yBefore = m_y;
      m_factor.solve(m_island, m_change);
      for (std::size_t i = 0; i < n; ++i) m_x[i] += m_change[i];
      multiply();
      m_island.multiplyAdds += kOfRow * n;
      for (std::size_t i = 0; i < n; ++i) m_y[i] = bound(i) ? m_x[i] + m_z[i] / rho : m_x[i];
      for (std::size_t i = 0; i < n; ++i) limit(i);
      double apart = 0, moved = 0, sum = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const double weight = bound(i) ? rho : 0, difference = m_x[i] - m_y[i];
        m_z[i] += weight * difference, sum += m_y[i];
        apart += squared(difference / m_island.root[i]);
        moved += squared((weight * (m_yBefore[i] - m_y[i]) - eta * m_change[i]) / m_island.root[i]);
      }
      apart = std::sqrt(apart), moved = std::sqrt(moved);  // norms that do not depend on the orientation of the frame
      const double residual = std::max({apart, moved, lift()});
      if (!(residual <= kDiverged * least) || !std::isfinite(sum)) break;
      if (residual < kBetter * least || residual <= double(m_params.tolerance)) least = residual, m_island.x = m_y;
      if (residual <= double(m_params.tolerance)) break;
      if (it % kPatience != 0) continue;
      const int step = apart > kRatio * moved ? 1 : moved > kRatio * apart ? -1 : 0;
      if (step == 0 || power + step < 0 || power + step > kLastPower) continue;
      power += step, rho = penalty();
      factor(rho);
    }
  }

  Params m_params;
  IslandFactor<D> m_factor;
  Island<D> m_island;
  double m_largest = 0;  // bound on the eigenvalues of W
  IndexedVector<double> m_lifted, m_x, m_y, m_z, m_slide, m_product, m_change, m_diagonal, m_yBefore;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Admm, 2, 3);

}}  // namespace lpc::LPC_PRECISION
