// SPDX-License-Identifier: Zlib
// Sequential impulses over contacts: the code that resolvers share that sweep over manifolds.
#pragma once

#include "algorithms/solver/rows/contact_rows.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Warm starts with the share `factor` of the last step's impulses, and applies them.
template <int D>
void warmStartContacts(const VelocityInput<D>& in, Real factor, ContactRows<D>& contacts) {
  const bool rotation = in.model.rotation;
  for (const ManifoldRows<D>& m : contacts.manifolds) {
    Motion<D>& a = in.bodies.motion[m.a];
    Motion<D>& b = in.bodies.motion[m.b];
    const Manifold<D>& old = in.manifolds[m.manifold];
    for (int i = 0; i < m.count; ++i) {
      PointRows<D>& row = contacts.points[m.first + i];
      const ContactPoint<D>& c = old.points[i];
      row.impulse[0] = std::max(factor * c.impulse[0], Real(0));
      applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0], a, b, rotation);
      if (!(m.friction > 0)) continue;
      for (std::size_t d = 1; d < D; ++d) {
        row.impulse[d] = factor * c.impulse[d];
        applyRow<D>(row.tangent[d - 1], m.t.col(static_cast<int>(d) - 1), m.invMassA, m.invMassB, row.impulse[d], a, b,
                    rotation);
      }
    }
  }
}

/// Updates a point's accumulated normal impulse once.
template <int D>
void solveNormalAt(const ManifoldRows<D>& m, PointRows<D>& row, Real relaxation, Motion<D>& a, Motion<D>& b,
                   bool rotation) {
  const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
  const Real old = row.impulse[0];
  row.impulse[0] = std::max(old + relaxation * row.normal.mass * (row.target - v), Real(0));
  applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, rotation);
}

/// Updates a point's accumulated friction once, each tangent separately within the limit (N s): a square, whose corners
/// are sqrt(2) away and follow the directions of tangents(n).
template <int D>
void solveBoxFrictionAt(const ManifoldRows<D>& m, PointRows<D>& row, Real limit, Motion<D>& a, Motion<D>& b,
                        bool rotation) {
  for (int d = 0; d < D - 1; ++d) {
    const Row<D>& tangent = row.tangent[d];
    Real& impulse = row.impulse[d + 1];
    const Real old = impulse, v = rowVelocity<D>(tangent, m.t.col(d), a, b, rotation);
    impulse = std::clamp(old - tangent.mass * v, -limit, limit);
    applyRow<D>(tangent, m.t.col(d), m.invMassA, m.invMassB, impulse - old, a, b, rotation);
  }
}

}}}  // namespace lpc::LPC_PRECISION::solver
