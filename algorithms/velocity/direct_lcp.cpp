// SPDX-License-Identifier: Zlib
#include "algorithms/solver/island/lemke.h"
#include "algorithms/solver/island/pyramid_lcp.h"
#include "algorithms/solver/rows/whole_problem.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Solves each island's complementarity problem exactly, with a friction pyramid of k facets (Stewart and Trinkle 1996).
// First active sets: the last step's impulses predict which contacts press, stick and slide, the linear system is
// solved, and rows that violate their law change state. Most steps need one or two solves. If sets repeat, a homotopy
// path is followed from a problem that the last impulses solve to the given one; one contact changes at a time. If the
// path does not end, Lemke's method solves a dense matrix. Systems are solved over the bodies, linear for a tower.
// Projected Gauss-Seidel takes islands that none of these solves or that are too large; they are counted:
// WorkCount::fallbacks.
//
// The first corner of a pyramid lies in the sliding direction, so that the pyramid turns with the scene.
template <int D>
class DirectLcp final : public VelocityResolver<D>, private WholeProblem<D>, private PyramidLcp<D> {
 public:
  struct Params {
    int facets = 8;
    Real cfm = -1;
    int maxBodies = 1000;
    int maxRows = 120;
    int maxPivots = 10000;
    int sweeps = 20;
    void visit(ParamVisitor& v) {
      v.integer("facets", facets, 4, 16, "facets of the friction pyramid in 3D; two in 2D");
      v.real("cfm", cfm, -1, Real(0.1), "1",
             "compliance of each row over W_ii, which lets redundant contacts share a load; < 0: 1e-7, in f32 1e-3");
      v.integer("max_bodies", maxBodies, 0, 10000, "bodies of the largest island that is solved directly");
      v.integer("max_rows", maxRows, 0, 2000,
                "rows of the largest dense problem: without bodies or compliance, or for Lemke's method");
      v.integer("max_pivots", maxPivots, 0, 1000000, "largest number of pivots of the path and of Lemke's method");
      v.integer("sweeps", sweeps, 0, 100000, "projected Gauss-Seidel passes, the last fallback");
    }
  };
  explicit DirectLcp(const Params& params) : m_params(params) {
    m_facets = params.facets;
    if (m_params.cfm < 0) m_params.cfm = sizeof(Real) == 8 ? Real(1e-7) : Real(1e-3);  // above the rounding of rows
  }

  static AlgorithmInfo info() {
    AlgorithmInfo info = {
        .name = "direct_lcp",
        .summary =
            "solves each island's linear complementarity problem with a friction pyramid: active sets, path following, "
            "Lemke's method",
        .paper = "stewart1996",
        .complexity = "a sparse factorisation of an island's bodies per active set, linear in a tower; Lemke: rows^3",
        .guarantee = Guarantee::approximate,
        .failures = {{"a heavy body on a light one, with more and more iterations",
                      "it solves the island at once, so it has no Gauss-Seidel convergence rate",
                      "Joint.ConvergesAsPredicted"}},
        .friction = FrictionLaw::facets,
        .noEffort = "it solves the island at once; its passes are a last fallback",
        .matrixAlone = true};
    if (sizeof(Real) == 4) {
      info.failures.push_back({"a motor of 1e6 N m at its joint limit, in f32",
                               "each pass adds at most 1 / cfm, so three passes do not reach the motor's limit",
                               "Joint.StopHoldsAgainstItsMotor"});
    }
    return info;
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      this->prepare(in, 1);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    this->eachIsland(in.work, m_params.sweeps, [&](std::span<const std::int32_t> rows) {
      m_island.multiplyAdds = 0;
      const bool done =
          m_island.set(in, m_problem, rows, m_free, m_impulse, m_params.maxBodies, m_params.maxRows) && direct(rows);
      in.work[WorkCount::multiplyAdds] += m_island.multiplyAdds;
      return done;
    });
    m_problem.apply(in, m_impulse);
  }

