// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/substep.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Sub-steps with one detection: separations follow from the anchors. Each sub-step solves soft contacts, moves the
// bodies, and solves again without the springs, which removes the velocity that the springs added. Restitution comes
// last.
template <int D>
class SoftStep final : public Solver<D> {
 public:
  enum class Arms { turning, asMade };
  enum class Joints { soft, rigid };
  struct Params {
    int substeps = 4;
    Real hertz = 30, dampingRatio = 10, pushSpeed = 3, jointDampingRatio = 2, jointFactor = Real(0.2);
    int relax = 1;
    bool warmStart = true, gyroscopic = false;
    ContactsOf contacts = ContactsOf::step;
    Joints joints = Joints::soft;
    Arms arms = Arms::turning;
    bool bounceFriction = false;
    SweepOrder order = SweepOrder::stored;
    SweepLanes lanes = SweepLanes::automatic;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step", ParamRole::effort);
      v.real("hertz", hertz, 0, 100000, "1/s", "stiffness of contacts; limited to a quarter of the sub-step rate");
      v.real("damping_ratio", dampingRatio, 0, 1000, "1", "damping ratio of contacts; large values prevent bouncing");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "largest speed at which penetration is corrected");
      v.choice("joints", joints, {"soft", "rigid"},
               "soft: springs twice as stiff as contacts (published); rigid: a fraction of the error per step");
      v.real("joint_damping_ratio", jointDampingRatio, 0, 1000, "1", "joints=soft only: damping ratio of joints");
      v.real("joint_factor", jointFactor, 0, 1, "1", "joints=rigid only: fraction of an error corrected per step");
      v.integer("relax", relax, 0, 100, "relaxation passes without springs after each move");
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.flag("gyroscopic", gyroscopic, "implicit gyroscopic term, in 3D; published: false");
      visitContactsOf(v, contacts);
      visitSweepOrder(v, order), visitSweepLanes(v, lanes);
      v.choice("arms", arms, {"turning", "as_made"},
               "lever arms of cached points: current, or frozen at creation as in Box2D 3, which misses a lean");
      v.flag("bounce_friction", bounceFriction, "friction also acts on restitution impulses; published: false");
    }
  };
  explicit SoftStep(const Params& params) : m_params(params) {
    if (params.contacts == ContactsOf::substep && params.arms == Arms::asMade) {
      throw UserError("'soft_step' has contacts=substep and arms=as_made; valid: contacts=substep with arms=turning");
    }
  }

  static AlgorithmInfo info() {
    return {.name = "soft_step",
            .summary = "sub-steps with soft contacts, relaxed after each position update, then restitution",
            .paper = "catto2024",
            .complexity = "substeps x (1 + relax) x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = substepFailures(
                "soft contacts and relaxation slow it, not at the Gauss-Seidel rate",
                {kArmsStay,
                 {"a spring of a hinge or slider that moves a body on a long arm",
                  "its period is too long, because the joint is another spring in series; joints=rigid is right",
                  "KnownAnswer.torsion_pendulum"},
                 {"a body on a very heavy one", "it sinks deeper than on a static body, which gets stiffer springs",
                  "Symmetry.HeavyIsFixed"},
                 {"a motor with a million times the needed torque, at a joint limit",
                  "it drives through the limit, which is a spring", "Joint.StopHoldsAgainstItsMotor"},
                 {"a hinge beyond its limit", "it keeps a speed after correction", "JointStep.LeavesNoSpeed"},
                 {"a limit that is hit or a weld that is bent, with shorter and shorter steps",
                  "its error shrinks slower than the step: relaxation removes the spring's impulse",
                  "JointMotion.Converges"}}),
            .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_substeps.prepare(in, {m_params.substeps, m_params.warmStart, m_params.gyroscopic, m_params.arms == Arms::asMade,
                            m_params.contacts, m_params.order, m_params.lanes});
    const Real h = m_substeps.h(), hertz = std::min(m_params.hertz, Real(0.25) / h);
    ErrorFeedback errors = springs(hertz, m_params.dampingRatio, m_params.jointDampingRatio, m_params.pushSpeed, h);
    if (m_params.joints == Joints::rigid) errors.joint = {.rate = m_params.jointFactor / in.dt};
    for (int i = 0; i < m_params.substeps; ++i) m_substeps.step(in, i, errors, 1, m_params.relax);
    m_substeps.finish(in, m_params.bounceFriction ? BounceFriction::withFriction : BounceFriction::frictionless);
  }

 private:
  Params m_params;
  Substeps<D> m_substeps;
};

}  // namespace

LPC_REGISTER(Solver, SoftStep, 2, 3);

}}  // namespace lpc::LPC_PRECISION
