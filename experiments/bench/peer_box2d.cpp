// SPDX-License-Identifier: Zlib
#include <box2d/b2_collision.h>
#include <box2d/b2_polygon_shape.h>

#include "experiments/bench/manifold_peers.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench { namespace {

b2Vec2 vector(const Vec<2>& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1])}; }

// b2CollidePolygons, in float: every edge of both polygons against every vertex, then one clip. It stops if the
// polygons, each with its skin of a centimetre, are apart, as ours do at the margin. Its manifold is a reference edge
// and points of the other polygon. `inWorld` adds the normal, the points and their separations in the world, which
// Box2D's solver computes in each step and ours has from the start. Unlike ours, neither variant mixes friction or
// names the bodies.
class Box2dPolygons final : public ManifoldPeer {
 public:
  explicit Box2dPolygons(bool inWorld) : m_inWorld(inWorld) {}
  void build(const std::vector<Shape<2>>& shapes, const std::vector<Pose<2>>& poses) override {
    m_shapes.resize(shapes.size()), m_poses.resize(shapes.size());
    m_manifolds.resize(shapes.size() / 2), m_worldManifolds.resize(shapes.size() / 2);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const ShapeView<2>& s = shapes[i].view();
      if (s.hull) {
        std::vector<b2Vec2> points;
        for (const Vec<2>& v : s.hull->vertices) points.push_back(vector(v));
        m_shapes[i].Set(points.data(), static_cast<std::int32_t>(points.size()));
      } else {
        m_shapes[i].SetAsBox(static_cast<float>(s.half[0]), static_cast<float>(s.half[1]));
      }
      m_poses[i].p = vector(poses[i].p);
      m_poses[i].q.c = static_cast<float>(poses[i].q.c), m_poses[i].q.s = static_cast<float>(poses[i].q.s);
    }
  }
  int collide() override {
    int points = 0;
    for (std::size_t k = 0; k < m_manifolds.size(); ++k) {
      const std::size_t a = 2 * k, b = a + 1;
      b2CollidePolygons(&m_manifolds[k], &m_shapes[a], m_poses[a], &m_shapes[b], m_poses[b]);
      points += m_manifolds[k].pointCount;
      if (!m_inWorld || m_manifolds[k].pointCount == 0) continue;
      m_worldManifolds[k].Initialize(&m_manifolds[k], m_poses[a], m_shapes[a].m_radius, m_poses[b],
                                     m_shapes[b].m_radius);
    }
    return points;
  }

 private:
  bool m_inWorld;
  std::vector<b2PolygonShape> m_shapes;
  std::vector<b2Transform> m_poses;
  std::vector<b2Manifold> m_manifolds;
  std::vector<b2WorldManifold> m_worldManifolds;
};

const ManifoldPeerRegistrar box2dPolygons({"peer_box2d", [] { return std::make_unique<Box2dPolygons>(false); }});
const ManifoldPeerRegistrar box2dInWorld({"peer_box2d_world", [] { return std::make_unique<Box2dPolygons>(true); }});

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::bench
