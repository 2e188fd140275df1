// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "algorithms/solver/step/free_motion.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Classical Runge-Kutta method of order four, rotation included. Rotations cannot be averaged like positions, so the
// stages use the rotation vector theta of q = exp(theta) q0 (Munthe-Kaas 1999), with the rate
//
// theta' = w - theta x w / 2 + theta x (theta x w) / 12 - ... (the next term is zero at this order)
//
// In 3D the method integrates angular momentum instead of angular velocity: without torque it stays constant, and the
// gyroscopic term needs no code of its own.
template <int D>
class Rk4 final : public Integrator<D> {
 public:
  using Params = NoParams;
  explicit Rk4(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "rk4",
            .summary = "fourth-order Runge-Kutta with the gyroscopic term; useful for free motion between contacts",
            .paper = "munthekaas1999",
            .complexity = "4 force evaluations",
            .guarantee = Guarantee::approximate,
            .failures = {
                {"a body at rest", "it hops: contacts stop the new velocity, but a mean velocity moves the body",
                 "Rest.Stays"},
                {"a box on a slope below the critical angle",
                 "it climbs by half of g dt^2 sin(angle) a step for the same reason", "Slope.HoldsOrSaysThatItDoesNot"},
                {"an oscillator for a thousand periods", "not symplectic: energy leaks by (w dt)^6/72 a step",
                 "Oscillator.KeepsEnergy"},
                {"a thin rod that rotates by 1.7 rad a step",
                 "its orientation drifts until its energy is a hundred times as large", "FreeTop.AddsNoEnergy"},
                {"bodies in contact that rotate together",
                 "they do not keep their angular momentum: forces are evaluated at poses without contacts",
                 "Solver.TurningKeepsAngularMomentum"}}};
  }

  void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) override {
    const std::size_t n = in.bodies.pose.size();
    begin(in, n);
    static constexpr Real kOffset[] = {0, Real(0.5), Real(0.5), 1};
    static constexpr Real kWeight[] = {Real(1) / 6, Real(1) / 3, Real(1) / 3, Real(1) / 6};
    for (int stage = 0; stage < 4; ++stage) {
      if (stage > 0) place(in, kOffset[stage] * in.dt);
      in.forces.eval({in.bodies, m_pose, m_motion}, in.time + kOffset[stage] * in.dt, m_wrenches);
      ++in.work[WorkCount::forceEvals];
      for (std::size_t i = 0; i < n; ++i) {
        Rate& k = m_rate[i];
        const bool turns = m_turns[i];
        k.v = m_motion[i].v;
        k.force = m_wrenches[i].force;
        k.theta = turns ? rate(stage > 0 ? m_theta[i] : Ang<D>(Ang<D>::Zero()), m_motion[i].w) : m_motion[i].w;
        k.torque = turns ? m_wrenches[i].torque : Ang<D>(Ang<D>::Zero());
        m_sum[i].v += kWeight[stage] * k.v;
        m_sum[i].force += kWeight[stage] * k.force;
        m_sum[i].theta += kWeight[stage] * k.theta;
        m_sum[i].torque += kWeight[stage] * k.torque;
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      drift[i] = {m_sum[i].v, m_sum[i].theta};
      Motion<D>& motion = in.bodies.motion[i];
      motion.v += (in.dt * in.bodies.invMass[i]) * m_sum[i].force;
      if (!m_turns[i]) continue;
      const Rot<D> q = integrateRotation(in.bodies.pose[i].q, Ang<D>(in.dt * m_sum[i].theta));
      const Ang<D> momentum = m_momentum[i] + in.dt * m_sum[i].torque;
      motion.w = rotateInertia(q, in.bodies.invInertiaBody[i]) * momentum;
    }
  }

 private:
  struct Rate {
    Vec<D> v = Vec<D>::Zero(), force = Vec<D>::Zero();
    Ang<D> theta = Ang<D>::Zero(), torque = Ang<D>::Zero();
  };

  void begin(const IntegrateInput<D>& in, std::size_t n) {
    const Bodies<D>& b = in.bodies;
    m_pose.assign(b.pose.begin(), b.pose.end());
    m_motion.assign(b.motion.begin(), b.motion.end());
    m_wrenches.resize(n), m_rate.resize(n), m_theta.resize(n), m_momentum.resize(n), m_turns.resize(n);
    m_sum.assign(n, Rate{});
    for (std::size_t i = 0; i < n; ++i) {
      const Inertia<D>& inverse = b.invInertiaBody[i];
      const bool regular = b.invInertia[i].trace() > 0 && inverse.determinant() > 0;
      m_turns[i] = in.model.rotation && regular;
      if (m_turns[i]) m_momentum[i] = rotateInertia(b.pose[i].q, Inertia<D>(inverse.inverse())) * b.motion[i].w;
    }
  }

  // Sets the state `h` seconds after the start from the rates of the last stage.
  void place(const IntegrateInput<D>& in, Real h) {
    const Bodies<D>& b = in.bodies;
    for (std::size_t i = 0; i < m_pose.size(); ++i) {
      const Rate& k = m_rate[i];
      m_pose[i].p = b.pose[i].p + h * k.v;
      m_motion[i].v = b.motion[i].v + (h * b.invMass[i]) * k.force;
      if (!m_turns[i]) continue;
      m_theta[i] = h * k.theta;
      m_pose[i].q = integrateRotation(b.pose[i].q, m_theta[i]);
      m_motion[i].w = rotateInertia(m_pose[i].q, b.invInertiaBody[i]) * (m_momentum[i] + h * k.torque);
    }
  }

  static Ang<2> rate(const Ang<2>&, const Ang<2>& w) { return w; }  // rotations in a plane commute
  static Ang<3> rate(const Ang<3>& theta, const Ang<3>& w) {
    const Ang<3> once = cross(theta, w);
    return w - once / 2 + cross(theta, once) / 12;
  }

  std::vector<Pose<D>> m_pose;
  std::vector<Motion<D>> m_motion;
  std::vector<Wrench<D>> m_wrenches;
  std::vector<Rate> m_rate, m_sum;
  std::vector<Ang<D>> m_theta, m_momentum;
  std::vector<std::uint8_t> m_turns;
};

}  // namespace

LPC_REGISTER(Integrator, Rk4, 2, 3);

}}  // namespace lpc::LPC_PRECISION
