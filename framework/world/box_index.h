// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/problem/body.h"
#include "framework/stage/stage_broadphase.h"
#include "framework/stage/stage_sleep.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Keeps a box for each shape of a world, the broadphase over these boxes, and the changes not yet passed to the
/// broadphase. Changes are noted immediately. sync() applies them in a single pass over the shapes.
///
/// A plane has no finite box, so the broadphase sees an empty box. findPairs() tests each plane against each active
/// box; the other queries report every plane. Worlds have few planes.
template <int D>
class BoxIndex {
 public:
  /// Each box grows by half the margin (m), so two boxes overlap when their shapes are within the margin. Does not own
  /// the broadphase, which must be fresh.
  BoxIndex(Broadphase<D>& broadphase, Real margin) : m_broadphase(&broadphase), m_margin(margin) {}

  void add(std::size_t shape, const ShapeRecord<D>& record);
  void remove(std::size_t shape);
  /// Marks the boxes of this body as stale, also when the body is static or sleeping.
  void touch(std::size_t body);
  /// Tells the broadphase that every box is removed. Must be the last call before another index takes over the same
  /// broadphase.
  void removeAll();
  /// Marks the boxes of all moving bodies as stale.
  void markAllStale() { m_stale = true; }
  /// Passes all noted changes to the broadphase. With `sleepers`, boxes of sleeping bodies are active too. While any
  /// body sleeps, so are the boxes of bodies that the user added or changed, also static ones: their contacts with
  /// sleepers are made and ended.
  void sync(std::span<const ShapeRecord<D>> shapes, const Bodies<D>& bodies, std::span<const SleepEvent> events,
            bool sleepers);

  // State of the last sync().
  bool changed(std::int32_t body) const { return m_changed[static_cast<std::size_t>(body)] != 0; }
  const Proxies<D>& proxies() const { return m_proxies; }
  bool active(std::int32_t shape) const { return m_proxies.active[static_cast<std::size_t>(shape)] != 0; }
  // Queries of the broadphase on these boxes (see Broadphase), with all planes added. ray() reports each plane with t =
  // 0, because the boxes do not give the exact hit.
  void findPairs(std::vector<ProxyPair>& out, WorkDone& work);
  void overlap(const Aabb<D>& box, std::vector<ProxyId>& out) const;
  void at(const Vec<D>& point, std::vector<ProxyId>& out) const;
  void ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, std::vector<RayHit<D>>& out) const;

 private:
  struct Plane {
    ProxyId shape;
    Pose<D> X_WS;
  };
  void refresh(std::size_t shape, const ShapeRecord<D>& record, const Pose<D>& X_WC);
  void findChanged(const Bodies<D>& bodies, std::span<const SleepEvent> events);
  enum Change : std::uint8_t { none = 0, added = 1, removed = 2, both = 3 };

  Broadphase<D>* m_broadphase;
  Real m_margin;
  Proxies<D> m_proxies;
  std::vector<Plane> m_planes;                       // ascending slots
  std::vector<std::uint8_t> m_change;                // by shape slot, since the last sync
  std::vector<std::uint8_t> m_touched;               // by body slot, since the last sync
  std::vector<std::uint8_t> m_changed;               // by body slot: added or changed by the user since the last step
  std::vector<ProxyId> m_added, m_removed, m_moved;  // scratch of sync
  bool m_stale = false;
  bool m_anyActive = false;  // as of the last sync()
};

}}  // namespace lpc::LPC_PRECISION
