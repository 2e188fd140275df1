// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_broadphase.h"

#include <algorithm>
#include <limits>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kInfinite = std::numeric_limits<Real>::infinity();

}  // namespace

template <int D>
void Proxies<D>::resize(int slots) {
  const auto padded = static_cast<std::size_t>((slots + kPad - 1) / kPad * kPad);
  // Shrinking to the used slots first resets everything behind them.
  const auto kept = static_cast<std::size_t>(std::min(slots, count));
  for (int k = 0; k < D; ++k) {
    lo[k].resize(kept), lo[k].resize(padded, kInfinite);
    hi[k].resize(kept), hi[k].resize(padded, -kInfinite);
  }
  active.resize(kept), active.resize(padded, 0);
  category.resize(kept), category.resize(padded, 0);
  mask.resize(kept), mask.resize(padded, 0);
  body.resize(kept), body.resize(padded, -1);
  count = slots;
}

template <int D>
void Proxies<D>::setBox(ProxyId i, const Aabb<D>& box) {
  for (int d = 0; d < D; ++d) {
    lo[d][i] = box.lo[d], hi[d][i] = box.hi[d];
  }
}

template <int D>
Aabb<D> Proxies<D>::box(ProxyId i) const {
  Aabb<D> b;
  for (int d = 0; d < D; ++d) {
    b.lo[d] = lo[d][i], b.hi[d] = hi[d][i];
  }
  return b;
}

template <int D>
void Broadphase<D>::overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const {
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    if (!proxies.isFree(i) && proxies.box(i).overlaps(box)) out.push_back(i);
  }
}

template <int D>
void Broadphase<D>::at(const Proxies<D>& proxies, const Vec<D>& point, std::vector<ProxyId>& out) const {
  overlap(proxies, {point, point}, out);
}

template <int D>
void Broadphase<D>::ray(const Proxies<D>& proxies, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                        std::vector<RayHit<D>>& out) const {
  RayHit<D> first{-1, kInfinite};
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    if (proxies.isFree(i)) continue;
    const Real t = castRay(proxies.box(i), p, direction, maxT);
    if (t < 0) continue;
    if (!firstOnly) {
      out.push_back({i, t});
    } else if (t < first.t) {
      first = {i, t};
    }
  }
  if (first.proxy >= 0) out.push_back(first);
}

template <int D>
void Broadphase<D>::sweep(const Proxies<D>& proxies, const Aabb<D>& box, const Vec<D>& displacement,
                          std::vector<RayHit<D>>& out) const {
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    if (proxies.isFree(i)) continue;
    const Real t = castBox(box, displacement, Real(1), proxies.box(i));
    if (t >= 0) out.push_back({i, t});
  }
}

template struct Proxies<2>;
template struct Proxies<3>;
template class Broadphase<2>;
template class Broadphase<3>;

}}  // namespace lpc::LPC_PRECISION
