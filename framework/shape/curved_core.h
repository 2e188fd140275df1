// SPDX-License-Identifier: Zlib
// Convex cores without a list of corners: a cylinder, an ellipsoid. A kind of them is one file,
// framework/shape/core_<kind>.cpp, which registers how it is made, and one name in ShapeKind; nobody else knows it by
// name. A plugin registers its own as ShapeKind::custom, of which there is one.
//
//   template <int D> struct Ball : CurvedBase<D, Ball<D>> {
//     template <class N> std::array<N, D> extreme(const std::array<N, D>& d) const;   // farthest along d
//     ...
//   };
//   const CurvedRegistrar<Ball, 2, 3> registrar{ShapeKind::ball, {{"radius"}, {"radius"}}};
#pragma once

#include <functional>
#include <map>

#include "framework/math/indexed.h"
#include "framework/shape/mass.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A point of a core, in numbers of any precision.
template <class N, int D>
using CorePoint = std::array<N, static_cast<std::size_t>(D)>;

template <int D>
class CurvedCore {
 public:
  virtual ~CurvedCore() = default;
  /// What it was made from (m), as in CurvedKind::sizes.
  virtual std::span<const Real> sizes() const = 0;
  /// Half extents of its box around the origin of its own frame (m).
  virtual Vec<D> half() const = 0;
  /// A point of the core that lies farthest along d, of any length; for d = 0 some point of the core.
  virtual Vec<D> support(const Vec<D>& d) const = 0;
  /// The same for the referee: within 8 roundings of a long double of half().norm() from the core, and as far along d.
  virtual CorePoint<long double, D> support(const CorePoint<long double, D>& d) const = 0;
  /// The flat or straight part of the surface that meets a plane with outward normal d best, as contact generators clip
  /// it: one corner where there is none, two of a straight line, or a convex polygon inscribed in a flat face,
  /// counter-clockwise seen from outside, of up to 64 corners. The i-th corner stays the i-th while d changes little.
  /// Any length of d.
  virtual void supportFace(const Vec<D>& d, std::vector<Vec<D>>& corners) const = 0;
  /// Of the solid core, in its own frame.
  virtual MassProperties<D> massProperties(Real density) const = 0;
};

/// Writes both support functions from one template, `extreme`.
template <int D, class Core>
class CurvedBase : public CurvedCore<D> {
 public:
  Vec<D> support(const Vec<D>& d) const final {
    IndexedArray<Real, D> along;
    for (int k = 0; k < D; ++k) along[k] = d[k];
    const IndexedArray<Real, D> p{self().extreme(along)};
    Vec<D> out;
    for (int k = 0; k < D; ++k) out[k] = p[k];
    return out;
  }
  CorePoint<long double, D> support(const CorePoint<long double, D>& d) const final { return self().extreme(d); }

 private:
  const Core& self() const { return static_cast<const Core&>(*this); }
};

/// How cores of a kind are made.
template <int D>
struct CurvedKind {
  std::vector<std::string_view> sizes;  // names, all lengths above zero (m)
  std::function<std::shared_ptr<const CurvedCore<D>>(std::span<const Real>)> create;
  int claims = 1;  // registrations: of more than one, by two plugins, none is the kind
};

/// Throws UserError when the kind is not curved or not of this dimension.
template <int D>
const CurvedKind<D>& curvedKind(ShapeKind kind);

/// Throws UserError, `who` first, unless the core is what it says along some hundred fixed directions: finite, inside
/// its box and as large as it, convex (no point lies farther along a direction than its support point), the same in
/// both number types, and with mass. Costs a fraction of a millisecond.
template <int D>
void requireConvexCore(const CurvedCore<D>& core, const std::string& who);

/// All of this dimension, in the order of the kinds.
template <int D>
std::map<ShapeKind, CurvedKind<D>>& curvedKinds();

namespace {  // as Registrar

template <template <int> class Core, int... D>
class CurvedRegistrar {
 public:
  CurvedRegistrar(ShapeKind kind, std::initializer_list<std::initializer_list<std::string_view>> sizes) {
    auto names = sizes.begin();
    (add<D>(kind, {*names++,
                   [](std::span<const Real> values) -> std::shared_ptr<const CurvedCore<D>> {
                     return std::make_shared<const Core<D>>(values);
                   }}),
     ...);
  }

 private:
  template <int N>
  static void add(ShapeKind kind, CurvedKind<N> made) {
    const auto [at, fresh] = curvedKinds<N>().try_emplace(kind, std::move(made));
    if (!fresh) ++at->second.claims;
  }
};

}  // namespace
}}  // namespace lpc::LPC_PRECISION
