// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct MassProperties {
  Real mass = 0;                            // kg
  Vec<D> center = Vec<D>::Zero();           // centre of mass, in the frame that was asked for (m)
  Inertia<D> inertia = Inertia<D>::Zero();  // about the centre, same axes (kg m^2); 3D: not only its diagonal
};

/// Mass properties of a solid of uniform density (kg/m^D) in its own frame. A segment has no area: its density is kg/m.
/// Computed about a point of the shape itself, so a small shape far from its frame's origin keeps its digits.
/// The rounding of a box, a polytope or a curved core adds no mass. A plane has none.
template <int D>
MassProperties<D> massProperties(const ShapeView<D>& shape, Real density);
/// Of a composite shape: of its parts together, so what they share counts more than once.
template <int D>
MassProperties<D> massProperties(const Shape<D>& shape, Real density);

/// Of some solid, within rounding: not negative, and in 3D symmetric with no principal value above the sum of the
/// others.
bool isInertia(const Inertia<2>& inertia);
bool isInertia(const Inertia<3>& inertia);

/// The same seen from a frame A in which the shape's frame has pose X_AS.
template <int D>
MassProperties<D> transformed(const MassProperties<D>& m, const Pose<D>& X_AS);

/// Two bodies as one, in the frame of both (parallel axis theorem).
template <int D>
MassProperties<D> combined(const MassProperties<D>& a, const MassProperties<D>& b);

}}  // namespace lpc::LPC_PRECISION
