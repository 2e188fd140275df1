// SPDX-License-Identifier: Zlib
// Places 2D pairs and brings their points back, with vectors in registers: these two take most of the time of a 2D
// pair.
#pragma once

#include <bit>

#include "algorithms/contacts/clip/xy.h"
#include "algorithms/contacts/patch/contact_patch.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// Whether both frames are bitwise the frames of the bodies; then no rotation is needed.
inline bool isBodysFrame(const Pose<2>& X_C1, const Pose<2>& X_C2) {
  using Bits = std::conditional_t<sizeof(Real) == 8, std::uint64_t, std::uint32_t>;
  const auto bits = [](Real x) { return std::bit_cast<Bits>(x); };
  const auto other = [&](const Pose<2>& X) {
    return bits(X.p[0]) | bits(X.p[1]) | bits(X.q.s) | (bits(X.q.c) ^ bits(Real(1)));
  };
  return (other(X_C1) | other(X_C2)) == 0;
}

/// Sizes of a box or a hull, the most frequent shapes, with one branch and no square root.
struct CoreSizes2 {
  Real reach;      // as coreReach, m
  Real thickness;  // coreThickness, m, or a lower bound that does not limit the bias

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
  const auto poseOf = [&](std::int32_t shape) -> const Pose<2>& { return in.pose[in.shapes[shape].body]; };
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
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  if (!(out.rounding < kInfinity)) out.limit = -kInfinity;  // body with a pose that is not finite: nothing touches it
  return out;
}

template <>
inline void addPatch<2>(const ContactInput<2>& in, const PlacedPair<2>& placed, const Vec<2>& n,
                        std::span<PatchPoint<2>> points, std::vector<Manifold<2>>& fresh) {
  if (points.empty()) return;
  LPC_ASSERT(points.size() <= static_cast<std::size_t>(kManifoldPoints<2>));
  Manifold<2>& m = fresh.emplace_back(StartedManifold<2>{in, *placed.pair});
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

}}}  // namespace lpc::LPC_PRECISION::contacts
