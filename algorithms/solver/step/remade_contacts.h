// SPDX-License-Identifier: Zlib
// Contacts that a solver makes again within its step (StepInput::detect).
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/problem/friction_turn.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

enum class ContactsOf { step, substep };
template <class Visitor>
void visitContactsOf(Visitor& v, ContactsOf& contacts, const char* again = "or again for each sub-step") {
  v.choice("contacts", contacts, {"step", "substep"},
           "made for the step, " + std::string(again) + ", which costs more");
}

/// Whether `impulse` of a contact point is that of the last sub-step, or the sum of all sub-steps.
enum class PointImpulse { ofSubstep, sum };

/// Hands what a step has done to its contacts to the contacts that replace them within the step: impulses, loads, and
/// the velocity with which each was hit (m/s, in memory[0]). The cache does not do this: `by_feature` keeps only points
/// with unchanged features, and `none` keeps nothing.
template <int D>
class RemadeContacts {
 public:
  /// Copies the manifolds that carry a load. Call it before the contacts are made again.
  void keep(IndexedSpan<const Manifold<D>> manifolds, IndexedSpan<const int> active) {
    m_old.clear();
    for (const int i : active) {
      if (isLoaded(manifolds[i])) m_old.push_back(manifolds[i]);
    }
  }
  /// Writes the copied data into the new manifolds of the same parts; data of a manifold that is gone are dropped. A
  /// load, or an impulse that is a sum, goes to the point of the same features, or else to the nearest one. Any other
  /// impulse goes to the same features only. memory[0] is 0 at points that were not hit.
  void restore(IndexedSpan<Manifold<D>> manifolds, IndexedSpan<const int> active, PointImpulse kind) const {
    for (const int i : active) {
      Manifold<D>& m = manifolds[i];
      for (int k = 0; k < m.count; ++k) {
        m.points[k].load = m.points[k].memory[0] = 0;
        if (kind == PointImpulse::sum) m.points[k].impulse.fill(0);
      }
      const auto at =
          std::partition_point(m_old.begin(), m_old.end(), [&](const Manifold<D>& old) { return old.key() < m.key(); });
      if (at != m_old.end() && at->key() == m.key()) hand(*at, m, kind);
    }
  }

 private:
  static bool isLoaded(const Manifold<D>& m) {
    bool loaded = false;
    for (int k = 0; k < m.count; ++k) loaded |= m.points[k].load > 0;
    return loaded;
  }
  static void hand(const Manifold<D>& old, Manifold<D>& m, PointImpulse kind) {
    const FrictionTurn<D> turn(old.normal, m.normal);
    for (int o = 0; o < old.count; ++o) {
      const ContactPoint<D>& from = old.points[o];
      ContactPoint<D>& to = m.points[nearest(from, m)];
      const bool same = to.feature == from.feature;
      to.load += from.load;
      if (from.load > 0 && (same || to.separation <= 0)) to.memory[0] = std::min(to.memory[0], from.memory[0]);
      if (!same && kind == PointImpulse::ofSubstep) continue;
      IndexedArray<Real, D> impulse = from.impulse;
      turn(impulse);
      for (int d = 0; d < D; ++d) to.impulse[d] = (kind == PointImpulse::sum ? to.impulse[d] : 0) + impulse[d];
    }
  }
  static int nearest(const ContactPoint<D>& from, const Manifold<D>& m) {
    int best = 0;
    Real least = std::numeric_limits<Real>::infinity();
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& p = m.points[k];
      if (p.feature == from.feature) return k;
      const Real far = (p.localA - from.localA).squaredNorm() + (p.localB - from.localB).squaredNorm();
      if (far < least) least = far, best = k;
    }
    return best;
  }
  std::vector<Manifold<D>> m_old;  // those with a load, sorted by key
};

}}}  // namespace lpc::LPC_PRECISION::solver
