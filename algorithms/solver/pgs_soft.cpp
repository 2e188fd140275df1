// SPDX-License-Identifier: Zlib
#include "algorithms/solver/substep.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// Soft contacts without sub-steps: many sweeps on one set of separations, one move, and then some without springs. It
// is soft_step with one sub-step of several sweeps, but for three things. Joints are rigid and pushed as tgs does: a
// spring's push over a whole step, taken out again, is what its joint gives way by. The springs of contacts may be
// twice as stiff for the step, or three boxes sink beyond the slop at 15 Hz. And they stop what closes a gap, too: a
// ball lands within rounding of the surface, and its next step may not depend on which side that is.
//
// Two sweeps of relaxing leave what hits a hinge's stop 12 mm from where 61440 steps a second take it, as ten
// iterations of split_solver do (11 mm); five leave 8 mm, ten 3 mm.
template <int D>
class PgsSoft final : public Solver<D> {
 public:
  struct Params {
    int iterations = 10;
    Real hertz = 30, dampingRatio = 10, pushSpeed = 3, jointFactor = Real(0.2);
    int relax = 2;
    bool warmStart = true;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "sweeps over all joints and contacts");
      v.real("hertz", hertz, 0, 100000, "1/s", "stiffness of contacts; limited to half of the step rate");
      v.real("damping_ratio", dampingRatio, 0, 1000, "1", "of contacts; large: they do not bounce");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "limit of the speed at which overlap is undone");
      v.real("joint_factor", jointFactor, 0, 1, "1", "share of a joint's error to remove in one step");
      v.integer("relax", relax, 0, 100000, "sweeps without springs and push after the move");
      v.flag("warm_start", warmStart, "start from the impulses of the last step");
    }
  };
  explicit PgsSoft(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "pgs_soft",
            .summary = "sequential impulses on soft contacts, relaxed after the move, restitution at the end",
            .paper = "catto2024",
            .complexity = "(iterations + relax) x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {{"a body on a very heavy one",
                          "sinks in deeper than on a fixed one, whose springs are stiffer", "Symmetry.HeavyIsFixed"},
                         {"a hinge that is beyond its stop",
                          "leaves it with a speed: two sweeps take too little out of stop and pivot, which are coupled",
                          "JointStep.LeavesNoSpeed"},
                         {"bodies that press on each other and turn together",
                          "lose angular momentum: they are relaxed after the move by arms of before it",
                          "Solver.TurningKeepsAngularMomentum"},
                         {"a heavy body that falls on a light one",
                          "is braked by springs and by relaxing, not as sweeps do", "Solver.ConvergesAsPredicted"}},
            .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_step.prepare(in, 1, m_params.warmStart);
    const Real hertz = std::min(m_params.hertz, Real(0.5) / in.dt), ratio = m_params.dampingRatio;
    const Push push{Softness(hertz, ratio, in.dt),
                    Softness(2 * hertz, ratio, in.dt),
                    {.rate = m_params.jointFactor / in.dt},
                    0,
                    m_params.pushSpeed,
                    true};
    m_step.begin(in, 0);
    m_step.solve(in, push, m_params.iterations);
    m_step.move(in);
    m_step.relax(in, m_params.relax);
    m_step.end();
    m_step.finish(in);
  }

 private:
  Params m_params;
  Substeps<D> m_step;
};

}  // namespace

LPC_REGISTER(Solver, PgsSoft, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
