// SPDX-License-Identifier: Zlib
#include "algorithms/solver/frame_rows.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// B slides along the x of A's frame and does not turn against it. One row keeps the nearer of the two limits, one is
// the motor, one the spring.
template <int D>
class Prismatic final : public JointKind<D> {
 public:
  struct Params {
    Real lower = -kFarLimit, upper = kFarLimit;
    Real motorSpeed = 0, motorForce = 0;
    Real stiffness = 0, damping = 0, rest = 0;
    void visit(ParamVisitor& v) {
      v.real("lower", lower, -kFarLimit, kFarLimit, "m", "least way of B's frame along the x of A's");
      v.real("upper", upper, -kFarLimit, kFarLimit, "m", "largest way");
      v.real("motor_speed", motorSpeed, Real(-1e6), Real(1e6), "m/s", "that the motor tries to reach");
      v.real("motor_force", motorForce, 0, Real(1e12), "N", "at most; 0: no motor");
      v.real("stiffness", stiffness, 0, Real(1e12), "N/m", "of a spring along the axis");
      v.real("damping", damping, 0, Real(1e12), "N s/m", "of that spring; also without stiffness");
      v.real("rest", rest, -kFarLimit, kFarLimit, "m", "way without force of the spring");
    }
  };
  explicit Prismatic(const Params& params) : m_params(params) {
    if (params.lower > params.upper) throw UserError("'prismatic' has limits that cross; valid: lower <= upper");
    if (params.motorSpeed != 0 && params.motorForce == 0) {
      throw UserError("'prismatic' has a motor_speed, but no motor; valid: motor_force > 0, or motor_speed=0");
    }
    if (params.rest != 0 && params.stiffness == 0) {
      throw UserError("'prismatic' has a rest, but no spring; valid: stiffness > 0, or rest=0");
    }
  }

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
    if (m_params.lower == -kFarLimit && m_params.upper == kFarLimit) {
      out.absent();
    } else {
      keepBetween(slide(at, 0, out), m_params.lower, m_params.upper);
    }
    if (m_params.motorForce == 0) {
      out.absent();
    } else {
      drive(slide(at, 0, out), m_params.motorSpeed, m_params.motorForce);
    }
    if (m_params.stiffness == 0 && m_params.damping == 0) {
      out.absent();
    } else {
      ConstraintRow<D>& row = slide(at, 0, out);
      row.error -= m_params.rest;
      makeSpring(row, m_params.stiffness, m_params.damping);
    }
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Prismatic, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
