// SPDX-License-Identifier: Zlib
// Places 3D pairs and brings their points back, number by number; triple.h says why.
#pragma once

#include "algorithms/contacts/patch/contact_patch.h"
#include "algorithms/pair_query/gjk/triple.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

inline bool isNoTurn(const Rot<3>& q) { return q.w == 1 && q.x == 0 && q.y == 0 && q.z == 0; }

template <>
inline PlacedPair<3> placePair(const ContactInput<3>& in, const ConvexPair<3>& pair, Real bias) {
  const auto poseOf = [&](std::int32_t shape) -> const Pose<3>& { return in.pose[in.shapes[shape].body]; };
  PlacedPair<3> out;
  out.pair = &pair;
  out.swapped = pair.a.kind > pair.b.kind;
  const Pose<3>& X_W1 = poseOf(out.swapped ? pair.shapes.b : pair.shapes.a);
  const Pose<3>& X_W2 = poseOf(out.swapped ? pair.shapes.a : pair.shapes.b);
  const Pose<3>&X_C1 = out.X_C1(), &X_C2 = out.X_C2();
  out.R_W1 = isNoTurn(X_C1.q) ? X_W1.q : X_W1.q * X_C1.q;
  const Rot<3> R_1W = out.R_W1.inverse();
  // Subtracts the bodies' positions first: far from the origin their difference is exact, the sum of pose and offset is
  // not.
  const Triple between = Triple(X_W2.p) - Triple(X_W1.p), p1 = X_W1.q * Triple(X_C1.p), p2 = X_W2.q * Triple(X_C2.p),
               p_12 = R_1W * Triple(between + (p2 - p1));
  p_12.store(out.X_12.p);
  out.X_12.q = R_1W * (isNoTurn(X_C2.q) ? X_W2.q : X_W2.q * X_C2.q);
  const ShapeView<3>&s1 = out.view1(), &s2 = out.view2();
  out.limit = in.margin + s1.radius + s2.radius;
  out.rounding = kNoise * (coreReach(s1) + coreReach(s2) + sumOfSizes(p_12));
  out.tolerance = std::max(std::min(bias, kThinPart * std::min(coreThickness(s1), coreThickness(s2))), out.rounding);
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  if (!(out.rounding < kInfinity)) out.limit = -kInfinity;  // body with a pose that is not finite: nothing touches it
  return out;
}

/// X * v. Most shapes have their body's orientation; then it is a sum.
inline Triple atPose(const Pose<3>& X, const Triple& v) {
  const Triple p(X.p);
  if (isNoTurn(X.q)) return p + v;
  return p + X.q * v;
}

template <>
inline void addPatch(const ContactInput<3>& in, const PlacedPair<3>& placed, const Vec<3>& n,
                     std::span<PatchPoint<3>> points, std::vector<Manifold<3>>& fresh) {
  if (points.empty()) return;
  LPC_ASSERT(points.size() <= static_cast<std::size_t>(kManifoldPoints<3>));
  Manifold<3>& m = fresh.emplace_back(StartedManifold<3>{in, *placed.pair});
  const Real r1 = placed.view1().radius, r2 = placed.view2().radius;
  const Triple n_1(n), n_W = placed.R_W1 * n_1;
  (placed.swapped ? -n_W : n_W).store(m.normal);
  m.count = static_cast<std::int32_t>(points.size());
  if (placed.swapped) {
    for (PatchPoint<3>& p : points) p.feature = p.feature << 32 | p.feature >> 32;
  }
  IndexedArray<std::size_t, kManifoldPoints<3>> order{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t k = i;
    for (; k > 0 && points[i].feature < points[order[k - 1]].feature; --k) order[k] = order[k - 1];
    order[k] = i;
  }
  const Rot<3> R_21 = placed.X_12.q.inverse();
  const Triple p_21 = -(R_21 * Triple(placed.X_12.p));
  const Pose<3>&X_C1 = placed.X_C1(), &X_C2 = placed.X_C2();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PatchPoint<3>& p = points[order[i]];
    ContactPoint<3>& c = m.points[i];
    const Triple p_1 = Triple(p.p1) + r1 * n_1, p_2 = p_21 + R_21 * Triple(Triple(p.p2) - r2 * n_1);
    atPose(X_C1, p_1).store(placed.swapped ? c.localB : c.localA);
    atPose(X_C2, p_2).store(placed.swapped ? c.localA : c.localB);
    c.separation = p.separation - r1 - r2;
    c.feature = p.feature;
    if (i > 0 && c.feature <= m.points[i - 1].feature) c.feature = m.points[i - 1].feature + 1;
  }
}

}}}  // namespace lpc::LPC_PRECISION::contacts
