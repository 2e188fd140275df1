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
    bool warmStart = true, gyroscopic = false;
    Joints joints = Joints::soft;
    Gaps gaps = Gaps::rigid;
    RelaxAt relaxAt = RelaxAt::start;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "passes over all joints and contacts", ParamRole::effort);
      v.real("hertz", hertz, 0, 100000, "1/s", "stiffness of contacts; limited to half of the step rate");
      v.real("damping_ratio", dampingRatio, 0, 1000, "1", "damping ratio of contacts; large values prevent bouncing");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "largest speed at which penetration is corrected");
      v.choice(
          "joints", joints, {"soft", "rigid"},
          "soft: springs with twice the stiffness of contacts (published); rigid: a fraction of the error per step");
      v.real("joint_damping_ratio", jointDampingRatio, 0, 1000, "1", "joints=soft only: damping ratio of joints");
      v.real("joint_factor", jointFactor, 0, 1, "1", "joints=rigid only: fraction of an error corrected per step");
      v.choice("gaps", gaps, {"rigid", "soft"},
               "how a closing gap is stopped: rigidly (published) or by the contact's spring");
      v.integer("relax", relax, 0, 100000, "relaxation passes after the move, without springs and position correction",
                ParamRole::effort);
      v.choice("relax_at", relaxAt, {"start", "end"},
               "separations in the relaxation passes: of the step's start (published) or end");
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.flag("gyroscopic", gyroscopic, "implicit gyroscopic term, in 3D; published: false");
    }
  };
  explicit PgsSoft(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "pgs_soft",
        .summary = "soft contacts by sequential impulses, relaxed after the position update, then restitution",
        .paper = "catto2024",
        .complexity = "(iterations + relax) x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures =
            {kNoGyroscopicTerm,
             {"a spring of a hinge or slider that moves a body on a long arm",
              "its period is too long, because the joint is another spring in series; joints=rigid is right",
              "KnownAnswer.torsion_pendulum"},
             {"a body on a very heavy one", "it sinks deeper than on a static body, which gets stiffer springs",
              "Symmetry.HeavyIsFixed"},
             {"a hinge beyond its limit",
              "it keeps a speed after correction: two relaxation passes are too few for the coupled limit and pivot",
              "JointStep.LeavesNoSpeed"},
             {"bodies in contact that rotate together",
              "they lose angular momentum: relaxation after the move uses lever arms from before it",
              "Solver.TurningKeepsAngularMomentum"},
             {"a motor with a million times the needed torque, at a joint limit",
              "it drives through the limit, which is a spring; joints=rigid holds", "Joint.StopHoldsAgainstItsMotor"},
             {"a joint, with shorter and shorter steps",
              "its error shrinks slower than the step, because relaxation removes the spring's impulse; joints=rigid "
              "converges",
              "JointMotion.Converges"},
             {"a body that lands within rounding of the surface",
              "a rigid law stops it on one side of the surface, a spring on the other; gaps=soft has one law",
              "Parting.EverySolverAgreesUntilTheFirstImpact"},
             {"a heavy body that falls on a light one",
              "soft contacts and relaxation slow it, not at the Gauss-Seidel rate", "Solver.ConvergesAsPredicted"}},
        .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_step.prepare(in, {1, m_params.warmStart, m_params.gyroscopic});
    const Real most = Real(0.5) / in.dt, hertz = std::min(m_params.hertz, most), ratio = m_params.dampingRatio;
    const Feedback joints = m_params.joints == Joints::rigid
                                ? Feedback{.rate = m_params.jointFactor / in.dt}
                                : Softness(std::min(2 * m_params.hertz, most), m_params.jointDampingRatio, in.dt);
    const ErrorFeedback errors{
        Softness(hertz, ratio, in.dt), Softness(2 * hertz, ratio, in.dt), joints, 0, m_params.pushSpeed,
        m_params.gaps == Gaps::soft};
    m_step.step(in, 0, errors, m_params.iterations, m_params.relax, m_params.relaxAt == RelaxAt::end);
    m_step.finish(in);
  }

 private:
  Params m_params;
  Substeps<D> m_step;
};

}  // namespace

LPC_REGISTER(Solver, PgsSoft, 2, 3);

}}  // namespace lpc::LPC_PRECISION
