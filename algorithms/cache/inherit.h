// SPDX-License-Identifier: Zlib
// What a point takes over from the one that it was in the step before.
#pragma once

#include "framework/math/indexed.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace cache {

/// Friction from the tangents of one normal to those of another. tangents(n) jumps where n_z changes its sign, so on a
/// slope the two bases may differ by a mirror image although the normals differ by one rounding: friction is carried as
/// a vector, not as two numbers.
template <int D>
class FrictionTurn {
 public:
  FrictionTurn(const Vec<D>& from, const Vec<D>& to)
      : m_same(from == to), m_turn(tangents(to).transpose() * tangents(from)) {}

  void operator()(IndexedArray<Real, D>& impulse) const {
    if (m_same) return;
    Vec<D - 1> friction;
    for (int k = 1; k < D; ++k) friction[k - 1] = impulse[k];
    friction = (m_turn * friction).eval();
    for (int k = 1; k < D; ++k) impulse[k] = friction[k - 1];
  }

 private:
  bool m_same;
  RealMatrix<D - 1, D - 1> m_turn;
};

/// Impulse, memory and load of `old` to the fresh `p`.
template <int D>
void inherit(const ContactPoint<D>& old, const FrictionTurn<D>& turn, ContactPoint<D>& p) {
  p.impulse = old.impulse, p.memory = old.memory, p.load = old.load;
  turn(p.impulse);
}

/// Points that have the number of their pair of features in common. Both lists are sorted, so one walk does it.
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

/// `f(old, m)` for each fresh manifold that has an old one of its key. Both lists are sorted, too.
template <int D, class F>
void forKnown(std::span<const Manifold<D>> old, std::vector<Manifold<D>>& fresh, const F& f) {
  std::size_t o = 0;
  for (Manifold<D>& m : fresh) {
    while (o < old.size() && old[o].key() < m.key()) ++o;
    if (o == old.size()) return;
    if (old[o].key() == m.key()) f(old[o], m);
  }
}

}}}  // namespace lpc::LPC_PRECISION::cache
