// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/joint_rows.h"
#include "algorithms/solver/rows/sequential_impulse.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

enum class Splitting { none, averaged, mass };

// All pairs at once, each from the velocities of the last sweep; within a pair, rows one after the other. n pairs
// together would change a body n times too much. With mass splitting (Tonge 2012) each pair gets an n-th of the body's
// mass, and the body takes the mean velocity of its parts, which is the sum of their impulses. With averaging each pair
// applies one over the larger n of its two bodies, so that both bodies still get the same impulse.
template <int D>
class Jacobi final : public VelocityResolver<D> {
 public:
  struct Params {
    int iterations = 20;
    bool warmStart = true;
    Splitting splitting = Splitting::mass;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "passes over all joints and contacts", ParamRole::effort);
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.choice("splitting", splitting, {"none", "averaged", "mass"},
               "how contacts share a body: none: full mass for each; averaged: averaged impulses; mass: split mass");
    }
  };
  explicit Jacobi(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    AlgorithmInfo info{
        .name = "jacobi",
        .summary =
            "Jacobi iterations with mass splitting: all contacts at once, each with a share of the bodies' masses",
        .paper = "tonge2012",
        .complexity = "iterations x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures = {{"a heavy body on a light one; a tall stack",
                      "shares of the light body are lighter still: twenty passes carry little of the weight",
                      "Impulse.CarriesHeavyOnLight"},
                     {"a heavy body on a light one, with more and more iterations",
                      "its error shrinks slower than with Gauss-Seidel", "Joint.ConvergesAsPredicted"},
                     {"without splitting, a body with four contacts",
                      "each contact stops the whole body: it leaves three times as fast as it arrived",
                      "Jacobi.SplittingKeepsEnergy"}},
        .friction = FrictionLaw::coulomb};
    if (D == 2 && sizeof(Real) == 8) {  // a ten-thousandth is rounding in f32
      info.failures.push_back({"five contacts between three bodies",
                               "shares are small: 2000 passes leave a ten-thousandth of the speed",
                               "Accumulation.TakesBack"});
    }
    return info;
  }

  void solve(const VelocityInput<D>& in) override {
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      prepare(in);
      if (m_params.warmStart) warmStart(in);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    const Feedback feedback{.rate = in.position.jointBias(in.dt)};
    for (int i = 0; i < m_params.iterations; ++i) sweep(in, feedback);
    std::uint64_t rows = 0;
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      rows += m.rows();
    }
    countRows<D>(in.work, rows * static_cast<std::uint64_t>(m_params.iterations));
    m_joints.count(in.work, static_cast<std::uint64_t>(m_params.iterations));
    m_contacts.store(in.manifolds);
    m_joints.store(in.joints);
  }

 private:
  // Rows are those of the bodies' mass shares.
  void prepare(const VelocityInput<D>& in) {
    Bodies<D>& bodies = in.bodies;
    m_pairs.assign(bodies.pose.size(), 0);
    const auto count = [&](std::int32_t body) {
      if (body >= 0) m_pairs[body] += 1;
    };
    for (const int i : in.order) {
      const Manifold<D>& m = in.manifolds[i];
      if (m.count > 0) count(m.bodyA), count(m.bodyB);
    }
    if (in.model.joints) {
      for (const JointRecord<D>& j : in.joints) {
        if (j.active()) count(j.bodyA), count(j.bodyB);
      }
    }
    if (m_params.splitting == Splitting::mass) {
      m_invMass = bodies.invMass, m_invInertia = bodies.invInertia;
      for (std::size_t i = 0; i < m_pairs.size(); ++i) {
        bodies.invMass[i] *= m_pairs[i], bodies.invInertia[i] *= m_pairs[i];
      }
    }
    m_contacts.prepare(in);
    m_joints.clear();
    if (in.model.joints) m_joints.prepare(in.work, bodies, in.joints);
    if (m_params.splitting == Splitting::mass) bodies.invMass = m_invMass, bodies.invInertia = m_invInertia;
  }

  // An impulse is a force times dt: if dt changes, the force is the better guess.
  void warmStart(const VelocityInput<D>& in) {
    const Real factor = lastImpulseScale(in);
    m_change.assign(m_pairs.size(), {});
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Manifold<D>& old = in.manifolds[m.manifold];
      Motion<D>&a = change(m.a), &b = change(m.b);
      for (int i = 0; i < m.count; ++i) {
        PointRows<D>& row = m_contacts.points[m.first + i];
        const auto& impulse = old.points[i].impulse;
        for (std::size_t d = 0; d < (m.friction > 0 ? D : 1); ++d) {
          row.impulse[d] = d == 0 ? std::max(factor * impulse[0], Real(0)) : factor * impulse[d];
          applyRow<D>(d == 0 ? row.normal : row.tangent[d - 1], d == 0 ? m.n : Vec<D>(m.t.col(static_cast<int>(d) - 1)),
                      m.invMassA, m.invMassB, row.impulse[d], a, b, in.model.rotation);
        }
      }
    }
    m_joints.warmStart(in.dt,
                       [&](std::int32_t joint, std::int32_t row) { return factor * in.joints[joint].impulse[row]; });
    m_joints.applyAccumulated(m_change);
    move(in);
  }

  void sweep(const VelocityInput<D>& in, const Feedback& feedback) {
    m_change.assign(m_pairs.size(), {});
    for (JointBlock<D>& block : m_joints.blocks) {
      const std::span<JointRow<D>> rows = m_joints.of(block);
      IndexedArray<Real, kJointRows> old{};
      for (std::size_t i = 0; i < rows.size(); ++i) old[i] = rows[i].impulse;
      const Real share = push(in, block.a, block.b,
                              [&](Motion<D>& a, Motion<D>& b) { m_joints.sweepBlock(block, a, b, in.dt, feedback); });
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i].impulse = old[i] + share * (rows[i].impulse - old[i]);
    }
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const auto points = m_contacts.points.part(m.first, m.count);
      IndexedArray<IndexedArray<Real, D>, kManifoldPoints<D>> old{};
      for (std::size_t i = 0; i < points.size(); ++i) old[i] = points[i].impulse;
      const Real share =
          push(in, m.a, m.b, [&](Motion<D>& a, Motion<D>& b) { sweepManifold(m, points, a, b, in.model.rotation); });
      for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t d = 0; d < D; ++d)
          points[i].impulse[d] = old[i][d] + share * (points[i].impulse[d] - old[i][d]);
      }
    }
    move(in);
  }

  // Returns the averaging factor.
  template <class Body>
  Real push(const VelocityInput<D>& in, std::int32_t bodyA, std::int32_t bodyB, const Body& body) {
    const auto at = [&](std::int32_t i) { return i < 0 ? Motion<D>{} : in.bodies.motion[i]; };
    const Motion<D> fromA = at(bodyA), fromB = at(bodyB);
    Motion<D> a = fromA, b = fromB;
    body(a, b);
    const Real share = m_params.splitting == Splitting::averaged
                           ? 1 / std::max({pairs(in, bodyA), pairs(in, bodyB), Real(1)})
                           : Real(1);
    if (bodyA >= 0) change(bodyA).v += share * (a.v - fromA.v), change(bodyA).w += share * (a.w - fromA.w);
    change(bodyB).v += share * (b.v - fromB.v), change(bodyB).w += share * (b.w - fromB.w);
    return share;
  }
  // Number of pairs that push a movable body.
  Real pairs(const VelocityInput<D>& in, std::int32_t body) const {
    return body >= 0 && (in.bodies.invMass[body] > 0 || in.bodies.invInertia[body].trace() > 0) ? m_pairs[body]
                                                                                                : Real(0);
  }
  Motion<D>& change(std::int32_t body) { return m_change[body]; }

  void move(const VelocityInput<D>& in) {
    for (std::size_t i = 0; i < m_change.size(); ++i) {
      if (!(m_pairs[i] > 0)) continue;
      const Real share = m_params.splitting == Splitting::mass ? 1 / m_pairs[i] : Real(1);
      in.bodies.motion[i].v += share * m_change[i].v;
      in.bodies.motion[i].w += share * m_change[i].w;
    }
  }

  // Catto 2006: all normals of a manifold, then its friction.
  static void sweepManifold(const ManifoldRows<D>& m, std::span<PointRows<D>> points, Motion<D>& a, Motion<D>& b,
                            bool rotation) {
    for (PointRows<D>& row : points) solveNormalAt(m, row, Real(1), a, b, rotation);
    if (!(m.friction > 0)) return;
    for (PointRows<D>& row : points) solveFrictionAt(m, row, a, b, rotation);
  }

  Params m_params;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
  IndexedVector<Real> m_pairs;  // by body: of contacts or joints that push it
  std::vector<Real> m_invMass;
  std::vector<Inertia<D>> m_invInertia;
  IndexedVector<Motion<D>> m_change;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Jacobi, 2, 3);

}}  // namespace lpc::LPC_PRECISION
