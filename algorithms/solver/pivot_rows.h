// SPDX-License-Identifier: Zlib
// Pivot joints as a resolver sees them: D rows solved as one block, since they are strongly coupled.
#pragma once

#include <span>
#include <vector>

#include "framework/stage_solver.h"

namespace lpc::inline LPC_PRECISION::solver {

/// (relative velocity at two arms) = K (impulse). Symmetric, positive definite unless both bodies are infinitely heavy.
template <int D>
Mat<D> pointResponse(const Vec<D>& rA, const Vec<D>& rB, Real invMassSum, const Inertia<D>& invIA,
                     const Inertia<D>& invIB) {
  Mat<D> k;
  for (int i = 0; i < D; ++i) {
    const Vec<D> d = Vec<D>::Unit(i);
    k.col(i) = invMassSum * d + cross((invIA * cross(rA, d)).eval(), rA) + cross((invIB * cross(rB, d)).eval(), rB);
  }
  return k;
}

template <int D>
struct PivotRow {
  int a, b, joint;
  Real invMassA, invMassB;
  Vec<D> rA, rB;  // from the centres of mass to each body's own anchor, m
  Vec<D> error;   // anchor of B minus anchor of A, m
  Mat<D> mass;    // K^-1, kg
  bool warm;      // may it start from the last impulse?
  Inertia<D> invIA, invIB;
  Vec<D> impulse;  // accumulated, on B
};

/// Velocity of B's anchor against A's, m/s.
template <int D>
Vec<D> pivotVelocity(const PivotRow<D>& row, const Motion<D>& a, const Motion<D>& b) {
  return b.v + cross(b.w, row.rB) - a.v - cross(a.w, row.rA);
}

template <int D>
void applyPivot(const PivotRow<D>& row, const Vec<D>& impulse, Motion<D>& a, Motion<D>& b) {
  a.v -= row.invMassA * impulse;
  b.v += row.invMassB * impulse;
  a.w -= row.invIA * cross(row.rA, impulse);
  b.w += row.invIB * cross(row.rB, impulse);
}

template <int D>
struct PivotRows {
  std::vector<PivotRow<D>> rows;

  /// Skips free slots and joints between bodies that cannot move.
  void prepare(const Bodies<D>& bodies, std::span<const PivotJoint<D>> joints) {
    rows.clear();
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const PivotJoint<D>& joint = joints[j];
      if (joint.bodyA < 0) continue;
      const auto a = static_cast<std::size_t>(joint.bodyA), b = static_cast<std::size_t>(joint.bodyB);
      PivotRow<D> row;
      row.a = joint.bodyA, row.b = joint.bodyB, row.joint = static_cast<int>(j);
      row.invMassA = bodies.invMass[a], row.invMassB = bodies.invMass[b];
      row.invIA = bodies.invInertia[a], row.invIB = bodies.invInertia[b];
      row.rA = bodies.pose[a].q * joint.localA, row.rB = bodies.pose[b].q * joint.localB;
      row.error = (bodies.pose[b].p - bodies.pose[a].p) + row.rB - row.rA;
      const Real invMassSum = row.invMassA + row.invMassB;
      const Mat<D> k = pointResponse<D>(row.rA, row.rB, invMassSum, row.invIA, row.invIB);
      const Real trace = k.trace();
      if (!(trace > 0)) continue;
      row.warm = invMassSum > 0;
      // Two pinned bodies can only turn: K is singular, and its inverse would ask for endless impulses along the
      // direction that nothing can move in. A gradient step is slow and safe.
      row.mass = row.warm ? Mat<D>(k.inverse()) : Mat<D>(Mat<D>::Identity() / trace);
      row.impulse = Vec<D>::Zero();
      rows.push_back(row);
    }
  }

  void store(std::span<PivotJoint<D>> joints) const {
    for (const PivotRow<D>& row : rows) joints[static_cast<std::size_t>(row.joint)].impulse = row.impulse;
  }
};

}  // namespace lpc::inline LPC_PRECISION::solver
