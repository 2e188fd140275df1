// SPDX-License-Identifier: Zlib
#include "algorithms/solver/dense.h"
#include "algorithms/solver/island.h"
#include "algorithms/solver/lemke.h"
#include "algorithms/solver/row_sweep.h"
#include "framework/profiler.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// Each island's complementarity problem to the end, with a pyramid of k facets for a cone (Stewart and Trinkle 1996).
// First the linear system of who pushes, sticks and slides, guessed from the last step and put right until nobody
// objects: most steps need one or two. Where that goes round in circles Lemke's method, which does not guess. What
// neither solves, or is too large, is left to projected Gauss-Seidel, and counted: WorkCount::fallbacks.
//
// A pyramid has corners: the first is laid where the contact slides, so that it turns with the scene.
template <int D>
class DirectLcp final : public VelocityResolver<D> {
 public:
  struct Params {
    int facets = 8;
    Real cfm = sizeof(Real) == 8 ? Real(1e-4) : Real(1e-3);  // far above the rounding of rows
    int maxRows = 120;
    int maxPivots = 2000;
    int sweeps = 20;
    void visit(ParamVisitor& v) {
      v.integer("facets", facets, 4, 16, "of the pyramid in 3D; in 2D there are two");
      v.real("cfm", cfm, 0, Real(0.1), "1", "compliance of each row in a solve, of W_ii: redundant contacts share");
      v.integer("max_rows", maxRows, 0, 2000, "of an island that is solved directly");
      v.integer("max_pivots", maxPivots, 0, 1000000, "of Lemke's method");
      v.integer("sweeps", sweeps, 0, 100000, "of projected Gauss-Seidel, where nothing else helps");
    }
  };
  explicit DirectLcp(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    AlgorithmInfo info = {
        .name = "direct_lcp",
        .summary = "each island's complementarity problem by active sets and Lemke's method, on a pyramid",
        .paper = "stewart1996",
        .complexity = "(rows of an island)^3",
        .guarantee = Guarantee::approximate,
        .failures = {{"a heavy body on a light one in ever more iterations",
                      "it has no rate of sweeps: it is at the end at once", "Joint.ConvergesAsPredicted"}},
        .friction = FrictionLaw::facets,
        .matrixAlone = true};
    if (sizeof(Real) == 4) {
      info.failures.push_back({"a motor of 1e6 N m at its stop, in f32",
                               "each pass gives no more than 1 / cfm, and three do not come to the motor's limit",
                               "Joint.StopHoldsAgainstItsMotor"});
    }
    return info;
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      m_problem.set(in);
      m_sweep.prepare(m_problem);
      m_problem.freeVelocities(in, m_free);
      m_problem.lastImpulses(in, 1, m_impulse);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    const auto islands = m_problem.islands();
    for (std::size_t k = 0; k + 1 < islands.size(); ++k) {
      const auto first = static_cast<std::size_t>(islands[k]), last = static_cast<std::size_t>(islands[k + 1]);
      const auto rows = m_problem.grouped().subspan(first, last - first);
      if (last - first <= static_cast<std::size_t>(m_params.maxRows) && direct(rows, in.work)) continue;
      m_sweep.descend(m_problem, rows, m_free, m_impulse, m_params.sweeps, in.work);
    }
    m_problem.apply(in, m_impulse);
  }

 private:
  static constexpr int kMostTrials = 30;      // of who pushes; the guess is good or it goes in circles
  static constexpr int kPasses = 3;           // each leaves cfm / (W_ii + cfm) of what was left
  static constexpr double kTolerance = 1e-9;  // of the largest free velocity or last impulse: what nobody objects to
  enum class Part : std::uint8_t { none, inside, low, high, stick, corner, edge };
  struct State {
    Part part = Part::none;
    int which = 0;  // corner, or the edge after it
    bool operator==(const State&) const = default;
  };
  /// Impulse per unknown, and the velocity that it has to make zero: D rows from `first`.
  struct Unknown {
    std::size_t first;
    std::array<double, D> impulse{}, velocity{};
    std::size_t rows = 1;
  };
  using Tangent = std::array<double, D - 1>;

  const ProblemRow<D>& row(std::size_t i) const { return m_island.row(i); }
  double* w(std::size_t i) { return m_island.w.data() + i * m_island.size(); }
  int facets() const { return D == 2 ? 2 : m_params.facets; }

