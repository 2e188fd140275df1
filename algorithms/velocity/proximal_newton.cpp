// SPDX-License-Identifier: Zlib
#include "algorithms/solver/block_cholesky.h"
#include "algorithms/solver/inertia_root.h"
#include "algorithms/solver/row_sweep.h"
#include "framework/profiler.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// Each row is a spring of what it is to do, as stiff as double can bear, that pushes within its limits only: then the
// velocities of an island are where a strictly convex function is least. Newton's method with an exact line search
// finds them, by one sparse factorisation over the bodies per iteration, which is linear in a tower. From where it
// comes the springs begin anew (the method of multipliers), so that nothing gives way; De Saxce's correction, from the
// sliding so far, makes Coulomb's law of the convex one.
//
// Unknowns are the changes of velocity z = M^1/2 dv. The function is half of z^2 + sum of soft (y^2 - (y - x)^2):
//
//     y = (eps centre - u - shift) / soft,   x = nearest allowed to y,   u = u(0) + J z,   soft = eps + compliance
//
// Its gradient is z - J^T x. Bodies that cannot move are no unknowns.
template <int D>
class ProximalNewton final : public VelocityResolver<D> {
 public:
  struct Params {
    Real cfm = Real(1e-7);
    int passes = 30;
    int iterations = 100;
    Real tolerance = Real(1e-9);
    int maxBodies = 1000;
    int sweeps = 20;
    void visit(ParamVisitor& v) {
      v.real("cfm", cfm, Real(1e-11), Real(0.1), "1", "what a row gives way in a pass, of W_ii");
      v.integer("passes", passes, 1, 1000, "at most, from where the last has come");
      v.integer("iterations", iterations, 1, 100000, "at most, of Newton's method in a step, over all passes");
      v.real("tolerance", tolerance, 0, 1, "1", "residual at which a pass is the last, of the largest velocity");
      v.integer("max_bodies", maxBodies, 0, 10000, "of an island that is solved so");
      v.integer("sweeps", sweeps, 0, 100000, "of projected Gauss-Seidel, over islands that are larger");
    }
  };
  explicit ProximalNewton(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "proximal_newton",
            .summary = "each island's convex problem by Newton's method over its bodies, De Saxce's correction",
            .paper = "castro2022",
            .complexity = "a sparse factorisation of an island's bodies per iteration; linear in a tower",
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
      m_problem.set(in);
      m_sweep.prepare(m_problem);
      m_problem.freeVelocities(in, m_free);
      m_problem.lastImpulses(in, 1, m_impulse);
      m_node.assign(static_cast<std::size_t>(in.bodies.size()) + 1, -1);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    const auto islands = m_problem.islands();
    for (std::size_t k = 0; k + 1 < islands.size(); ++k) {
      const auto first = static_cast<std::size_t>(islands[k]), last = static_cast<std::size_t>(islands[k + 1]);
      const auto rows = m_problem.grouped().subspan(first, last - first);
      if (set(in, rows) && descend(in.work)) {
        for (std::size_t i = 0; i < rows.size(); ++i) m_impulse[static_cast<std::size_t>(rows[i])] = m_best[i];
      } else {
        m_sweep.descend(m_problem, rows, m_free, m_impulse, m_params.sweeps, in.work);
      }
    }
    m_problem.apply(in, m_impulse);
  }

