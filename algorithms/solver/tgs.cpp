// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/substep.h"
#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Rigid sub-steps, a variant of our own: soft_step without springs. It is neither the sub-steps on positions of
// macklin2019 nor PhysX's TGS, whose order of sweeps is relax_at=end. Velocities remove position errors, as in
// Baumgarte's method, and relaxing removes the added velocity after the move. Each sub-step measures errors anew: of
// contacts along the normal of the detection by anchors that move with the bodies, of joints by new rows. Friction is
// Coulomb's law on velocities, without anchors.
//
// The push removes a share of the error per step, not per sub-step. A rigid row accumulates every correction, so
// pushing with warm starting is an integral of the error: `lpc run bridge --pipeline solver=tgs{factor=1}` flies about
// at 46 m/s, with a factor of a fifth at 4 m/s. Springs forget.
//
// Ways to spend twelve updates of each row, on `lpc run mass_ratio` and `overlap_recovery`, and on the shelf of
// JointMotion.Converges, whose hinge hits its limit: its distance at 240 steps a second from the result of 61440. None
// is best in all three, and the default is a compromise.
//   sub-steps x (sweep + relax)   moved, mm   apart by, m/s   off, mm
//              12 x (1 + 0)             2.9            13.2        25
//               6 x (1 + 1)              36             4.0        60
//               4 x (1 + 2)              26             2.1        48
//               3 x (1 + 3)              35             1.2        36
//               2 x (1 + 5)             161             1.1        22
// More relaxing in four sub-steps costs more and is better: relax=6 gives 3.5 mm, 1.1 m/s, 17 mm.
template <int D>
class Tgs final : public Solver<D> {
 public:
  enum class RelaxAt { eachSubstep, end };
  struct Params {
    int substeps = 4, sweeps = 1, relax = 2;
    RelaxAt relaxAt = RelaxAt::eachSubstep;
    Real factor = Real(0.2), slop = kLinearSlop, pushSpeed = 4;
    bool warmStart = true, gyroscopic = false;
    ContactsOf contacts = ContactsOf::step;
    SweepOrder order = SweepOrder::stored;
    SweepLanes lanes = SweepLanes::automatic;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step", ParamRole::effort);
      v.integer("sweeps", sweeps, 0, 100000, "passes over all joints and contacts in each sub-step");
      v.integer("relax", relax, 0, 100, "relaxation passes without position correction");
      v.choice("relax_at", relaxAt, {"each_substep", "end"},
               "relaxation after the move of each sub-step, or of the last one as in PhysX");
      v.real("factor", factor, 0, 1, "1",
             "fraction of an error corrected per step; larger values make chains unstable");
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "largest speed at which penetration is corrected");
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.flag("gyroscopic", gyroscopic, "implicit gyroscopic term, in 3D; published: false");
      visitContactsOf(v, contacts);
      visitSweepOrder(v, order), visitSweepLanes(v, lanes);
    }
  };
  explicit Tgs(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "tgs",
        .summary =
            "rigid variant of soft_step: sub-steps that correct errors by velocity, relaxed after each position update",
        .paper = "catto2024",
        .complexity = "substeps x (sweeps + relax) x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures =
            substepFailures("it slows down faster than Gauss-Seidel predicts",
                            {kArmsStay,
                             {"a hinge beyond its limit",
                              "it keeps a speed after correction: one pass is too few for the coupled limit and pivot",
                              "JointStep.LeavesNoSpeed"}}),
        .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_substeps.prepare(in, {m_params.substeps, m_params.warmStart, m_params.gyroscopic, false, m_params.contacts,
                            m_params.order, m_params.lanes});
    const Feedback rigid{.rate = m_params.factor / in.dt};
    const ErrorFeedback errors{rigid, rigid, rigid, m_params.slop, m_params.pushSpeed};
    for (int i = 0; i < m_params.substeps; ++i) {
      const bool relaxes = m_params.relaxAt == RelaxAt::eachSubstep || i + 1 == m_params.substeps;
      m_substeps.step(in, i, errors, m_params.sweeps, relaxes ? m_params.relax : 0);
    }
    m_substeps.finish(in);
  }

 private:
  Params m_params;
  Substeps<D> m_substeps;
};

}  // namespace

LPC_REGISTER(Solver, Tgs, 2, 3);

}}  // namespace lpc::LPC_PRECISION
