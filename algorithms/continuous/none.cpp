// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_continuous.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// No continuous collision: the baseline for the other methods.
template <int D>
class None final : public ContinuousCollision<D> {
 public:
  using Params = NoParams;
  explicit None(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "none",
            .summary = "bodies meet at the ends of steps only",
            .paper = "",
            .complexity = "nothing",
            .failures = {{"a ball that goes farther in a step than it and its obstacle are thick", "it passes through",
                          "Continuous.BallIsStopped"},
                         {"bullets of other shapes", "they pass through", "Continuous.BulletIsStopped"},
                         {"a wall's end in the way of half a box", "it passes through", "Continuous.EdgeIsMet"},
                         {"a turning rod at a post", "it passes through", "Continuous.SpinningRodIsStopped"},
                         {"two bullets head on", "they pass through each other", "Continuous.FastOnesMeet"},
                         {"a body that is hit and flies off", "it passes through", "Continuous.SentOnItsWayIsStopped"},
                         {"a rod that turns once in a step", "it passes through", "Continuous.WholeTurnsAreSeen"},
                         {"several bullets in a row", "they pass through", "Continuous.QueueIsStopped"}}};
  }

  Lookout lookout() const override { return Lookout::never; }
};

}  // namespace

LPC_REGISTER(ContinuousCollision, None, 2, 3);

}}  // namespace lpc::LPC_PRECISION
