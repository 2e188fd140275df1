// SPDX-License-Identifier: Zlib
#define BT_USE_DOUBLE_PRECISION  // see bullet.cpp
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <algorithm>
#include <memory>

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// Bullet keeps fat pairs from step to step. The tight ones are filtered out within the stage, since the stage must
/// return exactly these. In 2D the third axis is [0, 1] for all.
template <int D>
class BulletDbvt final : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit BulletDbvt(const Params&) {}
  ~BulletDbvt() override {
    for (btBroadphaseProxy* proxy : m_proxies) {
      if (proxy) m_tree.destroyProxy(proxy, nullptr);
    }
  }

  static AlgorithmInfo info() {
    return {.name = "bullet_dbvt",
            .summary = "Bullet's btDbvtBroadphase: two trees of fat boxes, with pairs kept between steps",
            .paper = "",
            .complexity = "n log n",
            .role = AlgorithmRole::witness};
  }

  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    for (const ProxyId i : changes.removed) take(i);
    for (const std::span<const ProxyId> list : {changes.added, changes.moved}) {
      for (const ProxyId i : list) place(proxies, i);
    }
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone&) override {
    m_tree.calculateOverlappingPairs(nullptr);
    btOverlappingPairCache* cache = m_tree.getOverlappingPairCache();
    const btBroadphasePair* pairs = cache->getOverlappingPairArrayPtr();
    for (int k = 0; k < cache->getNumOverlappingPairs(); ++k) {
      const ProxyId i = slotOf(pairs[k].m_pProxy0), j = slotOf(pairs[k].m_pProxy1);
      if (proxies.boxesOverlap(i, j) && proxies.mayCollide(i, j)) out.push_back({std::min(i, j), std::max(i, j)});
    }
  }

 private:
  void place(const Proxies<D>& proxies, ProxyId i) {
    const Aabb<D> box = proxies.box(i);
    // An empty box overlaps nothing: a free slot, or a body that has become NaN.
    if (proxies.isFree(i) || !(box.lo.array() <= box.hi.array()).all()) return take(i);
    if (m_proxies.size() <= static_cast<std::size_t>(i)) m_proxies.resize(static_cast<std::size_t>(i) + 1, nullptr);
    btBroadphaseProxy*& proxy = m_proxies[static_cast<std::size_t>(i)];
    if (proxy) {
      m_tree.setAabb(proxy, corner(box.lo, 0), corner(box.hi, 1), nullptr);
    } else {
      proxy = m_tree.createProxy(corner(box.lo, 0), corner(box.hi, 1), 0,
                                 reinterpret_cast<void*>(static_cast<std::intptr_t>(i)), 1, 1, nullptr);
    }
  }
  void take(ProxyId i) {
    if (static_cast<std::size_t>(i) >= m_proxies.size() || !m_proxies[static_cast<std::size_t>(i)]) return;
    m_tree.destroyProxy(m_proxies[static_cast<std::size_t>(i)], nullptr);
    m_proxies[static_cast<std::size_t>(i)] = nullptr;
  }
  static ProxyId slotOf(const btBroadphaseProxy* proxy) {
    return static_cast<ProxyId>(reinterpret_cast<std::intptr_t>(proxy->m_clientObject));
  }
  static btVector3 corner(const Vec<D>& p, double third) {
    btVector3 out(0, 0, third);
    for (int d = 0; d < D; ++d) out[d] = static_cast<double>(p[d]);
    return out;
  }

  btDbvtBroadphase m_tree;
  std::vector<btBroadphaseProxy*> m_proxies;  // by slot
};

}  // namespace

LPC_REGISTER(Broadphase, BulletDbvt, 2, 3);

}}  // namespace lpc::LPC_PRECISION
