// SPDX-License-Identifier: Zlib
// Sparse matrices of S x S blocks, one node per body. A symmetric matrix is factored as L L^T, one with a symmetric
// pattern as L U. factor() and solve() are linear for a tower. Nodes are eliminated in the order of fewest remaining
// neighbours (minimum degree), which keeps fill-in low. analyse() searches all remaining nodes for each, n^2
// comparisons, and keeps n^2 bits. Every sum has one fixed order, and arrays keep their capacity.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// The blocks of a matrix and the order in which nodes are eliminated.
class BlockPattern {
 public:
  /// Sets the number of nodes and the pairs of nodes that have a block, in any order, repeated or not.
  void analyse(std::size_t nodes, std::span<const std::pair<int, int>> edges) {
    m_nodes = nodes, m_words = (nodes + 63) / 64;
    m_near.assign(nodes * m_words, 0), m_place.assign(nodes, nodes), m_start.assign(1, 0), m_row.clear();
    for (const auto& [a, b] : edges) {
      if (a != b) join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    }
    m_degree.resize(nodes);
    for (std::size_t i = 0; i < nodes; ++i) m_degree[i] = count(i);
    for (std::size_t p = 0; p < nodes; ++p) {
      std::size_t least = nodes;
      for (std::size_t i = 0; i < nodes; ++i) {
        if (m_place[i] == nodes && (least == nodes || m_degree[i] < m_degree[least])) least = i;
      }
      eliminate(least, p);
    }
    // Rows were stored as nodes; they become places in the order of elimination.
    for (std::size_t p = 0; p < nodes; ++p) {
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) m_row[k] = m_place[m_row[k]];
      std::sort(m_row.begin() + static_cast<std::ptrdiff_t>(m_start[p]),
                m_row.begin() + static_cast<std::ptrdiff_t>(m_start[p + 1]));
    }
  }

  struct Between {
    std::size_t at;
    bool turned;  // rows of the block belong to the second node
  };
  Between between(int first, int second) const {
    const std::size_t p = m_place[first], q = m_place[second];
    const auto begin = m_row.begin() + static_cast<std::ptrdiff_t>(m_start[std::min(p, q)]);
    const auto end = m_row.begin() + static_cast<std::ptrdiff_t>(m_start[std::min(p, q) + 1]);
    return {static_cast<std::size_t>(std::lower_bound(begin, end, std::max(p, q)) - m_row.begin()), p < q};
  }

 protected:
  std::size_t m_nodes = 0;
  IndexedVector<std::size_t> m_place;       // place of each node in the order of elimination
  std::vector<std::size_t> m_start, m_row;  // of each column, by place: the places below it that are not zero

 private:
  std::uint64_t* near(std::size_t node) { return m_near.data() + node * m_words; }
  void join(std::size_t a, std::size_t b) {
    near(a)[b / 64] |= std::uint64_t{1} << (b % 64);
    near(b)[a / 64] |= std::uint64_t{1} << (a % 64);
  }
  int count(std::size_t node) {
    int bits = 0;
    for (std::size_t w = 0; w < m_words; ++w) bits += std::popcount(near(node)[w]);
    return bits;
  }

  // Makes the neighbours of a node neighbours of each other.
  void eliminate(std::size_t node, std::size_t place) {
    m_place[node] = place;
    for (std::size_t w = 0; w < m_words; ++w) {
      for (std::uint64_t bits = near(node)[w]; bits != 0; bits &= bits - 1) {
        m_row.push_back(w * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      }
    }
    for (std::size_t k = m_start[place]; k < m_row.size(); ++k) {
      const std::size_t other = m_row[k];
      for (std::size_t w = 0; w < m_words; ++w) near(other)[w] |= near(node)[w];
      near(other)[node / 64] &= ~(std::uint64_t{1} << (node % 64));
      near(other)[other / 64] &= ~(std::uint64_t{1} << (other % 64));
      m_degree[other] = count(other);
    }
    m_start.push_back(m_row.size());
  }

  std::size_t m_words = 0;
  std::vector<std::uint64_t> m_near;  // one bit per pair of nodes
  std::vector<int> m_degree;
};

template <std::size_t S>
class BlockCholesky : public BlockPattern {
 public:
  using Block = std::array<double, S * S>;  // row by row

  std::uint64_t multiplyAdds = 0;  // of the last factorisation, with square roots and divisions

  /// Sets A to a multiple of the identity.
  void set(double diagonal) {
    m_diagonal.resize(m_nodes), m_below.resize(m_row.size());
    for (Block& block : m_below) block.fill(0);
    for (Block& block : m_diagonal) {
      block.fill(0);
      for (std::size_t k = 0; k < S; ++k) block[k * S + k] = diagonal;
    }
  }
  Block& diagonal(int node) { return m_diagonal[m_place[node]]; }
  Block& below(std::size_t at) { return m_below[at]; }
  std::size_t entries() const { return (m_nodes + m_row.size()) * S * S; }
  /// Sum of the squares of all entries of A.
  double squares() const {
    double sum = 0;
    for (const Block& block : m_diagonal) {
      for (const double a : block) sum += a * a;
    }
    for (const Block& block : m_below) {
      for (const double a : block) sum += 2 * a * a;
    }
    return sum;
  }

