// SPDX-License-Identifier: Zlib
#include "algorithms/pair_query/core/hull_support.h"
#include "framework/math/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/core/hull_support_lanes.cpp"
#include "hwy/foreach_target.h"
// Must follow the header of Highway that includes this file again and again.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<Real, kManyVertices / 2>;
using Lanes = hn::Vec<Tag>;

// Per lane, the first of the farthest vertices; its index is stored as a number (a float holds 2^24 of them).
struct Farthest {
  Lanes far, index;
};

// The first of the two on a tie: every index of `first` is below that of `second`, or is the same vertex.
HWY_INLINE Farthest farther(const Farthest& first, const Farthest& second) {
  const auto more = hn::Gt(second.far, first.far);
  return {hn::IfThenElse(more, second.far, first.far), hn::IfThenElse(more, second.index, first.index)};
}
// The one with the lower index on a tie.
HWY_INLINE Farthest fartherOrFirst(const Farthest& u, const Farthest& v) {
  const auto tie = hn::And(hn::Eq(v.far, u.far), hn::Lt(v.index, u.index));
  const auto more = hn::Or(hn::Gt(v.far, u.far), tie);
  return {hn::IfThenElse(more, v.far, u.far), hn::IfThenElse(more, v.index, u.index)};
}

// Reduces all lanes: each lane is compared with the one across, until the first has seen all.
HWY_INLINE std::size_t indexOf(Farthest f) {
  const Tag d;
  f = fartherOrFirst(f, {hn::Reverse(d, f.far), hn::Reverse(d, f.index)});
  if (hn::Lanes(d) > 4) f = fartherOrFirst(f, {hn::Reverse4(d, f.far), hn::Reverse4(d, f.index)});
  if (hn::Lanes(d) > 2) f = fartherOrFirst(f, {hn::Reverse2(d, f.far), hn::Reverse2(d, f.index)});
  return static_cast<std::size_t>(static_cast<std::int64_t>(hn::GetLane(f.index)));
}

std::size_t farthestOf(const Real* HWY_RESTRICT vertices, std::size_t count, Real dx, Real dy, Real dz) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Lanes alongX = hn::Set(d, dx), alongY = hn::Set(d, dy), alongZ = hn::Set(d, dz);
  const auto at = [&](std::size_t i, Lanes index) HWY_ATTR {
    Lanes x, y, z;
    hn::LoadInterleaved3(d, vertices + 3 * i, x, y, z);
    x = hn::Mul(x, alongX), y = hn::Mul(y, alongY), z = hn::Mul(z, alongZ);
    return Farthest{sizeof(Real) == 8 ? hn::Add(hn::Add(x, y), z) : hn::Add(x, hn::Add(y, z)), index};
  };
  const Lanes first = hn::Iota(d, 0);
  const auto last = [&] HWY_ATTR {
    return at(count - lanes, hn::Add(first, hn::Set(d, static_cast<Real>(count - lanes))));
  };
  // Two independent runs, so that a comparison does not wait for the previous one. The last vertices may be tested
  // twice, which changes nothing.
  Lanes even = first;
  Farthest low = at(0, even);
  if (count > lanes) {
    const Lanes step = hn::Set(d, static_cast<Real>(2 * lanes));
    Lanes odd = hn::Iota(d, static_cast<Real>(lanes));
    Farthest high = count < 2 * lanes ? last() : at(lanes, odd);
    std::size_t i = 2 * lanes;
    for (; i + 2 * lanes <= count; i += 2 * lanes) {
      even = hn::Add(even, step), odd = hn::Add(odd, step);
      low = farther(low, at(i, even)), high = farther(high, at(i + lanes, odd));
    }
    if (i + lanes <= count) low = farther(low, at(i, hn::Add(even, step)));
    if (i < count) high = farther(high, last());
    low = fartherOrFirst(low, high);
  }
  return indexOf(low);
}

