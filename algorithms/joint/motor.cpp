// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

enum class MotorMode { target, friction };

// Damped springs to a target, with limited force. They are implicit, so any gain is stable at any step; a speed in
// proportion to the error is not. Without a target it is a brake: dry friction between two bodies that need not touch.
template <int D>
class Motor final : public JointKind<D> {
 public:
  struct Params {
    MotorMode mode = MotorMode::target;
    Vec<D> offset = Vec<D>::Zero();
    Real angle = 0;
    Real stiffness = 100, damping = 20, maxForce = 1000;
    Real angularStiffness = 100, angularDamping = 20, maxTorque = 1000;
    void visit(ParamVisitor& v) {
      v.choice("mode", mode, {"target", "friction"}, "drives B's frame to a place in A's, or brakes whatever moves");
      constexpr const char* kNames[] = {"x", "y", "z"};
      for (int i = 0; i < D; ++i) {
        v.real(kNames[i], offset[i], Real(-1e6), Real(1e6), "m", "target of B's frame, along this axis of A's");
      }
      v.real("angle", angle, Real(-3.14159), Real(3.14159), "rad", "target of B's frame, about A's z");
      v.real("stiffness", stiffness, 0, Real(1e12), "N/m", "of the drive to the place");
      v.real("damping", damping, 0, Real(1e12), "N s/m", "of that drive");
      v.real("max_force", maxForce, 0, Real(1e12), "N", "at most, along each axis of A's frame");
      v.real("angular_stiffness", angularStiffness, 0, Real(1e12), "N m/rad", "of the drive to the attitude");
      v.real("angular_damping", angularDamping, 0, Real(1e12), "N m s/rad", "of that drive");
      v.real("max_torque", maxTorque, 0, Real(1e12), "N m", "at most, about each axis of A's frame");
    }
  };
  explicit Motor(const Params& params) : m_params(params) {
    if (params.mode == MotorMode::target) return;
    const Params usual;
    if (params.offset != usual.offset || params.angle != usual.angle) {
      throw UserError("'motor' has a target, but only brakes; valid: mode=target");
    }
    if (params.stiffness != usual.stiffness || params.damping != usual.damping ||
        params.angularStiffness != usual.angularStiffness || params.angularDamping != usual.angularDamping) {
      throw UserError("'motor' has stiffness or damping, but only brakes; valid: mode=target");
    }
  }

  static AlgorithmInfo info() {
    return {.name = "motor",
            .summary = "drives a body to a place and an attitude by limited force, or brakes it by friction",
            .paper = "catto2011",
            .complexity = "3 rows in 2D, 6 in 3D, one by one"};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 0; i < D; ++i) {
      ConstraintRow<D>& row = slide(at, i, out);
      row.error -= m_params.offset[i];
      act(row, m_params.stiffness, m_params.damping, m_params.maxForce);
    }
    at.qB = at.qB * aboutZ(-m_params.angle);
    const Ang<D> turn = turnInA(at);
    for (int i = 0; i < kAngDim<D>; ++i) {
      act(out.turn(axisOfTurn(at, i), turn[i]), m_params.angularStiffness, m_params.angularDamping, m_params.maxTorque);
    }
  }

 private:
  static Rot<D> aboutZ(Real angle) {
    if constexpr (D == 2) {
      return Rot<2>::angle(double(angle));
    } else {
      return Rot<3>::vector(Vec<3>(0, 0, angle));
    }
  }
  void act(ConstraintRow<D>& row, Real stiffness, Real damping, Real most) const {
    if (m_params.mode == MotorMode::friction) return drive(row, 0, most);
    makeSpring(row, stiffness, damping);
    row.lo = -most, row.hi = most;
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Motor, 2, 3);

}}  // namespace lpc::LPC_PRECISION
