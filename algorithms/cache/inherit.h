// SPDX-License-Identifier: Zlib
// What a contact point inherits from the matching point of the previous step.
#pragma once

#include "framework/math/indexed.h"
#include "framework/problem/friction_turn.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace cache {

/// Copies impulse, memory and load of `old` to the new point `p`.
template <int D>
void inherit(const ContactPoint<D>& old, const FrictionTurn<D>& turn, ContactPoint<D>& p) {
  p.impulse = old.impulse, p.memory = old.memory, p.load = old.load;
  turn(p.impulse);
}

/// Calls f for points of both lists with the same feature number. Both lists are sorted, so one pass suffices.
template <int D>
void inheritByFeature(const Manifold<D>& old, Manifold<D>& m) {
  const FrictionTurn<D> turn(old.normal, m.normal);
  int o = 0;
  for (int i = 0; i < m.count; ++i) {
    ContactPoint<D>& p = m.points[i];
    while (o < old.count && old.points[o].feature < p.feature) ++o;
    if (o == old.count) return;
    const ContactPoint<D>& q = old.points[o];
    if (q.feature == p.feature) inherit(q, turn, p);
  }
}

/// Calls `f(old, m)` for each new manifold with an old one of the same key. Both lists are sorted.
template <int D, class F>
void forKnown(std::span<const Manifold<D>> old, std::span<Manifold<D>> fresh, const F& f) {
  std::size_t o = 0;
  for (Manifold<D>& m : fresh) {
    while (o < old.size() && old[o].key() < m.key()) ++o;
    if (o == old.size()) return;
    if (old[o].key() == m.key()) f(old[o], m);
  }
}

}}}  // namespace lpc::LPC_PRECISION::cache
