// SPDX-License-Identifier: Zlib
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include "experiments/bench/box_peers.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench { namespace {

// DynamicAABBTreeCollisionManager: a binary tree of tight boxes, refitted, then descended against itself. Its boxes are
// computed anew from centre and size, so a pair that touches within rounding may differ.
class FclTree final : public BoxPeer {
 public:
  void build(const std::vector<Box>& boxes) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      std::array<double, 3> size;
      for (std::size_t d = 0; d < 3; ++d) size[d] = boxes[i].hi[d] - boxes[i].lo[d];
      m_objects.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::make_shared<fcl::Boxd>(size[0], size[1], size[2]), fcl::Transform3d::Identity()));
      m_objects.back()->setUserData(reinterpret_cast<void*>(i));
      place(i, boxes[i]);
      m_pointers.push_back(m_objects.back().get());
    }
    m_manager.registerObjects(m_pointers);
    m_manager.setup();
  }
  void frame(const std::vector<Box>& boxes, std::vector<ProxyPair>& out) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) place(i, boxes[i]);
    m_manager.update();
    m_manager.collide(&out, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
      const auto i = static_cast<ProxyId>(reinterpret_cast<std::size_t>(a->getUserData()));
      const auto j = static_cast<ProxyId>(reinterpret_cast<std::size_t>(b->getUserData()));
      static_cast<std::vector<ProxyPair>*>(data)->push_back({std::min(i, j), std::max(i, j)});
      return false;
    });
  }

 private:
  void place(std::size_t i, const Box& box) {
    m_objects[i]->setTranslation(
        fcl::Vector3d((box.lo[0] + box.hi[0]) / 2, (box.lo[1] + box.hi[1]) / 2, (box.lo[2] + box.hi[2]) / 2));
    m_objects[i]->computeAABB();
  }
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> m_objects;
  std::vector<fcl::CollisionObjectd*> m_pointers;
  fcl::DynamicAABBTreeCollisionManagerd m_manager;
};

const BoxPeerRegistrar fclTree({"peer_fcl_dynamic_tree", 100000, [] { return std::make_unique<FclTree>(); }});

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::bench
