// SPDX-License-Identifier: Zlib
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/problem/contact.h"
#include "framework/world/body_table.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Corrects contacts of a convex part Q that touches several parts of one group: the parts of all static and kinematic
/// bodies, or the parts of one body. The motion of kinematic bodies is ignored. The contact generator sees each pair
/// alone. So it makes contacts with sides and corners that another part covers, such as the side of the next tile of a
/// floor, and sliding bodies stop at them.
///
/// A contact rests on a plane: through its deepest point, perpendicular to its normal. Another contact of Q is covered
/// when the feature that it touches does not stand out of this plane by more than kFlush, because Q then passes over
/// the feature:
///
/// - A covered contact whose normal is closer to the plane than to the plane's normal is removed.
/// - Any other covered contact whose deepest point is at the plane gets the plane's normal. A point is removed if
///   the closest point on P moves by more than kFlush.
///
/// A covered contact does not cover others. Of two contacts that cover each other the deeper one stays; of equally deep
/// ones both stay.
template <int D>
class FlushContacts {
 public:
  /// `fresh`: the manifolds of this step. `kept`: manifolds that a cache keeps from the last step, not yet updated;
  /// they cover, and stay unchanged. `before`: all manifolds of the last step, sorted; pairs that a listener vetoed
  /// there cover nothing.
  void correct(const BodyTable<D>& table, std::span<const Manifold<D>* const> kept, std::span<const Manifold<D>> before,
               std::vector<Manifold<D>>& fresh);

 private:
  // A manifold as seen from one of its parts, Q; P is the other part.
  struct Touch {
    std::int32_t shape, part;  // of Q
    std::int32_t group;        // of P: see above
    std::int32_t index;        // of the manifold: in `fresh`, from its size on in `kept`
    bool isA;                  // Q is the manifold's A
    auto operator<=>(const Touch&) const = default;
  };
  // The contacts of one Q with equal normals.
  struct Rest {
    Vec<D> normal;    // from P to Q, world
    Real depth;       // m, of the deepest
    const Touch* by;  // the deepest
    bool covered;
  };
  struct Side;

  void findTouches(const BodyTable<D>& table);
  void correctRun(const BodyTable<D>& table, std::span<const Touch> run);
  void turn(const BodyTable<D>& table, const Touch& t, const Vec<D>& old, const Vec<D>& n);
  const Rest* coverOf(const BodyTable<D>& table, const Touch& touch, const Rest& own) const;
  bool vetoed(const Manifold<D>& m) const;
  const Manifold<D>& manifold(const Touch& t) const;

  // Arguments of correct(), during the call.
  std::span<Manifold<D>> m_fresh;
  std::span<const Manifold<D>* const> m_kept;
  std::span<const Manifold<D>> m_before;
  // Scratch.
  std::vector<std::int32_t> m_count;  // of touches, by shape
  std::vector<Touch> m_touches;
  std::vector<Rest> m_rests;
  std::vector<int> m_restOf;                // by touch of a run
  std::vector<std::size_t> m_order;         // of the rests, the least deep first
  std::vector<std::size_t> m_deepestFirst;  // the same, the deepest first
};

}}  // namespace lpc::LPC_PRECISION