  bool direct(std::span<const std::int32_t> rows, WorkDone& work) {
    m_island.set(m_problem, rows, m_free, m_impulse);
    const std::size_t n = rows.size();
    double speed = 0;
    for (std::size_t i = 0; i < n; ++i) speed = std::max({speed, std::abs(m_island.u[i]), std::abs(m_island.x[i])});
    m_tolerance = kTolerance * speed;
    layPyramids();
    // Proximal steps from nothing: compliance makes the answer of each one and steady, and holds to where the last has
    // come. From the last impulses they would go on, where bodies are wedged, and push harder in each step.
    const double cfm = double(m_params.cfm);
    for (std::size_t i = 0; i < n; ++i) w(i)[i] += cfm;
    guess();
    m_start = m_island.u, m_last.assign(n, 0);
    for (int pass = 0; pass < kPasses; ++pass) {
      for (std::size_t i = 0; i < n; ++i) m_island.u[i] = m_start[i] - cfm * m_last[i];
      if (!activeSets(work)) {
        if (!lemke(work)) return false;
        guess();
      }
      m_last = m_island.x;
    }
    m_island.store(m_impulse);
    for (const std::int32_t i : rows) m_problem.project(i, m_impulse.data() + i);  // rounding
    return true;
  }

  // Corner j of contact i is at angle 2 pi j / k from where it slides.
  void layPyramids() {
    const std::size_t n = m_island.size();
    m_along.assign(n, {});
    for (std::size_t i = 0; i < n; ++i) {
      if (row(i).law != ProblemLaw::normal) continue;
      Tangent s{};
      double length = 0;
      for (std::size_t k = 0; k < D - 1; ++k) s[k] = m_island.u[i + 1 + k], length += s[k] * s[k];
      length = std::sqrt(length);
      const bool slides = length > m_tolerance;
      for (std::size_t k = 0; k < D - 1; ++k) s[k] = slides ? s[k] / length : (k == 0 ? 1.0 : 0.0);
      m_along[i] = s;
    }
    if (m_corner.size() == static_cast<std::size_t>(2 * facets())) return;
    for (int j = 0; j < 2 * facets(); ++j) {
      double s = 0, c = 1;
      sinCos(3.14159265358979323846 * j / facets(), s, c);
      m_corner.push_back({c, s});
    }
    m_middle = m_corner[1][0];
  }
  // In half steps: corners are even, the middles of edges odd.
  Tangent toward(std::size_t i, int half) const {
    const auto& turn = m_corner[static_cast<std::size_t>((half + 2 * facets()) % (2 * facets()))];
    const Tangent& s = m_along[i];
    if constexpr (D == 2) {
      return {turn[0] * s[0]};
    } else {
      return {turn[0] * s[0] - turn[1] * s[1], turn[1] * s[0] + turn[0] * s[1]};
    }
  }
  static double dot(const Tangent& d, const double* t) {
    double sum = 0;
    for (std::size_t k = 0; k < D - 1; ++k) sum += d[k] * t[k];
    return sum;
  }
  /// Of the directions half, half + 2, ... the one that is most along t.
  int best(std::size_t i, int half, const double* t, double sign) const {
    int found = half;
    for (int h = half; h < 2 * facets(); h += 2) {
      if (sign * dot(toward(i, h), t) > sign * dot(toward(i, found), t)) found = h;
    }
    return found;
  }

