// SPDX-License-Identifier: Zlib
#include <cmath>

#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// The rotation of a frame relative to the world about its own z: the twist of swing and twist. A rotation about z adds
// to it whatever the swing is.
Real axisOf(const Rot<2>&) { return 1; }
Vec<3> axisOf(const Rot<3>& q) { return q * Vec<3>(0, 0, 1); }
double twist(const Rot<2>& q, bool) { return angleOf(q.s, q.c); }
// Twist is undefined where z is opposite to the world's; it is then measured against the world turned by pi about x.
double twist(const Rot<3>& q, bool turnedRound) { return turnedRound ? 2 * angleOf(q.y, -q.x) : 2 * angleOf(q.z, q.w); }

// Keeps angle(A) + ratio angle(B) constant, each about the z axis of its frame. ratio = r_B / r_A > 0: two gears, which
// turn oppositely, w_A = -ratio w_B. ratio < 0: a belt. Each wheel needs its own hinge, since this joint holds no
// position and no axis. Angles are measured against the world, which takes the imbalance of the two torques.
template <int D>
class Gear final : public JointKind<D> {
 public:
  struct Params {
    Real ratio = 1;
    void visit(ParamVisitor& v) {
      v.real("ratio", ratio, Real(-1e4), Real(1e4), "1", "turns of A for one of B the other way; < 0: the same way");
    }
  };
  explicit Gear(const Params& params) : m_ratio(params.ratio) {
    if (m_ratio == 0) throw UserError("'gear' has the ratio 0; valid: other numbers");
  }

  static AlgorithmInfo info() {
    return {.name = "gear",
            .summary = "two bodies on hinges turn in a ratio; counts whole turns",
            .paper = "catto2014",
            .complexity = "1 row",
            .guarantee = Guarantee::approximate,
            .failures = {{"half a turn in a step", "it is taken for the rest of the turn, the other way",
                          "JointConformance.AGearLosesTurnsOfHalfATurnAStep"}}};
  }

  void begin(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    joint.state = {0, 0, 0, static_cast<Real>((pointsDown(at.qA) ? 1 : 0) + (pointsDown(at.qB) ? 2 : 0))};
    finish(joint, X_WA, X_WB);
    joint.state[2] = static_cast<Real>(sum(joint, at));
  }

  // Divided by the ratio: radians of B, and the torque on B.
  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    const double error = (sum(joint, at) - double(joint.state[2])) / double(m_ratio);
    ConstraintRow<D>& row = out.turn(Ang<D>(axisOf(at.qB)), static_cast<Real>(error));
    row.armA = Ang<D>(axisOf(at.qA)) / -m_ratio;
  }

  // Counts whole turns from step to step, assuming less than half a turn in each.
  void finish(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    joint.state[0] = static_cast<Real>(angleA(joint, at)), joint.state[1] = static_cast<Real>(angleB(joint, at));
  }

 private:
  static constexpr double kTurn = 6.283185307179586;

  static bool pointsDown(const Rot<2>&) { return false; }
  static bool pointsDown(const Rot<3>& q) { return axisOf(q)[2] < 0; }

  static double unwrapped(double angle, Real last) {
    return angle + kTurn * std::floor((double(last) - angle) / kTurn + 0.5);
  }
  static double angleA(const JointRecord<D>& joint, const JointFrames<D>& at) {
    return unwrapped(twist(at.qA, joint.state[3] == 1 || joint.state[3] == 3), joint.state[0]);
  }
  static double angleB(const JointRecord<D>& joint, const JointFrames<D>& at) {
    return unwrapped(twist(at.qB, joint.state[3] >= 2), joint.state[1]);
  }
  // In double even if Real is float: after many turns the sum is otherwise only rounding.
  double sum(const JointRecord<D>& joint, const JointFrames<D>& at) const {
    return angleA(joint, at) + double(m_ratio) * angleB(joint, at);
  }

  Real m_ratio;
};

}  // namespace

LPC_REGISTER(JointKind, Gear, 2, 3);

}}  // namespace lpc::LPC_PRECISION
