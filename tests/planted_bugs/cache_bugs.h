// SPDX-License-Identifier: Zlib
// Planted bugs of contact caches.
#pragma once

#include <memory>

#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D, class Inherit>
void forSamePairs(std::span<const Manifold<D>> old, std::span<Manifold<D>> fresh, const Inherit& inherit) {
  for (Manifold<D>& m : fresh) {
    for (const Manifold<D>& o : old) {
      if (o.key() == m.key()) inherit(o, m);
    }
  }
}

/// Keeps the old points of a known pair: contacts do not follow the bodies.
template <int D>
struct StaleManifold final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    forSamePairs<D>(in.old, fresh,
                    [](const Manifold<D>& o, Manifold<D>& m) { m.count = o.count, m.points = o.points; });
  }
};

/// The first point inherits from the first old point, whatever their features.
template <int D>
struct MatchesByPlace final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    forSamePairs<D>(in.old, fresh, [](const Manifold<D>& o, Manifold<D>& m) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(std::min(o.count, m.count)); ++i) {
        m.points[i].impulse = o.points[i].impulse, m.points[i].memory = o.points[i].memory;
      }
    });
  }
};

/// Forgets the children of shapes: the first pair of children inherits for all.
template <int D>
struct MatchesByShape final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    const auto right = createStage<ContactCache<D>>({"by_feature", {}});
    for (Manifold<D>& m : fresh) {
      for (const Manifold<D>& o : in.old) {
        if (o.shapeKey() != m.shapeKey()) continue;
        Manifold<D> renamed = o;
        renamed.partA = m.partA, renamed.partB = m.partB;
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

/// Each point inherits from the nearest old one, even if another point already has.
template <int D>
struct GivesToAllAround final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    forSamePairs<D>(in.old, fresh, [](const Manifold<D>& o, Manifold<D>& m) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
        std::size_t nearest = 0;
        const auto apart = [&](std::size_t k) { return (o.points[k].localA - m.points[i].localA).norm(); };
        for (std::size_t k = 1; k < static_cast<std::size_t>(o.count); ++k) {
          if (apart(k) < apart(nearest)) nearest = k;
        }
        m.points[i].impulse = o.points[nearest].impulse, m.points[i].memory = o.points[nearest].memory;
      }
    });
  }
};

/// Forgets that each normal has its own tangent basis.
template <int D>
struct FrictionAsNumbers final : ContactCache<D> {
  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
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

/// Base of bugs that change the input or output of `recycling`.
template <int D>
struct Recycled : ContactCache<D> {
  std::unique_ptr<ContactCache<D>> right = createStage<ContactCache<D>>({"recycling", {}});
  void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) override { right->select(in, regenerate); }
  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override { right->carry(in, fresh); }
  void renew(const CacheInput<D>& in, std::span<Manifold<D>> pair) override { right->renew(in, pair); }
};

/// Keeps separations along with the anchors.
template <int D>
struct StaleSeparations final : Recycled<D> {
  void renew(const CacheInput<D>& in, std::span<Manifold<D>> pair) override {
    const std::vector<Manifold<D>> old(pair.begin(), pair.end());
    Recycled<D>::renew(in, pair);
    forSamePairs<D>(old, pair, [](const Manifold<D>& o, Manifold<D>& m) {
      for (int i = 0; i < m.count; ++i) m.points[i].separation = o.points[i].separation;
    });
  }
};

/// The normal does not turn with A.
template <int D>
struct StaleNormals final : Recycled<D> {
  void renew(const CacheInput<D>& in, std::span<Manifold<D>> pair) override {
    const std::vector<Manifold<D>> old(pair.begin(), pair.end());
    Recycled<D>::renew(in, pair);
    forSamePairs<D>(old, pair, [](const Manifold<D>& o, Manifold<D>& m) { m.normal = o.normal; });
  }
};

/// Does not check for new contacts where the manifold has no point.
template <int D>
struct SeesPointsAlone final : Recycled<D> {
  void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) override {
    CacheInput<D> wide = in;
    wide.margin = 1000;
    Recycled<D>::select(wide, regenerate);
  }
};

}}}  // namespace lpc::LPC_PRECISION::test
