// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// The first resolver of the 2009 engine: contacts in stored order, each solved alone. Nothing is accumulated, so an
// impulse that turns out too large is never reduced, and no step is warm started.
template <int D>
class NaiveVelocity final : public VelocityResolver<D> {
 public:
  struct Params {
    int iterations = 1;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "passes over all joints and contacts", ParamRole::effort);
    }
  };
  explicit NaiveVelocity(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "naive",
            .summary = "one pass over the contacts in stored order, without accumulated impulses",
            .paper = "lpc2009",
            .complexity = "iterations x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {{"a box on a slope below the critical angle",
                          "it creeps: friction is bounded by this pass's normal impulses, without warm starting",
                          "Slope.HoldsOrSaysThatItDoesNot"},
                         {"several coupled contacts", "excess impulses are never undone: the bodies fly apart",
                          "Accumulation.TakesBack"},
                         {"the same contacts in another order",
                          "early impulses are never undone, so the result depends on the order",
                          "Impulse.OrderDoesNotMatter"},
                         {"a stack at rest", "it trembles until it falls", "Rest.Stays"},
                         {"a heavy body on a light one", "one pass carries little of the weight",
                          "Impulse.CarriesHeavyOnLight"},
                         {"a box that slides on four points", "it hops and rotates by half a per cent",
                          "Slope.SlidesOrSaysThatItDoesNot"},
                         {"a 2D box that slides on two points", "it slides a different distance",
                          "Extrusion.AgreesOrSaysThatItDoesNot"},
                         {"a plate that slides and spins on its corners",
                          "the first corners carry more than their share", "Corners.ShareAPlateThatSlides"}},
            .friction = FrictionLaw::coulomb};
  }

  void solve(const VelocityInput<D>& in) override {
    Profiler::Scope scope(in.profiler, "solver.iterate");
    m_contacts.prepare(in);
    m_joints.clear();
    if (in.model.joints) m_joints.prepare(in.work, in.bodies, in.joints);
    for (int i = 0; i < m_params.iterations; ++i) pass(in);
    m_contacts.store(in.manifolds);
    m_joints.store(in.joints);
  }

 private:
  void pass(const VelocityInput<D>& in) {
    const bool rotation = in.model.rotation;
    auto& motion = in.bodies.motion;
    m_joints.sweep(motion, in.dt, {.rate = in.position.jointBias(in.dt)});
    m_joints.count(in.work);
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      Motion<D>&a = motion[m.a], &b = motion[m.b];
      for (int i = 0; i < m.count; ++i) {
        PointRows<D>& row = m_contacts.points[m.first + i];
        // The present velocity, not that at the start of the step: earlier contacts have changed it.
        const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
        const Manifold<D>& manifold = in.manifolds[m.manifold];
        const Real target = contactTarget<D>(manifold.points[i].separation, v, v - row.kick,
                                             in.model.restitution ? manifold.restitution : Real(0),
                                             in.restitutionThreshold, in.dt, in.position);
        const Real impulse = row.normal.mass * (target - v);
        countRows<D>(in.work, 1);
        if (!(impulse > 0)) continue;  // moving apart
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, impulse, a, b, rotation);
        row.impulse[0] += impulse;
        if (!(m.friction > 0)) continue;
        // Friction of this pass alone, limited by the normal impulse that the pass has applied so far.
        const IndexedArray<Real, D> total = row.impulse;
        row.impulse.fill(0);
        row.impulse[0] = impulse;
        solveFrictionAt(m, row, a, b, rotation);
        row.impulse[0] = total[0];
        for (std::size_t d = 1; d < D; ++d) row.impulse[d] += total[d];
        countRows<D>(in.work, D - 1);
      }
    }
  }

  Params m_params;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
};

}  // namespace

LPC_REGISTER(VelocityResolver, NaiveVelocity, 2, 3);

}}  // namespace lpc::LPC_PRECISION
