// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "algorithms/solver/step/free_motion.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Semi-implicit (symplectic) Euler: position by the new velocity. Energy errors stay bounded up to w dt = 2. Free fall
// ends g T dt / 2 too low.
template <int D>
class SemiImplicitEuler final : public Integrator<D> {
 public:
  using Params = NoParams;
  explicit SemiImplicitEuler(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "semi_implicit_euler",
            .summary = "v by the old force, x by the new v; no gyroscopic term",
            .paper = "hairer2003",
            .complexity = "1 force evaluation",
            .guarantee = Guarantee::approximate,
            .failures = {{"a spinning body in 3D", "angular momentum is not kept", "FreeTop.KeepsAngularMomentum"}}};
  }

  void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) override {
    kick(in, m_wrenches);
    std::copy(in.bodies.motion.begin(), in.bodies.motion.end(), drift.begin());
  }

 private:
  std::vector<Wrench<D>> m_wrenches;
};

}  // namespace

LPC_REGISTER(Integrator, SemiImplicitEuler, 2, 3);

}}  // namespace lpc::LPC_PRECISION
