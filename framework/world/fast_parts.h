// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "framework/stage/stage_continuous.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/world/box_index.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How bodies go through a step: body i from start[i] at constant velocity[i].
template <int D>
struct Ways {
  std::span<const Pose<D>> start;  // X_WC
  std::span<const Motion<D>> velocity;
  Real dt;

  ShapeMotion<D> of(std::int32_t body, const Pose<D>& X_CS) const {
    const auto i = static_cast<std::size_t>(body);
    return {start[i], X_CS, velocity[i]};
  }
};

/// Which convex parts go far in a step, and whom they may meet on their way.
template <int D>
class FastParts {
 public:
  struct Part {
    std::int32_t body, shape, number;  // slots, and which of the shape's parts
    ShapeView<D> view;
    Pose<D> X_CP;
    Girth<D> girth;
    Real goes;    // m, no point of it farther
    Aabb<D> box;  // of its whole way
    bool fast;    // by the threshold; also of a kinematic body, which nobody stops
    bool operator<(const Part& o) const { return std::tie(body, shape, number) < std::tie(o.body, o.shape, o.number); }
  };
  struct Pair {
    Part a, b;  // a < b
  };

  FastParts();

  /// The slot has another shape now.
  void forget(std::size_t shape);
  /// All pairs of a fast part and one whose way comes near its own, of two bodies and as their filters allow; in the
  /// order of their parts. `boxes` are those of the start.
  std::span<const Pair> find(const Ways<D>& ways, Real threshold, const Bodies<D>& bodies,
                             std::span<const ShapeRecord<D>> shapes, const BoxIndex<D>& boxes, WorkDone& work);

 private:
  template <class F>
  void forParts(std::size_t shape, const Ways<D>& ways, Real threshold, const Bodies<D>& bodies,
                const ShapeRecord<D>& record, const Aabb<D>& near, const F& f);
  Girth<D> girthOf(const ShapeView<D>& part);

  std::unique_ptr<PairQuery<D>> m_query;        // how deep a part's centre is in it
  std::vector<std::vector<Girth<D>>> m_girths;  // by shape slot, of each part; none: not known
  // Scratch.
  std::vector<Part> m_fast;
  std::vector<ProxyId> m_near;
  std::vector<std::int32_t> m_parts;  // numbers of a surface's
  WorkDone* m_work = nullptr;         // of the step under way
  std::vector<Pair> m_pairs;
};

}}  // namespace lpc::LPC_PRECISION
