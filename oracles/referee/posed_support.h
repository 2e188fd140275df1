// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/shape/curved_core.h"
#include "oracles/referee/posed_core.h"
#include "oracles/referee/proof.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A bounded core in the world by its support function, with error bounds. The pose is applied as its numbers are, so a
/// rotation that is exact only within rounding deforms a curved core as it does a list of vertices.
template <int D>
class PosedSupport {
 public:
  struct Farthest {
    Point<Bounded, D> point;  // of the core
    Bounded value;            // the support value: the largest p . d
  };

  PosedSupport(const ShapeView<D>& shape, const Pose<D>& X_WS) : m_curved(shape.curved) {
    if (m_curved) {
      m_rotation = rotationOf<Bounded>(X_WS.q);
      m_reach = static_cast<Real80>(shape.half.norm());
      for (std::size_t k = 0; k < D; ++k) m_position[k] = Bounded(static_cast<double>(X_WS.p[static_cast<int>(k)]));
      return;
    }
    std::vector<Vec<D>> core;
    coreVertices(shape, core);
    poseVertices<Bounded, D>(core, X_WS, m_vertices);
  }

  Farthest farthest(const Point<Real80, D>& d) const { return m_curved ? onCurved(d) : onVertices(d); }

 private:
  Farthest onVertices(const Point<Real80, D>& d) const {
    const Point<Bounded, D> along = exactly<D>(d);
    Farthest best{m_vertices[0], boundedDot(m_vertices[0], along)};
    for (std::size_t i = 1; i < m_vertices.size(); ++i) {
      const Bounded x = boundedDot(m_vertices[i], along);
      if (x.v > best.value.v) best.point = m_vertices[i];
      best.value = -lesser(-best.value, -x);
    }
    return best;
  }

  Farthest onCurved(const Point<Real80, D>& d) const {
    constexpr Real80 kWithin = 8 * Bounded::kUlp;  // promised by CurvedCore::support, relative to its reach
    Point<Bounded, D> local;
    Point<Real80, D> values;
    Real80 lean = 0;
    for (std::size_t k = 0; k < D; ++k) {
      local[k] = Bounded{};
      for (std::size_t j = 0; j < D; ++j) local[k] = local[k] + m_rotation[j][k] * exactly<D>(d)[j];
      values[k] = local[k].v, lean += local[k].e;
    }
    const Point<Real80, D> q = m_curved->support(values);
    Farthest best;
    Real80 length = 0;
    for (std::size_t k = 0; k < D; ++k) {
      Bounded sum = m_position[k];
      for (std::size_t j = 0; j < D; ++j) sum = sum + m_rotation[k][j] * Bounded::make(q[j], kWithin * m_reach);
      best.point[k] = sum, length += std::abs(d[k]);
    }
    const Bounded along = boundedDot(best.point, exactly<D>(d));
    best.value = Bounded::make(along.v, along.e + m_reach * (lean + kWithin * length));
    return best;
  }

  const CurvedCore<D>* m_curved;
  std::vector<Point<Bounded, D>> m_vertices;
  std::array<Point<Bounded, D>, static_cast<std::size_t>(D)> m_rotation;
  Point<Bounded, D> m_position;
  Real80 m_reach = 0;
};

/// L(d) = min over M of m . d / |d|, with M = B - A: a lower bound of the signed distance of the cores for every d.
template <int D>
Bounded separationOfCores(const PosedSupport<D>& a, const PosedSupport<D>& b, const Point<Real80, D>& d) {
  const Point<Bounded, D> along = exactly<D>(d);
  return -(a.farthest(d).value + b.farthest(negative(d)).value) / sqrt(boundedDot(along, along));
}

}}  // namespace lpc::LPC_PRECISION
