// SPDX-License-Identifier: Zlib
// Each row of an island is a spring towards its target, with limited force. The velocities then minimise a strictly
// convex function. Newton's method with an exact line search finds the minimum, with one sparse factorisation over the
// bodies per iteration.
//
// Unknowns are the changes of velocity z = M^1/2 dv. The function is half of z^2 + sum of soft (y^2 - (y - x)^2):
//
// y = (eps centre - u - shift) / soft,   x = nearest allowed to y,   u = u(0) + J z,   soft = eps + compliance
//
// Its gradient is z - J^T x. Bodies that cannot move have no unknowns.
#pragma once

#include "algorithms/solver/island/body_rows.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
class SpringIsland {
 public:
  using Group = typename BodyRows<D>::Group;

  std::vector<double> last;           // impulses of the last step, by row
  std::vector<double> centre, shift;  // of the springs: an impulse and a velocity
  std::vector<double> x, y, u;        // impulses, demanded impulses, velocities
  double scale = 0;                   // of z, from the targets of the rows and the last impulses
  int budget = 0;                     // iterations that are left
  std::uint64_t multiplyAdds = 0;     // so far

  const ProblemRow<D>& row(std::size_t i) const { return m_problem->row(m_which[i]); }
  const std::vector<Group>& groups() const { return m_rows.groups; }
  std::size_t size() const { return m_rows.size(); }

