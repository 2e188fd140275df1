// SPDX-License-Identifier: Zlib
// The complementarity problem of an island with friction pyramids, solved by active sets: the linear system of the rows
// that press, stick and slide, and the rows that must change their state.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "algorithms/solver/island/island.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
struct PyramidLcp {
  static constexpr int kMostTrials = 10;      // of active sets; either a guess is good, or sets repeat
  static constexpr double kTolerance = 1e-9;  // of the largest free velocity or previous impulse
  static constexpr int kSolves = 4;           // with one factorisation
  static constexpr double kBetter = 0.5;      // of the previous residual; less gain is rounding
  static constexpr double kLeft = 1e-3,
                          kWrong = 1e4;  // of the tolerance: where solves end, and where there is no answer
  enum class Part : std::uint8_t { none, inside, low, high, stick, corner, edge };
  struct State {
    Part part = Part::none;
    int which = 0;  // corner, or the edge after it
    bool operator==(const State&) const = default;
  };
  /// Impulse per unknown, and the velocity that it must make zero: D rows from `first`.
  struct Unknown {
    std::size_t first;
    IndexedArray<double, D> impulse{}, velocity{};
    std::size_t rows = 1;
  };
  using Tangent = IndexedArray<double, D - 1>;

  const ProblemRow<D>& row(std::size_t i) const { return m_island.row(i); }
  double* w(std::size_t i) { return m_island.w.data() + i * m_island.size(); }
  int facets() const { return D == 2 ? 2 : m_facets; }
  // Corner j of contact i is at angle 2 pi j / k from the sliding direction.
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
    const auto& turn = m_corner[(half + 2 * facets()) % (2 * facets())];
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
  /// Returns which of the directions half, half + 2, ... lies most along t.
  int best(std::size_t i, int half, const double* t, double sign) const {
    int found = half;
    for (int h = half; h < 2 * facets(); h += 2) {
      if (sign * dot(toward(i, h), t) > sign * dot(toward(i, found), t)) found = h;
    }
    return found;
  }
  // Takes the initial states from the last impulses.
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
  bool activeSets() {
    for (int trial = 0; trial < kMostTrials; ++trial) {
      if (!solveActive()) return false;
      m_island.velocities(m_velocity);
      if (!revise()) return true;
      m_factored = false;
    }
    return false;
  }
  bool solveActive() {
    for (std::size_t i = 0; i < m_island.size(); ++i) {
      const Part part = m_state[i].part;
      m_island.x[i] = 0;
      if (part == Part::low) m_island.x[i] = row(i).lo / m_island.root[i];
      if (part == Part::high) m_island.x[i] = row(i).hi / m_island.root[i];
    }
    return factored() && settle(m_island.u, m_island.x);
  }
  bool factored() {
    if (m_factored) return true;
    const std::size_t n = m_island.size();
    m_unknowns.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const ProblemRow<D>& r = row(i);
      const State& state = m_state[i];
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
    return factor();
  }
  // Moves the unknowns x to where their velocities, from + W x, are zero. A solve over the bodies leaves a residual of
  // rounding over cfm, which is solved for again. Returns false if too much remains.
  bool settle(const std::vector<double>& from, std::vector<double>& x) {
    double before = std::numeric_limits<double>::infinity();
    for (int solve = 0;; ++solve) {
      m_island.multiply(x, m_product);
      m_right.resize(m_unknowns.size());
      double left = 0;
      for (std::size_t p = 0; p < m_unknowns.size(); ++p) {
        const Unknown& a = m_unknowns[p];
        m_right[p] = 0;
        for (std::size_t k = 0; k < a.rows; ++k) {
          m_right[p] -= a.velocity[k] * (from[a.first + k] + m_product[a.first + k]);
        }
        left = worse(left, std::abs(m_right[p]));
      }
      if (solve > 0 && (left <= kLeft * m_tolerance || !(left < kBetter * before) || solve > kSolves)) {
        return left <= kWrong * m_tolerance;
      }
      before = solve > 0 ? left : before;
      answer(x);
    }
  }
  void soften(double cfm) {
    for (std::size_t i = 0; i < m_island.size(); ++i) {
      m_island.soft[i] += cfm - m_cfm;
      if (m_island.dense) w(i)[i] += cfm - m_cfm;
    }
    m_cfm = cfm, m_factored = false;
  }
  // Adds the solution for m_right to x.
  void answer(std::vector<double>& x) {
    if (m_island.dense) {
      m_general.solve(m_right.data());
      m_island.multiplyAdds += m_general.multiplyAddsOfSolve();
    } else {
      m_z.assign(m_island.bodies.bodies() * BodyRows<D>::kSize, 0);
      for (std::size_t p = 0; p < m_unknowns.size(); ++p) {
        const Unknown& a = m_unknowns[p];
        m_right[p] /= m_island.soft[a.first];
        for (std::size_t k = 0; k < a.rows; ++k) m_island.bodies.push(a.first + k, a.impulse[k] * m_right[p], m_z);
      }
      m_bodies.solve(m_z);
      for (std::size_t p = 0; p < m_unknowns.size(); ++p) {
        const Unknown& a = m_unknowns[p];
        double sum = 0;
        for (std::size_t k = 0; k < a.rows; ++k) {
          if (a.velocity[k] != 0) sum += a.velocity[k] * m_island.bodies.along(a.first + k, m_z);
        }
        m_right[p] -= sum / m_island.soft[a.first];
      }
      m_island.multiplyAdds += m_bodies.multiplyAddsOfSolve() + 2 * m_island.bodies.multiplyAddsOfProduct();
    }
    for (std::size_t p = 0; p < m_unknowns.size(); ++p) {
      const Unknown& a = m_unknowns[p];
      for (std::size_t k = 0; k < a.rows; ++k) x[a.first + k] += m_right[p] * a.impulse[k];
    }
    m_island.multiplyAdds += 4 * m_unknowns.size();
  }
  // 1 + H^T G / soft over the bodies: G the velocities that unknowns make zero, H their impulses.
  bool factorBodies() {
    m_bodies.set(1);
    std::size_t p = 0;
    for (const auto& g : m_island.bodies.groups) {
      typename BodyRows<D>::Square s{};
      const std::size_t begin = p;
      for (; p < m_unknowns.size() && m_unknowns[p].first < g.first + g.count; ++p) {
        const Unknown& a = m_unknowns[p];
        const std::size_t at = a.first - g.first;
        for (std::size_t i = 0; i < a.rows; ++i) {
          for (std::size_t k = 0; k < a.rows; ++k) {
            s[(at + i) * D + at + k] += a.impulse[i] * a.velocity[k] / m_island.soft[a.first];
          }
        }
      }
      if (p == begin) continue;
      m_island.bodies.add(g, s, m_bodies);
      m_island.multiplyAdds += m_island.bodies.multiplyAddsOf(g, false);
    }
    const bool done = m_bodies.factor();
    m_island.multiplyAdds += m_bodies.multiplyAdds;
    return m_factored = done;
  }
  bool factor() {
    if (!m_island.dense) return factorBodies();
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
    m_factored = m_general.factor(count, m_matrix);
    m_island.multiplyAdds += count * count + m_general.multiplyAdds;
    return m_factored;
  }
  /// Velocity of row i per unit of an unknown or column.
  template <class Direction>
  double effect(std::size_t i, const Direction& part) {
    double sum = 0;
    for (std::size_t k = 0; k < part.rows; ++k) sum += w(i)[part.first + k] * part.impulse[k];
    return sum;
  }
  Unknown& add(std::size_t first, std::size_t rows) {
    m_unknowns.push_back({first, {}, {}, rows});
    return m_unknowns.back();
  }
  // Changes the state of each row that violates its law. Returns whether there was one.
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

  Island<D> m_island;
  GeneralFactor m_general;
  BlockLu<BodyRows<D>::kSize> m_bodies;
  int m_facets = 8;                      // of the pyramid in 3D
  double m_cfm = 0;                      // in use
  double m_tolerance = 0, m_middle = 0;  // scaled velocity; distance of an edge from the axis
  bool m_factored = false;               // whether the factor belongs to m_state
  std::vector<double> m_velocity, m_product, m_z, m_matrix, m_right;
  std::vector<Tangent> m_along;                     // by row, of normals
  IndexedVector<IndexedArray<double, 2>> m_corner;  // cosine and sine of half steps
  std::vector<State> m_state;
  std::vector<Unknown> m_unknowns;
};

}}}  // namespace lpc::LPC_PRECISION::solver