  void factor() {
    std::uint64_t products = 0;
    for (std::size_t p = 0; p < m_nodes; ++p) {
      Block& d = m_diagonal[p];
      for (std::size_t i = 0; i < S; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
          double sum = d[i * S + j];
          for (std::size_t k = 0; k < j; ++k) sum -= d[i * S + k] * d[j * S + k];
          d[i * S + j] = i == j ? std::sqrt(sum) : sum / d[j * S + j];
        }
      }
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) {
        Block& b = m_below[k];
        for (std::size_t i = 0; i < S; ++i) {
          for (std::size_t j = 0; j < S; ++j) {
            double sum = b[i * S + j];
            for (std::size_t m = 0; m < j; ++m) sum -= b[i * S + m] * d[j * S + m];
            b[i * S + j] = sum / d[j * S + j];
          }
        }
      }
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) {
        subtract(m_below[k], m_below[k], m_diagonal[m_row[k]]);
        products += m_start[p + 1] - k;
        std::size_t to = m_start[m_row[k]];  // its column holds the rows that are needed here, and others between them
        for (std::size_t m = k + 1; m < m_start[p + 1]; ++m) {
          while (m_row[to] < m_row[m]) ++to;
          subtract(m_below[m], m_below[k], m_below[to]);
        }
      }
    }
    multiplyAdds = m_nodes * (S * (S + 1) * (S + 2) / 6) + m_row.size() * (S * S * (S + 1) / 2) + products * S * S * S;
  }
  std::uint64_t multiplyAddsOfSolve() const { return m_nodes * S * (S + 1) + m_row.size() * 2 * S * S; }

  /// Replaces x by A^-1 x; S numbers per node.
  void solve(std::vector<double>& x) {
    m_x.resize(x.size());
    for (std::size_t i = 0; i < m_nodes; ++i) {
      for (std::size_t k = 0; k < S; ++k) m_x[m_place[i] * S + k] = x[i * S + k];
    }
    for (std::size_t p = 0; p < m_nodes; ++p) {
      double* const y = m_x.data() + p * S;
      const Block& d = m_diagonal[p];
      for (std::size_t i = 0; i < S; ++i) {
        for (std::size_t j = 0; j < i; ++j) y[i] -= d[i * S + j] * y[j];
        y[i] /= d[i * S + i];
      }
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) {
        double* const to = m_x.data() + m_row[k] * S;
        for (std::size_t i = 0; i < S; ++i) {
          for (std::size_t j = 0; j < S; ++j) to[i] -= m_below[k][i * S + j] * y[j];
        }
      }
    }
    for (std::size_t p = m_nodes; p-- > 0;) {
      double* const y = m_x.data() + p * S;
      const Block& d = m_diagonal[p];
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) {
        const double* const from = m_x.data() + m_row[k] * S;
        for (std::size_t i = 0; i < S; ++i) {
          for (std::size_t j = 0; j < S; ++j) y[j] -= m_below[k][i * S + j] * from[i];
        }
      }
      for (std::size_t i = S; i-- > 0;) {
        for (std::size_t j = i + 1; j < S; ++j) y[i] -= d[j * S + i] * y[j];
        y[i] /= d[i * S + i];
      }
    }
    for (std::size_t i = 0; i < m_nodes; ++i) {
      for (std::size_t k = 0; k < S; ++k) x[i * S + k] = m_x[m_place[i] * S + k];
    }
  }

 private:
  static void subtract(const Block& a, const Block& b, Block& from) {
    for (std::size_t i = 0; i < S; ++i) {
      for (std::size_t j = 0; j < S; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < S; ++k) sum += a[i * S + k] * b[j * S + k];
        from[i * S + j] -= sum;
      }
    }
  }

  std::vector<Block> m_diagonal, m_below;  // of the factor, once it is made
  std::vector<double> m_x;
};

/// Rows are exchanged only within the diagonal blocks: check the residual to see whether that was enough.
template <std::size_t S>
class BlockLu : public BlockPattern {
 public:
  using Block = std::array<double, S * S>;

  std::uint64_t multiplyAdds = 0;  // of the last factorisation

  /// Sets A to a multiple of the identity.
  void set(double diagonal) {
    m_diagonal.resize(m_nodes), m_below.resize(m_row.size()), m_above.resize(m_row.size());
    for (Block& block : m_below) block.fill(0);
    for (Block& block : m_above) block.fill(0);
    for (Block& block : m_diagonal) {
      block.fill(0);
      for (std::size_t k = 0; k < S; ++k) block[k * S + k] = diagonal;
    }
  }
  Block& diagonal(int node) { return m_diagonal[m_place[node]]; }
  /// Block with the rows of the node that is eliminated later.
  Block& below(std::size_t at) { return m_below[at]; }
  /// Block with the columns of the node that is eliminated later.
  Block& above(std::size_t at) { return m_above[at]; }