 private:
  static constexpr std::size_t kSize = D + kAngDim<D>;
  // Above this coefficient a cone is as good as a half-space, and the correction would overthrow the passes.
  static constexpr double kSteepest = 10;
  static constexpr double kBetter = 0.9;  // of the least residual so far: less is rounding, or rows that contradict
  static constexpr double kSlow = 0.5, kLeastShare = 0.125;
  static constexpr int kPatience = 3;  // passes that are no better
  static constexpr double kMoves = 1e-6, kContradiction = 1e-6, kSofter = 1e4;
  static constexpr double kUseful = 1e-3;                  // of the scale: a residual that sweeps would not better
  static constexpr double kFlat = 0.01;                    // of the slope along a direction, where a line search ends
  static constexpr double kStill = 1e-10, kTurned = 3e-8;  // of the scale: steps that end Newton's method
  static constexpr int kSearches = 40, kTries = 8, kSoftPasses = 3, kLast = 30;
  static constexpr int kTrials = 3;                      // of who pushes, by full steps
  static constexpr double kSoftest = 1e5, kHarder = 10;  // of the springs on the way, where that fails
  enum class Part : std::uint8_t { none, inside, low, high, slides };
  using Place = std::array<double, kSize>;
  struct Row {
    int a, b;  // nodes; -1: what cannot move
    Place onA, onB;
    double eps, soft;
    Part part = Part::none;
  };
  struct Group {
    std::size_t first, count;  // of rows: a contact's D, or one
    double friction;
    typename BlockCholesky<kSize>::Between between;
  };

  // An island's rows, bodies and matrix; false: too large.
  bool set(const VelocityInput<D>& in, std::span<const std::int32_t> which) {
    const std::size_t n = which.size();
    m_which = which;
    m_rows.resize(n), m_groups.clear(), m_edges.clear(), m_bodies.clear();
    bool fits = true;
    for (std::size_t i = 0; i < n && fits; ++i) {
      const ProblemRow<D>& r = m_problem.row(which[i]);
      Row& row = m_rows[i];
      row.a = nodeOf(in, r.a), row.b = nodeOf(in, r.b);
      row.onA = place(in, r, true), row.onB = place(in, r, false);
      if (r.law != ProblemLaw::tangent) {
        m_groups.push_back({i, 1, r.friction, {}});
        if (row.a >= 0 && row.b >= 0) m_edges.push_back({row.a, row.b});
      } else {
        ++m_groups.back().count;
      }
      fits = m_bodies.size() <= static_cast<std::size_t>(m_params.maxBodies);
    }
    for (const std::int32_t body : m_bodies) m_node[static_cast<std::size_t>(body)] = -1;
    if (!fits) return false;
    m_matrix.analyse(m_bodies.size(), m_edges);
    for (Group& g : m_groups) {
      const Row& row = m_rows[g.first];
      if (row.a >= 0 && row.b >= 0) g.between = m_matrix.between(row.a, row.b);
    }
    m_free0.resize(n), m_last.resize(n);
    m_scale = 0;
    for (std::size_t i = 0; i < n; ++i) {
      m_free0[i] = m_free[static_cast<std::size_t>(which[i])];
      m_last[i] = m_impulse[static_cast<std::size_t>(which[i])];
      const double root = std::sqrt(m_problem.row(which[i]).unit);
      m_scale = std::max({m_scale, std::abs(m_free0[i]) * root, std::abs(m_last[i]) / root});
    }
    return true;
  }
  int nodeOf(const VelocityInput<D>& in, std::int32_t body) {
    const auto i = static_cast<std::size_t>(body);
    if (body >= in.bodies.size() || !(in.bodies.invMass[i] > 0 || in.bodies.invInertia[i].trace() > 0)) return -1;
    if (m_node[i] < 0) {
      m_node[i] = static_cast<int>(m_bodies.size());
      m_bodies.push_back(body);
      if (m_root.size() < m_bodies.size()) m_root.emplace_back();
      m_root[m_bodies.size() - 1] = rootOfInertia<D>(in.bodies, i, in.features.rotation);
    }
    return m_node[i];
  }
  Place place(const VelocityInput<D>& in, const ProblemRow<D>& r, bool isA) const {
    Place p{};
    const std::int32_t body = isA ? r.a : r.b;
    if (body >= in.bodies.size() || m_node[static_cast<std::size_t>(body)] < 0) return p;
    const double sign = isA ? -1 : 1, mass = std::sqrt(double(in.bodies.invMass[static_cast<std::size_t>(body)]));
    const auto& arm = isA ? r.armA : r.armB;
    const InertiaRoot<D>& l = m_root[static_cast<std::size_t>(m_node[static_cast<std::size_t>(body)])];
    for (int k = 0; k < D; ++k) p[static_cast<std::size_t>(k)] = sign * mass * r.d[k];
    for (int k = 0; k < kAngDim<D>; ++k) {
      double sum = 0;
      for (int m = k; m < kAngDim<D>; ++m) sum += l[static_cast<std::size_t>(m * kAngDim<D> + k)] * arm[m];
      p[static_cast<std::size_t>(D + k)] = sign * sum;
    }
    return p;
  }

