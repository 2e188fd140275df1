// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <vector>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Counts dynamic bodies that have passed through a fixed shape with which they may collide: the centre of mass was
/// outside before and after, and its path crossed the shape. Bodies with the centre outside their own shapes may pass
/// legitimately, as a ring over a post, and are excluded. Uses poses only, so it serves worlds and engines.
template <int D>
class Tunnelling {
 public:
  /// Call before each step, after the script: new and displaced bodies start anew.
  void place(const Simulation<D>& world);
  void observe(const Simulation<D>& world);  // after each step
  void finish(const Simulation<D>& world);   // after the last step
  int count() const { return m_count; }      // bodies, each once

 private:
  struct Body {
    bool known = false;  // dynamic, and of this generation
    std::uint32_t generation = 0;
    Real reach = 0;  // m, half of the smallest extent of its smallest part
    bool holdsCenter = false, tunnelled = false;
    bool outside = false;          // `from` is known
    Vec<D> from = Vec<D>::Zero();  // last tested position outside all fixed shapes
    Vec<D> last = Vec<D>::Zero();  // at the end of the previous step
  };
  struct Part {  // of a fixed shape
    Aabb<D> box;
    Real farthest;  // largest box.hi[0] of this part and all parts before it
    ShapeView<D> view;
    Pose<D> X_WP;
    std::int32_t shape;
  };
  struct Place {  // of a fixed body, as in m_parts
    std::int32_t slot;
    std::uint32_t generation;
    Pose<D> pose;
    bool same(const Place& o) const {
      return slot == o.slot && generation == o.generation && pose.p == o.pose.p && pose.q.matrix() == o.pose.q.matrix();
    }
  };
  bool collectFixed(const Simulation<D>& world);  // returns whether anything changed
  void move(const Simulation<D>& world, std::size_t slot, const Vec<D>& to);
  static bool mayCollide(const Simulation<D>& world, std::int32_t body, std::int32_t shape);

  std::vector<Body> m_bodies;  // by slot
  std::vector<Part> m_parts;   // sorted by box.lo[0]
  std::vector<Place> m_fixed;
  int m_count = 0;
};

}}  // namespace lpc::LPC_PRECISION
