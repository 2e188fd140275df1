// SPDX-License-Identifier: Zlib
#include "algorithms/solver/island/anderson.h"
#include "algorithms/solver/island/spring_island.h"
#include "algorithms/solver/rows/whole_problem.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Each row is a spring: a convex problem, which Newton's method solves with a factorisation that is linear for a tower.
// The springs restart from each solution (method of multipliers, Rockafellar 1976), so that the limit is rigid. De
// Saxce's correction, from the sliding so far, turns the convex law into Coulomb's as a fixed point (Acary et al.
// 2011). Its limit is extrapolated (Walker and Ni 2011); otherwise nearly wedged bodies would take hundreds of passes.
// A tower needs springs as stiff as double permits, and then two passes. Where redundant contacts are many, softer
// springs from the last impulses converge at once when nothing moves.
template <int D>
class ProximalNewton final : public VelocityResolver<D>, private WholeProblem<D> {
 public:
  struct Params {
    Real cfm = Real(1e-7);
    int passes = 30;
    int iterations = 600;
    Real tolerance = Real(1e-9);
    int maxBodies = 1000;
    int sweeps = 20;
    void visit(ParamVisitor& v) {
      v.real("cfm", cfm, Real(1e-11), Real(0.1), "1", "what a row gives way in a pass, of W_ii");
      v.integer("passes", passes, 1, 1000, "at most, from where the last has come");
      v.integer("iterations", iterations, 1, 100000,
                "at most, of Newton's method in an island and step, over all passes", ParamRole::effort);
      v.real("tolerance", tolerance, 0, 1, "1", "residual at which a pass is the last, of what rows are to do",
             ParamRole::tolerance);
      v.integer("max_bodies", maxBodies, 0, 10000, "of an island that is solved so");
      v.integer("sweeps", sweeps, 0, 100000, "of projected Gauss-Seidel, over islands that are larger");
    }
  };
  explicit ProximalNewton(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "proximal_newton",
            .summary = "method of multipliers, Newton's method over an island's bodies inside, De Saxce's correction",
            .paper = "rockafellar1976",
            .complexity =
                "a sparse factorisation of an island's bodies per iteration, linear in a tower; bodies^2 to order them",
            .guarantee = Guarantee::approximate,
            .failures = {{"a heavy body on a light one in ever more iterations",
                          "it has no rate of sweeps: it is at the end at once", "Joint.ConvergesAsPredicted"},
                         {"a slide in space that is the plane's, to a nanometre only",
                          "its passes end at a tolerance, that is coarser than rounding",
                          "Extrusion.AgreesOrSaysThatItDoesNot"}},
            .friction = FrictionLaw::coulomb};
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      this->prepare(in, 1);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    this->eachIsland(in.work, m_params.sweeps, [&](std::span<const std::int32_t> rows) {
      m_island.multiplyAdds = m_anderson.multiplyAdds = 0;
      const bool done = m_island.set(in, m_problem, rows, m_free, m_impulse, m_params.maxBodies) && descend();
      in.work[WorkCount::multiplyAdds] += m_island.multiplyAdds + m_anderson.multiplyAdds;
      for (std::size_t i = 0; done && i < rows.size(); ++i) m_impulse[rows[i]] = m_best[i];
      return done;
    });
    m_problem.apply(in, m_impulse);
  }

 private:
  using WholeProblem<D>::m_problem, WholeProblem<D>::m_free, WholeProblem<D>::m_impulse;
  using Group = typename SpringIsland<D>::Group;
  static constexpr double kBetter =
      0.9;  // of the smallest residual so far: less gain is rounding, or contradicting rows
  static constexpr double kSlow = 0.5;
  static constexpr std::uint64_t kOfRow = 8;  // multiply-adds of a residual
  static constexpr int kPatience = 3;         // passes without improvement
  static constexpr double kMoves = 1e-6, kContradiction = 1e-6;
  static constexpr double kUseful = 1e-3;            // of the scale: a residual that sweeps would not improve
  static constexpr int kTrials = 2, kFewPasses = 3;  // for the pressing rows, by full steps
  static constexpr int kTries = 8;                   // the same with a line search
  // Compliance of rows, relative to W_ii: on the way, if that fails, and finally for rows that contradict each other.
  static constexpr double kSoftest = 1e-2, kHarder = 10, kSofter = 1e-3;
  static constexpr double kEven = 0.1;  // where redundant contacts slide
  static constexpr int kEvenPasses = 30;
  static constexpr int kSoftPasses = 3, kLast = 30;  // iterations reserved for them

  // Returns false if Newton's method has not converged.
  bool descend() {
    const int kept = std::min(kLast, m_params.iterations / 3);
    m_island.budget = m_params.iterations - kept;
    m_least = std::numeric_limits<double>::infinity(), m_best = m_island.last;
    // Starts as stiff as possible, from zero. The last impulses predict which rows press: a guess that holds for most
    // steps of a tower.
    begin(double(m_params.cfm));
    for (std::size_t i = 0; i < m_island.size(); ++i) {
      m_guess[i] = m_island.last[i] - m_island.row(i).unit * (m_island.u[i] + m_island.shift[i]);
    }
    const bool moves = slides();
    bool right = !moves && m_island.tryFrom(m_guess, kTrials);
    if (right) right = refine(right, kFewPasses);
    if (moves) right = slide();
    if (!(m_least <=
          double(m_params.tolerance) * m_island.scale)) {  // from the last impulses, which a resting island keeps
      begin(kSofter);
      m_island.centre = m_island.last;
      right = m_island.newton(kTries);
      if (!right) {  // through softer problems, each of which predicts the pressing rows of the next
        begin(kSoftest);
        right = m_island.newton(m_island.budget);
      }
      right = refine(right, m_params.passes);
    }
    m_island.budget += kept;
    if (m_least > kContradiction * m_island.scale) contradicted(right);
    return std::isfinite(m_least) && (right || m_least <= kUseful * m_island.scale);
  }

  // Rows that contradict each other pull as hard as they are stiff, so their result would be rounding: a few passes of
  // softer rows replace it, whatever residual they leave. If Newton's method was only too slow, they replace it only
  // with a smaller residual.
  void contradicted(bool right) {
    m_island.budget = std::min(m_island.budget, kLast);
    begin(kSofter);
    bool soft = false;
    for (int pass = 0; pass < kSoftPasses; ++pass) {
      soft = m_island.newton(m_island.budget);
      m_island.from(m_island.x);
      lift(false);
      m_island.centre = m_island.x;
    }
    const double left = residual();
    if (left < m_least || (right && soft)) m_least = left, m_best = m_island.x;
  }

  // Whether De Saxce's correction is nonzero.
  bool slides() const {
    for (const Group& g : m_island.groups()) {
      if (m_island.shift[g.first] * std::sqrt(m_island.row(g.first).unit) > kMoves * m_island.scale) return true;
    }
    return false;
  }

  // Where redundant contacts slide, many distributions of the load are solutions. The smallest impulses lead to that of
  // soft springs: start from them.
  bool slide() {
    begin(kEven);
    m_anderson.begin();
    bool right = true;
    for (int pass = 0; pass < kEvenPasses; ++pass) {
      right = m_island.newton(m_island.budget);
      m_island.from(m_island.x);
      if (lift(true) <= kMoves * m_island.scale) break;
    }
    return refine(right, m_params.passes);
  }

  // Repeats passes from the last solution, stiffer where they gain little; or from zero while De Saxce's correction
  // changes, since a wrong correction would leave its clamped rows. Leaves the best impulses so far. Returns whether
  // the last pass converged.
  bool refine(bool right, int passes) {
    double before = std::numeric_limits<double>::infinity();
    bool moves = true;
    m_anderson.begin();
    for (int pass = 1, worse = 0;; ++pass) {
      const bool stiff = m_cfm <= double(m_params.cfm), moved = moves;
      m_island.from(m_island.x);
      moves = lift(true) > kMoves * m_island.scale;
      if (!stiff || moves != moved) m_anderson.begin();
      const double left = residual();
      ++worse;
      if (left < kBetter * m_least) m_least = left, m_best = m_island.x, worse = 0;
      const bool done = left <= double(m_params.tolerance) * m_island.scale;
      if (done || (stiff && worse > kPatience) || pass >= std::min(passes, m_params.passes) || m_island.budget <= 0)
        return right;
      m_island.centre = m_island.x;
      if (stiff && moves) m_island.centre.assign(m_island.size(), 0);
      if (left > kSlow * before) soften(m_cfm / kHarder);
      before = left;
      right = m_island.newton(m_island.budget);
    }
  }

  // Residual of the natural map, with De Saxce's correction.
  double residual() {
    const std::vector<double>& x = m_island.x;
    m_island.multiplyAdds += kOfRow * x.size();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const ProblemRow<D>& r = m_island.row(i);
      m_guess[i] = x[i] - r.unit * (m_island.u[i] + r.compliance * x[i]);
    }
    for (const Group& g : m_island.groups()) m_guess[g.first] -= m_island.row(g.first).unit * m_island.slide(g);
    for (const Group& g : m_island.groups()) m_island.limit(g, m_guess.data());
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += (m_guess[i] - x[i]) * (m_guess[i] - x[i]) / m_island.row(i).unit;
    }
    return std::sqrt(sum);
  }

  void begin(double cfm) {
    m_guess.resize(m_island.size());
    m_island.centre.assign(m_island.size(), 0);
    m_island.from(m_island.last);
    lift(false);
    soften(cfm);
  }
  void soften(double cfm) {
    m_cfm = std::max(cfm, double(m_params.cfm));
    m_island.soften(m_cfm);
  }

  // De Saxce's correction at the present rows, or extrapolated (`ahead`); returns its largest change.
  double lift(bool ahead) {
    m_from.clear(), m_to.clear();
    double change = 0;
    for (const Group& g : m_island.groups()) {
      if (g.count == 1) continue;
      const double root = std::sqrt(m_island.row(g.first).unit);
      m_from.push_back(m_island.shift[g.first] * root), m_to.push_back(m_island.slide(g) * root);
      change = std::max(change, std::abs(m_to.back() - m_from.back()));
    }
    if (ahead) m_anderson.next(m_from, m_to);
    std::size_t next = 0;
    for (const Group& g : m_island.groups()) {
      if (g.count == 1) continue;
      m_island.shift[g.first] = std::max((ahead ? m_from : m_to)[next++], 0.0) / std::sqrt(m_island.row(g.first).unit);
    }
    return change;
  }

  Params m_params;
  SpringIsland<D> m_island;
  Anderson m_anderson;
  double m_least = 0, m_cfm = 0;
  std::vector<double> m_guess, m_best, m_from, m_to;  // of the island
};

}  // namespace

LPC_REGISTER(VelocityResolver, ProximalNewton, 2, 3);

}}  // namespace lpc::LPC_PRECISION