  static double dot(const Place& p, const double* z) {
    double sum = 0;
    for (std::size_t k = 0; k < kSize; ++k) sum += p[k] * z[k];
    return sum;
  }
  double along(const Row& row, const std::vector<double>& z) const {
    double sum = 0;
    if (row.a >= 0) sum += dot(row.onA, z.data() + static_cast<std::size_t>(row.a) * kSize);
    if (row.b >= 0) sum += dot(row.onB, z.data() + static_cast<std::size_t>(row.b) * kSize);
    return sum;
  }
  void push(const Row& row, double x, std::vector<double>& z) const {
    if (!(x != 0)) return;
    for (std::size_t k = 0; k < kSize; ++k) {
      if (row.a >= 0) z[static_cast<std::size_t>(row.a) * kSize + k] += x * row.onA[k];
      if (row.b >= 0) z[static_cast<std::size_t>(row.b) * kSize + k] += x * row.onB[k];
    }
  }
  double asked(std::size_t i, double u) const {
    const Row& row = m_rows[i];
    return (row.eps * m_centre[i] - u - m_shift[i]) / row.soft;
  }
  void limit(const Group& g, double* x) const {
    const ProblemRow<D>& r = m_problem.row(m_which[g.first]);
    if (g.count > 1) projectOnCone<D>(std::min(g.friction, kSteepest), x + g.first);
    if (g.count == 1 && r.law == ProblemLaw::interval) x[g.first] = std::clamp(x[g.first], r.lo, r.hi);
  }

  // Who pushes, at what is asked for. Has it changed? Where something slides in space, by any step that has a length.
  bool sort(const std::vector<double>& y, double length = 0) {
    bool changed = false;
    for (const Group& g : m_groups) {
      const ProblemRow<D>& r = m_problem.row(m_which[g.first]);
      Part part = Part::inside;
      if (g.count > 1) {
        double t = 0;
        for (std::size_t k = 1; k < D; ++k) t += y[g.first + k] * y[g.first + k];
        t = std::sqrt(t);
        const double mu = std::min(g.friction, kSteepest), n = y[g.first];
        part = t <= mu * n ? Part::inside : n + mu * t > 0 ? Part::slides : Part::none;
        if (D == 2 && part == Part::slides) part = y[g.first + 1] > 0 ? Part::high : Part::low;
      } else if (r.law == ProblemLaw::interval) {
        part = y[g.first] <= r.lo ? Part::low : y[g.first] >= r.hi ? Part::high : Part::inside;
      }
      changed = changed || part != m_rows[g.first].part || (part == Part::slides && length > kTurned * m_scale);
      m_rows[g.first].part = part;
    }
    return changed;
  }

  // The derivative of x by y, of the part that a group was sorted into; `from` is what y was then.
  using Slope = std::array<double, static_cast<std::size_t>(D* D)>;
  Slope slope(const Group& g, const std::vector<double>& from) const {
    Slope s{};
    const Part part = m_rows[g.first].part;
    if (part == Part::none || (g.count == 1 && part != Part::inside)) return s;
    if (part == Part::inside) {
      for (std::size_t k = 0; k < g.count; ++k) s[k * D + k] = 1;
      return s;
    }
    double t = 0;
    const double* const y = from.data() + g.first;
    for (std::size_t k = 1; k < D; ++k) t += y[k] * y[k];
    t = std::sqrt(t);
    const double mu = std::min(g.friction, kSteepest), inverse = 1 / (1 + mu * mu), onto = (y[0] + mu * t) * inverse;
    std::array<double, D> edge{1};
    for (std::size_t k = 1; k < D; ++k) edge[k] = mu * y[k] / t;
    for (std::size_t i = 0; i < D; ++i) {
      for (std::size_t j = 0; j < D; ++j) s[i * D + j] = edge[i] * edge[j] * inverse;
    }
    for (std::size_t i = 1; i < D && D > 2; ++i) {
      for (std::size_t j = 1; j < D; ++j) s[i * D + j] += onto * mu / t * ((i == j) - y[i] * y[j] / (t * t));
    }
    return s;
  }

