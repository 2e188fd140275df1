// SPDX-License-Identifier: Zlib
#include "algorithms/solver/contact_rows.h"
#include "algorithms/solver/joint_rows.h"
#include "framework/profiler.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

enum class Sweep { forward, symmetric };

// Sequential impulses: projected Gauss-Seidel on velocities. The accumulated impulse is clamped, never the increment,
// so that a later sweep can take back what an earlier one gave; and it is the next step's first guess.
template <int D>
class Catto final : public VelocityResolver<D> {
 public:
  struct Params {
    int iterations = 10;
    bool warmStart = true;
    Real warmFactor = 1;
    Real relaxation = 1;
    Sweep sweep = Sweep::forward;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "sweeps over all joints and contacts");
      v.flag("warm_start", warmStart, "start from the impulses of the last step");
      v.real("warm_factor", warmFactor, 0, 1, "1", "share of the last step's impulses to start from");
      v.real("relaxation", relaxation, Real(0.05), Real(1.95), "1", "over-relaxation of normal impulses (SOR)");
      v.choice("sweep", sweep, {"forward", "symmetric"}, "always in the given order, or there and back by turns");
    }
  };
  explicit Catto(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "catto",
            .summary = "sequential impulses, accumulated and clamped, warm started",
            .paper = "catto2006",
            .complexity = "iterations x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {{"a heavy body on a light one, a tall stack",
                          "linear convergence: the error of a sweep shrinks by r/(1+r) for a mass ratio r",
                          "Impulse.CarriesHeavyOnLight"}},
            .friction = FrictionLaw::coulomb};
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      m_contacts.prepare(in);
      m_joints.clear();
      if (in.features.joints) m_joints.prepare(in.bodies, in.joints);
      if (m_params.warmStart) warmStart(in);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    const Feedback feedback{.rate = in.position.jointBias(in.dt)};
    for (int i = 0; i < m_params.iterations; ++i) {
      m_joints.sweep(in.bodies.motion, in.dt, feedback);
      const bool back = m_params.sweep == Sweep::symmetric && i % 2 == 1;
      const std::size_t n = m_contacts.manifolds.size();
      for (std::size_t k = 0; k < n; ++k) {
        solveManifold(m_contacts.manifolds[back ? n - 1 - k : k], in.bodies, in.features.rotation, back);
      }
    }
    std::uint64_t rows = m_joints.rows.size();
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      rows += static_cast<std::uint64_t>(m.count) * (m.friction > 0 ? D : 1);
    }
    in.work[WorkCount::rowUpdates] += rows * static_cast<std::uint64_t>(m_params.iterations);
    m_contacts.store(in.manifolds);
    m_joints.store(in.joints);
  }

 private:
  // An impulse is a force times dt: when dt changes, the force is the better guess.
  void warmStart(const VelocityInput<D>& in) {
    const Real factor = m_params.warmFactor * (in.lastDt > 0 ? in.dt / in.lastDt : Real(1));
    const bool rotation = in.features.rotation;
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      Motion<D>& a = in.bodies.motion[static_cast<std::size_t>(m.a)];
      Motion<D>& b = in.bodies.motion[static_cast<std::size_t>(m.b)];
      const Manifold<D>& old = in.manifolds[static_cast<std::size_t>(m.manifold)];
      for (int i = 0; i < m.count; ++i) {
        PointRows<D>& row = m_contacts.points[static_cast<std::size_t>(m.first + i)];
        const ContactPoint<D>& c = old.points[static_cast<std::size_t>(i)];
        row.impulse[0] = std::max(factor * c.impulse[0], Real(0));
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0], a, b, rotation);
        if (!(m.friction > 0)) continue;
        for (std::size_t d = 1; d < D; ++d) {
          row.impulse[d] = factor * c.impulse[d];
          applyRow<D>(row.tangent[d - 1], m.t.col(static_cast<int>(d) - 1), m.invMassA, m.invMassB, row.impulse[d], a,
                      b, rotation);
        }
      }
    }
    m_joints.warmStart(in.dt, [&](std::int32_t joint, std::int32_t row) {
      return factor * in.joints[static_cast<std::size_t>(joint)].impulse[static_cast<std::size_t>(row)];
    });
    m_joints.applyAccumulated(in.bodies.motion);
  }

  void solveManifold(const ManifoldRows<D>& m, Bodies<D>& bodies, bool rotation, bool back) {
    // Local copies: the compiler keeps them in registers over all rows of the manifold.
    Motion<D> a = bodies.motion[static_cast<std::size_t>(m.a)], b = bodies.motion[static_cast<std::size_t>(m.b)];
    PointRows<D>* const points = m_contacts.points.data() + m.first;
    for (int i = 0; i < m.count; ++i) {
      PointRows<D>& row = points[back ? m.count - 1 - i : i];
      const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
      const Real old = row.impulse[0];
      row.impulse[0] = std::max(old + m_params.relaxation * row.normal.mass * (row.target - v), Real(0));
      applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, rotation);
    }
    // Friction last, with the normal impulse as it now is: Coulomb's law holds exactly at the end of the sweep.
    if (m.friction > 0) {
      for (int i = 0; i < m.count; ++i) rubAt(m, points[back ? m.count - 1 - i : i], a, b, rotation);
    }
    bodies.motion[static_cast<std::size_t>(m.a)] = a;
    bodies.motion[static_cast<std::size_t>(m.b)] = b;
  }

  Params m_params;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Catto, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
