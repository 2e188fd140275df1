// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/joint_rows.h"
#include "algorithms/solver/rows/sequential_impulse.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Sequential impulses, followed by one pass over the contacts from the ground upwards, level by level, with infinite
// mass for all bodies of lower levels: bodies come to rest on them however many or heavy they are. Each step starts
// without impulses, as published. With warm_start=true the next step applies to the lower bodies the impulses of this
// pass, which they have not felt.
template <int D>
class ShockPropagation final : public VelocityResolver<D> {
 public:
  struct Params {
    int iterations = 10;
    int passes = 4;
    bool warmStart = false;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "passes over all joints and contacts before the levels",
                ParamRole::effort);
      v.integer("passes", passes, 0, 1000, "passes over each level on the way up, because a face has several points");
      v.flag("warm_start", warmStart,
             "warm start from the impulses of the last step, levels included; published: false");
    }
  };
  explicit ShockPropagation(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "shock_propagation",
        .summary =
            "sequential impulses, then shock propagation: levels from the ground up, with lower levels infinitely "
            "heavy",
        .paper = "guendelman2003",
        .complexity = "iterations x (contacts + joints) + passes x contacts",
        .guarantee = Guarantee::approximate,
        .failures = {{"a body on another body that can move",
                      "no reaction acts on the lower body, so momentum is not conserved",
                      "Impulse.GroundGivesTheMomentum"},
                     {"a body on another body that can move, with twice as many iterations before the levels",
                      "the levels start from a different motion and end no closer to the solution",
                      "Impulse.MoreIsNoWorse"},
                     {"a heavy body on a light one", "it rests, but its weight does not act on the light body at once",
                      "Impulse.CarriesHeavyOnLight"},
                     {"a heavy body on a light one, with more and more iterations",
                      "the levels stop both bodies at once, so there is no Gauss-Seidel convergence rate",
                      "Impulse.ConvergesAsPredicted"},
                     {"cubes on each other", "they creep, because each step starts cold; warm_start=true rests",
                      "Rest.StackStays"},
                     {"a load on a weld or a stop", "it trembles, because each step starts cold", "JointMotion.Rests"},
                     {"a body on a very heavy one that is not static",
                      "it has no static body below it, and so no level", "Symmetry.HeavyIsFixed"}},
        .friction = FrictionLaw::coulomb};
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      m_contacts.prepare(in);
      m_joints.clear();
      if (in.model.joints) m_joints.prepare(in.work, in.bodies, in.joints);
      if (m_params.warmStart) warmStart(in);
    }
    {
      Profiler::Scope scope(in.profiler, "solver.iterate");
      for (int i = 0; i < m_params.iterations; ++i) {
        sweepJoints(in);
        for (const ManifoldRows<D>& m : m_contacts.manifolds) sweep(m, in);
      }
    }
    Profiler::Scope scope(in.profiler, "solver.shock");
    if (m_params.passes > 0) propagate(in);
    m_contacts.store(in.manifolds);
    m_joints.store(in.joints);
  }

 private:
  void warmStart(const VelocityInput<D>& in) {
    const Real growth = lastImpulseScale(in);
    warmStartContacts(in, growth, m_contacts);
    m_joints.warmStart(in.dt,
                       [&](std::int32_t joint, std::int32_t row) { return growth * in.joints[joint].impulse[row]; });
    m_joints.applyAccumulated(in.bodies.motion);
  }

  void sweepJoints(const VelocityInput<D>& in) {
    m_joints.sweep(in.bodies.motion, in.dt, {.rate = in.position.jointBias(in.dt)});
    m_joints.count(in.work);
  }

  void sweep(const ManifoldRows<D>& m, const VelocityInput<D>& in) {
    Motion<D> a = in.bodies.motion[m.a], b = in.bodies.motion[m.b];
    PointRows<D>* const points = m_contacts.points.data() + m.first;
    for (int i = 0; i < m.count; ++i) solveNormalAt(m, points[i], Real(1), a, b, in.model.rotation);
    for (int i = 0; i < m.count && m.friction > 0; ++i) solveFrictionAt(m, points[i], a, b, in.model.rotation);
    in.bodies.motion[m.a] = a, in.bodies.motion[m.b] = b;
    countRows<D>(in.work, m.rows());
  }

  void propagate(const VelocityInput<D>& in) {
    m_graph.reset(in.bodies, in.manifolds, in.joints, in.work);
    const IndexedSpan<const std::int32_t> levels = m_graph.supportLevels();
    const auto level = [&](int body) { return levels[body]; };
    // Counting sort by the level of the upper body, in the given order within each. Bodies in the air (-1) have no
    // level.
    m_start.assign(2, 0);
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const auto upper = static_cast<std::size_t>(std::max(level(m.a), level(m.b)) + 1);
      if (m_start.size() < upper + 2) m_start.resize(upper + 2, 0);
      ++m_start[upper + 1];
    }
    for (std::size_t l = 1; l < m_start.size(); ++l) m_start[l] += m_start[l - 1];
    m_next.assign(m_start.begin(), m_start.end());
    m_upwards.resize(m_contacts.manifolds.size());
    for (std::size_t k = 0; k < m_upwards.size(); ++k) {
      ManifoldRows<D>& m = m_contacts.manifolds[k];
      m_upwards[m_next[std::max(level(m.a), level(m.b)) + 1]++] = k;
      if (level(m.a) != level(m.b)) freeze(m, level(m.a) < level(m.b), in.model.rotation);
    }
    for (std::size_t l = 1; l + 1 < m_start.size(); ++l) {
      for (int i = 0; i < m_params.passes; ++i) {
        for (std::size_t k = m_start[l]; k < m_start[l + 1]; ++k) sweep(m_contacts.manifolds[m_upwards[k]], in);
      }
    }
    if (!m_joints.rows.empty()) sweepJoints(in);  // joints that the level passes have violated
  }

  // Gives A or B of a contact infinite mass.
  void freeze(ManifoldRows<D>& m, bool isA, bool rotation) {
    (isA ? m.invMassA : m.invMassB) = 0;
    const auto freezeRow = [&](Row<D>& row) {
      (isA ? row.turnA : row.turnB).setZero();
      Real k = m.invMassA + m.invMassB;
      if (rotation) k += row.armA.dot(row.turnA) + row.armB.dot(row.turnB);
      row.mass = k > 0 ? 1 / k : Real(0);
    };
    for (int i = 0; i < m.count; ++i) {
      PointRows<D>& row = m_contacts.points[m.first + i];
      freezeRow(row.normal);
      if (!(m.friction > 0)) continue;
      for (Row<D>& tangent : row.tangent) freezeRow(tangent);
      prepareFriction(row);
    }
  }

  Params m_params;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
  ContactGraph<D> m_graph;
  IndexedVector<std::size_t> m_start, m_next, m_upwards;
};

}  // namespace

LPC_REGISTER(VelocityResolver, ShockPropagation, 2, 3);

}}  // namespace lpc::LPC_PRECISION
