// SPDX-License-Identifier: Zlib
// The velocity problem of a whole step, for methods that solve it as a whole and for measuring residuals.
//
// With one impulse x_i per row, the row velocities after the step, minus their targets, are u = W x + v - target. Here
// W = J M^-1 J^T, and v are the current velocities. Find impulses with
//
//     free       u_i + compliance_i x_i = 0
//     interval   lo_i <= x_i <= hi_i; u_i >= 0 at lo_i, <= 0 at hi_i, 0 between
//     contact    |x_t| <= mu x_n and u_n >= 0, x_n u_n = 0, u_t = -s x_t with s >= 0, which is 0 inside the cone
//
// The contact law is not that of a convex problem. De Saxce's correction replaces u_n by u_n + mu |u_t|. Then the law
// reads "x and u lie in two dual cones and are orthogonal", which one projection tests.
//
// All numbers are double in either precision: redundant contacts make W singular, and float rounding would decide the
// result.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/worse.h"
#include "framework/problem/contact_as_rows.h"
#include "framework/problem/given_problem.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class ProblemLaw : std::uint8_t { free, interval, normal, tangent };

template <int D>
struct ProblemRow {
  using Linear = Eigen::Matrix<double, D, 1, Eigen::DontAlign>;
  using Angular = Eigen::Matrix<double, kAngDim<D>, 1, Eigen::DontAlign>;

  std::int32_t a = 0, b = 0;  // bodies by slot; the world has the number after the last slot
  Linear d;                   // as in ConstraintRow
  Angular armA, armB;
  Linear pushA, pushB;    // velocity of a body per impulse, m/s per N s
  Angular turnA, turnB;   // the same, rad/s
  double target = 0;      // m/s or rad/s
  double compliance = 0;  // of a spring, velocity per impulse
  double lo = 0, hi = 0;  // of the impulse, N s or N m s
  double mass = 0;        // 1 / (W_ii + compliance)
  double unit = 0;        // one mass for all directions of a contact or of a joint's equality rows: 1 / mean W_ii
  double friction = 0;    // of a normal row, which is followed by its D - 1 tangent rows
  ProblemLaw law = ProblemLaw::free;
  bool ofJoint = false;
  bool movable = false;                // an impulse can move the centre of mass of at least one body
  std::int32_t owner = 0, number = 0;  // joint and its row, or manifold and D x point + direction

  /// True for equality rows that a joint solves together: no limits, no compliance.
  bool holds() const { return ofJoint && law == ProblemLaw::free && !(compliance > 0); }
};

/// Distance of the impulses from a solution, in m/s (rad/s for angular rows): the impulse error divided by the row's
/// effective mass. Divide it by g dt for an error relative to the row's own weight.
struct ProblemResidual {
  double natural = 0;  // residual of the natural map, maximum over all rows
  double cone = 0;     // how far an impulse lies outside its cone or interval, maximum over all rows
};

/// Projects (n, t) to the nearest point with |t| <= mu n.
template <int D>
void projectOnCone(double mu, double* x) {
  double squared = 0;
  for (int k = 1; k < D; ++k) squared += x[k] * x[k];
  const double t = std::sqrt(squared), n = x[0];
  if (t <= mu * n) return;
  const double onto = std::max((n + mu * t) / (1 + mu * mu), 0.0);
  x[0] = onto;
  for (int k = 1; k < D; ++k) x[k] *= onto > 0 ? mu * onto / t : 0.0;
}

template <int D>
class ContactProblem {
 public:
  using Row = ProblemRow<D>;

  const std::vector<Row>& rows() const { return m_rows; }
  int size() const { return static_cast<int>(m_rows.size()); }
  const Row& row(int i) const { return m_rows[i]; }

  /// Builds the problem, without rows whose velocity no impulse can change. Arrays keep their capacity. Keeps a pointer
  /// to in.given, which must outlive this object.
  void set(const VelocityInput<D>& in) {
    m_given = in.given;
    m_bodies = m_given ? m_given->size() : in.bodies.size();
    m_rows.clear(), m_joints.clear();
    if (m_given) addGiven(in.model.friction);
    for (std::size_t j = 0; !m_given && in.model.joints && j < in.joints.size(); ++j) addJoint(in, j);
    for (std::size_t k = 0; !m_given && k < in.order.size(); ++k) addContacts(in, in.order[k]);
    for (std::size_t i = 0, end = 0; i < m_rows.size(); i = end) {
      double response = 0;
      for (end = i; end < m_rows.size() && together(i, end); ++end) response += 1 / m_rows[end].mass;
      for (std::size_t k = i; k < end; ++k) m_rows[k].unit = static_cast<double>(end - i) / response;
    }
    group(in.bodies);
  }

