// SPDX-License-Identifier: Zlib
// The support vertex of a hull, and the support point of the difference of two hulls, for searches with dozens of
// supports. Several vertices are tested at a time by the instruction set of the machine, with the same answer on all of
// them.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// From this number on, several at a time are faster than one by one, and there is always work for two times eight
/// lanes.
inline constexpr std::size_t kManyVertices = 16;

/// Three products added in the order in which Vec::dot adds them, in either precision.
inline Real summed(Real x, Real y, Real z) { return sizeof(Real) == 8 ? (x + y) + z : x + (y + z); }

/// Index of the support vertex along d, of several the first, as in coreSupport. Precondition: at least kManyVertices,
/// and d is finite.
std::size_t farthestVertex(const std::vector<Vec<3>>& vertices, const Vec<3>& d);

/// Appends, in order, the vertices within `band` of the support vertex along d.
void verticesWithin(const std::vector<Vec<3>>& vertices, const Vec<3>& d, Real band, std::vector<Vec<3>>& out);

/// The support point of M = { b - a } of two hulls along n, and its vertices.
struct HullSupport {
  Vec<3> point;
  std::size_t a, b;
};

/// Two hulls for repeated support queries, in one piece: passing vectors from function to function took longer than
/// testing eight vertices. From the second query on, coordinates lie in separate rows, which halves the cost per
/// vertex; making them costs as much as one query.
class HullPair {
 public:
  void begin(const std::vector<Vec<3>>& a, const std::vector<Vec<3>>& b) {
    m_asked = 0;
    m_a.begin(a), m_b.begin(b);
  }
  /// In A's frame, with B placed by p and r: the same bits as (p + r * support of B along -(r^T n)) - support of A
  /// along n, for hulls of any size.
  HullSupport support(const Vec<3>& p, const Mat<3>& r, const Vec<3>& n);

  struct Hull {
    const Real* vertices = nullptr;
    std::size_t count = 0, room = 0;  // vertices, and numbers in a row
    std::vector<Real> rows;           // all x, all y, all z; padded with the first vertex

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