void allWithin(const Real* HWY_RESTRICT vertices, std::size_t count, const Real* HWY_RESTRICT n, Real band,
               std::vector<Vec<3>>& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d), whole = count - count % lanes;
  const auto append = [&](const Real* v) { out.emplace_back(v[0], v[1], v[2]); };
  const auto one = [&](std::size_t i) {
    const Real* v = vertices + 3 * i;
    return summed(v[0] * n[0], v[1] * n[1], v[2] * n[2]);
  };
  const Lanes alongX = hn::Set(d, n[0]), alongY = hn::Set(d, n[1]), alongZ = hn::Set(d, n[2]);
  const auto at = [&](std::size_t i) HWY_ATTR {
    Lanes x, y, z;
    hn::LoadInterleaved3(d, vertices + 3 * i, x, y, z);
    x = hn::Mul(x, alongX), y = hn::Mul(y, alongY), z = hn::Mul(z, alongZ);
    return sizeof(Real) == 8 ? hn::Add(hn::Add(x, y), z) : hn::Add(x, hn::Add(y, z));
  };
  Lanes most = hn::Set(d, one(0));
  for (std::size_t i = 0; i < whole; i += lanes) {
    const Lanes far = at(i);
    most = hn::IfThenElse(hn::Gt(far, most), far, most);
  }
  HWY_ALIGN Real each[kManyVertices / 2];
  hn::Store(most, d, each);
  Real farthest = each[0];
  for (std::size_t k = 1; k < lanes; ++k) farthest = each[k] > farthest ? each[k] : farthest;
  for (std::size_t i = whole; i < count; ++i) farthest = one(i) > farthest ? one(i) : farthest;
  const Lanes least = hn::Set(d, farthest - band);
  for (std::size_t i = 0; i < whole; i += lanes) {
    const auto near = hn::Ge(at(i), least);
    if (hn::AllFalse(d, near)) continue;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, near, bits);
    for (std::size_t k = 0; k < lanes; ++k) {
      if (bits[0] >> k & 1) append(vertices + 3 * (i + k));
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    if (one(i) >= farthest - band) append(vertices + 3 * i);
  }
}

// Two runs of lanes at a time: the number of entries that are filled and tested.
HWY_INLINE std::size_t filled(std::size_t count) {
  const std::size_t step = 2 * hn::Lanes(Tag());
  return (count + step - 1) / step * step;
}

void fillRows(HullPair::Hull& hull) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d), count = hull.count;
  Real *x = hull.rows.data(), *y = x + hull.room, *z = y + hull.room;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    Lanes u, v, w;
    hn::LoadInterleaved3(d, hull.vertices + 3 * i, u, v, w);
    hn::StoreU(u, d, x + i), hn::StoreU(v, d, y + i), hn::StoreU(w, d, z + i);
  }
  for (const std::size_t end = filled(count); i < end; ++i) {
    const Real* v = hull.vertices + (i < count ? 3 * i : 0);
    x[i] = v[0], y[i] = v[1], z[i] = v[2];
  }
}

HWY_INLINE std::size_t farthestInRows(const HullPair::Hull& hull, Real dx, Real dy, Real dz) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d), end = filled(hull.count);
  const Lanes alongX = hn::Set(d, dx), alongY = hn::Set(d, dy), alongZ = hn::Set(d, dz);
  const Real *rowX = hull.rows.data(), *rowY = rowX + hull.room, *rowZ = rowY + hull.room;
  const auto at = [&](std::size_t i) HWY_ATTR {
    const Lanes x = hn::Mul(hn::LoadU(d, rowX + i), alongX), y = hn::Mul(hn::LoadU(d, rowY + i), alongY),
                z = hn::Mul(hn::LoadU(d, rowZ + i), alongZ);
    return sizeof(Real) == 8 ? hn::Add(hn::Add(x, y), z) : hn::Add(x, hn::Add(y, z));
  };
  // Counts the steps of a run, which both runs share.
  const Lanes step = hn::Set(d, static_cast<Real>(2 * lanes));
  Lanes first = hn::Zero(d);
  Farthest low{at(0), first}, high{at(lanes), first};
  for (std::size_t i = 2 * lanes; i < end; i += 2 * lanes) {
    first = hn::Add(first, step);
    low = farther(low, {at(i), first}), high = farther(high, {at(i + lanes), first});
  }
  const Lanes places = hn::Iota(d, 0);
  low.index = hn::Add(low.index, places);
  high.index = hn::Add(high.index, hn::Add(places, hn::Set(d, static_cast<Real>(lanes))));
  return indexOf(fartherOrFirst(low, high));
}

