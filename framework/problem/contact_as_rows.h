// SPDX-License-Identifier: Zlib
// Contacts as constraint rows, for methods that take a whole problem. Sequential resolvers have their own kernels,
// which a test compares with these rows.
#pragma once

#include <vector>

#include "framework/math/indexed.h"
#include "framework/problem/constraint_row.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Appends D rows per point of the manifold: a stop along the normal, then the friction tangents, which refer to the
/// stop by its index in `out`. Without friction the tangents are inactive. Impulses act at the midpoint between the
/// closest points, which conserves angular momentum to rounding even while shapes penetrate.
template <int D>
void contactRows(const VelocityInput<D>& in, const Manifold<D>& m, std::vector<ConstraintRow<D>>& out) {
  const auto a = m.bodyA, b = m.bodyB;
  const RealMatrix<D, D - 1> t = tangents(m.normal);
  for (int k = 0; k < m.count; ++k) {
    const ContactPoint<D>& c = m.points[k];
    const ContactArms<D> arms(c, m.normal, in.bodies.pose[a], in.bodies.pose[b]);
    const auto along = [&](const Vec<D>& d) {
      ConstraintRow<D> row;
      row.d = d, row.armA = cross(arms.rA, d), row.armB = cross(arms.rB, d);
      return row;
    };
    const auto stop = static_cast<std::int32_t>(out.size());
    ConstraintRow<D>& normal = out.emplace_back(along(m.normal));
    normal.block = RowBlock::box, normal.lo = 0;
    normal.error = c.separation;
    const auto speed = [&](IndexedSpan<const Motion<D>> motion) {
      return rowSpeed(normal, motion[a].v, motion[a].w, motion[b].v, motion[b].w);
    };
    const Real v = speed(in.bodies.motion), arrival = in.arrival.empty() ? v : speed(in.arrival);
    // Impact within this step: the contact separates with a fraction of its approach velocity before this step's
    // forces.
    const bool hit = arrival < -in.restitutionThreshold && c.separation + v * in.dt <= 0;
    if (hit && in.model.restitution && m.restitution > 0) normal.bounce = -m.restitution * arrival;
    for (int i = 0; i < D - 1; ++i) {
      ConstraintRow<D>& tangent = out.emplace_back(along(t.col(i)));
      tangent.block = RowBlock::cone;
      tangent.friction = in.model.friction ? m.friction : Real(0);
      tangent.normal = stop;
      if (!(tangent.friction > 0)) tangent.lo = tangent.hi = 0;
    }
  }
}

}}  // namespace lpc::LPC_PRECISION
