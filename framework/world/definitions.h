// SPDX-License-Identifier: Zlib
// What follows from a body's definition alone, before any world has the body.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What a checked definition gives its body.
template <int D>
struct Weighed {
  MassProperties<D> mass;
  Inertia<D> invInertia = Inertia<D>::Zero();
  std::vector<ShapeDef<D>> shapes;        // each near its own frame's origin
  std::array<bool, kShapeKinds> kinds{};  // of their convex parts
};

/// What messages call the body.
template <int D>
std::string calledIn(const BodyDef<D>& def);

/// Throws UserError for poses, velocities or sizes that are not finite, for a dynamic body without mass, for masses
/// that numbers do not hold, and for a plane or a surface on a body that moves.
template <int D>
Weighed<D> weigh(const BodyDef<D>& def);

/// One body of two where they are, with the shapes of both and both momenta. Throws UserError unless both are dynamic
/// or both are fixed.
template <int D>
BodyDef<D> merged(const BodyDef<D>& a, const BodyDef<D>& b);

/// A body of each shape, where it is and moving as it moved about `center`, the centre of mass of the whole. The first
/// has the velocity of the whole. Throws UserError where a shape alone is no body.
template <int D>
std::vector<BodyDef<D>> takenApart(const BodyDef<D>& whole, const Vec<D>& center);

}}  // namespace lpc::LPC_PRECISION