  /// Returns false if the island has too many bodies. Velocities and impulses are those of the whole problem.
  bool set(const VelocityInput<D>& in, const ContactProblem<D>& problem, std::span<const std::int32_t> which,
           IndexedSpan<const double> freeVelocity, IndexedSpan<const double> lastImpulse, int maxBodies) {
    const std::size_t n = which.size();
    m_problem = &problem, m_which = which;
    if (!m_rows.set(in, problem, which, maxBodies)) return false;
    m_rows.analyse(m_matrix);
    m_eps.resize(n), m_soft.resize(n), m_part.resize(n);
    m_free0.resize(n), m_du.resize(n), last.resize(n);
    x.assign(n, 0), y.assign(n, 0), u.assign(n, 0), centre.assign(n, 0), shift.assign(n, 0);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      m_free0[i] = freeVelocity[which[i]];
      last[i] = lastImpulse[which[i]];
      const double unit = row(i).unit;
      sum += m_free0[i] * m_free0[i] * unit + last[i] * last[i] / unit;
    }
    scale = std::sqrt(sum);
    return true;
  }

  /// Sets z and u from impulses. Newton's method rounds them as coarsely as the springs are stiff; the change of a pass
  /// from here is small, and so is its rounding.
  void from(const std::vector<double>& impulses) {
    multiplyAdds += 2 * m_rows.multiplyAddsOfProduct();
    m_z.assign(m_rows.bodies() * BodyRows<D>::kSize, 0);
    for (std::size_t i = 0; i < size(); ++i) m_rows.push(i, impulses[i], m_z);
    for (std::size_t i = 0; i < size(); ++i) u[i] = m_free0[i] + m_rows.along(i, m_z);
  }
  /// Softens the springs by this multiple of W_ii.
  void soften(double cfm) {
    for (std::size_t i = 0; i < size(); ++i) {
      const ProblemRow<D>& r = row(i);
      m_eps[i] = cfm / r.unit, m_soft[i] = m_eps[i] + r.compliance;
    }
    ask();
  }
  /// Moves z, u, x and y to the minimum. Returns false if it is not reached within these iterations, or within all that
  /// are left.
  bool newton(int iterations) {
    ask();
    sort(y);
    for (int it = 0; it < iterations && budget > 0; ++it) {
      const double length = direction(y), t = search();
      go(t);
      const bool changed = sort(y, length);
      if (length <= kStill * scale || (t == 1 && !changed)) return true;
    }
    return false;
  }
  /// The same by full steps; `guess` tells which rows press at the start.
  bool tryFrom(const std::vector<double>& guess, int iterations) {
    sort(guess);
    bool right = false;
    for (int it = 0; it < iterations && budget > 0 && !right; ++it) {
      const double length = direction(it == 0 ? guess : y);
      go(1);
      right = !sort(y, length);
    }
    return right;
  }
  /// Projects impulses onto those that the group allows.
  void limit(const Group& g, double* impulses) const {
    const ProblemRow<D>& r = row(g.first);
    double* const own = impulses + g.first;
    if (g.count > 1) projectOnCone<D>(std::min(g.friction, kSteepest), own);
    if (g.count == 1 && r.law == ProblemLaw::interval) *own = std::clamp(*own, r.lo, r.hi);
  }

  /// De Saxce's correction at the present velocities.
  double slide(const Group& g) const {
    double squared = 0;
    for (std::size_t k = 1; k < g.count; ++k) squared += u[g.first + k] * u[g.first + k];
    return std::min(g.friction, kSteepest) * std::sqrt(squared);
  }

 private:
  // Above this coefficient a cone is as good as a half-space, and the correction would make the passes diverge.
  static constexpr double kSteepest = 10;
  static constexpr double kFlat = 0.01;  // of the slope along a direction, at which a line search ends
  static constexpr double kStill = 1e-10, kTurned = 3e-8;  // of the scale: step sizes that end Newton's method
  static constexpr int kSearches = 40;
  static constexpr std::uint64_t kOfRow = 4;  // multiply-adds of a row's demand, and of the projection onto its cone
  enum class Part : std::uint8_t { none, inside, low, high, slides };
  double asked(std::size_t i, double velocity) const {
    return (m_eps[i] * centre[i] - velocity - shift[i]) / m_soft[i];
  }
  // Sorts the rows by the limits that they are at. Returns whether that changed; where something slides in 3D, any step
  // with a length counts as a change.
  bool sort(const std::vector<double>& at, double length = 0) {
    bool changed = false;
    for (const Group& g : groups()) {
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
      changed = changed || part != m_part[g.first] || (part == Part::slides && length > kTurned * scale);
      m_part[g.first] = part;
    }
    return changed;
  }

  // Derivative of x by y in the state into which a group was sorted; `from` is the y of that time.
  using Slope = typename BodyRows<D>::Square;
  Slope slope(const Group& g, const std::vector<double>& from) const {
    Slope s{};
    const Part part = m_part[g.first];
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
    IndexedArray<double, D> edge{1};
    for (std::size_t k = 1; k < D; ++k) edge[k] = mu * at[k] / t;
    for (std::size_t i = 0; i < D; ++i) {
      for (std::size_t j = 0; j < D; ++j) s[i * D + j] = edge[i] * edge[j] * inverse;
    }
    for (std::size_t i = 1; i < D && D > 2; ++i) {
      for (std::size_t j = 1; j < D; ++j) s[i * D + j] += onto * mu / t * ((i == j) - at[i] * at[j] / (t * t));
    }
    return s;
  }

  // The direction towards the solution of the linear problem in the states at `from`.
  double direction(const std::vector<double>& from) {
    --budget;
    m_matrix.set(1);
    m_dz = m_z;
    for (double& v : m_dz) v = -v;
    for (const Group& g : groups()) {
      Slope s = slope(g, from);
      const ProblemRow<D>& r = row(g.first);
      const Part part = m_part[g.first];
      if (g.count == 1 && part != Part::inside && r.law == ProblemLaw::interval) {
        m_rows.push(g.first, part == Part::low ? r.lo : r.hi, m_dz);
      }
      if (part == Part::none || (g.count == 1 && part != Part::inside)) continue;
      for (std::size_t i = 0; i < g.count; ++i) {
        double pushes = 0;
        for (std::size_t j = 0; j < g.count; ++j) {
          pushes += s[i * D + j] * y[g.first + j];
          s[i * D + j] /= m_soft[g.first + j];
        }
        m_rows.push(g.first + i, pushes, m_dz);
      }
      m_rows.add(g, s, m_matrix);
      multiplyAdds += 2 * g.count * g.count + m_rows.multiplyAddsOf(g, true);
    }
    m_matrix.factor();
    m_matrix.solve(m_dz);
    multiplyAdds += m_matrix.multiplyAdds + m_matrix.multiplyAddsOfSolve();
    double length = 0;
    for (const double v : m_dz) length += v * v;
    for (std::size_t i = 0; i < size(); ++i) m_du[i] = m_rows.along(i, m_dz);
    multiplyAdds += m_dz.size() + 2 * m_rows.multiplyAddsOfProduct();
    return std::sqrt(length);
  }

  // The slope of the function at t along the direction. Leaves y and x there.
  double slopeAt(double t) {
    for (std::size_t i = 0; i < size(); ++i) x[i] = y[i] = asked(i, u[i] + t * m_du[i]);
    for (const Group& g : groups()) limit(g, x.data());
    double sum = 0;
    for (std::size_t i = 0; i < m_z.size(); ++i) sum += (m_z[i] + t * m_dz[i]) * m_dz[i];
    for (std::size_t i = 0; i < size(); ++i) sum -= x[i] * m_du[i];
    multiplyAdds += 2 * m_z.size() + 2 * size() + kOfRow * size();
    return sum;
  }
  double search() {
    const double start = slopeAt(0);
    double high = 1, atHigh = slopeAt(1), low = 0, atLow = start;
    if (!(start < 0) || atHigh <= -kFlat * start) return 1;
    double t = 1;
    int side = 0;
    for (int i = 0; i < kSearches; ++i) {  // Illinois method: the slope is monotone
      t = (low * atHigh - high * atLow) / (atHigh - atLow);
      const double here = slopeAt(t);
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
    multiplyAdds += m_z.size() + size();
    for (std::size_t i = 0; i < m_z.size(); ++i) m_z[i] += t * m_dz[i];
    for (std::size_t i = 0; i < size(); ++i) u[i] += t * m_du[i];
    ask();
  }

  // Computes y and x at the present velocities.
  void ask() {
    multiplyAdds += kOfRow * size();
    for (std::size_t i = 0; i < size(); ++i) x[i] = y[i] = asked(i, u[i]);
    for (const Group& g : groups()) limit(g, x.data());
  }

  const ContactProblem<D>* m_problem = nullptr;
  BodyRows<D> m_rows;
  BlockCholesky<BodyRows<D>::kSize> m_matrix;
  std::span<const std::int32_t> m_which;             // rows of the problem
  std::vector<Part> m_part;                          // by row, of the first row of a group
  std::vector<double> m_free0, m_du, m_eps, m_soft;  // by row
  std::vector<double> m_z, m_dz;                     // by node and direction
};

}}}  // namespace lpc::LPC_PRECISION::solver
