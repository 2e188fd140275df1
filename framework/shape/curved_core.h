// SPDX-License-Identifier: Zlib
// Convex cores without a list of corners: a cylinder, an ellipsoid. A kind is one file,
// framework/shape/core_<kind>.cpp, which registers its constructor, and one name in ShapeKind; no other code uses the
// name. A plugin registers its own core as ShapeKind::custom; a program has at most one custom core.
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

/// A point of a core, with numbers of any precision.
template <class N, int D>
using CorePoint = std::array<N, static_cast<std::size_t>(D)>;

template <int D>
class CurvedCore {
 public:
  virtual ~CurvedCore() = default;
  /// The sizes from which it was made (m), as in CurvedKind::sizes.
  virtual std::span<const Real> sizes() const = 0;
  /// Half extents of its box around the origin of its frame (m).
  virtual Vec<D> half() const = 0;
  /// Support point: a point of the core farthest along d. d may have any length; for d = 0 returns any point of the
  /// core.
  virtual Vec<D> support(const Vec<D>& d) const = 0;
  /// Support point for the referee. Its error is at most 8 long-double roundings of half().norm(), both in its distance
  /// from the core and in its height along d.
  virtual CorePoint<long double, D> support(const CorePoint<long double, D>& d) const = 0;
  /// Support feature: the flat or straight part of the surface most nearly perpendicular to d, which contact generators
  /// clip. It has one corner when the surface is curved there, and two corners for a straight line. For a flat face it
  /// is an inscribed convex polygon with up to 64 corners, counter-clockwise from outside. Corner i stays corner i
  /// while d changes little. d may have any length.
  virtual void supportFace(const Vec<D>& d, std::vector<Vec<D>>& corners) const = 0;
  /// Mass properties of the solid core, in its own frame.
  virtual MassProperties<D> massProperties(Real density) const = 0;
};

/// Implements both support functions by one template, `extreme`.
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

/// A kind of core: its sizes and its constructor.
template <int D>
struct CurvedKind {
  std::vector<std::string_view> sizes;  // names of the sizes, all lengths > 0 (m)
  std::function<std::shared_ptr<const CurvedCore<D>>(std::span<const Real>)> create;
  int claims = 1;  // number of registrations; when two plugins register, neither is used
};

/// Throws UserError when the kind is not curved or not of this dimension.
template <int D>
const CurvedKind<D>& curvedKind(ShapeKind kind);

/// Throws UserError, starting with `subject`, unless the core is consistent along some hundred fixed directions. It
/// must be finite, fill its box, have mass, and be equal in both number types. It must be convex: no point is farther
/// along a direction than the support point of that direction. Costs a fraction of a millisecond.
template <int D>
void requireConvexCore(const CurvedCore<D>& core, const std::string& subject);

/// All kinds of this dimension, in the order of ShapeKind.
template <int D>
std::map<ShapeKind, CurvedKind<D>>& curvedKinds();

namespace {  // anonymous for the same reason as in Registrar

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
