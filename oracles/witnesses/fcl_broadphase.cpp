// SPDX-License-Identifier: Zlib
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include <algorithm>
#include <memory>

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// FCL's tree of tight boxes, refitted and traversed against itself. In 2D the third axis is [0, 1] for all. The
/// collision filters are applied to the library's pairs.
template <int D>
class FclTree final : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit FclTree(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "fcl_tree",
            .summary = "FCL's DynamicAABBTreeCollisionManager: a binary tree of tight boxes, refitted in each step",
            .paper = "",
            .complexity = "n log n",
            .role = AlgorithmRole::witness};
  }

  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    for (const ProxyId i : changes.removed) take(i);
    for (const std::span<const ProxyId> list : {changes.added, changes.moved}) {
      for (const ProxyId i : list) place(proxies, i);
    }
    m_manager.update();
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone&) override {
    Found found{proxies, out};
    m_manager.collide(&found, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
      auto& all = *static_cast<Found*>(data);
      const auto i = static_cast<ProxyId>(reinterpret_cast<std::intptr_t>(a->getUserData()));
      const auto j = static_cast<ProxyId>(reinterpret_cast<std::intptr_t>(b->getUserData()));
      if (all.proxies.mayCollide(i, j)) all.out.push_back({std::min(i, j), std::max(i, j)});
      return false;
    });
  }

 private:
  struct Found {
    const Proxies<D>& proxies;
    std::vector<ProxyPair>& out;
  };
  struct Slot {
    std::shared_ptr<fcl::Boxd> shape;
    std::unique_ptr<fcl::CollisionObjectd> object;
    bool inside = false;
  };

  void place(const Proxies<D>& proxies, ProxyId i) {
    const Aabb<D> box = proxies.box(i);
    // An empty box overlaps nothing: a free slot, or a body that has become NaN.
    if (proxies.isFree(i) || !(box.lo.array() <= box.hi.array()).all()) return take(i);
    if (m_slots.size() <= static_cast<std::size_t>(i)) m_slots.resize(static_cast<std::size_t>(i) + 1);
    Slot& slot = m_slots[static_cast<std::size_t>(i)];
    if (!slot.object) {
      slot.shape = std::make_shared<fcl::Boxd>(1, 1, 1);
      slot.object = std::make_unique<fcl::CollisionObjectd>(slot.shape, fcl::Transform3d::Identity());
      slot.object->setUserData(reinterpret_cast<void*>(static_cast<std::intptr_t>(i)));
    }
    // The object stays at the origin and its shape takes our bounds: bounds computed from centre and size would be
    // rounded.
    slot.shape->aabb_local = fcl::AABBd(corner(box.lo, 0), corner(box.hi, 1));
    slot.object->computeAABB();
    if (!slot.inside) m_manager.registerObject(slot.object.get());
    slot.inside = true;
  }
  void take(ProxyId i) {
    if (static_cast<std::size_t>(i) >= m_slots.size()) return;
    Slot& slot = m_slots[static_cast<std::size_t>(i)];
    if (slot.inside) m_manager.unregisterObject(slot.object.get());
    slot.inside = false;
  }
  static fcl::Vector3d corner(const Vec<D>& p, double third) {
    fcl::Vector3d out(0, 0, third);
    for (int d = 0; d < D; ++d) out[d] = static_cast<double>(p[d]);
    return out;
  }

  std::vector<Slot> m_slots;
  fcl::DynamicAABBTreeCollisionManagerd m_manager;
};

}  // namespace

LPC_REGISTER(Broadphase, FclTree, 2, 3);

}}  // namespace lpc::LPC_PRECISION
