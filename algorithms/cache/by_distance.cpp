// SPDX-License-Identifier: Zlib
#include <limits>

#include "algorithms/cache/inherit.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Matches new points to old ones by the distance of their anchors, nearest pair first. Each old point passes its
// impulse on once. A point matches if its anchor has stayed in place on A or on B: the corner of a sliding box keeps
// its place on the box but not on the floor, and the order of the bodies alone decides which of the two is A.
template <int D>
class ByDistance final : public ContactCache<D> {
 public:
  struct Params {
    Real distance = Real(0.02);
    void visit(ParamVisitor& v) {
      v.real("distance", distance, 0, 1000, "m",
             "largest motion of a matched point, measured on the body on which it moved less");
    }
  };
  explicit ByDistance(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "by_distance",
            .summary = "a point inherits the impulse of the nearest old point of the same shapes",
            .paper = "bullet",
            .complexity = "old and new manifolds, points squared in each",
            .failures = {{"a body that rolls or rotates by more than `distance` in a step",
                          "its points start cold, although their features would match", "Cache.CarriesAcrossAJump"}}};
  }

  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    cache::forKnown<D>(in.old, fresh, [&](const Manifold<D>& old, Manifold<D>& m) { inherit(old, m); });
  }

 private:
  void inherit(const Manifold<D>& old, Manifold<D>& m) const {
    const FrictionTurn<D> turn(old.normal, m.normal);
    IndexedArray<bool, kManifoldPoints<D>> given{}, taken{};
    for (int n = std::min(old.count, m.count); n > 0; --n) {
      Real least = std::numeric_limits<Real>::infinity();
      int from = 0, to = 0;
      for (int o = 0; o < old.count; ++o) {
        for (int i = 0; i < m.count; ++i) {
          if (given[o] || taken[i]) continue;
          const ContactPoint<D>&p = m.points[i], &q = old.points[o];
          const Real apart = std::min((p.localA - q.localA).norm(), (p.localB - q.localB).norm());
          if (apart < least) least = apart, from = o, to = i;
        }
      }
      if (!(least <= m_params.distance)) return;
      given[from] = taken[to] = true;
      cache::inherit(old.points[from], turn, m.points[to]);
    }
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(ContactCache, ByDistance, 2, 3);

}}  // namespace lpc::LPC_PRECISION
