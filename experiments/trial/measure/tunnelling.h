// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <vector>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Who has passed through what is fixed: dynamic bodies whose centre of mass was outside before and after, on a path
/// that led through a fixed shape that they may collide with. Bodies whose centre is not in any of their own shapes may
/// do so honestly, a ring over a post, and are not looked at. From poses alone: for worlds and engines alike.
template <int D>
class Tunnelling {
 public:
  /// Before each step, after what a script did: who has come or was put elsewhere starts anew.
  void place(const Simulation<D>& world);
  void observe(const Simulation<D>& world);  // after each step
  void finish(const Simulation<D>& world);   // after the last step
  int count() const { return m_count; }      // bodies, each once

 private:
  struct Body {
    bool known = false;  // dynamic, and of this generation
    std::uint32_t generation = 0;
    Real reach = 0;  // m, half of its smallest part's smallest extent
    bool holdsCenter = false, tunnelled = false;
    bool outside = false;          // `from` is known
    Vec<D> from = Vec<D>::Zero();  // where it was asked about last and was outside of all that is fixed
    Vec<D> last = Vec<D>::Zero();  // at the end of the step before
  };
  struct Part {  // of a fixed shape
    Aabb<D> box;
    Real farthest;  // largest box.hi[0] of this part and all before
    ShapeView<D> view;
    Pose<D> X_WP;
    std::int32_t shape;
  };
  struct Place {  // of a fixed body, as m_parts have it
    std::int32_t slot;
    std::uint32_t generation;
    Pose<D> pose;
    bool same(const Place& o) const {
      return slot == o.slot && generation == o.generation && pose.p == o.pose.p && pose.q.matrix() == o.pose.q.matrix();
    }
  };
  bool collectFixed(const Simulation<D>& world);  // true: it is not as before
  void move(const Simulation<D>& world, std::size_t slot, const Vec<D>& to);
  static bool mayCollide(const Simulation<D>& world, std::int32_t body, std::int32_t shape);

  std::vector<Body> m_bodies;  // by slot
  std::vector<Part> m_parts;   // sorted by box.lo[0]
  std::vector<Place> m_fixed;
  int m_count = 0;
};

}}  // namespace lpc::LPC_PRECISION
