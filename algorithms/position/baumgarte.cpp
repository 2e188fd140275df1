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
      v.real("factor", factor, 0, 1, "1", "share of the error to remove in one step; near 1 overshoots");
      v.real("slop", slop, 0, 1, "m", "depth that stays, so that resting contacts do not come and go");
      v.real("max_speed", maxSpeed, 0, 1000, "m/s", "limit of the speed of separation");
    }
  };
  explicit Baumgarte(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "baumgarte",
            .summary = "position errors become target velocities",
            .paper = "baumgarte1972",
            .complexity = "nothing beyond the velocity resolver",
            .guarantee = Guarantee::approximate,
            .failures = {{"deep overlap", "bodies leave with the speed of separation", "PositionError.AddsNoVelocity"},
                         {"deep overlap, steps later", "bodies end apart", "PositionError.EndsInTouch"},
                         {"a joint that is pulled together", "its bodies go on with that speed",
                          "JointStep.PullsLeaveNoSpeed"}},
            .noEffort = "its targets are met by the velocity resolver"};
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
