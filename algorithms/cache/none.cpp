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
    return {.name = "none",
            .summary = "no warm starting: impulses start from zero in each step",
            .paper = "",
            .complexity = "0",
            .failures = {
                {"any contact that lasts", "the solver starts from zero in each step, so stacks need more iterations",
                 "Cache.CarriesImpulses"},
                {"a contact on a slope", "friction starts from zero in each step", "Cache.CarriesFrictionAsAVector"},
                {"a sliding body", "impulses are not kept", "Cache.CarriesWhereFeaturesChange"},
                {"a body that is moved at once", "impulses are not kept", "Cache.CarriesAcrossAJump"}}};
  }

  void carry(const CacheInput<D>&, std::span<Manifold<D>>) override {}
};

}  // namespace

LPC_REGISTER(ContactCache, NoCache, 2, 3);

}}  // namespace lpc::LPC_PRECISION
