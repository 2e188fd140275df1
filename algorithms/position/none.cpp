// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// No position correction: the baseline for the other methods.
template <int D>
class NoPosition final : public PositionResolver<D> {
 public:
  using Params = NoParams;
  explicit NoPosition(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "none",
            .summary = "no position correction",
            .paper = "",
            .complexity = "0",
            .guarantee = Guarantee::approximate,
            .failures = {{"any resting body", "it sinks in", "PositionError.Shrinks"},
                         {"pinned bodies that overlap", "they stay overlapping", "PositionError.TurnsPinnedBodies"},
                         {"a joint under load", "it drifts apart", "JointError.Shrinks"}},
            .noEffort = "it does nothing"};
  }
};

}  // namespace

LPC_REGISTER(PositionResolver, NoPosition, 2, 3);

}}  // namespace lpc::LPC_PRECISION
