// SPDX-License-Identifier: Zlib
#include "framework/stage_narrowphase.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// Matches points by the shapes' pair and the number of their pair of features. Both lists are sorted, so one walk
// through each does it.
template <int D>
class ByFeature final : public ContactCache<D> {
 public:
  using Params = NoParams;
  explicit ByFeature(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "by_feature",
            .summary = "a point inherits from the old point with the same shapes and feature number",
            .paper = "catto2006",
            .complexity = "m old + m fresh manifolds",
            .failures = {{"a body that slides over a vertex or rolls over an edge",
                          "the same place has a new feature and starts cold", "Cache.CarriesWhereFeaturesChange"}}};
  }

  void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) override {
    const std::span<const Manifold<D>> old = in.old;
    std::size_t o = 0;
    for (Manifold<D>& m : fresh) {
      while (o < old.size() && old[o].key() < m.key()) ++o;
      if (o == old.size()) return;
      if (old[o].key() == m.key()) inherit(old[o], m);
    }
  }

 private:
  static void inherit(const Manifold<D>& old, Manifold<D>& m) {
    // tangents(n) jumps where n_z changes its sign, so on a slope the two bases may differ by a mirror image although
    // the normals differ by one rounding: friction is carried as a vector, not as two numbers.
    const bool sameBasis = old.normal == m.normal;
    const RealMatrix<D - 1, D - 1> turn = tangents(m.normal).transpose() * tangents(old.normal);
    int o = 0;
    for (int i = 0; i < m.count; ++i) {
      ContactPoint<D>& p = m.points[static_cast<std::size_t>(i)];
      while (o < old.count && old.points[static_cast<std::size_t>(o)].feature < p.feature) ++o;
      if (o == old.count) return;
      const ContactPoint<D>& q = old.points[static_cast<std::size_t>(o)];
      if (q.feature != p.feature) continue;
      p.impulse = q.impulse, p.memory = q.memory;
      if (sameBasis) continue;
      Vec<D - 1> friction;
      for (int k = 1; k < D; ++k) friction[k - 1] = q.impulse[static_cast<std::size_t>(k)];
      friction = (turn * friction).eval();
      for (int k = 1; k < D; ++k) p.impulse[static_cast<std::size_t>(k)] = friction[k - 1];
    }
  }
};

}  // namespace

LPC_REGISTER(ContactCache, ByFeature, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