 private:
  using WholeProblem<D>::m_problem, WholeProblem<D>::m_free, WholeProblem<D>::m_impulse;
  using Lcp = PyramidLcp<D>;
  using Lcp::m_island, Lcp::m_bodies, Lcp::m_facets, Lcp::m_cfm, Lcp::m_tolerance, Lcp::m_middle, Lcp::m_factored,
      Lcp::m_velocity, Lcp::m_product, Lcp::m_matrix, Lcp::m_state, Lcp::row, Lcp::w, Lcp::facets, Lcp::layPyramids,
      Lcp::toward, Lcp::dot, Lcp::best, Lcp::guess, Lcp::activeSets, Lcp::factored, Lcp::settle, Lcp::soften,
      Lcp::effect, Lcp::kTolerance;
  using typename Lcp::Part, typename Lcp::State, typename Lcp::Tangent;
  static constexpr int kPasses = 3;  // each pass leaves cfm / (W_ii + cfm) of the residual
  static constexpr int kFewTurns = 100;
  static constexpr double kContradiction = 1e-6, kContradicted = 1e-4;  // of the speed; the compliance of rows then
  static constexpr double kSoftest = 1e-1, kHarder = 0.1;
  static constexpr double kApart = 1e-3, kWithin = 0.9;  // of the start of a path: of the speed, and of a cone

  bool direct(std::span<const std::int32_t> rows) {
    const std::size_t n = rows.size();
    double speed = 0;
    for (std::size_t i = 0; i < n; ++i) speed = std::max({speed, std::abs(m_island.u[i]), std::abs(m_island.x[i])});
    m_tolerance = kTolerance * speed;
    layPyramids();
    // Proximal steps from zero impulses: compliance makes the solution unique and continuous, and pulls towards the
    // previous solution. Starting from the last impulses would press wedged bodies harder in each step.
    const double cfm = double(m_params.cfm);
    m_cfm = 0;
    if (!m_island.dense && !(cfm > 0) && !assemble()) return false;
    if (!m_island.dense) m_island.bodies.analyse(m_bodies);
    soften(cfm);
    m_start = m_island.u, m_first = m_warm = m_island.x;
    double left = 0;
    const bool solved = passes(left);
    m_kept = m_island.x;
    if ((!solved || left > kContradiction * m_tolerance / kTolerance) && cfm < kContradicted) {
      m_island.x = m_warm = m_first;
      soften(kContradicted);
      if (!passes(left)) {
        if (!solved) return false;
        m_island.x = m_kept;
      }
    } else if (!solved) {
      return false;
    }
    m_island.store(m_impulse);
    for (const std::int32_t i : rows) m_problem.project(i, m_impulse.data() + i);  // removes rounding
    return true;
  }

  // Rows that contradict each other pull as hard as they are stiff, so their result would be rounding; `left` is the
  // residual of the last pass.
  bool passes(double& left) {
    const std::size_t n = m_island.size();
    m_island.u = m_start, m_last.assign(n, 0);
    guess();
    for (int pass = 0; pass < kPasses; ++pass) {
      for (std::size_t i = 0; i < n; ++i) m_island.u[i] = m_start[i] - m_cfm * m_last[i];
      if (!activeSets() && !path(kFewTurns) && !(m_cfm > 0 && softly())) {
        if (!assemble() || !lemke()) return false;
        guess();
      }
      left = 0;
      for (std::size_t i = 0; i < n; ++i) left = worse(left, m_cfm * std::abs(m_island.x[i] - m_last[i]));
      m_last = m_warm = m_island.x;
    }
    return true;
  }
  /// Returns false if there are too many rows.
  bool assemble() {
    if (m_island.dense) return true;
    if (m_island.size() > static_cast<std::size_t>(m_params.maxRows)) return false;
    m_island.assemble();
    for (std::size_t i = 0; i < m_island.size(); ++i) w(i)[i] += m_cfm;
    return true;
  }

