// SPDX-License-Identifier: Zlib
#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include "experiments/bench/box_peers.h"

namespace lpc::inline LPC_PRECISION::bench {
namespace {

btVector3 vector(const std::array<double, 3>& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

int index(const btBroadphaseProxy* proxy) {
  return static_cast<int>(reinterpret_cast<std::size_t>(proxy->m_clientObject));
}

// Bullet keeps fat pairs from frame to frame; the tight ones are filtered out of them, inside the timing, as a user who
// wants what we return must do.
class Bullet : public BoxPeer {
 public:
  void build(const std::vector<Box>& boxes) override {
    m_broadphase = create(boxes);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      m_proxies.push_back(m_broadphase->createProxy(vector(boxes[i].lo), vector(boxes[i].hi), 0,
                                                    reinterpret_cast<void*>(i), 1, 1, nullptr));
    }
  }
  void frame(const std::vector<Box>& boxes, std::vector<ProxyPair>& out) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      m_broadphase->setAabb(m_proxies[i], vector(boxes[i].lo), vector(boxes[i].hi), nullptr);
    }
    m_broadphase->calculateOverlappingPairs(nullptr);
    btOverlappingPairCache* cache = m_broadphase->getOverlappingPairCache();
    const btBroadphasePair* pairs = cache->getOverlappingPairArrayPtr();
    for (int k = 0; k < cache->getNumOverlappingPairs(); ++k) {
      const int i = index(pairs[k].m_pProxy0), j = index(pairs[k].m_pProxy1);
      const Box &a = boxes[static_cast<std::size_t>(i)], &b = boxes[static_cast<std::size_t>(j)];
      bool overlap = true;
      for (std::size_t d = 0; d < 3; ++d) overlap = overlap && a.lo[d] <= b.hi[d] && b.lo[d] <= a.hi[d];
      if (overlap) out.push_back({std::min(i, j), std::max(i, j)});
    }
  }

 protected:
  virtual std::unique_ptr<btBroadphaseInterface> create(const std::vector<Box>& boxes) = 0;

 private:
  std::unique_ptr<btBroadphaseInterface> m_broadphase;
  std::vector<btBroadphaseProxy*> m_proxies;
};

class BulletTree final : public Bullet {
 public:
  explicit BulletTree(bool deferred) : m_deferred(deferred) {}

 private:
  std::unique_ptr<btBroadphaseInterface> create(const std::vector<Box>&) override {
    auto tree = std::make_unique<btDbvtBroadphase>();
    tree->m_deferedcollide = m_deferred;
    return tree;
  }
  bool m_deferred;
};

class BulletSweep final : public Bullet {
  std::unique_ptr<btBroadphaseInterface> create(const std::vector<Box>& boxes) override {
    Box world = boxes.front();
    for (const Box& box : boxes) {
      for (std::size_t d = 0; d < 3; ++d) {
        world.lo[d] = std::min(world.lo[d], box.lo[d] - 10), world.hi[d] = std::max(world.hi[d], box.hi[d] + 10);
      }
    }
    const auto most = static_cast<unsigned>(boxes.size()) + 1;
    return std::make_unique<bt32BitAxisSweep3>(vector(world.lo), vector(world.hi), most, nullptr, true);
  }
};

const BoxPeerRegistrar immediate({"peer_bullet_dbvt", 100000, [] { return std::make_unique<BulletTree>(false); }});
const BoxPeerRegistrar deferred({"peer_bullet_dbvt_deferred", 100000,
                                 [] { return std::make_unique<BulletTree>(true); }});
const BoxPeerRegistrar sweep({"peer_bullet_axis_sweep", 10000, [] { return std::make_unique<BulletSweep>(); }});

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::bench
