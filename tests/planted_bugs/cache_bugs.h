// SPDX-License-Identifier: Zlib
// Contact caches with one mistake each.
#pragma once

#include "framework/stage_narrowphase.h"

namespace lpc::inline LPC_PRECISION::test {

template <int D, class Inherit>
void forSamePairs(std::span<const Manifold<D>> old, std::vector<Manifold<D>>& fresh, const Inherit& inherit) {
  for (Manifold<D>& m : fresh) {
    for (const Manifold<D>& o : old) {
      if (o.key() == m.key()) inherit(o, m);
    }
  }
}

/// Keeps the old points where the pair is known: contacts that stay where they were.
template <int D>
struct StaleManifold final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) override {
    forSamePairs<D>(in.old, fresh,
                    [](const Manifold<D>& o, Manifold<D>& m) { m.count = o.count, m.points = o.points; });
  }
};

/// The first point inherits from the first, whatever their features.
template <int D>
struct MatchesByPlace final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) override {
    forSamePairs<D>(in.old, fresh, [](const Manifold<D>& o, Manifold<D>& m) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(std::min(o.count, m.count)); ++i) {
        m.points[i].impulse = o.points[i].impulse, m.points[i].memory = o.points[i].memory;
      }
    });
  }
};

/// Forgets that shapes have children: the first of the pair of shapes leaves all.
template <int D>
struct MatchesByShape final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) override {
    const auto right = createStage<ContactCache<D>>({"by_feature", {}});
    for (Manifold<D>& m : fresh) {
      for (const Manifold<D>& o : in.old) {
        if (o.shapeKey() != m.shapeKey()) continue;
        Manifold<D> renamed = o;
        renamed.childA = m.childA, renamed.childB = m.childB;
        std::vector<Manifold<D>> one = {m};
        CacheInput<D> single = in;
        single.old = {&renamed, 1};
        right->carry(single, one);
        m = one[0];
        break;
      }
    }
  }
};

/// Forgets that two normals have two tangent bases.
template <int D>
struct FrictionAsNumbers final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) override {
    forSamePairs<D>(in.old, fresh, [](const Manifold<D>& o, Manifold<D>& m) {
      for (int i = 0; i < m.count; ++i) {
        for (int k = 0; k < o.count; ++k) {
          const auto& q = o.points[static_cast<std::size_t>(k)];
          auto& p = m.points[static_cast<std::size_t>(i)];
          if (p.feature == q.feature) p.impulse = q.impulse;
        }
      }
    });
  }
};

}  // namespace lpc::inline LPC_PRECISION::test
