// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "algorithms/solver/step/free_motion.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Velocity Verlet: half a step of the old force, the motion, half a step of the new force. Order two, symplectic, exact
// in a constant field. Rotations integrate the angular momentum in the same way, so it stays constant without torque;
// they turn with the velocity at mid-step. A velocity-dependent force at the end of the step sees the velocity that the
// old force alone would give.
template <int D>
class VelocityVerlet final : public Integrator<D> {
 public:
  using Params = NoParams;
  explicit VelocityVerlet(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "velocity_verlet",
            .summary =
                "velocity Verlet: x from v and the old force, v from the mean of both forces; with the gyroscopic term",
            .paper = "hairer2003",
            .complexity = "2 force evaluations",
            .guarantee = Guarantee::approximate,
            .failures = {
                {"a body at rest", "it hops: contacts stop the new velocity, but the half-step velocity moves the body",
                 "Rest.Stays"},
                {"a box on a slope below the critical angle",
                 "it climbs by half of g dt^2 sin(angle) a step for the same reason", "Slope.HoldsOrSaysThatItDoesNot"},
                {"a thin rod that rotates by 1.7 rad a step",
                 "its orientation drifts until its energy is 45 times as large", "FreeTop.AddsNoEnergy"},
                {"bodies in contact that rotate together",
                 "they do not keep their angular momentum: forces are evaluated at poses without contacts",
                 "Solver.TurningKeepsAngularMomentum"}}};
  }

  void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) override {
    Bodies<D>& b = in.bodies;
    const std::size_t n = b.pose.size();
    m_wrenches.resize(n), m_pose.resize(n), m_momentum.resize(n), m_turns.resize(n);
    m_motion.assign(b.motion.begin(), b.motion.end());
    in.forces.eval({b, b.pose, b.motion}, in.time, m_wrenches);
    for (std::size_t i = 0; i < n; ++i) {
      const Motion<D>& start = b.motion[i];
      const Vec<D> push = (in.dt / 2 * b.invMass[i]) * m_wrenches[i].force;
      drift[i] = {start.v + push, start.w};
      m_motion[i].v = start.v + 2 * push;
      m_pose[i].p = b.pose[i].p + in.dt * drift[i].v;
      const Inertia<D>& inverse = b.invInertiaBody[i];
      m_turns[i] = in.model.rotation && b.invInertia[i].trace() > 0 && inverse.determinant() > 0;
      if (m_turns[i]) {
        const Ang<D> twist = in.dt / 2 * m_wrenches[i].torque;
        m_momentum[i] = rotateInertia(b.pose[i].q, Inertia<D>(inverse.inverse())) * start.w + twist;
        const Rot<D> middle = integrateRotation(b.pose[i].q, Ang<D>(in.dt / 2 * start.w));
        drift[i].w = rotateInertia(middle, inverse) * m_momentum[i];
        m_pose[i].q = integrateRotation(b.pose[i].q, Ang<D>(in.dt * drift[i].w));
        m_motion[i].w = rotateInertia(m_pose[i].q, inverse) * Ang<D>(m_momentum[i] + twist);
      } else {
        m_pose[i].q = integrateRotation(b.pose[i].q, Ang<D>(in.dt * start.w));
      }
    }
    in.forces.eval({b, m_pose, m_motion}, in.time + in.dt, m_wrenches);
    in.work[WorkCount::forceEvals] += 2;
    for (std::size_t i = 0; i < n; ++i) {
      b.motion[i].v = drift[i].v + (in.dt / 2 * b.invMass[i]) * m_wrenches[i].force;
      if (!m_turns[i]) continue;
      const Ang<D> momentum = m_momentum[i] + in.dt / 2 * m_wrenches[i].torque;
      b.motion[i].w = rotateInertia(m_pose[i].q, b.invInertiaBody[i]) * momentum;
    }
  }

 private:
  std::vector<Wrench<D>> m_wrenches;
  std::vector<Pose<D>> m_pose;      // at the end of the step
  std::vector<Motion<D>> m_motion;  // at the end of the step, by the forces of its start
  std::vector<Ang<D>> m_momentum;   // at mid-step
  std::vector<std::uint8_t> m_turns;
};

}  // namespace

LPC_REGISTER(Integrator, VelocityVerlet, 2, 3);

}}  // namespace lpc::LPC_PRECISION
