// SPDX-License-Identifier: Zlib
// The cache of a pair's direction search: the best direction, and the corners of both shapes in the last simplex. A
// pair that has hardly moved has the same nearest feature, or the same simplex around the origin, so that one support
// point proves it, or none is needed.
#pragma once

#include <bit>
#include <cstring>
#include <vector>

#include "algorithms/pair_query/gjk/gjk_simplex3.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Numbers of corners: of a hull its vertices, of a box and a segment the bits of their signs. A curved core has none,
/// and of a hull with too many vertices the others are not remembered.
inline constexpr std::uint16_t kNoCorner = 0xffff;

struct CornerPair {
  std::uint16_t a = kNoCorner, b = kNoCorner;
  bool operator==(const CornerPair&) const = default;
};

/// Number of corners of this core that have numbers.
template <int D>
int cornerCount(const ShapeView<D>& shape) {
  switch (shape.core()) {
    case CoreClass::point:
      return 1;
    case CoreClass::segment:
      return 2;
    case CoreClass::box:
      return 1 << D;
    case CoreClass::hull:
      return static_cast<int>(std::min<std::size_t>(shape.hull->vertices.size(), kNoCorner));
    case CoreClass::curved:
    case CoreClass::plane:
      break;
  }
  return 0;
}

/// Precondition: number < cornerCount(shape).
template <int D>
Vec<D> cornerOf(const ShapeView<D>& shape, int number) {
  if (shape.core() == CoreClass::hull) return shape.hull->vertices[number];
  Vec<D> v;
  for (int k = 0; k < D; ++k) v[k] = (number >> k) & 1 ? shape.half[k] : -shape.half[k];
  return v;
}

/// The support point with the number of its corner, or kNoCorner.
template <int D>
Vec<D> supportCorner(const ShapeView<D>& shape, const Vec<D>& d, std::uint16_t& number, int* climb) {
  int corner = -1;
  const Vec<D> p = farthest(shape, d, &corner, climb);
  if (shape.core() != CoreClass::hull) {
    corner = 0;
    for (int k = 0; k < D; ++k) corner |= p[k] > 0 ? 1 << k : 0;
  }
  number = corner < cornerCount(shape) ? static_cast<std::uint16_t>(corner) : kNoCorner;
  return p;
}

template <int D>
class GjkCache {
 public:
  /// Reads the cache. Ignores bytes that cannot belong to this pair.
  void recall(const CorePair<D>& pair, const PairMemory* memory) {
    m_seen.clear();
    m_direction.setZero(), m_simplex.count = 0;
    m_kept = memory != nullptr;
    if (!memory) return;
    const auto stored = std::bit_cast<Stored>(memory->bytes);
    Vec<D> n;
    for (int k = 0; k < D; ++k) n[k] = stored.direction[k];
    if (n.allFinite()) m_direction = n;
    if (stored.count > D + 1) return;
    for (std::size_t i = 0; i < stored.count; ++i) {
      const CornerPair c = stored.corners[i];
      const bool known = c.a < cornerCount(pair.a) && c.b < cornerCount(pair.b);
      if (!known || std::count(stored.corners.begin(), stored.corners.begin() + stored.count, c) != 1) {
        m_simplex.count = 0;
        return;
      }
      m_simplex.push(difference(pair, cornerOf(pair.a, c.a), cornerOf(pair.b, c.b)));
      if (pair.climb) *pair.climb = {c.a, c.b};
      m_seen.push_back({m_simplex[m_simplex.count - 1], c});
    }
  }

  /// Of any length; zero: none.
  const Vec<D>& direction() const { return m_direction; }
  /// The present positions of the corners of the last simplex; empty: none.
  const Simplex<D>& simplex() const { return m_simplex; }

  /// CorePair::support; records the corners if there is a cache.
  Vec<D> support(const CorePair<D>& pair, const Vec<D>& n) {
    if (!m_kept) return pair.support(n);
    CornerPair c;
    if constexpr (D == 3) {
      if (pair.hulls) {
        const HullSupport w = pair.hulls->support(pair.p, pair.r, n);
        if (w.a < kNoCorner) c.a = static_cast<std::uint16_t>(w.a);
        if (w.b < kNoCorner) c.b = static_cast<std::uint16_t>(w.b);
        m_seen.push_back({w.point, c});
        return w.point;
      }
    }
    const Vec<D> a = supportCorner(pair.a, n, c.a, pair.climbOnA());
    const Vec<D> b = supportCorner(pair.b, Vec<D>(-(pair.r.transpose() * n)), c.b, pair.climbOnB());
    m_seen.push_back({difference(pair, a, b), c});
    return m_seen.back().point;
  }

  /// `last` consists of results of `support` and of the remembered simplex.
  void remember(const Vec<D>& n, const Simplex<D>& last, PairMemory& memory) const {
    Stored stored;
    const Vec<D>& best = n.isZero(0) ? m_direction : n;  // no direction was tried if the origin was inside at once
    for (int k = 0; k < D; ++k) stored.direction[k] = static_cast<float>(best[k]);
    for (int i = 0; i < last.count; ++i) {
      const auto of = std::find_if(m_seen.begin(), m_seen.end(), [&](const Seen& s) { return s.point == last[i]; });
      if (of == m_seen.end() || of->corners.a == kNoCorner || of->corners.b == kNoCorner) {
        stored.count = 0;
        break;
      }
      stored.corners[stored.count++] = of->corners;
    }
    memory.bytes = std::bit_cast<decltype(memory.bytes)>(stored);
  }

 private:
  struct Stored {
    IndexedArray<float, 3> direction{};
    std::array<CornerPair, 4> corners{};
    std::uint32_t count = 0;
  };
  struct Seen {
    Vec<D> point;
    CornerPair corners;
  };
  static Vec<D> difference(const CorePair<D>& pair, const Vec<D>& a, const Vec<D>& b) {
    return (pair.p + pair.r * b) - a;
  }

  bool m_kept = false;
  Vec<D> m_direction = Vec<D>::Zero();
  Simplex<D> m_simplex;
  std::vector<Seen> m_seen;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
