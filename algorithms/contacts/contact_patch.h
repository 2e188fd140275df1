// SPDX-License-Identifier: Zlib
// What all contact generators share: two shapes brought into one frame, and contact points brought back to the bodies.
//
// Kernels see a pair in the order of the kinds ("1" is the lower one) and in the frame of shape 1, and they see cores:
// the radii are added here, at the end, because rounding both shapes moves each witness along the normal and nothing
// else.
#pragma once

#include <algorithm>
#include <bit>
#include <limits>

#include "algorithms/contacts/tolerances.h"
#include "algorithms/contacts/xy.h"
#include "algorithms/pair_query/triple.h"
#include "framework/curved_core.h"
#include "framework/stage_narrowphase.h"

namespace lpc::inline LPC_PRECISION::contacts {

using pair_query::Triple;

/// A vector for arithmetic on its numbers one by one (triple.h says why).
template <int D>
using Plain = std::conditional_t<D == 3, Triple, Vec<2>>;
inline Real sumOfSizes(const Vec<2>& v) { return v.lpNorm<1>(); }
inline void store(const Vec<2>& v, Vec<2>& out) { out = v; }
inline void store(const Triple& v, Vec<3>& out) { v.store(out); }

/// Witnesses on the two cores, in the frame of shape 1, and (p2 - p1) . n.
template <int D>
struct PatchPoint {
  Vec<D> p1, p2;
  Real separation;        // of the cores, m
  std::uint64_t feature;  // see featureNumber()
};

inline bool isNoTurn(const Rot<2>& q) { return q.c == 1 && q.s == 0; }
inline bool isNoTurn(const Rot<3>& q) { return q.w == 1 && q.x == 0 && q.y == 0 && q.z == 0; }

/// A feature of a shape is a vertex (i, i) or an edge (i, j); none is (65535, 65535). Two bytes each, shape A's
/// feature above B's. So a number does not depend on which face served as reference, and a vertex keeps its number when
/// the face around it changes. Beyond 65,536 vertices numbers may coincide: `addPatch` keeps them apart.
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
  bool swapped;    // shape 1 is on body B
  bool framed;     // 2D: a shape has a frame other than its body's
  Real limit;      // core separations beyond it are no contacts, m
  Real rounding;   // below this, lengths are noise, m
  Real tolerance;  // depths that differ by less than this are alike, m

  const ShapeView<D>& view1() const { return swapped ? pair->b : pair->a; }
  const ShapeView<D>& view2() const { return swapped ? pair->a : pair->b; }
  const Pose<D>& X_C1() const { return swapped ? pair->X_CB : pair->X_CA; }  // in its body's frame
  const Pose<D>& X_C2() const { return swapped ? pair->X_CA : pair->X_CB; }
};

/// Half the thickness of a core where it is known at no cost, otherwise half of some chord: a length that the
/// tolerances must stay well below.
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

/// Some length not below a quarter of the core's reach from its own origin; a plane's is 0.
template <int D>
Real coreReach(const ShapeView<D>& s) {
  if (s.core() != CoreClass::hull) return sumOfSizes(Plain<D>(s.half));
  const auto& v = s.hull->vertices;
  return v[0].template lpNorm<1>() + (v[v.size() / 2] - v[0]).template lpNorm<1>();
}

/// `bias`: depths that differ by less than this (m) are alike, so that ties do not flip from step to step. It is cut
/// to 1 % of the thinner shape, and never below rounding.
template <int D>
PlacedPair<D> placePair(const ContactInput<D>& in, const ConvexPair<D>& pair, Real bias) {
  const auto poseOf = [&](std::int32_t shape) -> const Pose<D>& {
    return in.pose[static_cast<std::size_t>(in.shapes[static_cast<std::size_t>(shape)].body)];
  };
  PlacedPair<D> out;
  out.pair = &pair;
  out.swapped = pair.a.kind > pair.b.kind, out.framed = true;
  const Pose<D>& X_W1 = poseOf(out.swapped ? pair.shapes.b : pair.shapes.a);
  const Pose<D>& X_W2 = poseOf(out.swapped ? pair.shapes.a : pair.shapes.b);
  const Pose<D>&X_C1 = out.X_C1(), &X_C2 = out.X_C2();
  out.R_W1 = isNoTurn(X_C1.q) ? X_W1.q : X_W1.q * X_C1.q;
  const Rot<D> R_1W = out.R_W1.inverse();
  // Bodies are subtracted first: far from the origin their difference is exact, the sum of pose and offset is not.
  const Plain<D> between = Plain<D>(X_W2.p) - Plain<D>(X_W1.p), p1 = X_W1.q * Plain<D>(X_C1.p),
                 p2 = X_W2.q * Plain<D>(X_C2.p), p_12 = R_1W * Plain<D>(between + (p2 - p1));
  store(p_12, out.X_12.p);
  out.X_12.q = R_1W * (isNoTurn(X_C2.q) ? X_W2.q : X_W2.q * X_C2.q);
  const ShapeView<D>&s1 = out.view1(), &s2 = out.view2();
  out.limit = in.margin + s1.radius + s2.radius;
  out.rounding = kNoise * (coreReach(s1) + coreReach(s2) + sumOfSizes(p_12));
  out.tolerance = std::max(std::min(bias, kThinPart * std::min(coreThickness(s1), coreThickness(s2))), out.rounding);
  return out;
}

