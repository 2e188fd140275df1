// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/whole_problem.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Nonsmooth nonlinear conjugate gradients: the change of a projected Gauss-Seidel sweep serves as the negative gradient
// of some function, and the next step follows a conjugate direction (Fletcher and Reeves). A direction after which
// sweeps change more than before is dropped.
template <int D>
class Nncg final : public VelocityResolver<D>, private WholeProblem<D> {
 public:
  struct Params {
    int iterations = 10;
    bool warmStart = true;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "sweeps over all joints and contacts", ParamRole::effort);
      v.flag("warm_start", warmStart, "start from the impulses of the last step");
    }
  };
  explicit Nncg(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    AlgorithmInfo info{
        .name = "nncg",
        .summary = "projected Gauss-Seidel, accelerated by nonlinear conjugate gradients",
        .paper = "silcowitz2010",
        .complexity = "iterations x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures =
            {{"a heavy body on a light one, a tall stack",
              "faster than plain sweeps, but ten carry two fifths of a ratio of 80", "Impulse.CarriesHeavyOnLight"},
             {"contacts elsewhere, that do not touch these", "share the factor of the next direction",
              "Replay.DisjointScenesAreTwoWorlds"},
             {"joints, by six iterations instead of three", "its error grows between restarts", "Joint.MoreIsNoWorse"},
             {"contacts, by twice as many iterations", "their energy grows between restarts", "Impulse.MoreIsNoWorse"}},
        .friction = FrictionLaw::coulomb,
        .matrixAlone = true};
    if (D == 2) {
      info.failures.push_back({"a stop that is hit, in ever shorter steps",
                               "ten iterations end with another error in each: directions from before the stop go on",
                               "JointMotion.Converges"});
    }
    return info;
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      this->prepare(in, m_params.warmStart ? 1 : 0);
      m_problem.clearMotion();
      for (int i = 0; i < m_problem.size(); ++i) m_problem.push(i, m_impulse[i]);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    m_before.resize(m_impulse.size()), m_direction.assign(m_impulse.size(), 0);
    m_rows.resize(m_impulse.size());
    for (std::size_t i = 0; i < m_rows.size(); ++i) m_rows[i] = static_cast<std::int32_t>(i);
    iterate(m_rows, in.work);
    m_problem.apply(in, m_impulse);
  }

 private:
  using WholeProblem<D>::m_problem, WholeProblem<D>::m_sweep, WholeProblem<D>::m_free, WholeProblem<D>::m_impulse;
  // Multiply-adds per row besides the sweep: of its change, and of the conjugate step.
  static constexpr std::uint64_t kOfRow = 4 + 2 * D + D * (D - 1);

  void iterate(std::span<const std::int32_t> rows, WorkDone& work) {
    double last = 0;
    for (int n = 0; n < m_params.iterations; ++n) {
      for (const std::int32_t i : rows) m_before[i] = m_impulse[i];
      m_sweep.sweep(m_problem, rows, m_free, m_impulse);
      countRows<D>(work, rows.size());
      if (n + 1 == m_params.iterations) return;  // ends with a sweep, so that all limits hold
      double change = 0;                         // in J, so that N s and N m s can be added
      for (const std::int32_t i : rows) {
        const double by = m_impulse[i] - m_before[i];
        change += by * by / m_problem.row(i).unit;
      }
      const double beta = n > 0 && last > 0 && change <= last ? change / last : 0;
      last = change;
      work[WorkCount::multiplyAdds] += kOfRow * rows.size();
      for (const std::int32_t i : rows) {
        const double step = beta * m_direction[i];
        m_direction[i] = step + m_impulse[i] - m_before[i];
        if (!(step != 0)) continue;
        m_impulse[i] += step;
        m_problem.push(i, step);
      }
    }
  }

  Params m_params;
  std::vector<std::int32_t> m_rows;  // all
  IndexedVector<double> m_before, m_direction;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Nncg, 2, 3);

}}  // namespace lpc::LPC_PRECISION