  /// Writes into x the last step's impulses, mapped to this step's rows, times `factor`, scaled to this step's length,
  /// and projected onto their limits.
  void lastImpulses(const VelocityInput<D>& in, double factor, std::vector<double>& x) const {
    if (in.lastDt > 0) factor *= double(in.dt) / double(in.lastDt);
    impulses(in, x);
    for (double& impulse : x) impulse *= factor;
    for (int i = 0; i < size(); ++i) project(i, x.data() + i);
  }

  /// Writes into x the impulses stored in the manifolds and joints of set(), or in the given problem. After a solve
  /// they are the solution.
  void impulses(const VelocityInput<D>& in, std::vector<double>& x) const {
    if (!in.given) return impulses(in.manifolds, in.joints, x);
    x.resize(m_rows.size());
    for (std::size_t i = 0; i < m_rows.size(); ++i) x[i] = in.given->impulse[m_rows[i].number];
  }
  void impulses(std::span<Manifold<D>> manifolds, std::span<JointRecord<D>> joints, std::vector<double>& x) const {
    x.resize(m_rows.size());
    for (std::size_t i = 0; i < m_rows.size(); ++i) x[i] = double(stored(manifolds, joints, m_rows[i]));
  }

  /// Writes into u the current row velocities minus their targets, which is u for x = 0.
  void freeVelocities(const VelocityInput<D>& in, std::vector<double>& u) const {
    u.resize(m_rows.size());
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      const Row& r = m_rows[i];
      if (in.given) {
        u[i] = in.given->velocity[r.number];
        continue;
      }
      double v = -r.target;
      if (r.b < m_bodies) v += along(r.d, r.armB, in.bodies.motion[r.b]);
      if (r.a < m_bodies) v -= along(r.d, r.armA, in.bodies.motion[r.a]);
      u[i] = v;
    }
  }

  /// W_ij, without compliance.
  double response(const Row& r, const Row& s) const {
    if (m_given) return m_given->at(r.number, s.number);
    double w = 0;
    if (r.a == s.a) w += r.d.dot(s.pushA) + r.armA.dot(s.turnA);
    if (r.b == s.b) w += r.d.dot(s.pushB) + r.armB.dot(s.turnB);
    if (r.a == s.b) w -= r.d.dot(s.pushB) + r.armA.dot(s.turnB);
    if (r.b == s.a) w -= r.d.dot(s.pushA) + r.armB.dot(s.turnA);
    return w;
  }

  /// W of the listed rows, row by row, with the compliance of springs.
  void assemble(std::span<const std::int32_t> which, std::vector<double>& w) const {
    const std::size_t n = which.size();
    w.resize(n * n);
    for (std::size_t i = 0; i < n; ++i) {
      const Row& r = row(which[i]);
      for (std::size_t j = 0; j < i; ++j) w[i * n + j] = w[j * n + i] = response(r, row(which[j]));
      w[i * n + i] = 1 / r.mass;
    }
  }

  /// y = W x, with the compliance of springs. Computed through the velocities of the bodies, without W.
  void multiply(IndexedSpan<const double> x, std::vector<double>& y) {
    clearMotion();
    for (int i = 0; i < size(); ++i) push(i, x[i]);
    y.resize(m_rows.size());
    for (int i = 0; i < size(); ++i) {
      y[i] = pushed(i) + row(i).compliance * x[i];
    }
  }

  /// Resets the velocity changes that push() accumulates during a sweep.
  void clearMotion() {
    if (m_given) return m_moved.assign(static_cast<std::size_t>(m_bodies), 0);
    m_motion.assign(static_cast<std::size_t>(m_bodies) + 1, {});
  }
  void push(int i, double impulse) {
    const Row& r = row(i);
    if (m_given) {
      m_given->eachOf(r.number, [&](std::int32_t k, double w) { m_moved[k] += w * impulse; });
      return;
    }
    Moved &a = m_motion[r.a], &b = m_motion[r.b];
    a.v -= impulse * r.pushA, a.w -= impulse * r.turnA;
    b.v += impulse * r.pushB, b.w += impulse * r.turnB;
  }
  double pushed(int i) const {
    const Row& r = row(i);
    if (m_given) return m_moved[r.number];
    const Moved &a = m_motion[r.a], &b = m_motion[r.b];
    return r.d.dot(b.v - a.v) + r.armB.dot(b.w) - r.armA.dot(a.w);
  }

  /// Adds the effect of the impulses to the velocities, and writes the impulses into manifolds and joints. A joint
  /// between immovable bodies keeps its old impulses; an inactive row gets zero.
  void apply(const VelocityInput<D>& in, IndexedSpan<const double> x) {
    clearMotion();
    if (in.given) {
      std::fill(in.given->impulse.begin(), in.given->impulse.end(), 0.0);
      for (int i = 0; i < size(); ++i) {
        push(i, x[i]);
        in.given->impulse[row(i).number] = x[i];
      }
      for (std::size_t k = 0; k < m_moved.size(); ++k) in.given->velocity[k] += m_moved[k];
      return;
    }
    for (const int i : in.order) {
      Manifold<D>& m = in.manifolds[i];
      for (int k = 0; k < m.count; ++k) m.points[k].impulse.fill(0);
    }
    for (const std::int32_t j : m_joints) in.joints[j].impulse.fill(0);
    for (int i = 0; i < size(); ++i) {
      push(i, x[i]);
      stored(in.manifolds, in.joints, row(i)) = static_cast<Real>(x[i]);
    }
    for (std::size_t i = 0; i + 1 < m_motion.size(); ++i) {
      in.bodies.motion[i].v += m_motion[i].v.template cast<Real>();
      in.bodies.motion[i].w += m_motion[i].w.template cast<Real>();
    }
  }

  /// Projects x to the nearest impulse that row i allows. For a normal row this includes its tangents; a tangent row is
  /// left unchanged.
  void project(int i, double* x) const {
    const Row& r = row(i);
    if (r.law == ProblemLaw::interval) *x = std::clamp(*x, r.lo, r.hi);
    if (r.law == ProblemLaw::normal) projectOnCone<D>(r.friction, x);
  }

  /// Residual of impulses x. With `corrected` false: residual of the convex law, without De Saxce's correction.
  ProblemResidual naturalMap(IndexedSpan<const double> x, IndexedSpan<const double> freeVelocity,
                             bool corrected = true) {
    ProblemResidual worst;
    multiply(x, m_velocity);
    for (int i = 0; i < size(); ++i) {
      const Row& r = row(i);
      if (r.law == ProblemLaw::tangent) continue;
      const int n = r.law == ProblemLaw::normal ? D : 1;
      IndexedArray<double, D> here{}, u{}, moved{};
      double slide = 0;
      const double mass = r.unit;  // one mass for all directions: different masses would tilt the cone
      for (int k = 0; k < n; ++k) {
        here[k] = x[i + k], u[k] = m_velocity[i + k] + freeVelocity[i + k];
        if (k > 0) slide += u[k] * u[k];
      }
      if (n > 1 && corrected) u[0] += r.friction * std::sqrt(slide);
      for (std::size_t k = 0; k < D; ++k) moved[k] = here[k] - mass * u[k];
      project(i, moved.data());
      IndexedArray<double, D> inside = here;
      project(i, inside.data());
      double error = 0, outside = 0;
      for (int k = 0; k < n; ++k) {
        error += (here[k] - moved[k]) * (here[k] - moved[k]);
        outside += (here[k] - inside[k]) * (here[k] - inside[k]);
      }
      worst.natural = worse(worst.natural, std::sqrt(error) / mass);
      worst.cone = worse(worst.cone, std::sqrt(outside) / mass);
    }
    return worst;
  }

  /// Rows by island, connected by bodies that the rows can move. The rows of island k are grouped()[islands()[k]] up
  /// to, but not including, grouped()[islands()[k + 1]], in the order of rows().
  std::span<const std::int32_t> grouped() const { return m_grouped; }
  std::span<const std::int32_t> islands() const { return m_islands; }

 private:
  struct Moved {
    typename Row::Linear v = Row::Linear::Zero();
    typename Row::Angular w = Row::Angular::Zero();
  };

  bool together(std::size_t i, std::size_t k) const {
    const Row &r = m_rows[i], &s = m_rows[k];
    if (i == k) return true;
    if (r.law == ProblemLaw::normal) return s.law == ProblemLaw::tangent && k < i + D;
    return r.holds() && s.holds() && r.owner == s.owner && r.d.isZero(0) == s.d.isZero(0);
  }
  static double along(const typename Row::Linear& d, const typename Row::Angular& arm, const Motion<D>& m) {
    return d.dot(m.v.template cast<double>()) + arm.dot(m.w.template cast<double>());
  }
  static Real& stored(IndexedSpan<Manifold<D>> manifolds, IndexedSpan<JointRecord<D>> joints, const Row& r) {
    if (r.ofJoint) return joints[r.owner].impulse[r.number];
    return manifolds[r.owner].points[r.number / D].impulse[r.number % D];
  }

  Row& add(const VelocityInput<D>& in, int a, int b, const ConstraintRow<D>& from) {
    Row& r = m_rows.emplace_back();
    r.a = a < 0 ? m_bodies : a, r.b = b;
    r.d = from.d.template cast<double>();
    r.armA = from.armA.template cast<double>(), r.armB = from.armB.template cast<double>();
    r.pushA.setZero(), r.turnA.setZero();
    using Turn = Eigen::Matrix<double, kAngDim<D>, kAngDim<D>, Eigen::DontAlign>;
    const bool turns = in.model.rotation;
    if (a >= 0) r.pushA = double(in.bodies.invMass[a]) * r.d;
    if (a >= 0 && turns) r.turnA = Turn(in.bodies.invInertia[a].template cast<double>()) * r.armA;
    r.pushB = double(in.bodies.invMass[b]) * r.d, r.turnB.setZero();
    if (turns) r.turnB = Turn(in.bodies.invInertia[b].template cast<double>()) * r.armB;
    r.movable = in.bodies.invMass[b] > 0 || (a >= 0 && in.bodies.invMass[a] > 0);
    r.lo = double(from.lo) * double(in.dt), r.hi = double(from.hi) * double(in.dt);
    const double w = response(r, r);
    r.mass = w > 0 ? 1 / w : 0.0;
    return r;
  }

  // Skips rows with W_ii = 0, which no impulse can move. A contact with such a tangent row slides without friction.
  void addGiven(bool friction) {
    const auto add = [&](std::int32_t number, ProblemLaw law) {
      Row& r = m_rows.emplace_back();
      r.a = r.b = r.number = r.owner = number, r.law = law, r.movable = true;
      r.mass = m_given->at(number, number) > 0 ? 1 / m_given->at(number, number) : 0.0;
      return r.mass > 0;
    };
    const auto contacts = static_cast<std::int32_t>(m_given->friction.size());
    for (std::int32_t c = 0; c < contacts; ++c) {
      const double mu = friction ? m_given->friction[c] : 0.0;
      const std::size_t first = m_rows.size();
      bool rubs = mu > 0;
      if (!add(D * c, ProblemLaw::interval)) {
        m_rows.pop_back();
        continue;
      }
      for (int k = 1; k < D && rubs; ++k) rubs = add(D * c + k, ProblemLaw::tangent);
      if (!rubs) m_rows.resize(first + 1);
      m_rows[first].hi = std::numeric_limits<double>::infinity();
      if (rubs) m_rows[first].law = ProblemLaw::normal, m_rows[first].friction = mu;
    }
    for (std::int32_t i = D * contacts; i < m_given->size(); ++i) {
      const bool moves = add(i, ProblemLaw::free);
      m_rows.back().ofJoint = true;
      if (!moves) m_rows.pop_back();
    }
  }

  void addJoint(const VelocityInput<D>& in, std::size_t j) {
    if (!in.joints[j].active()) return;
    jointRows(in.joints[j], in.bodies, m_jointRows);
    const std::size_t first = m_rows.size();
    const double dt = double(in.dt), rate = double(in.position.jointBias(in.dt));
    bool present = false;
    for (int i = 0; i < m_jointRows.count; ++i) {
      const ConstraintRow<D>& from = m_jointRows.row[i];
      if (from.absent()) continue;
      present = true;
      Row& r = add(in, in.joints[j].bodyA, in.joints[j].bodyB, from);
      r.ofJoint = true, r.owner = static_cast<std::int32_t>(j), r.number = i;
      r.law = std::isinf(r.lo) && std::isinf(r.hi) ? ProblemLaw::free : ProblemLaw::interval;
      const double error = double(from.error), c = double(from.damping) + dt * double(from.stiffness);
      if (from.law == RowLaw::motor) r.target = double(from.speed);
      if (from.law == RowLaw::rigid) r.target = from.open() ? -error / dt : -rate * error;
      // Implicit, as in JointSystem: x = -dt (stiffness (error + dt v) + damping v).
      if (from.law == RowLaw::spring && c > 0) r.target = -error * double(from.stiffness) / c;
      if (from.law == RowLaw::spring && c > 0 && r.mass > 0) {
        r.compliance = 1 / (dt * c), r.mass = 1 / (1 / r.mass + r.compliance);
      }
      if (!(r.mass > 0) || (from.law == RowLaw::spring && !(c > 0))) m_rows.pop_back();
    }
    if (!present || m_rows.size() > first) m_joints.push_back(static_cast<std::int32_t>(j));
  }

  void addContacts(const VelocityInput<D>& in, int manifold) {
    const Manifold<D>& m = in.manifolds[manifold];
    m_contactRows.clear();
    contactRows(in, m, m_contactRows);
    for (int k = 0; k < m.count; ++k) {
      const ConstraintRow<D>* const from = m_contactRows.data() + D * k;
      const std::size_t first = m_rows.size();
      bool rubs = !from[1].absent();
      for (int i = 0; i < (rubs ? D : 1); ++i) {
        Row& r = add(in, m.bodyA, m.bodyB, from[i]);
        r.owner = manifold, r.number = D * k + i;
        if (i > 0) r.law = ProblemLaw::tangent, rubs = rubs && r.mass > 0;
      }
      if (!(m_rows[first].mass > 0)) {
        m_rows.resize(first);
        continue;
      }
      if (!rubs) m_rows.resize(first + 1);  // pinned bodies: no friction when an impulse cannot move a tangent
      Row& normal = m_rows[first];
      normal.law = rubs ? ProblemLaw::normal : ProblemLaw::interval;
      normal.friction = rubs ? double(from[1].friction) : 0.0;
      const Real least = from->open() ? -from->error / in.dt : in.position.bias(from->error, in.dt);
      normal.target = double(std::max(least, from->bounce));
    }
  }

  void group(const Bodies<D>& bodies) {
    m_parent.resize(static_cast<std::size_t>(m_bodies) + 1);
    for (std::size_t i = 0; i < m_parent.size(); ++i) m_parent[i] = static_cast<std::int32_t>(i);
    const auto root = [&](std::int32_t i) {
      while (m_parent[i] != i) {
        auto& up = m_parent[i];
        i = up = m_parent[up];
      }
      return i;
    };
    const auto moves = [&](std::int32_t i) {
      return i < m_bodies && (m_given || bodies.invMass[i] > 0 || bodies.invInertia[i].trace() > 0);
    };
    const auto join = [&](std::int32_t a, std::int32_t b) { m_parent[root(a)] = root(b); };
    std::int32_t normal = 0;
    for (const Row& r : m_rows) {
      if (moves(r.a) && moves(r.b)) join(r.a, r.b);
      if (!m_given) continue;
      m_given->eachOf(r.number, [&](std::int32_t k, double w) {
        if (w != 0) join(r.number, k);
      });
      if (r.law == ProblemLaw::tangent) join(r.number, normal);
      if (r.law == ProblemLaw::normal) normal = r.number;
    }
    // Number islands by their first rows; rows keep their order inside.
    m_number.assign(m_parent.size(), -1);
    m_islands.assign(1, 0), m_of.resize(m_rows.size());
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      const Row& r = m_rows[i];
      std::int32_t& number = m_number[root(moves(r.a) ? r.a : r.b)];
      if (number < 0) number = static_cast<std::int32_t>(m_islands.size()) - 1, m_islands.push_back(0);
      m_of[i] = number, ++m_islands[number + 1];
    }
    for (std::size_t k = 1; k < m_islands.size(); ++k) m_islands[k] += m_islands[k - 1];
    m_next.assign(m_islands.begin(), m_islands.end());
    m_grouped.resize(m_rows.size());
    for (std::size_t i = 0; i < m_rows.size(); ++i) {
      m_grouped[m_next[m_of[i]]++] = static_cast<std::int32_t>(i);
    }
  }

  const GivenProblem* m_given = nullptr;
  std::int32_t m_bodies = 0;  // or rows of the given problem
  IndexedVector<Row> m_rows;
  IndexedVector<std::int32_t> m_joints;  // joints that get impulses
  JointRows<D> m_jointRows;
  IndexedVector<ConstraintRow<D>> m_contactRows;
  IndexedVector<Moved> m_motion;
  IndexedVector<double> m_moved;  // by row of the given problem
  IndexedVector<double> m_velocity;
  IndexedVector<std::int32_t> m_parent, m_number, m_of, m_next, m_grouped, m_islands;
};

}}  // namespace lpc::LPC_PRECISION
