// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/ngs_sweep.h"
#include "algorithms/solver/step/substep.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Rigid sub-steps without error feedback in their velocities; after each, sweeps correct the poses directly. The arms
// of contacts turn with the bodies and lead to a point shared by both bodies. In solver2d each arm leads to the anchor
// of its own body (arms=own), so that the two impulses form a torque where the anchors have slid apart. With the arms
// of the detection, bodies that press on each other and turn together lose angular momentum.
template <int D>
class TgsNgs final : public Solver<D> {
 public:
  enum class Arms { shared, own, detection };
  struct Params {
    int substeps = 4, sweeps = 1, positionIterations = 1;
    Arms arms = Arms::shared;
    NgsShare share;
    bool warmStart = true;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step", ParamRole::effort);
      v.integer("sweeps", sweeps, 0, 100000, "sweeps over velocities in each sub-step");
      v.integer("position_iterations", positionIterations, 0, 10000, "sweeps over positions in each sub-step");
      v.choice("arms", arms, {"shared", "own", "detection"},
               "of contacts in each sub-step: of a point that both bodies share; of each body's own anchor, as "
               "solver2d; or those of the step's start");
      share.visit(v);
      v.flag("warm_start", warmStart, "start from the impulses of the last step");
    }
  };
  explicit TgsNgs(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "tgs_ngs",
        .summary = "rigid sub-steps that mend positions after each move, restitution at the end",
        .paper = "catto2024",
        .complexity = "substeps x (sweeps + position_iterations) x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures = substepFailures(
            "is braked by more than sweeps do",
            {{"a ball that rolls", "gains speed: within a step its anchor turns with it; arms=detection does not",
              "Rolling.StopsOrSaysThatItDoesNot"},
             {"bodies that hang from hinges at their stops",
              "never rest: a sweep undoes the whole error of each stop; stop_factor=0.2 rests", "JointMotion.Rests"},
             {"a hinge that hits its stop, in ever shorter steps",
              "its error falls slower than the step: sweeps over positions are few; position_iterations=8 converges",
              "JointMotion.Converges"}}),
        .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_substeps.prepare(in, m_params.substeps, m_params.warmStart);
    for (int i = 0; i < m_params.substeps; ++i) {
      m_substeps.begin(in, i);
      if (i > 0 && m_params.arms != Arms::detection) m_substeps.turnArms(in, m_params.arms == Arms::shared);
      m_substeps.solve(in, {}, m_params.sweeps);
      m_substeps.end();
      m_substeps.move(in);
      Profiler::Scope scope(in.profiler, "solver.position");
      for (int k = 0; k < m_params.positionIterations; ++k) {
        if (!m_sweep.sweep(
                {m_substeps.h(), in.bodies, in.manifolds, in.active, in.joints, in.features, in.work, in.profiler},
                m_params.share, m_substeps.places())) {
          break;
        }
      }
      m_substeps.measure(in);
    }
    m_substeps.finish(in);
  }

 private:
  Params m_params;
  Substeps<D> m_substeps;
  NgsSweep<D> m_sweep;
};

}  // namespace

LPC_REGISTER(Solver, TgsNgs, 2, 3);

}}  // namespace lpc::LPC_PRECISION
