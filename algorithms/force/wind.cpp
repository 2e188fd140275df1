// SPDX-License-Identifier: Zlib
#include <cmath>

#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Drag against moving air, at the centre of mass, so without torque. Gusts rise and fall linearly, because sine has
// different bits in different libraries.
template <int D>
class Wind final : public ForceKind<D> {
 public:
  struct Params {
    Vec<D> velocity = Vec<D>::Unit(0);
    Real linear = Real(0.1), quadratic = 0, gust = 0, period = 1;
    void visit(ParamVisitor& v) {
      constexpr const char* kNames[] = {"x", "y", "z"};
      for (int i = 0; i < D; ++i) {
        v.real(kNames[i], velocity[i], Real(-1e6), Real(1e6), "m/s",
               "velocity of the air along this axis of the world");
      }
      v.real("linear", linear, 0, Real(1e12), "N s/m", "a of -(a + b |u|) u, of the velocity u in the air");
      v.real("quadratic", quadratic, 0, Real(1e12), "N s^2/m^2", "b of that");
      v.real("gust", gust, 0, 1, "1", "share of the velocity by which it rises and falls");
      v.real("period", period, Real(1e-6), Real(1e6), "s", "of the gusts");
    }
  };
  explicit Wind(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "wind",
            .summary = "air that moves, in gusts or evenly: takes bodies along by speed in it and its square",
            .paper = "",
            .complexity = "1, or the number of bodies"};
  }

  ForceEnds ends() const override { return {}; }

  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override {
    const Vec<D> air = (1 + m_params.gust * wave(t / m_params.period)) * m_params.velocity;
    forEachActedOn(force, state.bodies, [&](std::size_t i) {
      const Vec<D> u = state.motion[i].v - air;
      out[i].force -= (m_params.linear + m_params.quadratic * u.norm()) * u;
    });
  }

 private:
  // Triangle wave: 0, 1, -1, 0 within one period.
  static Real wave(Real periods) {
    const Real phase = periods - std::floor(periods);
    if (phase < Real(0.25)) return 4 * phase;
    return phase < Real(0.75) ? 2 - 4 * phase : 4 * phase - 4;
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(ForceKind, Wind, 2, 3);

}}  // namespace lpc::LPC_PRECISION
