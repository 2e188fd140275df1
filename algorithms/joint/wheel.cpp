// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// B is a wheel on A: its axle moves along the x axis of A's frame only, and it spins about the z axes of both frames.
// In 3D it does not steer: the axle keeps A's z.
template <int D>
class Wheel final : public JointKind<D> {
 public:
  struct Params : Axis {
    Params() { stiffness = 100, damping = 10; }
    void visit(ParamVisitor& v) {
      v.real("lower", lower, -kFarLimit, kFarLimit, "m", "least way of the axle along the x of A's frame");
      v.real("upper", upper, -kFarLimit, kFarLimit, "m", "largest way");
      v.real("stiffness", stiffness, 0, Real(1e12), "N/m", "of the suspension; 0: the axle slides freely");
      v.real("damping", damping, 0, Real(1e12), "N s/m", "of the suspension; also without stiffness");
      v.real("rest", rest, -kFarLimit, kFarLimit, "m", "way without force of the suspension");
      v.real("motor_speed", motorSpeed, Real(-1e6), Real(1e6), "rad/s", "of the wheel against A, about z");
      v.real("motor_torque", motorMost, 0, Real(1e12), "N m", "at most; 0: it spins freely");
    }
  };
  explicit Wheel(const Params& params) : m_params(params) { params.check("wheel", "motor_torque"); }

  static AlgorithmInfo info() {
    return {.name = "wheel",
            .summary = "an axle on a suspension with limits, whose wheel spins freely or by a motor; no steering",
            .paper = "catto2014",
            .complexity = "1 row in 2D, 4 in 3D, solved as one block, and 3 for limits, suspension and motor",
            .guarantee = Guarantee::approximate,
            .failures = {{"both limits within reach of one step", "only the nearer holds",
                          "JointConformance.OfTwoStopsTheNearerHoldsAlone"}}};
  }

  void begin(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    if (!(alignment(at) > 0)) throw UserError("'wheel' has axes more than a right angle apart; valid: axes that agree");
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 1; i < D; ++i) slide(at, i, out);
    const Ang<D> axle = alignAxes(at, out);
    const auto along = [&]() -> ConstraintRow<D>& { return slide(at, 0, out); };
    m_params.addLimits(out, along);
    m_params.addSpring(out, along);
    m_params.addMotor(out, [&]() -> ConstraintRow<D>& { return out.turn(axle, 0); });
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Wheel, 2, 3);

}}  // namespace lpc::LPC_PRECISION
