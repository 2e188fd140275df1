// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Mouse joint: pulls the point of B to the point of A like a damped spring of this frequency on the effective mass of
// the two bodies, with limited force. A is the world, where the target is fixed, or a body that carries the target.
// Implicit, so stable at any frequency.
template <int D>
class Mouse final : public JointKind<D> {
 public:
  struct Params {
    Real hertz = 5, dampingRatio = Real(0.7), maxForce = 1000;
    void visit(ParamVisitor& v) {
      v.real("hertz", hertz, 0, Real(1e4), "Hz", "at which B would swing about the target, undamped");
      v.real("damping_ratio", dampingRatio, 0, Real(1e4), "1", "of the critical damping");
      v.real("max_force", maxForce, 0, Real(1e12), "N", "at most, along each axis of A's frame");
    }
  };
  explicit Mouse(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "mouse",
            .summary = "drags a point to a target by a spring of a frequency, of limited force",
            .paper = "catto2011",
            .complexity = "D rows, one by one"};
  }

  void weigh(JointRecord<D>& joint, Real mass) const override { joint.state[0] = mass; }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    const Real mass = joint.state[0], omega = Real(6.283185307179586) * m_params.hertz;
    for (int i = 0; i < D; ++i) {
      ConstraintRow<D>& row = slide(at, i, out);
      makeSpring(row, mass * omega * omega, 2 * m_params.dampingRatio * mass * omega);
      row.lo = -m_params.maxForce, row.hi = m_params.maxForce;
    }
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Mouse, 2, 3);

}}  // namespace lpc::LPC_PRECISION
