// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_sleep.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// No sleeping: the baseline for the sleeping policies. Bodies that were added asleep wake up.
template <int D>
class None final : public SleepPolicy<D> {
 public:
  using Params = NoParams;
  explicit None(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "none",
            .summary = "keeps every body awake",
            .paper = "",
            .complexity = "bodies",
            .failures = {{"anything that rests", "it costs as much as what moves", "Sleep.PendulumSleeps"},
                         {"a body rests beside one that does not", "it costs as much", "Sleep.OthersMaySleep"},
                         {"a body is added asleep", "it wakes at once", "Sleep.GentleTouchWakesNobody"}}};
  }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>>) override {
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (in.bodies.used[i]) awake[i] = 1;
    }
  }
};

}  // namespace

LPC_REGISTER(SleepPolicy, None, 2, 3);

}}  // namespace lpc::LPC_PRECISION