  // Lemke's path from the last impulses. The problem is u(0) + t d, with d such that these impulses solve it at t = 1.
  // Between two changes x is linear in t. Where a contact reaches a limit it changes its state, and t continues, down
  // or up, as the new state allows. The solution is at t = 0.
  bool path(int turnsAllowed) {
    if (!startPath()) return false;
    double t = 1, sign = -1;
    std::size_t fresh = m_island.size();  // the row that changed last, and the limit at which it is
    int limit = 0;
    for (int turns = 0; turns < std::min(turnsAllowed, m_params.maxPivots); ++turns) {
      m_factored = false;
      m_dx.assign(m_island.size(), 0);
      if (!factored() || !settle(m_way, m_dx)) return false;
      m_du.resize(m_island.size());
      for (std::size_t i = 0; i < m_island.size(); ++i) m_du[i] = m_way[i] + m_product[i];
      if (fresh < m_island.size()) sign = room(fresh, limit, m_dx, m_du, 0) < 0 ? -1 : 1;
      double step = sign < 0 ? t : std::numeric_limits<double>::infinity();
      std::size_t blocking = m_island.size();
      int which = 0;
      for (std::size_t i = 0; i < m_island.size(); ++i) {
        for (int k = 0; k < limits(i); ++k) {
          if (i == fresh && k == limit) continue;
          const double change = sign * room(i, k, m_dx, m_du, 0);
          if (!(change < 0)) continue;
          const double far = std::max(room(i, k, m_island.x, m_velocity, 1), 0.0) / -change;
          if (far < step) step = far, blocking = i, which = k;
        }
      }
      if (!std::isfinite(step)) return false;
      for (std::size_t i = 0; i < m_island.size(); ++i) {
        m_island.x[i] += sign * step * m_dx[i], m_velocity[i] += sign * step * m_du[i];
      }
      t += sign * step;
      if (blocking == m_island.size()) return activeSets();  // at the end
      limit = turn(blocking, which), fresh = blocking;
    }
    return false;
  }
  // Through softer problems, which have fewer changes along their paths.
  bool softly() {
    const double cfm = m_cfm;
    bool right = true;
    for (double soft = std::max(kSoftest, cfm); right; soft = std::max(soft * kHarder, cfm)) {
      soften(soft);
      right = activeSets() || path(m_params.maxPivots);
      m_warm = m_island.x;
      if (soft <= cfm) return right;
    }
    soften(cfm);
    return false;
  }
  bool startPath() {
    const std::size_t n = m_island.size();
    m_island.x = m_warm, m_factored = false;
    m_way.assign(n, 0);  // first the target of u
    double speed = m_tolerance / kTolerance;
    std::vector<double>& x = m_island.x;
    for (std::size_t i = 0; i < n; ++i) {
      const ProblemRow<D>& r = row(i);
      State& state = m_state[i];
      state = {};
      const double some = kApart * speed * (1 + static_cast<double>((i * 7919 + 1) % 1024) / 1024);  // breaks ties
      if (r.law == ProblemLaw::free) state.part = Part::inside;
      if (r.law == ProblemLaw::interval) {
        const double lo = r.lo / m_island.root[i], hi = r.hi / m_island.root[i];
        if (!(lo < hi)) return false;
        state.part = x[i] <= lo ? Part::low : x[i] >= hi ? Part::high : Part::inside;
        x[i] = std::clamp(x[i], lo, hi);
        m_way[i] = state.part == Part::low ? some : state.part == Part::high ? -some : 0;
      }
      if (r.law != ProblemLaw::normal) continue;
      state.part = x[i] > 0 ? Part::stick : Part::none;
      if (state.part == Part::none) m_way[i] = some;
      x[i] = state.part == Part::stick ? x[i] + some : 0;
      double length = 0;
      for (std::size_t k = 1; k < D; ++k) length += x[i + k] * x[i + k];
      const double most = kWithin * r.friction * x[i], share = length > most * most ? most / std::sqrt(length) : 1;
      for (std::size_t k = 1; k < D; ++k) x[i + k] *= state.part == Part::stick ? share : 0;
    }
    m_island.velocities(m_velocity);
    for (std::size_t i = 0; i < n; ++i) {
      const bool open = row(i).law == ProblemLaw::normal && m_state[i].part == Part::none;
      m_way[i] -= m_velocity[i], m_velocity[i] += m_way[i];
      for (std::size_t k = 1; k < D && open; ++k) m_way[i + k] = m_velocity[i + k];  // any will do
    }
    return true;
  }
  /// Number of limits that a row or contact has in its present state.
  int limits(std::size_t i) const {
    const ProblemLaw law = row(i).law;
    const Part part = m_state[i].part;
    if (law == ProblemLaw::free || law == ProblemLaw::tangent) return 0;
    if (law == ProblemLaw::interval) return part == Part::inside ? 2 : 1;
    if (part == Part::none) return 1;
    return part == Part::stick ? facets() : part == Part::edge ? 4 : D;
  }
  /// Distance from the limit; for changes (`bounds` 0), how fast it changes.
  double room(std::size_t i, int limit, const std::vector<double>& x, const std::vector<double>& u,
              double bounds) const {
    const State& state = m_state[i];
    const double mu = row(i).friction;
    if (row(i).law == ProblemLaw::interval) {
      if (state.part == Part::low) return u[i];
      if (state.part == Part::high) return -u[i];
      const double at = (limit == 0 ? row(i).lo : row(i).hi) / m_island.root[i];
      if (std::isinf(at)) return bounds > 0 ? std::numeric_limits<double>::infinity() : 0;
      return (limit == 0 ? 1 : -1) * (x[i] - bounds * at);
    }
    if (state.part == Part::none) return u[i];
    const double *const xt = x.data() + i + 1, *const ut = u.data() + i + 1;
    if (state.part == Part::stick) {
      return mu * x[i] * (D == 2 ? 1 : m_middle) - dot(toward(i, 2 * limit + (D == 2 ? 0 : 1)), xt);
    }
    if (limit == 0) return x[i];
    if (state.part == Part::corner) {
      const double own = dot(toward(i, 2 * state.which), ut);
      return D == 2 ? -own : dot(toward(i, 2 * state.which + (limit == 1 ? 2 : -2)), ut) - own;
    }
    const Tangent d = toward(i, 2 * state.which + 1);
    if (limit == 1) return -dot(d, ut);
    if constexpr (D == 3) {
      const double across = -d[1] * xt[0] + d[0] * xt[1];
      return mu * x[i] * std::sqrt(1 - m_middle * m_middle) + (limit == 2 ? -across : across);
    }
    return 0;
  }
  /// Changes the state of a row at its limit. Returns the limit of the new state at which it is.
  int turn(std::size_t i, int limit) {
    State& state = m_state[i];
    const State before = state;
    if (row(i).law == ProblemLaw::interval) {
      state.part = before.part != Part::inside ? Part::inside : limit == 0 ? Part::low : Part::high;
      return before.part == Part::high ? 1 : 0;
    }
    if (before.part == Part::none) {
      state = {Part::corner, best(i, 0, m_velocity.data() + i + 1, -1) / 2};
      return 0;
    }
    if (before.part == Part::stick) {
      state = {D == 2 ? Part::corner : Part::edge, limit};
      return 1;
    }
    if (limit == 0) {
      state = {};
      return 0;
    }
    const int all = facets();
    if (before.part == Part::corner && D == 2) {
      state = {Part::stick, 0};
      return before.which;
    }
    if (before.part == Part::corner) {
      state = {Part::edge, limit == 1 ? before.which : (before.which + all - 1) % all};
      return limit == 1 ? 3 : 2;
    }
    if (limit == 1) {
      state = {Part::stick, 0};
      return before.which;
    }
    state = {Part::corner, limit == 2 ? (before.which + 1) % all : before.which};
    return limit == 2 ? 2 : 1;
  }

