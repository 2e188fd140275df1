// SPDX-License-Identifier: Zlib
// A = L L^T of a sparse symmetric matrix of S x S blocks, one node per body: factor() and solve() are linear in a tower.
// Nodes are eliminated in the order of the fewest neighbours left, so that neighbours become neighbours of each other as
// seldom as they can; analyse() looks for each among all that are left, n^2 comparisons, and keeps n^2 bits. Every sum
// has one order, and arrays keep their capacity.
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

namespace lpc::inline LPC_PRECISION::solver {

template <std::size_t S>
class BlockCholesky {
 public:
  using Block = std::array<double, S * S>;  // row by row

  std::uint64_t products = 0;  // of blocks, in the last factorisation

  /// Nodes and which of them have a block between them, in any order and more than once.
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
    // Rows were written as nodes, and are wanted as places.
    for (std::size_t p = 0; p < nodes; ++p) {
      for (std::size_t k = m_start[p]; k < m_start[p + 1]; ++k) m_row[k] = m_place[m_row[k]];
      std::sort(m_row.begin() + static_cast<std::ptrdiff_t>(m_start[p]),
                m_row.begin() + static_cast<std::ptrdiff_t>(m_start[p + 1]));
    }
    m_diagonal.resize(nodes), m_below.resize(m_row.size());
  }

  /// A becomes 1.
  void setIdentity() {
    for (Block& block : m_below) block.fill(0);
    for (Block& block : m_diagonal) {
      block.fill(0);
      for (std::size_t k = 0; k < S; ++k) block[k * S + k] = 1;
    }
  }
  Block& diagonal(int node) { return m_diagonal[m_place[static_cast<std::size_t>(node)]]; }
  struct Between {
    std::size_t at;
    bool turned;  // rows of the block are of the second node
  };
  Between between(int first, int second) const {
    const std::size_t p = m_place[static_cast<std::size_t>(first)], q = m_place[static_cast<std::size_t>(second)];
    const auto begin = m_row.begin() + static_cast<std::ptrdiff_t>(m_start[std::min(p, q)]);
    const auto end = m_row.begin() + static_cast<std::ptrdiff_t>(m_start[std::min(p, q) + 1]);
    return {static_cast<std::size_t>(std::lower_bound(begin, end, std::max(p, q)) - m_row.begin()), p < q};
  }
  Block& below(std::size_t at) { return m_below[at]; }

  void factor() {
    products = 0;
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
        std::size_t to = m_start[m_row[k]];  // its column has the rows that come here, and others between them
        for (std::size_t m = k + 1; m < m_start[p + 1]; ++m) {
          while (m_row[to] < m_row[m]) ++to;
          subtract(m_below[m], m_below[k], m_below[to]);
        }
      }
    }
  }

  /// x becomes A^-1 x; S numbers per node.
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

  // Its neighbours become neighbours of each other.
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

  void subtract(const Block& a, const Block& b, Block& from) {
    ++products;
    for (std::size_t i = 0; i < S; ++i) {
      for (std::size_t j = 0; j < S; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < S; ++k) sum += a[i * S + k] * b[j * S + k];
        from[i * S + j] -= sum;
      }
    }
  }

  std::size_t m_nodes = 0, m_words = 0;
  std::vector<std::uint64_t> m_near;  // a bit per pair of nodes
  std::vector<int> m_degree;
  std::vector<std::size_t> m_place;         // of a node in the order of elimination
  std::vector<std::size_t> m_start, m_row;  // of each column, by place: places below that are not zero
  std::vector<Block> m_diagonal, m_below;   // of the factor, when it is made
  std::vector<double> m_x;
};

}  // namespace lpc::inline LPC_PRECISION::solver
