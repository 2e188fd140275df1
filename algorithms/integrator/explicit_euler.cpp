// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "algorithms/solver/step/free_motion.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Explicit Euler: position by the old velocity, velocity by the old force. Free fall ends g T dt / 2 too high;
// oscillators gain energy without bound.
template <int D>
class ExplicitEuler final : public Integrator<D> {
 public:
  using Params = NoParams;
  explicit ExplicitEuler(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "explicit_euler",
            .summary = "x by the old v, v by the old force; no gyroscopic term",
            .paper = "euler1768",
            .complexity = "1 force evaluation",
            .guarantee = Guarantee::approximate,
            .failures = {
                {"any oscillator", "the amplitude grows by sqrt(1 + (w dt)^2) a step", "Oscillator.Bounded"},
                {"any oscillator", "its energy doubles again and again", "Oscillator.KeepsEnergy"},
                {"a body at rest", "it hops: contacts stop the new velocity, it travels by the old one", "Rest.Stays"},
                {"a box on a slope that holds it", "climbs by g dt^2 sin(angle) a step for the same reason",
                 "Slope.HoldsOrSaysThatItDoesNot"},
                {"a spinning body in 3D", "angular momentum is not kept", "FreeTop.KeepsAngularMomentum"},
                {"bodies that press on each other and turn together",
                 "gain angular momentum: they travel without what their forces give them in this step",
                 "Solver.TurningKeepsAngularMomentum"}}};
  }

  void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) override {
    std::copy(in.bodies.motion.begin(), in.bodies.motion.end(), drift.begin());
    kick(in, m_wrenches);
  }

 private:
  std::vector<Wrench<D>> m_wrenches;
};

}  // namespace

LPC_REGISTER(Integrator, ExplicitEuler, 2, 3);

}}  // namespace lpc::LPC_PRECISION
