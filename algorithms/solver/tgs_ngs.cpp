// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/ngs_sweep.h"
#include "algorithms/solver/step/substep.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Rigid sub-steps without error feedback in their velocities; after each, sweeps correct the poses directly. The arms
// of contacts turn with the bodies and lead to a point shared by both bodies. In solver2d each arm leads to the anchor
// of its own body (arms=own), so that the two impulses form a torque where the anchors have slid apart. With the arms
// of the detection, bodies in contact that rotate together lose angular momentum.
template <int D>
class TgsNgs final : public Solver<D> {
 public:
  enum class Arms { shared, own, detection };
  struct Params {
    int substeps = 4, sweeps = 1, positionIterations = 1;
    Arms arms = Arms::shared;
    NgsShare share;
    bool warmStart = true, gyroscopic = false;
    ContactsOf contacts = ContactsOf::step;
    SweepOrder order = SweepOrder::stored;
    SweepLanes lanes = SweepLanes::automatic;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step", ParamRole::effort);
      v.integer("sweeps", sweeps, 0, 100000, "velocity passes in each sub-step");
      v.integer("position_iterations", positionIterations, 0, 10000, "position passes in each sub-step");
      v.choice("arms", arms, {"shared", "own", "detection"},
               "lever arms of contacts in each sub-step: to one shared point, to each body's anchor (solver2d), or "
               "those of the step's start");
      share.visit(v);
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.flag("gyroscopic", gyroscopic, "implicit gyroscopic term, in 3D; published: false");
      visitContactsOf(v, contacts);
      visitSweepOrder(v, order), visitSweepLanes(v, lanes);
    }
  };
  explicit TgsNgs(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "tgs_ngs",
        .summary = "rigid sub-steps with nonlinear Gauss-Seidel position correction after each move, then restitution",
        .paper = "catto2024",
        .complexity = "substeps x (sweeps + position_iterations) x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures = substepFailures(
            "it slows down faster than Gauss-Seidel predicts",
            {{"a ball that rolls",
              "it gains speed, because its anchor rotates with it within a step; not with arms=detection",
              "Rolling.StopsOrSaysThatItDoesNot"},
             {"bodies that hang from hinges at their limits",
              "they never rest, because a pass corrects the whole error of each limit; stop_factor=0.2 rests",
              "JointMotion.Rests"},
             {"a hinge that hits its limit, with shorter and shorter steps",
              "its error shrinks slower than the step, because position passes are few; position_iterations=8 "
              "converges",
              "JointMotion.Converges"}}),
        .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_substeps.prepare(in, {m_params.substeps, m_params.warmStart, m_params.gyroscopic, false, m_params.contacts,
                            m_params.order, m_params.lanes});
    for (int i = 0; i < m_params.substeps; ++i) {
      m_substeps.begin(in, i);
      if (i > 0 && m_params.arms != Arms::detection) m_substeps.turnArms(in, m_params.arms == Arms::shared);
      m_substeps.solve(in, {}, m_params.sweeps);
      m_substeps.end();
      m_substeps.move(in);
      Profiler::Scope scope(in.profiler, "solver.position");
      for (int k = 0; k < m_params.positionIterations; ++k) {
        if (!m_sweep.sweep(
                {m_substeps.h(), in.bodies, in.manifolds, in.active, in.joints, in.model, in.work, in.profiler},
                m_params.share, m_substeps.displacements())) {
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
