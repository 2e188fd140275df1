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
    return {
        .name = "none",
        .summary = "no continuous collision: contacts are found at the ends of steps only",
        .paper = "",
        .complexity = "nothing",
        .failures = {{"a ball that moves farther in a step than its thickness plus the obstacle's", "it passes through",
                      "Continuous.BallIsStopped"},
                     {"bullets of other shapes", "they pass through", "Continuous.BulletIsStopped"},
                     {"bullets at a mesh or chain", "they pass through", "Continuous.SurfaceIsNotPassed"},
                     {"the end of a wall in the path of half a box", "it passes through", "Continuous.EdgeIsMet"},
                     {"a rotating rod beside a post", "it passes through", "Continuous.SpinningRodIsStopped"},
                     {"two bullets head on", "they pass through each other", "Continuous.FastOnesMeet"},
                     {"a body that is struck and moves off", "it passes through", "Continuous.SentOnItsWayIsStopped"},
                     {"a rod that makes a whole turn in a step", "it passes through", "Continuous.WholeTurnsAreSeen"},
                     {"several bullets in a row", "they pass through", "Continuous.QueueIsStopped"}}};
  }

  CcdPhase ccdPhase() const override { return CcdPhase::never; }
};

}  // namespace

LPC_REGISTER(ContinuousCollision, None, 2, 3);

}}  // namespace lpc::LPC_PRECISION
