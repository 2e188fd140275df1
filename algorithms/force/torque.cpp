// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cmath>

#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class TorqueMode { constant, speed };

// Applies a torque. With a target it applies what reaches the target speed within the step, up to its limit, so that
// the speed does not oscillate. It ignores other torques on the bodies and therefore lags behind by one step of those.
template <int D>
class TorqueGenerator final : public ForceKind<D> {
 public:
  struct Params {
    TorqueMode mode = TorqueMode::constant;
    Real torque = 1, speed = 1;
    Ang<D> axis = Ang<D>::Unit(kAngDim<D> - 1);
    void visit(ParamVisitor& v) {
      v.choice("mode", mode, {"constant", "speed"}, "the torque as it is, or as much of it as a speed needs");
      v.real("torque", torque, Real(-1e12), Real(1e12), "N m",
             "on B about the axis, and back on A; in 'speed' at most");
      v.real("speed", speed, Real(-1e6), Real(1e6), "rad/s", "of B against A, or the world: the target of 'speed'");
      if constexpr (D == 3) {
        constexpr const char* kNames[] = {"x", "y", "z"};
        for (int i = 0; i < 3; ++i)
          v.real(kNames[i], axis[i], -1, 1, "1",
                 i < 2 ? "of the axis, in A's own frame, or the world's" : "of the axis; about x or y alone, z=0");
      }
    }
  };
  explicit TorqueGenerator(const Params& params) : m_params(params) {
    if (params.mode == TorqueMode::speed && params.torque < 0) {
      throw UserError("'torque' drives to a speed by less than no torque; valid: torque >= 0");
    }
    if (params.mode == TorqueMode::constant && params.speed != Params{}.speed) {
      throw UserError("'torque' has a speed, but no target; valid: mode=speed");
    }
    const Real length = params.axis.norm();
    if (!(length > Real(1e-6))) throw UserError("'torque' has an axis of no length; valid: such as x=0,y=0,z=1");
    m_params.axis /= length;
  }

  static AlgorithmInfo info() {
    return {.name = "torque",
            .summary = "turns a body, against the world or another one, evenly or to a speed by a limited torque",
            .paper = "lpc2009",
            .complexity = "1, or the number of bodies"};
  }

  ForceEnds ends() const override { return {.from = true}; }

  void begin(const ForceRecord<D>& force, const Pose<D>&, const Pose<D>&) const override {
    if (force.bodyA < 0 || force.bodyB >= 0) return;
    throw UserError("force 'torque' from one body turns one other; valid: both, or no body that it comes from");
  }

  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    const Bodies<D>& bodies = state.bodies;
    const auto a = static_cast<std::size_t>(force.bodyA);
    const bool fromBody = force.bodyA >= 0;
    const Ang<D> axis = fromBody ? turned(state.pose[a].q, m_params.axis) : m_params.axis;
    const auto ease = [&](std::size_t i) {  // rad/s per N m s
      if (!movedByForces(bodies, i)) return Real(0);
      return axis.dot(rotateInertia(state.pose[i].q, bodies.invInertiaBody[i]) * axis);
    };
    const auto drive = [&](std::size_t b) {
      Real torque = m_params.torque;
      if (m_params.mode == TorqueMode::speed) {
        const Real back = fromBody ? axis.dot(state.motion[a].w) : Real(0);
        const Real missing = m_params.speed - (axis.dot(state.motion[b].w) - back);
        const Real needed = std::abs(missing), gain = (ease(b) + (fromBody ? ease(a) : Real(0))) * state.dt;
        if (needed < torque * gain) torque = needed / gain;
        if (missing < 0) torque = -torque;
        if (missing == 0) torque = 0;
      }
      if (movedByForces(bodies, b)) out[b].torque += torque * axis;
      if (fromBody && movedByForces(bodies, a)) out[a].torque -= torque * axis;
    };
    if (force.bodyB >= 0) return drive(static_cast<std::size_t>(force.bodyB));  // A may be fixed; B is then driven
    forEachActedOn(force, bodies, drive);
  }

 private:
  static Ang<2> turned(const Rot<2>&, const Ang<2>& axis) { return axis; }
  static Ang<3> turned(const Rot<3>& q, const Ang<3>& axis) { return q * axis; }

  Params m_params;
};

}  // namespace

LPC_REGISTER(ForceKind, TorqueGenerator, 2, 3);

}}  // namespace lpc::LPC_PRECISION
