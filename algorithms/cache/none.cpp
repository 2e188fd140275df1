// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Keeps nothing: every step starts cold.
template <int D>
class NoCache final : public ContactCache<D> {
 public:
  using Params = NoParams;
  explicit NoCache(const Params&) {}

  static AlgorithmInfo info() {
    return {
        .name = "none",
        .summary = "forgets all impulses: every step starts cold",
        .paper = "",
        .complexity = "0",
        .failures = {{"any contact that lasts", "the solver starts from zero each step, stacks need more iterations",
                      "Cache.CarriesImpulses"},
                     {"a contact on a slope", "friction starts from zero, too", "Cache.CarriesFrictionAsAVector"},
                     {"a sliding body", "it forgets all the same", "Cache.CarriesWhereFeaturesChange"},
                     {"a body that jumps", "it forgets all the same", "Cache.CarriesAcrossAJump"}}};
  }

  void carry(const CacheInput<D>&, std::vector<Manifold<D>>&) override {}
};

}  // namespace

LPC_REGISTER(ContactCache, NoCache, 2, 3);

}}  // namespace lpc::LPC_PRECISION
