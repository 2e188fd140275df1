// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "framework/stage/stage_continuous.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/world/box_index.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Motions of all bodies in a step: body i starts at start[i] and moves at constant velocity[i].
template <int D>
struct BodySweeps {
  std::span<const Pose<D>> start;  // X_WC
  std::span<const Motion<D>> velocity;
  Real dt;

  ShapeMotion<D> of(std::int32_t body, const Pose<D>& X_CS) const {
    const auto i = static_cast<std::size_t>(body);
    return {start[i], X_CS, velocity[i]};
  }
};

/// Finds the convex parts that move far in a step, and the parts that they may hit.
template <int D>
class FastParts {
 public:
  struct Part {
    std::int32_t body, shape, number;  // slots, and the index of the part in the shape
    ShapeView<D> view;
    Pose<D> X_CP;
    InnerOuterRadii<D> radii;
    Real maxTravel;  // m, upper bound of the distance that its points travel
    Aabb<D> box;     // of the whole swept part
    bool fast;       // travels farther than the threshold; also set for kinematic parts, which are never stopped
    bool operator<(const Part& o) const { return std::tie(body, shape, number) < std::tie(o.body, o.shape, o.number); }
  };
  struct Pair {
    Part a, b;  // a < b
  };

  FastParts();

  /// Drops the data of the shape in this slot, after the shape was replaced.
  void forget(std::size_t shape);
  /// Finds all pairs of a fast part and another part with overlapping swept boxes, on two different bodies whose
  /// filters allow it. Sorted by parts. `boxes` are those of the start of the step.
  std::span<const Pair> find(const BodySweeps<D>& sweeps, Real threshold, const Bodies<D>& bodies,
                             std::span<const ShapeRecord<D>> shapes, const BoxIndex<D>& boxes, WorkDone& work);

 private:
  template <class F>
  void forParts(std::size_t shape, const BodySweeps<D>& sweeps, Real threshold, const Bodies<D>& bodies,
                const ShapeRecord<D>& record, const Aabb<D>& near, const F& f);
  InnerOuterRadii<D> innerOuterRadii(const ShapeView<D>& part);

  std::unique_ptr<PairQuery<D>> m_query;                 // measures the depth of a part's centre
  std::vector<std::vector<InnerOuterRadii<D>>> m_radii;  // by shape slot, for each part; empty: not computed yet
  // Scratch.
  std::vector<Part> m_fast;
  std::vector<ProxyId> m_near;
  std::vector<std::int32_t> m_parts;  // indices of parts of a surface
  WorkDone* m_work = nullptr;         // of the current step
  std::vector<Pair> m_pairs;
};

}}  // namespace lpc::LPC_PRECISION
