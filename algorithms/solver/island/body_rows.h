// SPDX-License-Identifier: Zlib
// Rows of an island as W = J J^T, with J by row and movable body. The unknowns of a body are changes of velocity in
// units of the square root of its inverse mass. 1 + J^T S J, with one block of S per contact, is block sparse over the
// bodies.
#pragma once

#include "algorithms/solver/island/block_matrix.h"
#include "algorithms/solver/island/inertia_root.h"
#include "framework/math/indexed.h"
#include "framework/problem/contact_problem.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
class BodyRows {
 public:
  static constexpr std::size_t kSize = D + kAngDim<D>;
  struct Group {
    std::size_t first, count;  // of rows: D for a contact, otherwise one
    double friction;
    BlockPattern::Between between;
  };
  /// A matrix over the rows of a group, row by row.
  using Square = IndexedArray<double, D * D>;

  std::vector<Group> groups;

  std::size_t size() const { return m_rows.size(); }
  std::size_t bodies() const { return m_bodies.size(); }
  bool ofTwoBodies(const Group& g) const { return m_rows[g.first].a >= 0 && m_rows[g.first].b >= 0; }

  /// Returns false if the island has too many bodies.
  bool set(const VelocityInput<D>& in, const ContactProblem<D>& problem, std::span<const std::int32_t> which,
           int maxBodies) {
    const std::size_t n = which.size();
    m_node.resize(in.bodies.pose.size() + 1, -1);
    m_rows.resize(n), groups.clear(), m_edges.clear(), m_bodies.clear();
    bool fits = true;
    for (std::size_t i = 0; i < n && fits; ++i) {
      const ProblemRow<D>& r = problem.row(which[i]);
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
    for (const std::int32_t body : m_bodies) m_node[body] = -1;
    return fits;
  }
  void analyse(BlockPattern& matrix) {
    matrix.analyse(m_bodies.size(), m_edges);
    for (Group& g : groups) {
      if (ofTwoBodies(g)) g.between = matrix.between(m_rows[g.first].a, m_rows[g.first].b);
    }
  }
  /// Multiplies row i by `factor`.
  void scale(std::size_t i, double factor) {
    for (double& v : m_rows[i].onA) v *= factor;
    for (double& v : m_rows[i].onB) v *= factor;
  }

  /// Returns (J z)_i.
  double along(std::size_t i, const std::vector<double>& z) const {
    const Row& row = m_rows[i];
    double sum = 0;
    if (row.a >= 0) sum += dot(row.onA, z.data() + static_cast<std::size_t>(row.a) * kSize);
    if (row.b >= 0) sum += dot(row.onB, z.data() + static_cast<std::size_t>(row.b) * kSize);
    return sum;
  }
  /// Adds J_i^T impulse to z.
  void push(std::size_t i, double impulse, std::vector<double>& z) const {
    if (!(impulse != 0)) return;
    const Row& row = m_rows[i];
    for (std::size_t k = 0; k < kSize; ++k) {
      if (row.a >= 0) z[static_cast<std::size_t>(row.a) * kSize + k] += impulse * row.onA[k];
      if (row.b >= 0) z[static_cast<std::size_t>(row.b) * kSize + k] += impulse * row.onB[k];
    }
  }
  /// Multiply-adds of J z over all rows, or of J^T x.
  std::uint64_t multiplyAddsOfProduct() const {
    std::uint64_t bodies = 0;
    for (const Row& row : m_rows) bodies += (row.a >= 0) + (row.b >= 0);
    return bodies * kSize;
  }
  /// Multiply-adds of add() for a group.
  std::uint64_t multiplyAddsOf(const Group& g, bool symmetric) const {
    const Row& row = m_rows[g.first];
    const bool both = row.a >= 0 && row.b >= 0;
    const std::uint64_t squares = both ? (symmetric ? 3 : 4) : 1;
    return g.count * g.count * (both ? 2 : 1) * kSize + g.count * kSize * kSize * squares;
  }

  /// Adds J_g^T s J_g to the matrix; s is symmetric for a Cholesky factor.
  template <class Matrix>
  void add(const Group& g, const Square& s, Matrix& matrix) const {
    const Row* const rows = m_rows.data() + g.first;
    IndexedArray<Place, D> givesA{}, givesB{};
    for (std::size_t i = 0; i < g.count; ++i) {
      for (std::size_t j = 0; j < g.count; ++j) {
        const double k = s[i * D + j];
        if (!(k != 0)) continue;
        for (std::size_t m = 0; m < kSize; ++m) {
          givesA[i][m] += k * rows[j].onA[m], givesB[i][m] += k * rows[j].onB[m];
        }
      }
    }
    if (rows->a >= 0) add(g.count, rows, &Row::onA, givesA, matrix.diagonal(rows->a));
    if (rows->b >= 0) add(g.count, rows, &Row::onB, givesB, matrix.diagonal(rows->b));
    if (rows->a < 0 || rows->b < 0) return;
    const auto& between = g.between;
    if (between.turned) add(g.count, rows, &Row::onB, givesA, matrix.below(between.at));
    if (!between.turned) add(g.count, rows, &Row::onA, givesB, matrix.below(between.at));
    if constexpr (requires { matrix.above(between.at); }) {
      if (between.turned) add(g.count, rows, &Row::onA, givesB, matrix.above(between.at));
      if (!between.turned) add(g.count, rows, &Row::onB, givesA, matrix.above(between.at));
    }
  }

 private:
  using Place = IndexedArray<double, kSize>;
  struct Row {
    int a, b;  // nodes; -1: a body that cannot move
    Place onA, onB;
  };

  int nodeOf(const VelocityInput<D>& in, std::int32_t body) {
    if (body >= in.bodies.size() || !(in.bodies.invMass[body] > 0 || in.bodies.invInertia[body].trace() > 0)) return -1;
    if (m_node[body] < 0) {
      m_node[body] = static_cast<int>(m_bodies.size());
      m_bodies.push_back(body);
      if (m_root.size() < m_bodies.size()) m_root.emplace_back();
      m_root[m_bodies.size() - 1] = rootOfInertia<D>(in.bodies, body, in.model.rotation);
    }
    return m_node[body];
  }
  Place place(const VelocityInput<D>& in, const ProblemRow<D>& r, bool isA) const {
    Place p{};
    const std::int32_t body = isA ? r.a : r.b;
    if (body >= in.bodies.size() || m_node[body] < 0) return p;
    const double sign = isA ? -1 : 1, mass = std::sqrt(double(in.bodies.invMass[body]));
    const auto& arm = isA ? r.armA : r.armB;
    const InertiaRoot<D>& l = m_root[m_node[body]];
    for (int k = 0; k < D; ++k) p[k] = sign * mass * r.d[k];
    for (int k = 0; k < kAngDim<D>; ++k) {
      double sum = 0;
      for (int m = k; m < kAngDim<D>; ++m) sum += l[m * kAngDim<D> + k] * arm[m];
      p[D + k] = sign * sum;
    }
    return p;
  }
  static double dot(const Place& p, const double* z) {
    double sum = 0;
    for (std::size_t k = 0; k < kSize; ++k) sum += p[k] * z[k];
    return sum;
  }
  template <class Block>
  static void add(std::size_t count, const Row* rows, Place Row::*on, const IndexedArray<Place, D>& gives, Block& to) {
    for (std::size_t r = 0; r < count; ++r) {
      for (std::size_t i = 0; i < kSize; ++i) {
        const double left = (rows[r].*on)[i];
        if (!(left != 0)) continue;
        for (std::size_t j = 0; j < kSize; ++j) to[i * kSize + j] += left * gives[r][j];
      }
    }
  }

  std::vector<Row> m_rows;
  std::vector<std::pair<int, int>> m_edges;
  IndexedVector<std::int32_t> m_bodies;  // body of each node
  IndexedVector<int> m_node;             // node of each body
  IndexedVector<InertiaRoot<D>> m_root;
};

}}}  // namespace lpc::LPC_PRECISION::solver
