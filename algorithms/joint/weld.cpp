// SPDX-License-Identifier: Zlib
#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
class Weld final : public JointKind<D> {
 public:
  using Params = NoParams;
  explicit Weld(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "weld",
            .summary = "fixes all relative motion of two bodies",
            .paper = "catto2014",
            .complexity = "3 rows in 2D, 6 in 3D, solved as one block"};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 0; i < D; ++i) out.point(Vec<D>::Unit(i), at.rA, at.rB, at.gap[i]);
    const Ang<D> turn = turnOf(at.qB * at.qA.inverse());
    for (int i = 0; i < kAngDim<D>; ++i) out.turn(Ang<D>::Unit(i), turn[i]);
  }
};

}  // namespace

LPC_REGISTER(JointKind, Weld, 2, 3);

}}  // namespace lpc::LPC_PRECISION