  // The direction in which a linear problem has its solution: that of who pushes, and how, at `from`.
  double direction(const std::vector<double>& from, WorkDone& work) {
    --m_budget;
    m_matrix.setIdentity();
    m_dz = m_z;
    for (double& v : m_dz) v = -v;
    for (const Group& g : m_groups) {
      const Slope s = slope(g, from);
      const Row* const rows = m_rows.data() + g.first;
      const ProblemRow<D>& r = m_problem.row(m_which[g.first]);
      if (g.count == 1 && rows->part != Part::inside && r.law == ProblemLaw::interval) {
        push(*rows, rows->part == Part::low ? r.lo : r.hi, m_dz);
      }
      if (rows->part == Part::none || (g.count == 1 && rows->part != Part::inside)) continue;
      std::array<Place, D> givesA{}, givesB{};
      for (std::size_t i = 0; i < g.count; ++i) {
        double x = 0;
        for (std::size_t j = 0; j < g.count; ++j) {
          const double k = s[i * D + j] / rows[j].soft;
          x += s[i * D + j] * m_y[g.first + j];
          if (!(k != 0)) continue;
          for (std::size_t m = 0; m < kSize; ++m) {
            givesA[i][m] += k * rows[j].onA[m], givesB[i][m] += k * rows[j].onB[m];
          }
        }
        push(rows[i], x, m_dz);
      }
      if (rows->a >= 0) add(g.count, rows, &Row::onA, givesA, m_matrix.diagonal(rows->a));
      if (rows->b >= 0) add(g.count, rows, &Row::onB, givesB, m_matrix.diagonal(rows->b));
      if (rows->a < 0 || rows->b < 0) continue;
      if (g.between.turned) {
        add(g.count, rows, &Row::onB, givesA, m_matrix.below(g.between.at));
      } else {
        add(g.count, rows, &Row::onA, givesB, m_matrix.below(g.between.at));
      }
    }
    m_matrix.factor();
    m_matrix.solve(m_dz);
    work[WorkCount::rowUpdates] += m_rows.size() + kSize * m_matrix.products;
    double length = 0;
    for (const double v : m_dz) length += v * v;
    for (std::size_t i = 0; i < m_rows.size(); ++i) m_du[i] = along(m_rows[i], m_dz);
    return std::sqrt(length);
  }
  static void add(std::size_t count, const Row* rows, Place Row::*on, const std::array<Place, D>& gives,
                  typename BlockCholesky<kSize>::Block& to) {
    for (std::size_t r = 0; r < count; ++r) {
      for (std::size_t i = 0; i < kSize; ++i) {
        const double left = (rows[r].*on)[i];
        if (!(left != 0)) continue;
        for (std::size_t j = 0; j < kSize; ++j) to[i * kSize + j] += left * gives[r][j];
      }
    }
  }

