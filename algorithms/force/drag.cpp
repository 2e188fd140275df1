// SPDX-License-Identifier: Zlib
#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Drag of section 9.4.4 of the report, which uses the same two coefficients for linear and angular motion. It is
// explicit: if (linear + quadratic |v|) dt / m exceeds 2, the body is thrown back faster than it came.
template <int D>
class Drag final : public ForceKind<D> {
 public:
  struct Params {
    Real linear = Real(0.01), quadratic = Real(0.01), angularLinear = Real(0.01), angularQuadratic = Real(0.01);
    void visit(ParamVisitor& v) {
      v.real("linear", linear, 0, Real(1e12), "N s/m", "a of -(a + b |v|) v");
      v.real("quadratic", quadratic, 0, Real(1e12), "N s^2/m^2", "b of that");
      v.real("angular_linear", angularLinear, 0, Real(1e12), "N m s", "the same on the rotation");
      v.real("angular_quadratic", angularQuadratic, 0, Real(1e12), "N m s^2", "the same on the rotation");
    }
  };
  explicit Drag(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "drag",
            .summary = "air at rest: brakes by speed and its square, and the rotation, too",
            .paper = "lpc2009",
            .complexity = "1, or the number of bodies"};
  }

  ForceEnds ends() const override { return {}; }

  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    forEachActedOn(force, state.bodies, [&](std::size_t i) {
      const Motion<D>& motion = state.motion[i];
      out[i].force -= (m_params.linear + m_params.quadratic * motion.v.norm()) * motion.v;
      out[i].torque -= (m_params.angularLinear + m_params.angularQuadratic * motion.w.norm()) * motion.w;
    });
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(ForceKind, Drag, 2, 3);

}}  // namespace lpc::LPC_PRECISION
