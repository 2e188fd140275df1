// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// B slides along the x axis of A's frame and does not turn relative to it. One row holds the nearer of the two limits,
// one is the motor, one the spring.
template <int D>
class Prismatic final : public JointKind<D> {
 public:
  struct Params : Axis {
    void visit(ParamVisitor& v) {
      v.real("lower", lower, -kFarLimit, kFarLimit, "m", "least way of B's frame along the x of A's");
      v.real("upper", upper, -kFarLimit, kFarLimit, "m", "largest way");
      v.real("motor_speed", motorSpeed, Real(-1e6), Real(1e6), "m/s", "that the motor tries to reach");
      v.real("motor_force", motorMost, 0, Real(1e12), "N", "at most; 0: no motor");
      v.real("stiffness", stiffness, 0, Real(1e12), "N/m", "of a spring along the axis");
      v.real("damping", damping, 0, Real(1e12), "N s/m", "of that spring; also without stiffness");
      v.real("rest", rest, -kFarLimit, kFarLimit, "m", "way without force of the spring");
    }
  };
  explicit Prismatic(const Params& params) : m_params(params) { params.check("prismatic", "motor_force"); }

  static AlgorithmInfo info() {
    return {.name = "prismatic",
            .summary = "slides along one axis, between limits, by a motor, against a spring; does not turn",
            .paper = "catto2014",
            .complexity = "2 rows in 2D, 5 in 3D, solved as one block, and 3 for limits, motor and spring",
            .guarantee = Guarantee::approximate,
            .failures = {{"both limits within reach of one step", "only the nearer holds",
                          "JointConformance.OfTwoStopsTheNearerHoldsAlone"}}};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 1; i < D; ++i) slide(at, i, out);
    const Ang<D> turn = turnInA(at);
    for (int i = 0; i < kAngDim<D>; ++i) out.turn(axisOfTurn(at, i), turn[i]);
    const auto make = [&]() -> ConstraintRow<D>& { return slide(at, 0, out); };
    m_params.addLimits(out, make);
    m_params.addMotor(out, make);
    m_params.addSpring(out, make);
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Prismatic, 2, 3);

}}  // namespace lpc::LPC_PRECISION
