// SPDX-License-Identifier: Zlib
// The farthest vertex of a hull, and of two hulls the point of their difference, for searches that ask for dozens of
// them: several at a time by the instruction set that the machine has, with the same answer on all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// From here on several at a time are faster than one by one, and there is always work for two times eight lanes.
inline constexpr std::size_t kManyVertices = 16;

/// Three products added in the order in which Vec::dot adds them, in either precision.
inline Real summed(Real x, Real y, Real z) { return sizeof(Real) == 8 ? (x + y) + z : x + (y + z); }

/// Index of the vertex that lies farthest along d, of several the first, as coreSupport finds it. There are
/// kManyVertices or more, and d is finite.
std::size_t farthestVertex(const std::vector<Vec<3>>& vertices, const Vec<3>& d);

/// Appends, in their order, the vertices that lie no farther than `band` behind the farthest along d.
void verticesWithin(const std::vector<Vec<3>>& vertices, const Vec<3>& d, Real band, std::vector<Vec<3>>& out);

/// Where two hulls' difference M = { b - a } lies least far along n, and the vertices that are there.
struct HullSupport {
  Vec<3> point;
  std::size_t a, b;
};

/// Two hulls as a search asks for their supports again and again, in one piece: what is handed over from function to
/// function as vectors took longer than to look at eight vertices. From the second time on coordinates lie in rows of
/// their own, which halves the look at a vertex and costs as much as one look.
class HullPair {
 public:
  void begin(const std::vector<Vec<3>>& a, const std::vector<Vec<3>>& b) {
    m_asked = 0;
    m_a.begin(a), m_b.begin(b);
  }
  /// In A's frame, of B placed by p and r: the very numbers of (p + r * farthest of B along -(r^T n)) - farthest of A
  /// along n, of hulls of any size.
  HullSupport support(const Vec<3>& p, const Mat<3>& r, const Vec<3>& n);

  struct Hull {
    const Real* vertices = nullptr;
    std::size_t count = 0, room = 0;  // vertices, and numbers in a row
    std::vector<Real> rows;           // all x, all y, all z; more of the first vertex fill them up

    void begin(const std::vector<Vec<3>>& given) {
      vertices = given.data()->data(), count = given.size();
      room = (count + kManyVertices - 1) / kManyVertices * kManyVertices;
      if (rows.size() < 3 * room) rows.resize(3 * room);
    }
  };

 private:
  Hull m_a, m_b;
  int m_asked = 0;
};
static_assert(sizeof(Vec<3>) == 3 * sizeof(Real), "vertices are triples of numbers, one after the other");

}}}  // namespace lpc::LPC_PRECISION::pair_query
