// SPDX-License-Identifier: Zlib
// Questions about exact shapes at present poses.
#include <algorithm>

#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {

// The bodies, each once, of those proxies of whose shape a convex part holds; `holds` is asked with it and its pose.
template <int D>
template <class Holds>
std::vector<Handle> World<D>::bodiesOf(std::vector<ProxyId>& found, const Holds& holds) const {
  std::sort(found.begin(), found.end());
  std::vector<Handle> out;
  for (ProxyId id : found) {
    const ShapeRecord<D>& s = m_shapes[static_cast<std::size_t>(id)];
    const Pose<D> X_WS = m_bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    bool held = false;
    forParts(s.shape, X_WS, [&](const auto& part, const Pose<D>& X_WP) { held = held || holds(part, X_WP); });
    const Handle h = handle(s.body);
    if (held && std::find(out.begin(), out.end(), h) == out.end()) out.push_back(h);
  }
  return out;
}

template <int D>
std::vector<Handle> World<D>::at(const Vec<D>& point) const {
  sync();
  std::vector<ProxyId> found;
  m_boxes.at(point, found);
  return bodiesOf(found, [&](const auto& shape, const Pose<D>& X_WS) { return containsPoint(shape, X_WS, point); });
}

template <int D>
std::vector<Handle> World<D>::overlap(const Aabb<D>& box) const {
  sync();
  std::vector<ProxyId> found;
  m_boxes.overlap(box, found);
  return bodiesOf(found, [&](const auto& shape, const Pose<D>& X_WS) { return overlapsBox(shape, X_WS, box); });
}

template <int D>
template <class Meets>
std::vector<BodyRayHit<D>> World<D>::rayHits(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                                             const Meets& meets) const {
  if (!p.allFinite() || !direction.allFinite()) throw UserError("ray: its start or direction is not finite");
  if (!(maxT >= 0)) throw UserError("ray: maxT is " + std::to_string(maxT) + "; valid: a number >= 0");
  sync();
  std::vector<RayHit<D>> found;
  m_boxes.ray(p, direction, maxT, found);  // the first box need not hold the first shape
  std::vector<BodyRayHit<D>> out;
  for (const RayHit<D>& hit : found) {
    const ShapeRecord<D>& s = m_shapes[static_cast<std::size_t>(hit.proxy)];
    const Handle body = handle(s.body);
    if (!meets(body, s)) continue;
    const Pose<D> X_WS = m_bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    RayEntry<D> first;
    forParts(s.shape, X_WS, [&](const auto& part, const Pose<D>& X_WP) {
      const RayEntry<D> entry = rayEntry(part, X_WP, p, direction, maxT);
      if (entry.t >= 0 && (first.t < 0 || entry.t < first.t)) first = entry;
    });
    if (first.t >= 0) out.push_back({body, s.index, first.t, first.normal, s.userData});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.t, a.body.slot, a.shape) < std::tuple(b.t, b.body.slot, b.shape);
  });
  if (firstOnly && out.size() > 1) out.resize(1);
  return out;
}

template <int D>
std::vector<BodyRayHit<D>> World<D>::ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly) const {
  return rayHits(p, direction, maxT, firstOnly, [](Handle, const ShapeRecord<D>&) { return true; });
}

template <int D>
std::vector<BodyRayHit<D>> World<D>::ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                                         const RayFilter<D>& filter) const {
  return rayHits(p, direction, maxT, firstOnly, [&](Handle body, const ShapeRecord<D>& s) {
    return (filter.category & s.mask) && (filter.mask & s.category) && (!filter.accepts || filter.accepts(body, s));
  });
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                                           \
  template std::vector<Handle> World<D>::at(const Vec<D>&) const;                                    \
  template std::vector<Handle> World<D>::overlap(const Aabb<D>&) const;                              \
  template std::vector<BodyRayHit<D>> World<D>::ray(const Vec<D>&, const Vec<D>&, Real, bool) const; \
  template std::vector<BodyRayHit<D>> World<D>::ray(const Vec<D>&, const Vec<D>&, Real, bool, const RayFilter<D>&) const
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}  // namespace lpc::inline LPC_PRECISION