  // What the last impulses say.
  void guess() {
    m_state.assign(m_island.size(), {});
    const std::vector<double>& x = m_island.x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const ProblemRow<D>& r = row(i);
      State& state = m_state[i];
      if (r.law == ProblemLaw::free) state.part = Part::inside;
      if (r.law == ProblemLaw::interval) {
        const double lo = r.lo / m_island.root[i], hi = r.hi / m_island.root[i];
        state.part = x[i] > lo && x[i] < hi ? Part::inside : x[i] >= hi ? Part::high : Part::low;
      }
      if (r.law == ProblemLaw::normal) {
        state.part = x[i] > 0 || m_island.u[i] < 0 ? Part::stick : Part::none;
      }
    }
    m_factored = false;
  }

  bool activeSets(WorkDone& work) {
    for (int trial = 0; trial < kMostTrials; ++trial) {
      if (!solveActive(work)) return false;
      m_island.velocities(m_velocity);
      if (!revise()) return true;
      m_factored = false;
    }
    return false;
  }

  bool solveActive(WorkDone& work) {
    const std::size_t n = m_island.size();
    m_unknowns.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const ProblemRow<D>& r = row(i);
      const State& state = m_state[i];
      double& x = m_island.x[i];
      x = 0;
      if (state.part == Part::low) x = r.lo / m_island.root[i];
      if (state.part == Part::high) x = r.hi / m_island.root[i];
      if (state.part == Part::inside) add(i, 1).impulse[0] = 1;
      if (state.part == Part::stick) {
        for (std::size_t k = 0; k < D; ++k) add(i + k, 1).impulse[0] = 1;
      }
      if (state.part == Part::corner || state.part == Part::edge) {
        const bool edge = state.part == Part::edge;
        const Tangent d = toward(i, 2 * state.which + (edge ? 1 : 0));
        Unknown& push = add(i, D);
        push.impulse[0] = 1, push.velocity[0] = 1;
        for (std::size_t k = 1; k < D; ++k) push.impulse[k] = r.friction * (edge ? m_middle : 1) * d[k - 1];
        if constexpr (D == 3) {
          if (edge) add(i + 1, D - 1).impulse = {-d[1], d[0], 0};
        }
      }
    }
    for (Unknown& u : m_unknowns) {
      if (u.velocity[0] == 0 && u.rows == 1) u.velocity = u.impulse;
      if (u.rows == D - 1 && D == 3) u.velocity = u.impulse;
    }
    if (!m_factored && !factor(work)) return false;
    m_island.velocities(m_velocity);
    m_right.resize(m_unknowns.size());
    for (std::size_t p = 0; p < m_unknowns.size(); ++p) {
      const Unknown& a = m_unknowns[p];
      m_right[p] = 0;
      for (std::size_t k = 0; k < a.rows; ++k) m_right[p] -= a.velocity[k] * m_velocity[a.first + k];
    }
    m_general.solve(m_right.data());
    for (std::size_t p = 0; p < m_unknowns.size(); ++p) {
      const Unknown& a = m_unknowns[p];
      for (std::size_t k = 0; k < a.rows; ++k) m_island.x[a.first + k] += m_right[p] * a.impulse[k];
    }
    return true;
  }
  bool factor(WorkDone& work) {
    const std::size_t count = m_unknowns.size();
    m_matrix.assign(count * count, 0);
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t q = 0; q < count; ++q) {
        for (std::size_t k = 0; k < m_unknowns[p].rows; ++k) {
          const double share = m_unknowns[p].velocity[k];
          if (share != 0) m_matrix[p * count + q] += share * effect(m_unknowns[p].first + k, m_unknowns[q]);
        }
      }
    }
    work[WorkCount::rowUpdates] += count * count;
    return m_factored = m_general.factor(count, m_matrix);
  }
  /// Velocity of row i by a unit of an unknown or column.
  template <class Part>
  double effect(std::size_t i, const Part& part) {
    double sum = 0;
    for (std::size_t k = 0; k < part.rows; ++k) sum += w(i)[part.first + k] * part.impulse[k];
    return sum;
  }
  Unknown& add(std::size_t first, std::size_t rows) {
    m_unknowns.push_back({first, {}, {}, rows});
    return m_unknowns.back();
  }

  // Who objects changes sides. Does anybody?
  bool revise() {
    bool changed = false;
    for (std::size_t i = 0; i < m_island.size(); ++i) {
      const State before = m_state[i];
      if (row(i).law == ProblemLaw::interval) reviseInterval(i);
      if (row(i).law == ProblemLaw::normal) reviseContact(i);
      changed = changed || !(m_state[i] == before);
    }
    return changed;
  }
  void reviseInterval(std::size_t i) {
    const double x = m_island.x[i], u = m_velocity[i];
    const double lo = row(i).lo / m_island.root[i], hi = row(i).hi / m_island.root[i];
    Part& part = m_state[i].part;
    if (part == Part::inside) {
      if (x < lo - m_tolerance) part = Part::low;
      if (x > hi + m_tolerance) part = Part::high;
    } else if (part == Part::low ? u < -m_tolerance : u > m_tolerance) {
      part = lo < hi ? Part::inside : part;
    }
  }
  void reviseContact(std::size_t i) {
    State& state = m_state[i];
    const double limit = row(i).friction * m_island.x[i];
    const double *const t = m_island.x.data() + i + 1, *const u = m_velocity.data() + i + 1;
    if (state.part == Part::none) {
      if (m_velocity[i] < -m_tolerance) state.part = Part::stick;
      return;
    }
    if (m_island.x[i] < -m_tolerance) {
      state.part = Part::none;
    } else if (state.part == Part::stick) {
      const int half = best(i, D == 2 ? 0 : 1, t, 1);
      if (dot(toward(i, half), t) > limit * (D == 2 ? 1 : m_middle) + m_tolerance) {
        state = {D == 2 ? Part::corner : Part::edge, half / 2};
      }
    } else if (state.part == Part::corner) {
      const int mine = 2 * state.which, half = best(i, 0, u, -1);
      const double gain = -dot(toward(i, half), u) + dot(toward(i, mine), u);
      if (D == 2 ? dot(toward(i, mine), u) > m_tolerance : gain > m_tolerance) {
        if (D == 2) {
          state.part = Part::stick;
        } else {  // to the edge on that side
          const bool after = -dot(toward(i, mine + 2), u) > -dot(toward(i, mine - 2), u);
          state = {Part::edge, after ? state.which : (state.which + facets() - 1) % facets()};
        }
      }
    } else if constexpr (D == 3) {
      const Tangent d = toward(i, 2 * state.which + 1);
      const double across = -d[1] * t[0] + d[0] * t[1], reach = limit * std::sqrt(1 - m_middle * m_middle);
      if (dot(d, u) > m_tolerance) {
        state.part = Part::stick;
      } else if (std::abs(across) > reach + m_tolerance) {
        state = {Part::corner, across > 0 ? (state.which + 1) % facets() : state.which};
      }
    }
  }

  // Rows without limits are eliminated, then for each contact (push, corners ..., slack of the cone) and for each
  // interval (above its lower end, below its upper end).
  bool lemke(WorkDone& work) {
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
    // In rows without limits W is inverted, once.
    const std::size_t e = m_freeRows.size(), c = m_columns.size();
    m_matrix.assign(e * e, 0);
    for (std::size_t i = 0; i < e; ++i) {
      for (std::size_t j = 0; j < e; ++j) m_matrix[i * e + j] = w(m_freeRows[i])[m_freeRows[j]];
    }
    m_factor.factor(e, m_matrix);
    m_island.velocities(m_velocity);
    // Of each column: what it does to all rows, and what the free rows answer.
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
    const Lemke::End end = m_lemke.solve(c, m_lcp, m_q, static_cast<std::uint64_t>(m_params.maxPivots), m_z);
    work[WorkCount::rowUpdates] += m_lemke.pivots * c;
    if (end != Lemke::End::solved) return false;
    for (std::size_t q = 0; q <= c; ++q) {
      const double z = q == c ? 1 : m_z[q];
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
    std::array<double, D> impulse{};
    std::size_t rows = 0;
    double room = 0;  // of the slack of an interval
  };
  Column& addColumn(std::size_t first, std::size_t rows, typename Column::Kind kind) {
    Column& c = m_columns.emplace_back();
    c.kind = kind, c.first = first, c.rows = rows;
    return c;
  }
  // The slack's row is what is left of the limit; its variable is the sliding speed.
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
  ContactProblem<D> m_problem;
  RowSweep<D> m_sweep;
  Island<D> m_island;
  SymmetricFactor m_factor;
  GeneralFactor m_general;
  Lemke m_lemke;
  double m_tolerance = 0, m_middle = 0;  // scaled velocity; how far an edge is from the axis
  bool m_factored = false;               // is m_general that of m_state?
  std::vector<double> m_free, m_impulse, m_velocity, m_start, m_last, m_matrix, m_right, m_answer, m_lcp, m_q, m_z;
  std::vector<Tangent> m_along;                 // by row, of normals
  std::vector<std::array<double, 2>> m_corner;  // cosine and sine of half steps
  std::vector<State> m_state;
  std::vector<Unknown> m_unknowns;
  std::vector<std::size_t> m_freeRows;
  std::vector<Column> m_columns;
};

}  // namespace

LPC_REGISTER(VelocityResolver, DirectLcp, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
