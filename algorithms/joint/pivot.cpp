// SPDX-License-Identifier: Zlib
#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Pivot, the only joint of the 2009 engine. The rows lie along the world axes, so they do not turn with the bodies and
// the last step's impulses are a good first guess.
template <int D>
class Pivot final : public JointKind<D> {
 public:
  using Params = NoParams;
  explicit Pivot(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "pivot",
            .summary = "one point of both bodies stays together; all rotations are free",
            .paper = "lpc2009",
            .complexity = "D rows"};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 0; i < D; ++i) out.point(Vec<D>::Unit(i), at.rA, at.rB, at.gap[i]);
  }
};

}  // namespace

LPC_REGISTER(JointKind, Pivot, 2, 3);

}}  // namespace lpc::LPC_PRECISION
