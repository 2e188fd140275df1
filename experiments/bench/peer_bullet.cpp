// SPDX-License-Identifier: Zlib
#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>

#include "experiments/bench/box_peers.h"
#include "experiments/bench/pair_peers.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench { namespace {

btVector3 vector(const std::array<double, 3>& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

int index(const btBroadphaseProxy* proxy) {
  return static_cast<int>(reinterpret_cast<std::size_t>(proxy->m_clientObject));
}

// Bullet keeps fat pairs from frame to frame; the timed code filters the tight ones, as a user who wants our output
// must do.
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

// Like the witness bullet_dbvt, but it finds pairs once per frame, not at each move.
class BulletDeferredTree final : public Bullet {
  std::unique_ptr<btBroadphaseInterface> create(const std::vector<Box>&) override {
    auto tree = std::make_unique<btDbvtBroadphase>();
    tree->m_deferedcollide = true;
    return tree;
  }
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

class BulletBoxes final : public PairPeer {
 public:
  explicit BulletBoxes(const PairData<3>& data) {
    for (std::size_t k = 0; k < data.a.size(); ++k) {
      m_pairs.push_back({shapeOf(data.a[k]), shapeOf(data.b[k]), transform(data.X_WA[k]), transform(data.X_WB[k])});
    }
  }
  int run() override {
    int overlaps = 0;
    btBoxBoxDetector::ClosestPointInput input;
    for (const Pair& pair : m_pairs) {
      btBoxBoxDetector detector(pair.a.get(), pair.b.get());
      input.m_transformA = pair.X_WA, input.m_transformB = pair.X_WB;
      btPointCollector found;
      detector.getClosestPoints(input, found, nullptr);
      overlaps += found.m_hasResult;
    }
    return overlaps;
  }

 private:
  struct Pair {
    std::unique_ptr<btBoxShape> a, b;
    btTransform X_WA, X_WB;
  };
  static std::unique_ptr<btBoxShape> shapeOf(const Shape<3>& shape) {
    const Vec<3>& half = shape.view().half;
    auto box = std::make_unique<btBoxShape>(btVector3(half[0], half[1], half[2]));
    box->setMargin(0);
    return box;
  }
  static btTransform transform(const Pose<3>& X) {
    const Mat<3> r = X.q.matrix();
    return btTransform({r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)},
                       {X.p[0], X.p[1], X.p[2]});
  }

  std::vector<Pair> m_pairs;
};

const PairPeerRegistrar boxes({"peer_bullet_box_box", {ShapeKind::box}, [](const PairData<3>& data) {
                                 return std::make_unique<BulletBoxes>(data);
                               }});
const BoxPeerRegistrar deferred({"peer_bullet_dbvt_deferred", 100000,
                                 [] { return std::make_unique<BulletDeferredTree>(); }});
const BoxPeerRegistrar sweep({"peer_bullet_axis_sweep", 10000, [] { return std::make_unique<BulletSweep>(); }});

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::bench
