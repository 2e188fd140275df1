// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/edge.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
void Edge<D>::start(const Simulation<D>& world) {
  const Vec<D> gravity = world.settings().gravity;
  if (gravity.norm() == 0) return;
  m_down = gravity / gravity.norm();
  findFloor(world);
}

template <int D>
void Edge<D>::findFloor(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  m_has = false, m_floor.clear(), m_lowest = -std::numeric_limits<double>::infinity();
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0 || b.type[static_cast<std::size_t>(s.body)] == BodyType::dynamic) continue;
    m_has = true;
    if (s.shape.isPlane()) {
      m_lowest = std::numeric_limits<double>::infinity();
      return;
    }
    m_floor.push_back(boundingBox(s.shape, b.pose[static_cast<std::size_t>(s.body)] * s.X_CS));
    const Aabb<D>& box = m_floor.back();
    m_lowest = std::max(m_lowest, depth(box.center()) + 0.5 * double((box.hi - box.lo).dot(m_down.cwiseAbs())));
  }
}

template <int D>
std::string Edge<D>::left(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  if (!m_has) return "";
  const auto below = [&](std::size_t i) {
    return b.used[i] && b.type[i] == BodyType::dynamic && depth(b.pose[i].p) > m_lowest;
  };
  const auto any = [&] {
    for (std::size_t i = 0; i < b.pose.size(); ++i) {
      if (below(i)) return true;
    }
    return false;
  };
  if (!any()) return "";
  findFloor(world);  // it may have moved or been removed
  if (!m_has) return "";
  std::vector<std::uint8_t> holds(b.pose.size());
  for (const JointRecord<D>& j : world.joints()) {
    for (const std::int32_t body : {j.bodyA, j.bodyB}) {
      if (j.active() && body >= 0) holds[static_cast<std::size_t>(body)] = 1;
    }
  }
  std::vector<double> size(b.pose.size());
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0 || s.shape.isPlane()) continue;
    const Aabb<D> box = boundingBox(s.shape, s.X_CS);
    double& own = size[static_cast<std::size_t>(s.body)];
    own = std::max(own, double((box.hi - box.lo).norm()));
  }
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (!below(i) || holds[i] || !(depth(b.pose[i].p) > m_lowest + size[i])) continue;
    int along = 0;
    m_down.cwiseAbs().maxCoeff(&along);
    const bool over = std::none_of(m_floor.begin(), m_floor.end(), [&](const Aabb<D>& box) {
      for (int d = 0; d < D; ++d) {
        if (d != along && (b.pose[i].p[d] < box.lo[d] || b.pose[i].p[d] > box.hi[d])) return false;
      }
      return true;
    });
    char why[160];
    std::snprintf(why, sizeof why, "body %zu is below all that does not fall, %s, at x = %.4g m, at %.4g m/s", i,
                  over ? "over an edge" : "through it", double(b.pose[i].p[0]), double(b.motion[i].v.norm()));
    return why;
  }
  return "";
}

template class Edge<2>;
template class Edge<3>;

}}  // namespace lpc::LPC_PRECISION