std::size_t findOne(HullPair::Hull& hull, int asked, const Real* HWY_RESTRICT n) {
  if (asked == 0) return farthestOf(hull.vertices, hull.count, n[0], n[1], n[2]);
  if (asked == 1) fillRows(hull);
  return farthestInRows(hull, n[0], n[1], n[2]);
}

void findBoth(HullPair::Hull& a, HullPair::Hull& b, int asked, const Real* HWY_RESTRICT n,
              const Real* HWY_RESTRICT back, HullSupport& out) {
  out.a = findOne(a, asked, n), out.b = findOne(b, asked, back);
}

}  // namespace HWY_NAMESPACE
}}}  // namespace lpc::LPC_PRECISION::pair_query
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

HWY_EXPORT(farthestOf);
std::size_t farthestVertex(const std::vector<Vec<3>>& vertices, const Vec<3>& d) {
  LPC_ASSERT(vertices.size() >= kManyVertices);
  return HWY_DYNAMIC_DISPATCH(farthestOf)(vertices.data()->data(), vertices.size(), d[0], d[1], d[2]);
}

HWY_EXPORT(allWithin);
void verticesWithin(const std::vector<Vec<3>>& vertices, const Vec<3>& d, Real band, std::vector<Vec<3>>& out) {
  HWY_DYNAMIC_DISPATCH(allWithin)(vertices.data()->data(), vertices.size(), d.data(), band, out);
}

namespace {

// A few vertices are tested one by one: no branch, and no reduction over lanes.
std::size_t farthestOfFew(const HullPair::Hull& hull, const Real* n) {
  std::size_t best = 0;
  Real most = -std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < hull.count; ++i) {
    const Real* v = hull.vertices + 3 * i;
    const Real far = summed(v[0] * n[0], v[1] * n[1], v[2] * n[2]);
    best = far > most ? i : best;
    most = far > most ? far : most;
  }
  return best;
}

}  // namespace

HWY_EXPORT(findOne);
HWY_EXPORT(findBoth);
HullSupport HullPair::support(const Vec<3>& p, const Mat<3>& rotation, const Vec<3>& n) {
  const Real *r = rotation.data(), x = n[0], y = n[1], z = n[2], along[3] = {x, y, z};
  const Real back[3] = {-summed(r[0] * x, r[1] * y, r[2] * z), -summed(r[3] * x, r[4] * y, r[5] * z),
                        -summed(r[6] * x, r[7] * y, r[8] * z)};
  HullSupport out;
  const bool fewA = m_a.count < kManyVertices, fewB = m_b.count < kManyVertices;
  if (!fewA && !fewB) {
    HWY_DYNAMIC_DISPATCH(findBoth)(m_a, m_b, m_asked, along, back, out);
  } else {
    out.a = fewA ? farthestOfFew(m_a, along) : HWY_DYNAMIC_DISPATCH(findOne)(m_a, m_asked, along);
    out.b = fewB ? farthestOfFew(m_b, back) : HWY_DYNAMIC_DISPATCH(findOne)(m_b, m_asked, back);
  }
  ++m_asked;
  const Real *u = m_a.vertices + 3 * out.a, *v = m_b.vertices + 3 * out.b;
  // Adds in Eigen's order of a matrix times a vector: the first two rows column by column, the last one like a float's.
  out.point[0] = (p[0] + summed(r[0] * v[0], r[3] * v[1], r[6] * v[2])) - u[0];
  out.point[1] = (p[1] + summed(r[1] * v[0], r[4] * v[1], r[7] * v[2])) - u[1];
  out.point[2] = (p[2] + (r[2] * v[0] + (r[5] * v[1] + r[8] * v[2]))) - u[2];
  return out;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
#endif
