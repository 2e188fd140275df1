// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "framework/math/tolerances.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Removes errors by a separate velocity, which moves the bodies once and is then discarded, so that no energy is added.
// The rows are solved in displacements (pseudo velocity x dt); their "impulses" are in kg m.
template <int D>
class SplitImpulse final : public PositionResolver<D> {
 public:
  struct Params {
    int iterations = 10;
    Real factor = Real(0.2);
    Real slop = kLinearSlop;
    Real maxMove = Real(0.2);
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 10000, "passes over all joints and contacts", ParamRole::effort);
      v.real("factor", factor, 0, 1, "1", "fraction of the error corrected per step");
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
      v.real("max_move", maxMove, 0, 1000, "m", "largest correction of one contact per step");
    }
  };
  explicit SplitImpulse(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "split_impulse",
            .summary = "split impulse: position errors are corrected by pseudo-velocities that add no energy",
            .paper = "catto2006",
            .complexity = "iterations x (contacts + joints); 0 without joints and contacts deeper than the slop",
            .guarantee = Guarantee::approximate,
            .failures = {{"bodies that pass each other", "position correction changes their angular momentum",
                          "PositionError.KeepsAngularMomentum"}}};
  }

  void correct(const PositionInput<D>& in) override {
    prepare(in);
    if (!m_wrong) return;
    const bool rotation = in.model.rotation;
    for (int i = 0; i < m_params.iterations; ++i) {
      m_joints.sweepErrors(m_moves, m_params.factor, m_params.factor);
      for (Contact& c : m_contacts) {
        Motion<D>& a = m_moves[c.a];
        Motion<D>& b = m_moves[c.b];
        const Real old = c.impulse;
        c.impulse = std::max(old + c.row.mass * (c.target - rowVelocity<D>(c.row, c.n, a, b, rotation)), Real(0));
        applyRow<D>(c.row, c.n, c.invMassA, c.invMassB, c.impulse - old, a, b, rotation);
      }
    }
    countRows<D>(in.work, static_cast<std::uint64_t>(m_params.iterations) * m_contacts.size());
    m_joints.count(in.work, static_cast<std::uint64_t>(m_params.iterations));
    for (std::size_t i = 0; i < m_moves.size(); ++i) {
      Pose<D>& x = in.bodies.pose[i];
      x.p += m_moves[i].v;
      if (rotation && m_moves[i].w.squaredNorm() > 0) x.q = integrateRotation(x.q, m_moves[i].w);
    }
  }

 private:
  struct Contact {
    int a, b;
    Real invMassA, invMassB;
    Vec<D> n;
    Row<D> row;
    Real target, impulse;  // m, kg m
  };

  void prepare(const PositionInput<D>& in) {
    const Bodies<D>& bodies = in.bodies;
    m_wrong = false;
    m_contacts.clear();
    for (int k : in.order) {
      const Manifold<D>& m = in.manifolds[k];
      const auto a = m.bodyA, b = m.bodyB;
      for (int p = 0; p < m.count; ++p) {
        const ContactPoint<D>& c = m.points[p];
        const ContactArms<D> arms = ownArms(c, m.normal, bodies.pose[a], bodies.pose[b]);
        const Real spare = arms.separation + m_params.slop;
        m_wrong = m_wrong || spare < 0;
        // Contacts without an error take part too; otherwise correcting one contact would push bodies into another.
        const Real target = spare < 0 ? std::min(-m_params.factor * spare, m_params.maxMove) : -spare;
        const Real invMassSum = bodies.invMass[a] + bodies.invMass[b];
        m_contacts.push_back(
            {m.bodyA, m.bodyB, bodies.invMass[a], bodies.invMass[b], m.normal,
             makeRow<D>(m.normal, arms.rA, arms.rB, invMassSum, bodies.invInertia[a], bodies.invInertia[b]), target,
             0});
      }
    }
    countMadeRows<D>(in.work, m_contacts.size());
    m_joints.clear();
    if (in.model.joints) m_joints.prepare(in.work, bodies, in.joints);
    m_wrong = m_wrong || !m_joints.rows.empty();
    m_moves.assign(bodies.pose.size(), Motion<D>{});
  }

  Params m_params;
  std::vector<Contact> m_contacts;
  JointSystem<D> m_joints;
  IndexedVector<Motion<D>> m_moves;  // displacement of each body, m and rad
  bool m_wrong = false;
};

}  // namespace

LPC_REGISTER(PositionResolver, SplitImpulse, 2, 3);

}}  // namespace lpc::LPC_PRECISION
