// SPDX-License-Identifier: Zlib
#include "algorithms/pair_query/gjk/face_planes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/gjk/face_planes_lanes.cpp"
#include "hwy/foreach_target.h"
// Must follow the header of Highway that includes this file again and again.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<Real, FacePlanes::kFan>;
using Lanes = hn::Vec<Tag>;

struct LaneTriple {
  Lanes x, y, z;
};

HWY_INLINE LaneTriple load(const Tag d, const FacePlanes& f, std::size_t at) {
  return {hn::LoadU(d, &f.ring[0][at]), hn::LoadU(d, &f.ring[1][at]), hn::LoadU(d, &f.ring[2][at])};
}
HWY_INLINE LaneTriple minus(const LaneTriple& u, const LaneTriple& v) {
  return {hn::Sub(u.x, v.x), hn::Sub(u.y, v.y), hn::Sub(u.z, v.z)};
}
HWY_INLINE LaneTriple crossed(const LaneTriple& u, const LaneTriple& v) {
  return {hn::Sub(hn::Mul(u.y, v.z), hn::Mul(u.z, v.y)), hn::Sub(hn::Mul(u.z, v.x), hn::Mul(u.x, v.z)),
          hn::Sub(hn::Mul(u.x, v.y), hn::Mul(u.y, v.x))};
}
// Adds in the order of Vec::dot, in either precision.
HWY_INLINE Lanes dotted(const LaneTriple& u, const LaneTriple& v) {
  const Lanes x = hn::Mul(u.x, v.x), y = hn::Mul(u.y, v.y), z = hn::Mul(u.z, v.z);
  return sizeof(Real) == 8 ? hn::Add(hn::Add(x, y), z) : hn::Add(x, hn::Add(y, z));
}
HWY_INLINE Lanes larger(Lanes u, Lanes v) { return hn::IfThenElse(hn::Gt(v, u), v, u); }

void findPlanes(FacePlanes& f, int count) {
  const Tag d;
  const LaneTriple c{hn::Set(d, f.apex[0]), hn::Set(d, f.apex[1]), hn::Set(d, f.apex[2])};
  for (std::size_t at = 0; at < static_cast<std::size_t>(count); at += hn::Lanes(d)) {
    const LaneTriple a = load(d, f, at), b = load(d, f, at + 1);
    const LaneTriple n = crossed(minus(b, a), minus(c, a));
    const Lanes square = dotted(n, n), length = hn::Sqrt(square);
    const LaneTriple unit{hn::Div(n.x, length), hn::Div(n.y, length), hn::Div(n.z, length)};
    hn::StoreU(unit.x, d, &f.outward[0][at]), hn::StoreU(unit.y, d, &f.outward[1][at]);
    hn::StoreU(unit.z, d, &f.outward[2][at]), hn::StoreU(square, d, &f.square[at]);
    hn::StoreU(larger(larger(dotted(unit, a), dotted(unit, b)), dotted(unit, c)), d, &f.offset[at]);
  }
}

}  // namespace HWY_NAMESPACE
}}}  // namespace lpc::LPC_PRECISION::pair_query
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

HWY_EXPORT(findPlanes);
void FacePlanes::find(int count) { HWY_DYNAMIC_DISPATCH(findPlanes)(*this, count); }

}}}  // namespace lpc::LPC_PRECISION::pair_query
#endif
