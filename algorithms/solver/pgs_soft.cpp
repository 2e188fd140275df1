// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/substep.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Soft contacts and joints without sub-steps: many sweeps on one set of separations, one move, then some sweeps without
// springs on the same separations. Three parameters depart from the source where the defaults fail:
// joints=rigid     Each step removes a share of a joint's error, as in tgs. Relaxing then removes no spring force.
// gaps=soft        Springs also act on closing gaps, so that the law has no jump at touch.
// relax_at=end     Relaxing uses the separations after the move.
template <int D>
class PgsSoft final : public Solver<D> {
 public:
  enum class Joints { soft, rigid };
  enum class Gaps { rigid, soft };
  enum class RelaxAt { start, end };
  struct Params {
    int iterations = 10;
    Real hertz = 30, dampingRatio = 10, pushSpeed = 3, jointDampingRatio = 1, jointFactor = Real(0.2);
    int relax = 2;
    bool warmStart = true;
    Joints joints = Joints::soft;
    Gaps gaps = Gaps::rigid;
    RelaxAt relaxAt = RelaxAt::start;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "sweeps over all joints and contacts", ParamRole::effort);
      v.real("hertz", hertz, 0, 100000, "1/s", "stiffness of contacts; limited to half of the step rate");
      v.real("damping_ratio", dampingRatio, 0, 1000, "1", "of contacts; large: they do not bounce");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "limit of the speed at which overlap is undone");
      v.choice("joints", joints, {"soft", "rigid"}, "springs of twice the stiffness, as published, or a share a step");
      v.real("joint_damping_ratio", jointDampingRatio, 0, 1000, "1", "joints=soft only");
      v.real("joint_factor", jointFactor, 0, 1, "1", "joints=rigid only: share of an error to remove in one step");
      v.choice("gaps", gaps, {"rigid", "soft"},
               "how a closing gap is stopped: at once, as published, or by its spring");
      v.integer("relax", relax, 0, 100000, "sweeps without springs and push after the move", ParamRole::effort);
      v.choice("relax_at", relaxAt, {"start", "end"}, "separations of these sweeps: of the step's start, as published");
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
            .failures =
                {{"a body on a very heavy one", "sinks in deeper than on a fixed one, whose springs are stiffer",
                  "Symmetry.HeavyIsFixed"},
                 {"a hinge that is beyond its stop",
                  "leaves it with a speed: two sweeps take too little out of stop and pivot, which are coupled",
                  "JointStep.LeavesNoSpeed"},
                 {"bodies that press on each other and turn together",
                  "lose angular momentum: they are relaxed after the move by arms of before it",
                  "Solver.TurningKeepsAngularMomentum"},
                 {"a motor of a million times the torque that its body needs, at a stop",
                  "drives through the stop, which is a spring; joints=rigid holds", "Joint.StopHoldsAgainstItsMotor"},
                 {"a joint in ever shorter steps",
                  "its error falls slower than the step, because relaxing removes the push of its spring; joints=rigid "
                  "converges",
                  "JointMotion.Converges"},
                 {"a body that lands within rounding of the surface",
                  "is stopped at once on one side of it and by a spring on the other; gaps=soft has one law",
                  "Parting.EverySolverAgreesUntilTheFirstImpact"},
                 {"a heavy body that falls on a light one", "is braked by springs and by relaxing, not as sweeps do",
                  "Solver.ConvergesAsPredicted"}},
            .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_step.prepare(in, 1, m_params.warmStart);
    const Real most = Real(0.5) / in.dt, hertz = std::min(m_params.hertz, most), ratio = m_params.dampingRatio;
    const Feedback joints = m_params.joints == Joints::rigid
                                ? Feedback{.rate = m_params.jointFactor / in.dt}
                                : Softness(std::min(2 * m_params.hertz, most), m_params.jointDampingRatio, in.dt);
    const Push push{Softness(hertz, ratio, in.dt), Softness(2 * hertz, ratio, in.dt), joints, 0, m_params.pushSpeed,
                    m_params.gaps == Gaps::soft};
    m_step.step(in, 0, push, m_params.iterations, m_params.relax, m_params.relaxAt == RelaxAt::end);
    m_step.finish(in);
  }

 private:
  Params m_params;
  Substeps<D> m_step;
};

}  // namespace

LPC_REGISTER(Solver, PgsSoft, 2, 3);

}}  // namespace lpc::LPC_PRECISION
