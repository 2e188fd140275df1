// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// The angle of B relative to A about the axis: 0 where their frames agree.
Real hingeAngle(const Rot<2>& q_AB) { return static_cast<Real>(angleOf(q_AB.s, q_AB.c)); }
// The twist of swing and twist: the swing has no component about z.
Real hingeAngle(const Rot<3>& q_AB) { return static_cast<Real>(2 * angleOf(q_AB.z, q_AB.w)); }

// In 2D a pivot, in 3D a rotation about the z axes of the two frames. One row holds the nearer of the two limits, one
// is the motor, one the spring.
template <int D>
class Hinge final : public JointKind<D> {
 public:
  struct Params : Axis {
    void visit(ParamVisitor& v) {
      v.real("lower", lower, -kFarLimit, kFarLimit, "rad", "least angle of B against A; counts whole turns");
      v.real("upper", upper, -kFarLimit, kFarLimit, "rad", "largest angle");
      v.real("motor_speed", motorSpeed, Real(-1e6), Real(1e6), "rad/s", "that the motor tries to reach");
      v.real("motor_torque", motorMost, 0, Real(1e12), "N m", "at most; 0: no motor");
      v.real("stiffness", stiffness, 0, Real(1e12), "N m/rad", "of a spring about the axis");
      v.real("damping", damping, 0, Real(1e12), "N m s/rad", "of that spring; also without stiffness");
      v.real("rest", rest, -kFarLimit, kFarLimit, "rad", "angle without torque of the spring");
    }
  };
  explicit Hinge(const Params& params) : m_params(params) { params.check("hinge", "motor_torque"); }

  static AlgorithmInfo info() {
    return {.name = "hinge",
            .summary = "turns about one axis, between limits, by a motor, against a spring",
            .paper = "catto2014",
            .complexity = "2 rows in 2D, 5 in 3D, solved as one block, and 3 for limits, motor and spring",
            .guarantee = Guarantee::approximate,
            .failures = {{"both limits within reach of one step", "only the nearer holds",
                          "JointConformance.AHingeKeepsTheNearerStopAlone"}}};
  }

  void begin(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    if (!(alignment(at) > 0)) throw UserError("'hinge' has axes more than a right angle apart; valid: axes that agree");
    finish(joint, X_WA, X_WB);
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 0; i < D; ++i) out.point(Vec<D>::Unit(i), at.rA, at.rB, at.gap[i]);
    const Ang<D> axis = alignAxes(at, out);
    const Real angle = unwrapped(joint, at);
    const auto make = [&]() -> ConstraintRow<D>& { return out.turn(axis, angle); };
    m_params.addLimits(out, make);
    m_params.addMotor(out, make);
    m_params.addSpring(out, make);
  }

  // Counts whole turns from step to step, assuming less than half a turn in each.
  void finish(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    joint.state[0] = unwrapped(joint, JointFrames<D>(joint, X_WA, X_WB));
  }

 private:
  static constexpr double kTurn = 6.283185307179586;

  static Real unwrapped(const JointRecord<D>& joint, const JointFrames<D>& at) {
    const double angle = hingeAngle(at.qA.inverse() * at.qB);
    return static_cast<Real>(angle + kTurn * std::floor((joint.state[0] - angle) / kTurn + 0.5));
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Hinge, 2, 3);

}}  // namespace lpc::LPC_PRECISION