  // Eliminates rows without limits; then the unknowns are (press, corners ..., slack of the cone) for each contact and
  // (above its lower end, below its upper end) for each interval.
  bool lemke() {
    const std::size_t n = m_island.size();
    m_freeRows.clear(), m_columns.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const ProblemRow<D>& r = row(i);
      m_island.x[i] = 0;
      if (r.law == ProblemLaw::free) m_freeRows.push_back(i);
      if (r.law == ProblemLaw::interval) {
        const bool down = std::isinf(r.lo);  // measured from its upper end
        m_island.x[i] = (down ? r.hi : r.lo) / m_island.root[i];
        addColumn(i, 1, Column::push).impulse[0] = down ? -1 : 1;
        if (!std::isinf(r.lo) && !std::isinf(r.hi)) {
          addColumn(i, 0, Column::slack).room = (r.hi - r.lo) / m_island.root[i];
        }
      }
      if (r.law == ProblemLaw::normal) {
        addColumn(i, 1, Column::push).impulse[0] = 1;
        for (int j = 0; j < facets(); ++j) {
          const Tangent d = toward(i, 2 * j);
          Column& c = addColumn(i + 1, D - 1, Column::corner);
          for (std::size_t k = 0; k < D - 1; ++k) c.impulse[k] = d[k];
        }
        addColumn(i, 0, Column::slack);
      }
    }
    // Inverts W once over the rows without limits.
    const std::size_t e = m_freeRows.size(), c = m_columns.size();
    m_matrix.assign(e * e, 0);
    for (std::size_t i = 0; i < e; ++i) {
      for (std::size_t j = 0; j < e; ++j) m_matrix[i * e + j] = w(m_freeRows[i])[m_freeRows[j]];
    }
    m_factor.factor(e, m_matrix);
    m_island.velocities(m_velocity);
    // Per column: its effect on all rows, and the response of the free rows.
    m_answer.assign((c + 1) * e, 0);
    m_lcp.assign(c * c, 0), m_q.assign(c, 0);
    for (std::size_t q = 0; q <= c; ++q) {
      double* const y = m_answer.data() + q * e;
      for (std::size_t i = 0; i < e; ++i)
        y[i] = q == c ? -m_velocity[m_freeRows[i]] : -effect(m_freeRows[i], m_columns[q]);
      m_factor.solve(y);
      for (std::size_t p = 0; p < c; ++p) {
        const Column& to = m_columns[p];
        double sum = 0;
        for (std::size_t i = 0; i < to.rows; ++i) {
          const std::size_t at = to.first + i;
          double v = q == c ? m_velocity[at] : effect(at, m_columns[q]);
          for (std::size_t k = 0; k < e; ++k) v += w(at)[m_freeRows[k]] * y[k];
          sum += to.impulse[i] * v;
        }
        (q == c ? m_q[p] : m_lcp[p * c + q]) = sum;
      }
    }
    coneRows();
    const Lemke::End end = m_lemke.solve(c, m_lcp, m_q, static_cast<std::uint64_t>(m_params.maxPivots), m_lemkeZ);
    m_island.multiplyAdds +=
        m_factor.multiplyAdds + (c + 1) * (m_factor.multiplyAddsOfSolve() + (c + 1) * e * D) + m_lemke.multiplyAdds;
    if (end != Lemke::End::solved) return false;
    for (std::size_t q = 0; q <= c; ++q) {
      const double z = q == c ? 1 : m_lemkeZ[q];
      for (std::size_t k = 0; k < e; ++k) m_island.x[m_freeRows[k]] += z * m_answer[q * e + k];
      for (std::size_t i = 0; q < c && i < m_columns[q].rows; ++i) {
        m_island.x[m_columns[q].first + i] += z * m_columns[q].impulse[i];
      }
    }
    return true;
  }

  struct Column {
    enum Kind : std::uint8_t { push, corner, slack } kind = push;
    std::size_t first = 0;
    IndexedArray<double, D> impulse{};
    std::size_t rows = 0;
    double room = 0;  // limit of the slack of an interval
  };
  Column& addColumn(std::size_t first, std::size_t rows, typename Column::Kind kind) {
    Column& c = m_columns.emplace_back();
    c.kind = kind, c.first = first, c.rows = rows;
    return c;
  }
  // The row of the slack is the remaining friction limit; its variable is the sliding speed.
  void coneRows() {
    const std::size_t c = m_columns.size();
    std::size_t push = 0;
    for (std::size_t p = 0; p < c; ++p) {
      if (m_columns[p].kind == Column::push) push = p;
      if (m_columns[p].kind != Column::slack) continue;
      if (p == push + 1) {  // of an interval
        m_lcp[p * c + push] = -1, m_lcp[push * c + p] = 1, m_q[p] = m_columns[p].room;
        continue;
      }
      m_lcp[p * c + push] = row(m_columns[push].first).friction;
      for (std::size_t j = push + 1; j < p; ++j) m_lcp[p * c + j] = -1, m_lcp[j * c + p] = 1;
    }
  }

  Params m_params;
  SymmetricFactor m_factor;
  Lemke m_lemke;
  std::vector<double> m_start, m_first, m_kept, m_warm, m_last, m_way, m_dx, m_du, m_answer, m_lcp, m_q, m_lemkeZ;
  std::vector<std::size_t> m_freeRows;
  std::vector<Column> m_columns;
};

}  // namespace

LPC_REGISTER(VelocityResolver, DirectLcp, 2, 3);

}}  // namespace lpc::LPC_PRECISION