/// X * v. Most shapes lie in their body's frame as they are: then it is a sum.
template <int D>
Plain<D> atPose(const Pose<D>& X, const Plain<D>& v) {
  const Plain<D> p(X.p);
  if (isNoTurn(X.q)) return p + v;
  return p + X.q * v;
}

/// A manifold that is made where it shall be, and not copied there.
template <int D>
struct StartedManifold {
  const ContactInput<D>& in;
  const ConvexPair<D>& pair;
  operator Manifold<D>() const { return startManifold(in, pair); }
};

/// Appends the manifold with these points (at most kManifoldPoints) and the unit normal n_12 (in frame 1).
template <int D>
void addPatch(const ContactInput<D>& in, const PlacedPair<D>& placed, const Vec<D>& n, std::span<PatchPoint<D>> points,
              std::vector<Manifold<D>>& fresh) {
  if (points.empty()) return;
  LPC_ASSERT(points.size() <= static_cast<std::size_t>(kManifoldPoints<D>));
  Manifold<D>& m = fresh.emplace_back(StartedManifold<D>{in, *placed.pair});
  const Real r1 = placed.view1().radius, r2 = placed.view2().radius;
  const Plain<D> n_1(n), n_W = placed.R_W1 * n_1;
  store(placed.swapped ? Plain<D>(-n_W) : n_W, m.normal);
  m.count = static_cast<std::int32_t>(points.size());
  if (placed.swapped) {
    for (PatchPoint<D>& p : points) p.feature = p.feature << 32 | p.feature >> 32;
  }
  std::array<std::size_t, static_cast<std::size_t>(kManifoldPoints<D>)> order{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t k = i;
    for (; k > 0 && points[i].feature < points[order[k - 1]].feature; --k) order[k] = order[k - 1];
    order[k] = i;
  }
  const Rot<D> R_21 = placed.X_12.q.inverse();
  const Plain<D> p_21 = -(R_21 * Plain<D>(placed.X_12.p));
  const Pose<D>&X_C1 = placed.X_C1(), &X_C2 = placed.X_C2();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PatchPoint<D>& p = points[order[i]];
    ContactPoint<D>& c = m.points[i];
    const Plain<D> p_1 = Plain<D>(p.p1) + r1 * n_1, p_2 = p_21 + R_21 * Plain<D>(Plain<D>(p.p2) - r2 * n_1);
    store(atPose<D>(X_C1, p_1), placed.swapped ? c.localB : c.localA);
    store(atPose<D>(X_C2, p_2), placed.swapped ? c.localA : c.localB);
    c.separation = p.separation - r1 - r2;
    c.feature = p.feature;
    if (i > 0 && c.feature <= m.points[i - 1].feature) c.feature = m.points[i - 1].feature + 1;
  }
}

// In 2D a pair takes so little that these two, as they stand above, are most of it. Here they are with Xy, number for
// number the same.

/// Are both the frames of the bodies themselves, to the bit? Then nothing is to be turned between them.
inline bool isBodysFrame(const Pose<2>& X_C1, const Pose<2>& X_C2) {
  using Bits = std::conditional_t<sizeof(Real) == 8, std::uint64_t, std::uint32_t>;
  const auto bits = [](Real x) { return std::bit_cast<Bits>(x); };
  const auto other = [&](const Pose<2>& X) {
    return bits(X.p[0]) | bits(X.p[1]) | bits(X.q.s) | (bits(X.q.c) ^ bits(Real(1)));
  };
  return (other(X_C1) | other(X_C2)) == 0;
}

/// Of a box and a hull, which are most of what meets, by one question and without a root.
struct CoreSizes2 {
  Real reach;      // as coreReach, m
  Real thickness;  // coreThickness, m, or a bound from below that does not cut the bias

