// SPDX-License-Identifier: Zlib
#include "framework/world/box_index.h"

#include <algorithm>

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
void BoxIndex<D>::add(std::size_t shape, const ShapeRecord<D>& record) {
  if (shape >= m_change.size()) {
    m_change.resize(shape + 1, none);
    m_proxies.resize(static_cast<int>(shape + 1));
  }
  m_proxies.category[shape] = record.category, m_proxies.mask[shape] = record.mask;
  m_proxies.body[shape] = record.body;
  m_change[shape] |= added;
  m_stale = true;
}

template <int D>
void BoxIndex<D>::remove(std::size_t shape) {
  m_proxies.setBox(static_cast<ProxyId>(shape), Aabb<D>{});
  m_proxies.body[shape] = -1, m_proxies.active[shape] = 0;
  // A slot that was never passed to the broadphase need not be removed from it.
  m_change[shape] = m_change[shape] & added ? m_change[shape] & removed : removed;
  m_stale = true;
}

template <int D>
void BoxIndex<D>::removeAll() {
  m_removed.clear();
  for (std::size_t s = 0; s < m_change.size(); ++s) {
    const auto id = static_cast<ProxyId>(s);
    const bool known = (m_change[s] & removed) || (!m_proxies.isFree(id) && !(m_change[s] & added));
    if (known) m_removed.push_back(id);
    m_proxies.setBox(id, Aabb<D>{});
    m_proxies.body[s] = -1, m_proxies.active[s] = 0;
  }
  m_broadphase->update(m_proxies, {{}, m_removed, {}});
}

template <int D>
void BoxIndex<D>::touch(std::size_t body) {
  if (body >= m_touched.size()) m_touched.resize(body + 1, 0);
  m_touched[body] = 1;
  m_stale = true;
}

template <int D>
void BoxIndex<D>::refresh(std::size_t shape, const ShapeRecord<D>& record, const Pose<D>& X_WC) {
  Aabb<D> box = boundingBox(record.shape, X_WC * record.X_CS).grown(m_margin / 2);
  // A body with NaN takes no part in collision. The caller detects it and stops.
  if (!box.lo.allFinite() || !box.hi.allFinite()) box = Aabb<D>{};
  m_proxies.setBox(static_cast<ProxyId>(shape), box);
}

// Events, not m_touched: they are saved, and a query between two steps does not clear them.
template <int D>
void BoxIndex<D>::findChanged(const Bodies<D>& bodies, std::span<const SleepEvent> events) {
  m_changed.assign(bodies.pose.size(), 0);
  if (events.empty()) return;
  bool sleepers = false;
  for (std::size_t i = 0; i < bodies.used.size(); ++i) sleepers = sleepers || (bodies.used[i] && !bodies.awake[i]);
  if (!sleepers) return;
  for (const SleepEvent& e : events) {
    if (e.kind == SleepEvent::bodyAdded || e.kind == SleepEvent::userChange) {
      m_changed[static_cast<std::size_t>(e.body)] = 1;
    }
  }
}

template <int D>
void BoxIndex<D>::sync(std::span<const ShapeRecord<D>> shapes, const Bodies<D>& bodies,
                       std::span<const SleepEvent> events, bool sleepers) {
  if (!m_stale) return;
  m_stale = false;
  if (m_change.size() < shapes.size()) {  // a saved world may end in free slots
    m_change.resize(shapes.size(), none);
    m_proxies.resize(static_cast<int>(shapes.size()));
  }
  m_touched.resize(bodies.pose.size(), 0);
  findChanged(bodies, events);
  m_added.clear(), m_removed.clear(), m_moved.clear();
  m_planes.clear();
  m_anyActive = false;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (m_change[s] & removed) m_removed.push_back(static_cast<ProxyId>(s));
    if (m_change[s] & added) m_added.push_back(static_cast<ProxyId>(s));
    if (shapes[s].body >= 0) {
      const auto body = static_cast<std::size_t>(shapes[s].body);
      if (shapes[s].shape.isPlane()) {
        m_planes.push_back({static_cast<ProxyId>(s), bodies.pose[body] * shapes[s].X_CS});
      }
      const bool active = ((bodies.awake[body] || sleepers) && bodies.type[body] != BodyType::fixed) || m_changed[body];
      const bool moved = active || m_touched[body];
      if (moved || (m_change[s] & added)) refresh(s, shapes[s], bodies.pose[body]);
      if (moved || m_proxies.active[s]) m_moved.push_back(static_cast<ProxyId>(s));
      m_proxies.active[s] = active;
      m_anyActive = m_anyActive || active;
    }
    m_change[s] = none;
  }
  std::fill(m_touched.begin(), m_touched.end(), std::uint8_t(0));
  m_broadphase->update(m_proxies, {m_added, m_removed, m_moved});
}

template <int D>
void BoxIndex<D>::findPairs(std::vector<ProxyPair>& out, WorkDone& work) {
  if (!m_anyActive) return;  // each pair needs an active box
  m_broadphase->findPairs(m_proxies, out, work);
  const ShapeView<D> plane = Shape<D>::plane().view();
  for (const Plane& p : m_planes) {
    for (ProxyId i = 0; i < m_proxies.size(); ++i) {
      if (m_proxies.isFree(i) || !m_proxies.mayCollide(p.shape, i)) continue;
      ++work[WorkCount::boxTests];
      // The other half of the margin: a plane's own box would have grown by it.
      if (overlapsBox(plane, p.X_WS, m_proxies.box(i).grown(m_margin / 2))) {
        out.push_back({std::min(p.shape, i), std::max(p.shape, i)});
      }
    }
  }
}

template <int D>
void BoxIndex<D>::overlap(const Aabb<D>& box, std::vector<ProxyId>& out) const {
  m_broadphase->overlap(m_proxies, box, out);
  for (const Plane& p : m_planes) out.push_back(p.shape);
}

template <int D>
void BoxIndex<D>::at(const Vec<D>& point, std::vector<ProxyId>& out) const {
  m_broadphase->at(m_proxies, point, out);
  for (const Plane& p : m_planes) out.push_back(p.shape);
}

template <int D>
void BoxIndex<D>::ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, std::vector<RayHit<D>>& out) const {
  m_broadphase->ray(m_proxies, p, direction, maxT, false, out);
  for (const Plane& plane : m_planes) out.push_back({plane.shape, 0});
}

template class BoxIndex<2>;
template class BoxIndex<3>;

}}  // namespace lpc::LPC_PRECISION
