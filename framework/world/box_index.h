// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/problem/body.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The box of each shape of a world, the broadphase over them, and what it has not heard of yet. Changes are noted at
/// once and brought up to date by sync(), in one walk over the shapes however many there were.
///
/// A plane has no box: the broadphase sees an empty one, and every question is put to the planes here, each against
/// each box. There are few of them.
template <int D>
class BoxIndex {
 public:
  /// Both boxes of a pair grow by half the margin (m), so that they overlap when the shapes are within the whole of it.
  /// The broadphase is not owned, and must be fresh.
  BoxIndex(Broadphase<D>& broadphase, Real margin) : m_broadphase(&broadphase), m_margin(margin) {}

  void add(std::size_t shape, const ShapeRecord<D>& record);
  void remove(std::size_t shape);
  /// The boxes of this body are stale, also when it does not move by itself.
  void touch(std::size_t body);
  /// Those of all who move are.
  void outdate() { m_stale = true; }
  /// With `sleepers` those who sleep are active, too.
  void sync(std::span<const ShapeRecord<D>> shapes, const Bodies<D>& bodies, bool sleepers);

  // As of the last sync().
  const Proxies<D>& proxies() const { return m_proxies; }
  bool active(std::int32_t shape) const { return m_proxies.active[static_cast<std::size_t>(shape)] != 0; }
  // What the broadphase says of these boxes; see there. Planes are added; of a ray with t = 0, before anything is
  // known.
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
  enum Change : std::uint8_t { none = 0, added = 1, removed = 2, both = 3 };

  Broadphase<D>* m_broadphase;
  Real m_margin;
  Proxies<D> m_proxies;
  std::vector<Plane> m_planes;                       // in the order of their slots
  std::vector<std::uint8_t> m_change;                // by shape slot, since the last sync
  std::vector<std::uint8_t> m_touched;               // by body slot
  std::vector<ProxyId> m_added, m_removed, m_moved;  // scratch of sync
  bool m_stale = false;
  bool m_anyActive = false;  // as of the last sync()
};

}}  // namespace lpc::LPC_PRECISION
