// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A body has left the scene when it is lower than every body that cannot fall, by more than its own size, and no joint
/// could hold it. No body leaves without gravity, above a plane, or if there is no fixed body at the start.
template <int D>
class Edge {
 public:
  void start(const Simulation<D>& world);
  /// Call after each step. Empty while all bodies are inside; else which body left, and how.
  std::string left(const Simulation<D>& world);

 private:
  void findFloor(const Simulation<D>& world);
  double depth(const Vec<D>& p) const { return double(p.dot(m_down)); }  // m, along gravity

  Vec<D> m_down = Vec<D>::Zero();
  std::vector<Aabb<D>> m_floor;  // boxes of bodies that cannot fall
  double m_lowest = 0;           // m, along gravity
  bool m_has = false;
};

}}  // namespace lpc::LPC_PRECISION
