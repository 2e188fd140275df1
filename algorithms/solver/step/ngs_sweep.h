// SPDX-License-Identifier: Zlib
// Nonlinear Gauss-Seidel on positions.
#pragma once

#include <algorithm>
#include <vector>

#include "algorithms/solver/rows/body_displacements.h"
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "framework/math/indexed.h"
#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// The share of an error that one visit removes.
struct NgsShare {
  Real factor = Real(0.2), jointFactor = 1, stopFactor = 1, slop = kLinearSlop, maxMove = Real(0.2);
  void visit(ParamVisitor& v) {
    v.real("factor", factor, 0, 1, "1", "fraction of a penetration corrected per pass");
    v.real("joint_factor", jointFactor, 0, 1, "1", "fraction of a joint's error corrected per pass, except at limits");
    v.real("stop_factor", stopFactor, 0, 1, "1", "fraction of the error at a joint limit corrected per pass");
    v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
    v.real("max_move", maxMove, 0, 1000, "m", "largest correction of one contact per pass");
  }
};

/// Measures each joint, then each contact in the given order, at the present poses, and moves its bodies at once to
/// remove a share of the error, as in solver2d; of a joint the whole error. Limits of joints have no slop. Normals are
/// those of the detection, inertias those of the step.
template <int D>
class NgsSweep {
 public:
  /// Returns false if there was no error.
  bool sweep(const PositionInput<D>& in, const NgsShare& share, const BodyDisplacements<D>& displacements = {}) {
    m_moved = false, m_displacements = displacements;
    m_moves.resize(in.bodies.pose.size());
    for (std::size_t j = 0; j < in.joints.size() && in.model.joints; ++j) mend(in, in.joints.subspan(j, 1), share);
    for (const int k : in.order) {
      const Manifold<D>& m = in.manifolds[k];
      for (int p = 0; p < m.count; ++p) separate(in, m, m.points[p], share);
      countRows<D>(in.work, static_cast<std::uint64_t>(m.count));
    }
    return m_moved;
  }

 private:
  void mend(const PositionInput<D>& in, std::span<const JointRecord<D>> joint, const NgsShare& share) {
    if (!joint[0].active()) return;
    m_joint.prepare(in.work, in.bodies, joint, 0, m_displacements);
    m_joint.sweepErrors(m_moves, share.jointFactor, share.stopFactor);
    m_joint.count(in.work);
    for (const JointBlock<D>& block : m_joint.blocks) {
      move(in, block.a), move(in, block.b);
    }
  }

  void separate(const PositionInput<D>& in, const Manifold<D>& m, const ContactPoint<D>& c, const NgsShare& share) {
    const Bodies<D>& bodies = in.bodies;
    const auto a = m.bodyA, b = m.bodyB;
    const ContactArms<D> arms = armsOf(bodies, a, b, c, m.normal);
    const Real depth = -arms.separation - share.slop;
    if (!(depth > 0)) return;
    const Real invMassSum = bodies.invMass[a] + bodies.invMass[b];
    const Row<D> row = makeRow<D>(m.normal, arms.rA, arms.rB, invMassSum, bodies.invInertia[a], bodies.invInertia[b]);
    countMadeRows<D>(in.work, 1);
    const Real impulse = row.mass * std::min(share.factor * depth, share.maxMove);  // kg m
    applyRow<D>(row, m.normal, bodies.invMass[a], bodies.invMass[b], impulse, m_moves[a], m_moves[b],
                in.model.rotation);
    move(in, m.bodyA), move(in, m.bodyB);
  }

  ContactArms<D> armsOf(const Bodies<D>& bodies, std::int32_t a, std::int32_t b, const ContactPoint<D>& c,
                        const Vec<D>& n) const {
    if (m_displacements.empty()) return ownArms(c, n, bodies.pose[a], bodies.pose[b]);
    const auto [atA, atB] = m_displacements.pair(bodies, a, b);
    return ownArms(c, n, atA, atB);
  }

  void move(const PositionInput<D>& in, std::int32_t body) {
    if (body < 0) return;
    Motion<D>& by = m_moves[body];
    m_moved = m_moved || !by.v.isZero(0) || !by.w.isZero(0);
    Pose<D>& x = in.bodies.pose[body];
    if (m_displacements.empty()) {
      x.p += by.v;
    } else {
      m_displacements.displacement[body] += by.v;
      x.p = m_displacements.start[body] + m_displacements.displacement[body];
    }
    if (in.model.rotation && by.w.squaredNorm() > 0) x.q = integrateRotation(x.q, by.w);
    by = {};
  }

  JointSystem<D> m_joint;
  IndexedVector<Motion<D>> m_moves;  // of each body, m and rad; zero between two rows
  BodyDisplacements<D> m_displacements;
  bool m_moved = false;
};

}}}  // namespace lpc::LPC_PRECISION::solver