  // The slope of the function along the direction, so far along it. Leaves y and x there.
  double slopeAt(double t, WorkDone& work) {
    for (std::size_t i = 0; i < m_rows.size(); ++i) m_x[i] = m_y[i] = asked(i, m_u[i] + t * m_du[i]);
    for (const Group& g : m_groups) limit(g, m_x.data());
    double sum = 0;
    for (std::size_t i = 0; i < m_z.size(); ++i) sum += (m_z[i] + t * m_dz[i]) * m_dz[i];
    for (std::size_t i = 0; i < m_rows.size(); ++i) sum -= m_x[i] * m_du[i];
    work[WorkCount::rowUpdates] += m_rows.size();
    return sum;
  }
  double search(WorkDone& work) {
    const double start = slopeAt(0, work);
    double high = 1, atHigh = slopeAt(1, work), low = 0, atLow = start;
    if (!(start < 0) || atHigh <= -kFlat * start) return 1;
    double t = 1;
    int side = 0;
    for (int i = 0; i < kSearches; ++i) {  // the Illinois method: the slope only grows
      t = (low * atHigh - high * atLow) / (atHigh - atLow);
      const double here = slopeAt(t, work);
      if (std::abs(here) <= -kFlat * start) break;
      if (here > 0) {
        high = t, atHigh = here;
        if (side == 1) atLow /= 2;
        side = 1;
      } else {
        low = t, atLow = here;
        if (side == -1) atHigh /= 2;
        side = -1;
      }
    }
    return t;
  }
  void go(double t) {
    for (std::size_t i = 0; i < m_z.size(); ++i) m_z[i] += t * m_dz[i];
    for (std::size_t i = 0; i < m_rows.size(); ++i) m_u[i] += t * m_du[i];
    ask();
  }

  // False: Newton's method has not come to an end.
  bool descend(WorkDone& work) {
    const std::size_t n = m_rows.size();
    begin(1);
    // Who pushes, by the last impulses and what they leave: a guess that holds for most steps.
    for (std::size_t i = 0; i < n; ++i) {
      m_guess[i] = m_last[i] - m_problem.row(m_which[i]).unit * (m_u[i] + m_shift[i]);
    }
    sort(m_guess);
    m_budget = m_params.iterations;
    bool right = false;
    for (int trial = 0; trial < kTrials && !right; ++trial) {
      const double length = direction(trial == 0 ? m_guess : m_y, work);
      go(1);
      right = !sort(m_y, length);
    }
    right = right || newton(work, kTries);
    if (!right) {  // through softer problems, which tell each other who pushes
      begin(kSoftest);
      right = newton(work, m_budget);
    }
    right = refine(right, work);
    if (m_least > kContradiction * m_scale) contradicted(right, work);
    return right || m_least <= kUseful * m_scale;
  }

  // Rows that contradict each other pull as hard as they are stiff, and would be all rounding: a few passes of softer
  // ones instead, whatever they leave. Where Newton's method was only too slow, if they leave less.
  void contradicted(bool right, WorkDone& work) {
    begin(kSofter);
    m_budget = kLast;
    bool soft = false;
    for (int pass = 0; pass < kSoftPasses; ++pass) {
      soft = newton(work, m_budget);
      from(m_x);
      lift();
      m_centre = m_x;
    }
    const double left = residual();
    if ((right && soft) || left < m_least) m_least = left, m_best = m_x;
  }

  // Passes from where the last has come, stiffer where they gain little; or, while De Saxce's correction moves, from
  // nothing: what a wrong correction has clamped would stay. Leaves the best impulses so far. Was the last pass right?
  bool refine(bool right, WorkDone& work) {
    m_least = std::numeric_limits<double>::infinity();
    double share = 1, before = m_least;
    for (int pass = 1, worse = 0;; ++pass) {
      from(m_x);
      const bool moves = lift(share) > kMoves * m_scale;
      const double left = residual();
      worse = left <= kBetter * m_least ? 0 : worse + 1;
      if (left < m_least) m_least = left, m_best = m_x;
      const bool still = m_soft <= 1 && worse > kPatience;
      if (left <= double(m_params.tolerance) * m_scale || still || pass >= m_params.passes || m_budget <= 0)
        return right;
      if (m_soft <= 1 && worse > 1) share = std::max(share / 2, kLeastShare);
      m_centre = m_x;
      if (m_soft <= 1 && moves) m_centre.assign(m_x.size(), 0);
      if (left > kSlow * before) soften(std::max(m_soft / kHarder, 1.0));
      before = left;
      right = newton(work, m_budget);
    }
  }

