// SPDX-License-Identifier: Zlib
// Shapes by their corners, as the constructors of the 2009 engine had them.
#pragma once

#include "framework/shape/shape_def.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The box with these two opposite corners (m), given in a frame that is rotated by q.
template <int D>
ShapeDef<D> boxBetween(const Vec<D>& corner, const Vec<D>& opposite, const Rot<D>& q = {});
/// All points within `radius` (m) of the line between two points: a capsule; for equal points a sphere.
template <int D>
ShapeDef<D> capsuleBetween(const Vec<D>& from, const Vec<D>& to, Real radius);
/// 2D: a line without width; its density is kg/m.
ShapeDef<2> segmentBetween(const Vec<2>& from, const Vec<2>& to);

}}  // namespace lpc::LPC_PRECISION
