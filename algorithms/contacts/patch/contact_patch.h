// SPDX-License-Identifier: Zlib
// Shared by all contact generators: bringing two shapes into one frame, and contact points back to the bodies.
//
// Kernels see a pair in the order of the kinds ("1" is the lower one), in the frame of shape 1, and as cores. The radii
// are added here at the end, because rounding both shapes only moves each closest point along the normal.
#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/contacts/tolerances.h"
#include "algorithms/pair_query/gjk/triple.h"
#include "framework/shape/curved_core.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

using pair_query::Triple;

/// Closest points on the two cores, in the frame of shape 1, and (p2 - p1) . n.
template <int D>
struct PatchPoint {
  Vec<D> p1, p2;
  Real separation;        // of the cores, m
  std::uint64_t feature;  // see featureNumber()
};

/// Code of a feature: a vertex (i, i) or an edge (i, j); none is (65535, 65535). Two bytes each, shape A's feature
/// above B's. The number does not depend on which face was the reference, and a vertex keeps its number when the face
/// around it changes. Beyond 65,536 vertices numbers may coincide; `addPatch` then makes them different.
inline std::uint32_t featureCode(int i, int j) {
  const auto lo = static_cast<std::uint32_t>(std::min(i, j)), hi = static_cast<std::uint32_t>(std::max(i, j));
  return lo << 16 | (hi & 0xffffu);
}
inline std::uint32_t featureCode(int vertex) { return featureCode(vertex, vertex); }
inline constexpr std::uint32_t kNoFeature = 0xffffffff;
inline std::uint64_t featureNumber(std::uint32_t code1, std::uint32_t code2) {
  return std::uint64_t(code1) << 32 | code2;
}

template <int D>
struct PlacedPair {
  const ConvexPair<D>* pair;
  Rot<D> R_W1;
  Pose<D> X_12;
  bool swapped;        // shape 1 is on body B
  bool framed = true;  // 2D: a shape's frame differs from its body's
  Real limit;          // larger core separations give no contact, m
  Real rounding;       // shorter lengths are rounding, m
  Real tolerance;      // depths that differ by less count as equal, m

  const ShapeView<D>& view1() const { return swapped ? pair->b : pair->a; }
  const ShapeView<D>& view2() const { return swapped ? pair->a : pair->b; }
  const Pose<D>& X_C1() const { return swapped ? pair->X_CB : pair->X_CA; }  // in its body's frame
  const Pose<D>& X_C2() const { return swapped ? pair->X_CA : pair->X_CB; }
};

/// Half the thickness of a core if it is known at no cost, otherwise half of some chord: a length that tolerances must
/// stay well below.
template <int D>
Real coreThickness(const ShapeView<D>& s) {
  switch (s.core()) {
    case CoreClass::point:
    case CoreClass::plane:
      return std::numeric_limits<Real>::max();
    case CoreClass::segment:
      return s.half[0];
    case CoreClass::box:
    case CoreClass::curved:
      return s.half.minCoeff();
    case CoreClass::hull:
      return (s.hull->vertices[s.hull->vertices.size() / 2] - s.hull->vertices[0]).norm() / 2;
  }
  return 0;
}

/// A length not below a quarter of the core's reach from its own origin; 0 for a plane.
template <int D>
Real coreReach(const ShapeView<D>& s) {
  if (s.core() != CoreClass::hull) {
    if constexpr (D == 3) return sumOfSizes(Triple(s.half));
    return s.half.template lpNorm<1>();
  }
  const auto& v = s.hull->vertices;
  return v[0].template lpNorm<1>() + (v[v.size() / 2] - v[0]).template lpNorm<1>();
}

/// `bias`: depths that differ by less than this (m) count as equal, so that ties do not flip from step to step. It is
/// limited to 1 % of the thinner shape, and never below rounding.
template <int D>
PlacedPair<D> placePair(const ContactInput<D>& in, const ConvexPair<D>& pair, Real bias);

/// A manifold that is built in place and not copied.
template <int D>
struct StartedManifold {
  const ContactInput<D>& in;
  const ConvexPair<D>& pair;
  operator Manifold<D>() const { return startManifold(in, pair); }
};

/// Appends the manifold with these points (at most kManifoldPoints) and the unit normal n_12 (in frame 1).
template <int D>
void addPatch(const ContactInput<D>& in, const PlacedPair<D>& placed, const Vec<D>& n, std::span<PatchPoint<D>> points,
              std::vector<Manifold<D>>& fresh);

}}}  // namespace lpc::LPC_PRECISION::contacts

#include "algorithms/contacts/patch/contact_patch2.h"
#include "algorithms/contacts/patch/contact_patch3.h"
