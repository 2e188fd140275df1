// SPDX-License-Identifier: Zlib
// A joint as avbd solves it: rows, impulses, penalties.
#pragma once

#include <array>

#include "framework/math/indexed.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
struct AvbdJoint {
  std::int32_t joint, a, b;  // a -1: the world
  JointRows<D> rows;
  IndexedArray<Real, kJointRows> impulse, mass, start;  // start: the remaining error at the start of the step
  Real linear, angular;                                 // penalties
  Real reachA, reachB;                                  // from the centres of mass to the frames, m

  /// Starts a step: rows of the present poses, and this multiple of the stored impulses. Penalties stay unset.
  void begin(std::int32_t number, const JointRecord<D>& record, const Bodies<D>& bodies, Real warm) {
    joint = number, a = record.bodyA, b = record.bodyB;
    reachA = a < 0 ? Real(0) : record.X_CaJ.p.norm(), reachB = record.X_CbJ.p.norm();
    jointRows(record, bodies, rows);
    impulse.fill(0), start.fill(0);
    for (int i = 0; i < rows.count; ++i) {
      const ConstraintRow<D>& row = rows.row[i];
      if (row.absent()) continue;
      impulse[i] = warm * record.impulse[i];
      if (row.binds()) start[i] = row.error;
    }
  }

  /// Relative speed along a row, m/s or rad/s.
  Real speed(const Bodies<D>& bodies, const ConstraintRow<D>& row) const {
    const Motion<D> from = a < 0 ? Motion<D>{} : bodies.motion[a];
    const Motion<D>& to = bodies.motion[b];
    return rowSpeed<D>(row, from.v, from.w, to.v, to.w);
  }

  /// Sets the effective masses of the rows. Rows that are solved together share one, so that the directions of their
  /// axes do not matter.
  void setMasses(const Bodies<D>& bodies) {
    Real linearSum = 0, angularSum = 0;
    int linearRows = 0, angularRows = 0;
    for (int i = 0; i < rows.count; ++i) {
      const ConstraintRow<D>& row = rows.row[i];
      if (row.absent()) continue;
      const Real k = response(bodies, a, row.d, row.armA) + response(bodies, b, row.d, row.armB);
      mass[i] = k > 0 ? 1 / k : Real(0);
      if (row.block != RowBlock::equality) continue;
      (row.angular ? angularSum : linearSum) += k;
      ++(row.angular ? angularRows : linearRows);
    }
    for (int i = 0; i < rows.count; ++i) {
      const ConstraintRow<D>& row = rows.row[i];
      if (row.absent() || row.block != RowBlock::equality) continue;
      const Real sum = row.angular ? angularSum : linearSum;
      mass[i] = sum > 0 ? static_cast<Real>(row.angular ? angularRows : linearRows) / sum : Real(0);
    }
  }

  /// Adds the geometric stiffness of a loaded line between two points. Its direction follows the bodies. Without it
  /// light bodies on a tight line are thrown sideways. That of a pushing line is negative and counts by its magnitude,
  /// so the matrix stays positive definite; twice the diagonal bounds the coupling of shift and turn. `load`: kg m.
  template <class Block>
  void addBend(const ConstraintRow<D>& row, Real load, bool isB, bool shifts, bool rotates, Block& matrix) const {
    const Real reach = isB ? reachB : reachA;
    const Real stiffness = (shifts && rotates && reach > 0 ? 2 : 1) * load * row.bend;
    if (shifts) matrix.template topLeftCorner<D, D>() += stiffness * (Mat<D>::Identity() - row.d * row.d.transpose());
    if (!rotates) return;
    matrix.template bottomRightCorner<kAngDim<D>, kAngDim<D>>().diagonal().array() += stiffness * reach * reach;
  }

 private:
  static Real response(const Bodies<D>& bodies, std::int32_t body, const Vec<D>& d, const Ang<D>& arm) {
    if (body < 0) return Real(0);
    return bodies.invMass[body] * d.squaredNorm() + arm.dot(bodies.invInertia[body] * arm);
  }
};

}}}  // namespace lpc::LPC_PRECISION::solver