  // Where impulses lead. Newton's method leaves them rounded as coarsely as the springs are stiff; what a pass adds
  // from here is small, and so is its rounding.
  void from(const std::vector<double>& x) {
    m_z.assign(m_bodies.size() * kSize, 0);
    for (std::size_t i = 0; i < m_rows.size(); ++i) push(m_rows[i], x[i], m_z);
    for (std::size_t i = 0; i < m_rows.size(); ++i) m_u[i] = m_free0[i] + along(m_rows[i], m_z);
  }
  // Of the natural map, with De Saxce's correction.
  double residual() {
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& r = m_problem.row(m_which[i]);
      m_y[i] = m_x[i] - r.unit * (m_u[i] + r.compliance * m_x[i]);
    }
    for (const Group& g : m_groups) m_y[g.first] -= m_problem.row(m_which[g.first]).unit * slide(g);
    m_guess = m_y;
    for (const Group& g : m_groups) limit(g, m_guess.data());
    double most = 0;
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      most = std::max(most, std::abs(m_guess[i] - m_x[i]) / std::sqrt(m_problem.row(m_which[i]).unit));
    }
    return most;
  }

  void begin(double soft) {
    const std::size_t n = m_rows.size();
    m_y.resize(n), m_x.resize(n), m_u.resize(n), m_du.resize(n), m_guess.resize(n);
    m_centre.assign(n, 0), m_shift.assign(n, 0);
    from(m_last);
    lift();
    soften(soft);
  }
  void soften(double soft) {
    m_soft = soft;
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& r = m_problem.row(m_which[i]);
      m_rows[i].eps = soft * double(m_params.cfm) / r.unit, m_rows[i].soft = m_rows[i].eps + r.compliance;
    }
    ask();
  }
  // y and x of where the rows are.
  void ask() {
    for (std::size_t i = 0; i < m_rows.size(); ++i) m_x[i] = m_y[i] = asked(i, m_u[i]);
    for (const Group& g : m_groups) limit(g, m_x.data());
  }
  bool newton(WorkDone& work, int iterations) {
    ask();
    sort(m_y);
    for (int it = 0; it < iterations && m_budget > 0; ++it) {
      const double length = direction(m_y, work), t = search(work);
      go(t);
      const bool changed = sort(m_y, length);
      if (length <= kStill * m_scale || (t == 1 && !changed)) return true;
    }
    return false;
  }

  double slide(const Group& g) const {
    double squared = 0;
    for (std::size_t k = 1; k < g.count; ++k) squared += m_u[g.first + k] * m_u[g.first + k];
    return std::min(g.friction, kSteepest) * std::sqrt(squared);
  }
  // De Saxce's correction of where the rows are; answers its largest change.
  double lift(double share = 1) {
    double change = 0;
    for (const Group& g : m_groups) {
      const double shift = slide(g);
      change = std::max(change, std::abs(shift - m_shift[g.first]) * std::sqrt(m_problem.row(m_which[g.first]).unit));
      m_shift[g.first] += share * (shift - m_shift[g.first]);
    }
    return change;
  }

  Params m_params;
  ContactProblem<D> m_problem;
  RowSweep<D> m_sweep;
  BlockCholesky<kSize> m_matrix;
  std::span<const std::int32_t> m_which;  // rows of the island
  std::vector<Row> m_rows;
  std::vector<Group> m_groups;
  std::vector<std::pair<int, int>> m_edges;
  std::vector<std::int32_t> m_bodies;  // of the nodes
  std::vector<int> m_node;             // of the bodies
  std::vector<InertiaRoot<D>> m_root;
  double m_scale = 0, m_least = 0, m_soft = 1;
  int m_budget = 0;                       // Newton iterations that are left
  std::vector<double> m_free, m_impulse;  // of the problem
  std::vector<double> m_free0, m_last, m_centre, m_shift, m_guess, m_best, m_x, m_y, m_u, m_du;  // by row
  std::vector<double> m_z, m_dz;  // by node and direction
};

}  // namespace

LPC_REGISTER(VelocityResolver, ProximalNewton, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
