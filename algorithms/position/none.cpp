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
            .summary = "leaves penetration and joint errors as they are",
            .paper = "",
            .complexity = "0",
            .guarantee = Guarantee::approximate,
            .failures = {{"anything that rests", "sinks in", "PositionError.Shrinks"},
                         {"pinned bodies that overlap", "stay so", "PositionError.TurnsPinnedBodies"},
                         {"a joint under load", "drifts apart", "JointError.Shrinks"}},
            .noEffort = "does nothing"};
  }
};

}  // namespace

LPC_REGISTER(PositionResolver, NoPosition, 2, 3);

}}  // namespace lpc::LPC_PRECISION
