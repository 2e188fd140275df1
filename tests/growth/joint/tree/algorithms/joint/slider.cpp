// SPDX-License-Identifier: Zlib
#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// B slides along the first axis of A's frame and does not rotate relative to A.
template <int D>
class Slider final : public JointKind<D> {
 public:
  using Params = NoParams;
  explicit Slider(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "slider",
            .summary = "moves along one axis, turns about none",
            .paper = "catto2014",
            .complexity = "2 rows in 2D, 5 in 3D"};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 1; i < D; ++i) {
      const Vec<D> d = at.qA * Vec<D>(Vec<D>::Unit(i));
      out.point(d, Vec<D>(at.rA + at.gap), at.rB, d.dot(at.gap));  // A is pushed at B's anchor
    }
    const Ang<D> turn = turnOf(at.qB * at.qA.inverse());
    for (int i = 0; i < kAngDim<D>; ++i) out.turn(Ang<D>::Unit(i), turn[i]);
  }
};

}  // namespace

LPC_REGISTER(JointKind, Slider, 2, 3);

}}  // namespace lpc::LPC_PRECISION
