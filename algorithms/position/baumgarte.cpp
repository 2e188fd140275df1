// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "framework/math/tolerances.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Baumgarte stabilisation: the velocity rows remove part of the position error. The velocity stays in the bodies as
// kinetic energy.
template <int D>
class Baumgarte final : public PositionResolver<D> {
 public:
  struct Params {
    Real factor = Real(0.2);
    Real slop = kLinearSlop;
    Real maxSpeed = 4;
    void visit(ParamVisitor& v) {
      v.real("factor", factor, 0, 1, "1", "fraction of the error corrected per step; near 1 it overshoots");
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
      v.real("max_speed", maxSpeed, 0, 1000, "m/s", "largest separation speed");
    }
  };
  explicit Baumgarte(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "baumgarte",
            .summary = "Baumgarte stabilisation: position errors become target velocities",
            .paper = "baumgarte1972",
            .complexity = "nothing beyond the velocity resolver",
            .guarantee = Guarantee::approximate,
            .failures = {{"deep overlap", "bodies leave with the speed of separation", "PositionError.AddsNoVelocity"},
                         {"deep overlap, after some steps", "bodies end separated", "PositionError.EndsInTouch"},
                         {"a joint error that is corrected", "its bodies keep the correction speed",
                          "JointStep.PullsLeaveNoSpeed"}},
            .noEffort = "it only sets targets, which the velocity resolver meets"};
  }

  Real bias(Real separation, Real dt) const override {
    return std::min(m_params.maxSpeed, std::max(Real(0), -separation - m_params.slop) * m_params.factor / dt);
  }
  Real jointBias(Real dt) const override { return m_params.factor / dt; }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(PositionResolver, Baumgarte, 2, 3);

}}  // namespace lpc::LPC_PRECISION
