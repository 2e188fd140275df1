// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct MassProperties {
  Real mass = 0;                            // kg
  Vec<D> center = Vec<D>::Zero();           // centre of mass (m), in the frame of the call
  Inertia<D> inertia = Inertia<D>::Zero();  // about the centre, same axes (kg m^2); 3D: a full matrix
};

/// Mass properties of a solid of uniform density (kg/m^D) in its own frame. A segment has no area: its density is kg/m.
/// Computed about a point of the shape itself, so a small shape far from its frame's origin loses no digits. The
/// rounding of a box, a polytope or a curved core adds no mass. A plane has no mass.
template <int D>
MassProperties<D> massProperties(const ShapeView<D>& shape, Real density);
/// Mass properties of a composite shape: the sum over its parts, so overlaps count more than once.
template <int D>
MassProperties<D> massProperties(const Shape<D>& shape, Real density);

/// True when a solid with this inertia exists, within rounding. The inertia is not negative. In 3D it is symmetric, and
/// no principal value exceeds the sum of the other two.
bool isInertia(const Inertia<2>& inertia);
bool isInertia(const Inertia<3>& inertia);

/// Mass properties in a frame A in which the shape's frame has pose X_AS.
template <int D>
MassProperties<D> transformed(const MassProperties<D>& m, const Pose<D>& X_AS);

/// Mass properties of two bodies together, in their common frame (parallel axis theorem).
template <int D>
MassProperties<D> combined(const MassProperties<D>& a, const MassProperties<D>& b);

}}  // namespace lpc::LPC_PRECISION
