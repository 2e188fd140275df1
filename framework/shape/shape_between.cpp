// SPDX-License-Identifier: Zlib
#include "framework/shape/shape_between.h"

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Rotation of the x axis to a direction (unit).
Rot<2> fromX(const Vec<2>& d) { return {d[0], d[1]}; }
Rot<3> fromX(const Vec<3>& d) {
  // (1 + x) / 2 is the squared cosine of half the angle. When it is small: first half a turn about z, then from -x.
  if (d[0] >= 0) return Rot<3>{1 + d[0], 0, -d[2], d[1]}.normalized();
  return Rot<3>{1 - d[0], 0, d[2], -d[1]}.normalized() * Rot<3>{0, 0, 0, 1};
}

template <int D>
Pose<D> along(const Vec<D>& from, const Vec<D>& to) {
  const Vec<D> way = to - from;
  const Real length = way.norm();
  return {from + way / 2, length > 0 ? fromX(Vec<D>(way / length)) : Rot<D>{}};
}

}  // namespace

template <int D>
ShapeDef<D> boxBetween(const Vec<D>& corner, const Vec<D>& opposite, const Rot<D>& q) {
  const Vec<D> half = (q.inverse() * Vec<D>(opposite - corner)).cwiseAbs() / 2;
  return {.shape = Shape<D>::box(half), .X_BS = {(corner + opposite) / 2, q}};
}

template <int D>
ShapeDef<D> capsuleBetween(const Vec<D>& from, const Vec<D>& to, Real radius) {
  const Real length = (to - from).norm();
  return {.shape = length > 0 ? Shape<D>::capsule(length / 2, radius) : Shape<D>::sphere(radius),
          .X_BS = along<D>(from, to)};
}

ShapeDef<2> segmentBetween(const Vec<2>& from, const Vec<2>& to) {
  return {.shape = Shape<2>::segment((to - from).norm() / 2), .X_BS = along<2>(from, to)};
}

#define LPC_INSTANTIATE(D)                                                      \
  template ShapeDef<D> boxBetween(const Vec<D>&, const Vec<D>&, const Rot<D>&); \
  template ShapeDef<D> capsuleBetween(const Vec<D>&, const Vec<D>&, Real)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
