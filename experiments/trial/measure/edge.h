// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A body has left the scene when it is lower than all that does not fall, by more than its own size, with no joint
/// that could hold it. Without gravity, above a plane and where nothing is fixed at the start, no body leaves.
template <int D>
class Edge {
 public:
  void start(const Simulation<D>& world);
  /// After each step. Empty while all are there; else which body left, and how.
  std::string left(const Simulation<D>& world);

 private:
  void findFloor(const Simulation<D>& world);
  double depth(const Vec<D>& p) const { return double(p.dot(m_down)); }  // m, along gravity

  Vec<D> m_down = Vec<D>::Zero();
  std::vector<Aabb<D>> m_floor;  // boxes of what does not fall
  double m_lowest = 0;           // m, along gravity
  bool m_has = false;
};

}}  // namespace lpc::LPC_PRECISION
