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
/// Computed about a point of the shape itself, so a small shape far from its frame's origin keeps its digits. The
/// rounding of a box, a polytope or a curved core adds no mass. A plane has no mass.
template <int D>
MassProperties<D> massProperties(const ShapeView<D>& shape, Real density);
/// Of a composite shape: the sum over its parts, so overlaps count more than once.
template <int D>
MassProperties<D> massProperties(const Shape<D>& shape, Real density);

/// True when some solid has this inertia, within rounding: not negative; in 3D symmetric, with no principal value above
/// the sum of the others.
bool isInertia(const Inertia<2>& inertia);
bool isInertia(const Inertia<3>& inertia);

/// Mass properties in a frame A in which the shape's frame has pose X_AS.
template <int D>
MassProperties<D> transformed(const MassProperties<D>& m, const Pose<D>& X_AS);

/// Mass properties of two bodies together, in their common frame (parallel axis theorem).
template <int D>
MassProperties<D> combined(const MassProperties<D>& a, const MassProperties<D>& b);

}}  // namespace lpc::LPC_PRECISION
