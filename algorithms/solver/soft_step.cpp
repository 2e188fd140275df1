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
  struct Params {
    int substeps = 4;
    Real hertz = 30, dampingRatio = 10, pushSpeed = 3, jointDampingRatio = 2;
    int relax = 1;
    bool warmStart = true;
    Arms arms = Arms::turning;
    bool bounceFriction = false;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step", ParamRole::effort);
      v.real("hertz", hertz, 0, 100000, "1/s", "stiffness of contacts; limited to a quarter of the sub-step rate");
      v.real("damping_ratio", dampingRatio, 0, 1000, "1", "of contacts; large: they do not bounce");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "limit of the speed at which overlap is undone");
      v.real("joint_damping_ratio", jointDampingRatio, 0, 1000, "1", "of joints, which are twice as stiff as contacts");
      v.integer("relax", relax, 0, 100, "sweeps without springs after each move");
      v.flag("warm_start", warmStart, "start from the impulses of the last step");
      v.choice("arms", arms, {"turning", "as_made"},
               "of points that a cache keeps: where they are, or, as in Box2D 3, where they were: a lean is not felt");
      v.flag("bounce_friction", bounceFriction, "restitution allows friction; published: not");
    }
  };
  explicit SoftStep(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "soft_step",
            .summary = "sub-steps with soft contacts, relaxed after each move, restitution at the end",
            .paper = "catto2024",
            .complexity = "substeps x (1 + relax) x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = substepFailures(
                "is braked by springs and by relaxing, not as sweeps do",
                {kArmsStay,
                 {"a body on a very heavy one", "sinks in deeper than on a fixed one, whose springs are stiffer",
                  "Symmetry.HeavyIsFixed"},
                 {"a motor of a million times the torque that its body needs, at a stop",
                  "drives through the stop, which is a spring", "Joint.StopHoldsAgainstItsMotor"},
                 {"a hinge that is beyond its stop", "leaves it with a speed that nothing has given it",
                  "JointStep.LeavesNoSpeed"},
                 {"a stop that is hit, or a weld that is bent, in ever shorter steps",
                  "gives way by what falls slower than the step: relaxing takes out what its spring has put in",
                  "JointMotion.Converges"}}),
            .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_substeps.prepare(in, m_params.substeps, m_params.warmStart, m_params.arms == Arms::asMade);
    const Real h = m_substeps.h(), hertz = std::min(m_params.hertz, Real(0.25) / h);
    const Push push = springs(hertz, m_params.dampingRatio, m_params.jointDampingRatio, m_params.pushSpeed, h);
    for (int i = 0; i < m_params.substeps; ++i) m_substeps.step(in, i, push, 1, m_params.relax);
    m_substeps.finish(in, m_params.bounceFriction ? Bounce::withFriction : Bounce::frictionless);
  }

 private:
  Params m_params;
  Substeps<D> m_substeps;
};

}  // namespace

LPC_REGISTER(Solver, SoftStep, 2, 3);

}}  // namespace lpc::LPC_PRECISION
