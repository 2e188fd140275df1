// SPDX-License-Identifier: Zlib
// Each row of an island is a spring of what it is to do, that pushes within its limits only: then the velocities are
// where a strictly convex function is least. Newton's method with an exact line search finds them, by one sparse
// factorisation over the bodies per iteration.
//
// Unknowns are the changes of velocity z = M^1/2 dv. The function is half of z^2 + sum of soft (y^2 - (y - x)^2):
//
//     y = (eps centre - u - shift) / soft,   x = nearest allowed to y,   u = u(0) + J z,   soft = eps + compliance
//
// Its gradient is z - J^T x. Bodies that cannot move are no unknowns.
#pragma once

#include "algorithms/solver/block_cholesky.h"
#include "algorithms/solver/inertia_root.h"
#include "framework/contact_problem.h"

namespace lpc::inline LPC_PRECISION::solver {

template <int D>
class SpringIsland {
 public:
  struct Group {
    std::size_t first, count;  // of rows: a contact's D, or one
    double friction;
    typename BlockCholesky<D + kAngDim<D>>::Between between;
  };

  std::vector<Group> groups;
  std::vector<double> last;           // impulses of the last step, by row
  std::vector<double> centre, shift;  // of the springs, an impulse and a velocity
  std::vector<double> x, y, u;        // impulses, what was asked for, velocities
  double scale = 0;                   // of z: from what the rows are to do, and the last impulses
  int budget = 0;                     // iterations that are left

  const ProblemRow<D>& row(std::size_t i) const { return m_problem->row(m_which[i]); }
  std::size_t size() const { return m_rows.size(); }

  /// False: it has more bodies. Velocities and impulses are those of the whole problem.
  bool set(const VelocityInput<D>& in, const ContactProblem<D>& problem, std::span<const std::int32_t> which,
           std::span<const double> freeVelocity, std::span<const double> lastImpulse, int maxBodies) {
    const std::size_t n = which.size();
    m_problem = &problem, m_which = which;
    m_node.resize(static_cast<std::size_t>(in.bodies.size()) + 1, -1);
    m_rows.resize(n), groups.clear(), m_edges.clear(), m_bodies.clear();
    bool fits = true;
    for (std::size_t i = 0; i < n && fits; ++i) {
      const ProblemRow<D>& r = row(i);
      Row& to = m_rows[i];
      to.a = nodeOf(in, r.a), to.b = nodeOf(in, r.b);
      to.onA = place(in, r, true), to.onB = place(in, r, false);
      if (r.law != ProblemLaw::tangent) {
        groups.push_back({i, 1, r.friction, {}});
        if (to.a >= 0 && to.b >= 0) m_edges.push_back({to.a, to.b});
      } else {
        ++groups.back().count;
      }
      fits = m_bodies.size() <= static_cast<std::size_t>(maxBodies);
    }
    for (const std::int32_t body : m_bodies) m_node[static_cast<std::size_t>(body)] = -1;
    if (!fits) return false;
    m_matrix.analyse(m_bodies.size(), m_edges);
    for (Group& g : groups) {
      const Row& of = m_rows[g.first];
      if (of.a >= 0 && of.b >= 0) g.between = m_matrix.between(of.a, of.b);
    }
    m_free0.resize(n), m_du.resize(n), last.resize(n);
    x.assign(n, 0), y.assign(n, 0), u.assign(n, 0), centre.assign(n, 0), shift.assign(n, 0);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      m_free0[i] = freeVelocity[static_cast<std::size_t>(which[i])];
      last[i] = lastImpulse[static_cast<std::size_t>(which[i])];
      const double unit = row(i).unit;
      sum += m_free0[i] * m_free0[i] * unit + last[i] * last[i] / unit;
    }
    scale = std::sqrt(sum);
    return true;
  }