  /// Returns false if A is singular.
  bool factor() {
    std::uint64_t products = 0;
    for (std::size_t p = 0; p < m_nodes; ++p) {
      if (!invert(m_diagonal[p])) return false;
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) m_below[k] = product(m_below[k], m_diagonal[p]);
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) {
        const std::size_t row = m_row[k];
        subtract(m_below[k], m_above[k], m_diagonal[row]);
        std::size_t to = m_start[row];
        for (std::size_t m = k + 1; m < m_start[p + 1]; ++m) {
          while (m_row[to] < m_row[m]) ++to;
          subtract(m_below[m], m_above[k], m_below[to]);
          subtract(m_below[k], m_above[m], m_above[to]);
        }
        products += 2 * (m_start[p + 1] - k);  // including the one into m_below[k]
      }
    }
    multiplyAdds = (m_nodes + products) * S * S * S;
    return true;
  }
  std::uint64_t multiplyAddsOfSolve() const { return (m_nodes + 2 * m_row.size()) * S * S; }

  /// Replaces x by A^-1 x; S numbers per node.
  void solve(std::vector<double>& x) {
    m_x.resize(x.size());
    for (std::size_t i = 0; i < m_nodes; ++i) {
      for (std::size_t k = 0; k < S; ++k) m_x[m_place[i] * S + k] = x[i * S + k];
    }
    for (std::size_t p = 0; p < m_nodes; ++p) {
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) take(m_below[k], p, m_row[k]);
    }
    for (std::size_t p = m_nodes; p-- > 0;) {
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) take(m_above[k], m_row[k], p);
      std::array<double, S> y{};
      for (std::size_t i = 0; i < S; ++i) {
        for (std::size_t j = 0; j < S; ++j) y[i] += m_diagonal[p][i * S + j] * m_x[p * S + j];
      }
      std::copy(y.begin(), y.end(), m_x.begin() + static_cast<std::ptrdiff_t>(p * S));
    }
    for (std::size_t i = 0; i < m_nodes; ++i) {
      for (std::size_t k = 0; k < S; ++k) x[i * S + k] = m_x[m_place[i] * S + k];
    }
  }

 private:
  static Block product(const Block& a, const Block& b) {
    Block out{};
    for (std::size_t i = 0; i < S; ++i) {
      for (std::size_t k = 0; k < S; ++k) {
        for (std::size_t j = 0; j < S; ++j) out[i * S + j] += a[i * S + k] * b[k * S + j];
      }
    }
    return out;
  }
  static void subtract(const Block& a, const Block& b, Block& from) {
    for (std::size_t i = 0; i < S; ++i) {
      for (std::size_t k = 0; k < S; ++k) {
        for (std::size_t j = 0; j < S; ++j) from[i * S + j] -= a[i * S + k] * b[k * S + j];
      }
    }
  }
  void take(const Block& a, std::size_t from, std::size_t to) {
    for (std::size_t i = 0; i < S; ++i) {
      for (std::size_t j = 0; j < S; ++j) m_x[to * S + i] -= a[i * S + j] * m_x[from * S + j];
    }
  }
  /// Gauss-Jordan elimination; the largest entry of each column is the pivot.
  static bool invert(Block& a) {
    std::array<std::size_t, S> from{};
    for (std::size_t j = 0; j < S; ++j) {
      std::size_t best = j;
      for (std::size_t i = j + 1; i < S; ++i) {
        if (std::abs(a[i * S + j]) > std::abs(a[best * S + j])) best = i;
      }
      from[j] = best;
      if (!(std::abs(a[best * S + j]) > 0)) return false;
      for (std::size_t k = 0; k < S && best != j; ++k) std::swap(a[j * S + k], a[best * S + k]);
      const double inverse = 1 / a[j * S + j];
      a[j * S + j] = 1;
      for (std::size_t k = 0; k < S; ++k) a[j * S + k] *= inverse;
      for (std::size_t i = 0; i < S; ++i) {
        if (i == j) continue;
        const double share = a[i * S + j];
        a[i * S + j] = 0;
        for (std::size_t k = 0; k < S; ++k) a[i * S + k] -= share * a[j * S + k];
      }
    }
    for (std::size_t j = S; j-- > 0;) {
      for (std::size_t i = 0; i < S && from[j] != j; ++i) std::swap(a[i * S + j], a[i * S + from[j]]);
    }
    return true;
  }

  std::vector<Block> m_diagonal, m_below, m_above;  // inverses, L and U, once the factor is made
  std::vector<double> m_x;
};

}}}  // namespace lpc::LPC_PRECISION::solver
