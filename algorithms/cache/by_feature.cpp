// SPDX-License-Identifier: Zlib
#include "algorithms/cache/inherit.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Matches points by the pair of shapes and the number of the pair of features.
template <int D>
class ByFeature final : public ContactCache<D> {
 public:
  using Params = NoParams;
  explicit ByFeature(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "by_feature",
            .summary = "a point inherits the impulse of the old point with the same shapes and feature id",
            .paper = "catto2006",
            .complexity = "old and new manifolds",
            .failures = {{"a body that slides over a vertex or rolls over an edge",
                          "the contact gets a new feature id and starts cold", "Cache.CarriesWhereFeaturesChange"}}};
  }

  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    cache::forKnown<D>(in.old, fresh, cache::inheritByFeature<D>);
  }
};

}  // namespace

LPC_REGISTER(ContactCache, ByFeature, 2, 3);

}}  // namespace lpc::LPC_PRECISION