  /// z and u of where impulses lead. Newton's method leaves them rounded as coarsely as the springs are stiff; what a
  /// pass adds from here is small, and so is its rounding.
  void from(const std::vector<double>& impulses) {
    m_z.assign(m_bodies.size() * kSize, 0);
    for (std::size_t i = 0; i < m_rows.size(); ++i) push(m_rows[i], impulses[i], m_z);
    for (std::size_t i = 0; i < m_rows.size(); ++i) u[i] = m_free0[i] + along(m_rows[i], m_z);
  }
  /// The springs give way by so much, of W_ii.
  void soften(double cfm) {
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& r = row(i);
      m_rows[i].eps = cfm / r.unit, m_rows[i].soft = m_rows[i].eps + r.compliance;
    }
    ask();
  }
  /// z, u, x and y go to the least. False: it has not come to an end within so many iterations, or all that were left.
  bool newton(int iterations, WorkDone& work) {
    ask();
    sort(y);
    for (int it = 0; it < iterations && budget > 0; ++it) {
      const double length = direction(y, work), t = search(work);
      go(t);
      const bool changed = sort(y, length);
      if (length <= kStill * scale || (t == 1 && !changed)) return true;
    }
    return false;
  }
  /// The same by full steps, from who pushes at `guess`.
  bool tryFrom(const std::vector<double>& guess, int iterations, WorkDone& work) {
    sort(guess);
    bool right = false;
    for (int it = 0; it < iterations && budget > 0 && !right; ++it) {
      const double length = direction(it == 0 ? guess : y, work);
      go(1);
      right = !sort(y, length);
    }
    return right;
  }
  /// The nearest impulses that the group may have.
  void limit(const Group& g, double* impulses) const {
    const ProblemRow<D>& r = row(g.first);
    double* const own = impulses + g.first;
    if (g.count > 1) projectOnCone<D>(std::min(g.friction, kSteepest), own);
    if (g.count == 1 && r.law == ProblemLaw::interval) *own = std::clamp(*own, r.lo, r.hi);
  }

  /// De Saxce's correction of where the rows are.
  double slide(const Group& g) const {
    double squared = 0;
    for (std::size_t k = 1; k < g.count; ++k) squared += u[g.first + k] * u[g.first + k];
    return std::min(g.friction, kSteepest) * std::sqrt(squared);
  }

 private:
  static constexpr std::size_t kSize = D + kAngDim<D>;
  // Above this coefficient a cone is as good as a half-space, and the correction would overthrow the passes.
  static constexpr double kSteepest = 10;
  static constexpr double kFlat = 0.01;                    // of the slope along a direction, where a line search ends
  static constexpr double kStill = 1e-10, kTurned = 3e-8;  // of the scale: steps that end Newton's method
  static constexpr int kSearches = 40;
  enum class Part : std::uint8_t { none, inside, low, high, slides };
  using Place = std::array<double, kSize>;
  struct Row {
    int a, b;  // nodes; -1: what cannot move
    Place onA, onB;
    double eps, soft;
    Part part = Part::none;
  };

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
  void push(const Row& row, double impulse, std::vector<double>& z) const {
    if (!(impulse != 0)) return;
    for (std::size_t k = 0; k < kSize; ++k) {
      if (row.a >= 0) z[static_cast<std::size_t>(row.a) * kSize + k] += impulse * row.onA[k];
      if (row.b >= 0) z[static_cast<std::size_t>(row.b) * kSize + k] += impulse * row.onB[k];
    }
  }
  double asked(std::size_t i, double velocity) const {
    const Row& row = m_rows[i];
    return (row.eps * centre[i] - velocity - shift[i]) / row.soft;
  }
  // Who pushes, at what is asked for. Has it changed? Where something slides in space, by any step that has a length.
  bool sort(const std::vector<double>& at, double length = 0) {
    bool changed = false;
    for (const Group& g : groups) {
      const ProblemRow<D>& r = row(g.first);
      Part part = Part::inside;
      if (g.count > 1) {
        double t = 0;
        for (std::size_t k = 1; k < D; ++k) t += at[g.first + k] * at[g.first + k];
        t = std::sqrt(t);
        const double mu = std::min(g.friction, kSteepest), n = at[g.first];
        part = t <= mu * n ? Part::inside : n + mu * t > 0 ? Part::slides : Part::none;
        if (D == 2 && part == Part::slides) part = at[g.first + 1] > 0 ? Part::high : Part::low;
      } else if (r.law == ProblemLaw::interval) {
        part = at[g.first] <= r.lo ? Part::low : at[g.first] >= r.hi ? Part::high : Part::inside;
      }
      changed = changed || part != m_rows[g.first].part || (part == Part::slides && length > kTurned * scale);
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
    const double* const at = from.data() + g.first;
    for (std::size_t k = 1; k < D; ++k) t += at[k] * at[k];
    t = std::sqrt(t);
    const double mu = std::min(g.friction, kSteepest), inverse = 1 / (1 + mu * mu), onto = (at[0] + mu * t) * inverse;
    std::array<double, D> edge{1};
    for (std::size_t k = 1; k < D; ++k) edge[k] = mu * at[k] / t;
    for (std::size_t i = 0; i < D; ++i) {
      for (std::size_t j = 0; j < D; ++j) s[i * D + j] = edge[i] * edge[j] * inverse;
    }
    for (std::size_t i = 1; i < D && D > 2; ++i) {
      for (std::size_t j = 1; j < D; ++j) s[i * D + j] += onto * mu / t * ((i == j) - at[i] * at[j] / (t * t));
    }
    return s;
  }

  // The direction in which a linear problem has its solution: that of who pushes, and how, at `from`.
  double direction(const std::vector<double>& from, WorkDone& work) {
    --budget;
    m_matrix.setIdentity();
    m_dz = m_z;
    for (double& v : m_dz) v = -v;
    for (const Group& g : groups) {
      const Slope s = slope(g, from);
      const Row* const rows = m_rows.data() + g.first;
      const ProblemRow<D>& r = row(g.first);
      if (g.count == 1 && rows->part != Part::inside && r.law == ProblemLaw::interval) {
        push(*rows, rows->part == Part::low ? r.lo : r.hi, m_dz);
      }
      if (rows->part == Part::none || (g.count == 1 && rows->part != Part::inside)) continue;
      std::array<Place, D> givesA{}, givesB{};
      for (std::size_t i = 0; i < g.count; ++i) {
        double pushes = 0;
        for (std::size_t j = 0; j < g.count; ++j) {
          const double k = s[i * D + j] / rows[j].soft;
          pushes += s[i * D + j] * y[g.first + j];
          if (!(k != 0)) continue;
          for (std::size_t m = 0; m < kSize; ++m) {
            givesA[i][m] += k * rows[j].onA[m], givesB[i][m] += k * rows[j].onB[m];
          }
        }
        push(rows[i], pushes, m_dz);
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
    for (std::size_t i = 0; i < m_rows.size(); ++i) x[i] = y[i] = asked(i, u[i] + t * m_du[i]);
    for (const Group& g : groups) limit(g, x.data());
    double sum = 0;
    for (std::size_t i = 0; i < m_z.size(); ++i) sum += (m_z[i] + t * m_dz[i]) * m_dz[i];
    for (std::size_t i = 0; i < m_rows.size(); ++i) sum -= x[i] * m_du[i];
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
    for (std::size_t i = 0; i < m_rows.size(); ++i) u[i] += t * m_du[i];
    ask();
  }

  // y and x of where the rows are.
  void ask() {
    for (std::size_t i = 0; i < m_rows.size(); ++i) x[i] = y[i] = asked(i, u[i]);
    for (const Group& g : groups) limit(g, x.data());
  }

  const ContactProblem<D>* m_problem = nullptr;
  BlockCholesky<kSize> m_matrix;
  std::span<const std::int32_t> m_which;  // rows of the problem
  std::vector<Row> m_rows;
  std::vector<std::pair<int, int>> m_edges;
  std::vector<std::int32_t> m_bodies;  // of the nodes
  std::vector<int> m_node;             // of the bodies
  std::vector<InertiaRoot<D>> m_root;
  std::vector<double> m_free0, m_du;  // by row
  std::vector<double> m_z, m_dz;      // by node and direction
};

}  // namespace lpc::inline LPC_PRECISION::solver