  CoreSizes2(const ShapeView<2>& s, Real bias) {
    const CoreClass core = s.core();
    if (core == CoreClass::box) {
      reach = std::abs(s.half[0]) + std::abs(s.half[1]), thickness = std::min(s.half[0], s.half[1]);
      return;
    }
    reach = coreReach(s);
    if (core == CoreClass::hull) {
      const auto& v = s.hull->vertices;
      const Xy chord = Xy(v[v.size() / 2]) - Xy(v[0]);
      thickness = std::max(std::abs(chord.x()), std::abs(chord.y())) / 2;
      if (kThinPart * thickness > bias) return;
    }
    thickness = coreThickness(s);
  }
};

template <>
inline PlacedPair<2> placePair<2>(const ContactInput<2>& in, const ConvexPair<2>& pair, Real bias) {
  const auto poseOf = [&](std::int32_t shape) -> const Pose<2>& {
    return in.pose[static_cast<std::size_t>(in.shapes[static_cast<std::size_t>(shape)].body)];
  };
  PlacedPair<2> out;
  out.pair = &pair;
  out.swapped = pair.a.kind > pair.b.kind;
  const Pose<2>& X_W1 = poseOf(out.swapped ? pair.shapes.b : pair.shapes.a);
  const Pose<2>& X_W2 = poseOf(out.swapped ? pair.shapes.a : pair.shapes.b);
  const Pose<2>&X_C1 = out.X_C1(), &X_C2 = out.X_C2();
  out.framed = !isBodysFrame(X_C1, X_C2);
  Xy between = Xy(X_W2.p) - Xy(X_W1.p);
  Rot<2> R_W1 = X_W1.q, R_W2 = X_W2.q;
  if (out.framed) {
    between = between + (turned(R_W2, X_C2.p) - turned(R_W1, X_C1.p));
    R_W1 = R_W1 * X_C1.q, R_W2 = R_W2 * X_C2.q;
  }
  const Xy p_12 = turnedBack(R_W1, between);
  p_12.to(out.X_12.p);
  turnedBack(R_W1, Xy(R_W2)).to(out.X_12.q);
  out.R_W1 = R_W1;
  const ShapeView<2>&s1 = out.view1(), &s2 = out.view2();
  const CoreSizes2 size1(s1, bias), size2(s2, bias);
  out.limit = in.margin + s1.radius + s2.radius;
  out.rounding = kNoise * (size1.reach + size2.reach + (std::abs(p_12.x()) + std::abs(p_12.y())));
  out.tolerance = std::max(std::min(bias, kThinPart * std::min(size1.thickness, size2.thickness)), out.rounding);
  return out;
}

template <>
inline void addPatch<2>(const ContactInput<2>& in, const PlacedPair<2>& placed, const Vec<2>& n,
                        std::span<PatchPoint<2>> points, std::vector<Manifold<2>>& fresh) {
  if (points.empty()) return;
  LPC_ASSERT(points.size() <= static_cast<std::size_t>(kManifoldPoints<2>));
  struct Started {  // made where it stays, not copied there
    const ContactInput<2>& in;
    const ConvexPair<2>& pair;
    operator Manifold<2>() const { return startManifold(in, pair); }
  };
  Manifold<2>& m = fresh.emplace_back(Started{in, *placed.pair});
  const Real r1 = placed.view1().radius, r2 = placed.view2().radius;
  const Pose<2>&X_C1 = placed.X_C1(), &X_C2 = placed.X_C2();
  const Xy n_1 = n, n_W = turned(placed.R_W1, n_1), r1n = r1 * n_1, r2n = r2 * n_1;
  const Xy p_21 = -turnedBack(placed.X_12.q, placed.X_12.p);
  (placed.swapped ? -n_W : n_W).to(m.normal);
  m.count = static_cast<std::int32_t>(points.size());
  const int turn = placed.swapped ? 32 : 0;
  const auto featureOf = [&](const PatchPoint<2>& p) { return std::rotl(p.feature, turn); };
  const std::size_t lower = points.size() == 2 && featureOf(points[1]) < featureOf(points[0]) ? 1 : 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PatchPoint<2>& p = points[i ^ lower];
    ContactPoint<2>& c = m.points[i];
    Xy local1 = Xy(p.p1) + r1n, local2 = p_21 + turnedBack(placed.X_12.q, Xy(p.p2) - r2n);
    if (placed.framed) local1 = turned(X_C1.q, local1), local2 = turned(X_C2.q, local2);
    (Xy(X_C1.p) + local1).to(placed.swapped ? c.localB : c.localA);
    (Xy(X_C2.p) + local2).to(placed.swapped ? c.localA : c.localB);
    c.separation = p.separation - r1 - r2;
    c.feature = featureOf(p);
  }
  if (points.size() == 2 && m.points[1].feature == m.points[0].feature) ++m.points[1].feature;
}

}  // namespace lpc::inline LPC_PRECISION::contacts
