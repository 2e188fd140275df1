// SPDX-License-Identifier: Zlib
#include "framework/world/body_queries.h"

#include <algorithm>
#include <string>

#include "framework/shape/parts_near.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Calls meet(view, X_WP) for each part when the ray hits its box, grown by rounding errors. A surface has two sides for
// rays: the ray's direction decides by which side it enters.
template <int D, class Meet>
void meetOfSurface(const Surface<D>& surface, const Pose<D>& X_WS, const Vec<D>& p, const Vec<D>& direction, Real maxT,
                   std::vector<std::int32_t>& near, const Meet& meet) {
  const Vec<D> start = X_WS.q.inverse() * Vec<D>(p - X_WS.p), along = X_WS.q.inverse() * direction;
  const Real rounding = kTurnedBox * (p.cwiseAbs().maxCoeff() + X_WS.p.cwiseAbs().maxCoeff() + surface.reach());
  WorkDone work;
  surface.tree().find([&](const Aabb<D>& box) { return castRay(box.grown(rounding), start, along, maxT) >= 0; }, near,
                      work);
  for (const std::int32_t i : near) {
    const PlacedView<D>& part = surface.parts()[static_cast<std::size_t>(i)];
    meet(part.view, X_WS * part.X_SP);
  }
}

template <int D>
bool meets(const RayFilter<D>& filter, BodyHandle body, const ShapeRecord<D>& s) {
  return (filter.category & s.mask) && (filter.mask & s.category) && (!filter.accepts || filter.accepts(body, s));
}

}  // namespace

// The bodies of these proxies, each once, with a convex part for which `holds` is true; `holds` gets the part and its
// pose. Tests only the parts of a surface near the box.
template <int D>
template <class Holds>
std::vector<BodyHandle> BodyQueries<D>::bodiesOf(std::vector<ProxyId>& found, const Aabb<D>& box,
                                                 const Holds& holds) const {
  std::sort(found.begin(), found.end());
  std::vector<BodyHandle> out;
  std::vector<std::int32_t> near;
  WorkDone work;
  for (ProxyId id : found) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(id)];
    const Pose<D> X_WS = m_table.bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    bool held = false;
    forPartsNear(s.shape, X_WS, {}, box, near, work,
                 [&](std::int32_t, const auto& part, const Pose<D>& X_WP) { held = held || holds(part, X_WP); });
    const BodyHandle h = m_table.handle(s.body);
    if (held && std::find(out.begin(), out.end(), h) == out.end()) out.push_back(h);
  }
  return out;
}

template <int D>
std::vector<BodyHandle> BodyQueries<D>::at(const Vec<D>& point) const {
  std::vector<ProxyId> found;
  m_table.boxes.at(point, found);
  return bodiesOf(found, {point, point},
                  [&](const auto& shape, const Pose<D>& X_WS) { return containsPoint(shape, X_WS, point); });
}

template <int D>
std::vector<BodyHandle> BodyQueries<D>::overlap(const Aabb<D>& box) const {
  std::vector<ProxyId> found;
  m_table.boxes.overlap(box, found);
  return bodiesOf(found, box, [&](const auto& shape, const Pose<D>& X_WS) { return overlapsBox(shape, X_WS, box); });
}

// The same for one body, without the broadphase.
template <int D>
template <class Holds>
bool BodyQueries<D>::anyPart(std::size_t i, const Aabb<D>& box, const Holds& holds) const {
  std::vector<std::int32_t> near;
  WorkDone work;
  bool held = false;
  for (const std::int32_t shape : m_table.shapesOf(i)) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(shape)];
    forPartsNear(s.shape, m_table.bodies.pose[i] * s.X_CS, {}, box, near, work,
                 [&](std::int32_t, const auto& part, const Pose<D>& X_WP) { held = held || holds(part, X_WP); });
  }
  return held;
}

template <int D>
bool BodyQueries<D>::contains(std::size_t body, const Vec<D>& point) const {
  return anyPart(body, {point, point},
                 [&](const auto& shape, const Pose<D>& X_WS) { return containsPoint(shape, X_WS, point); });
}

template <int D>
bool BodyQueries<D>::intersects(std::size_t body, const Aabb<D>& box) const {
  return anyPart(body, box, [&](const auto& shape, const Pose<D>& X_WS) { return overlapsBox(shape, X_WS, box); });
}

template <int D>
std::vector<BodyRayHit<D>> BodyQueries<D>::rayAll(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                                  const RayFilter<D>* filter) const {
  if (!p.allFinite() || !direction.allFinite()) throw UserError("ray: its start or direction is not finite");
  if (!(maxT >= 0)) throw UserError("ray: maxT is " + std::to_string(maxT) + "; valid: a number >= 0");
  std::vector<RayHit<D>> found;
  m_table.boxes.ray(p, direction, maxT, found);  // the first box need not hold the first hit
  std::vector<BodyRayHit<D>> out;
  std::vector<std::int32_t> near;
  for (const RayHit<D>& hit : found) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(hit.proxy)];
    const BodyHandle body = m_table.handle(s.body);
    if (filter && !meets(*filter, body, s)) continue;
    const Pose<D> X_WS = m_table.bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    RayEntry<D> first;
    const auto meet = [&](const ShapeView<D>& part, const Pose<D>& X_WP) {
      const RayEntry<D> entry = rayEntry(part, X_WP, p, direction, maxT);
      if (entry.t >= 0 && (first.t < 0 || entry.t < first.t)) first = entry;
    };
    if (const Surface<D>* surface = s.shape.surface()) {
      meetOfSurface(*surface, X_WS, p, direction, maxT, near, meet);
    } else {
      forParts(s.shape, X_WS, meet);
    }
    if (first.t >= 0) out.push_back({body, s.index, first.t, first.normal, s.userData});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.t, a.body.slot, a.shape) < std::tuple(b.t, b.body.slot, b.shape);
  });
  return out;
}

template <int D>
std::optional<BodyRayHit<D>> BodyQueries<D>::rayFirst(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                                      const RayFilter<D>* filter) const {
  const std::vector<BodyRayHit<D>> hits = rayAll(p, direction, maxT, filter);
  return hits.empty() ? std::nullopt : std::optional(hits.front());
}

template class BodyQueries<2>;
template class BodyQueries<3>;

}}  // namespace lpc::LPC_PRECISION
