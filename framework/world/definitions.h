// SPDX-License-Identifier: Zlib
// Computes what follows from a body's definition alone, before a world has the body.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Mass, shapes and shape kinds of a body, computed from a checked definition.
template <int D>
struct CheckedBody {
  MassProperties<D> mass;
  Inertia<D> invInertia = Inertia<D>::Zero();
  std::vector<ShapeDef<D>> shapes;        // each close to the origin of its own frame
  std::array<bool, kShapeKinds> kinds{};  // of the convex parts
};

/// Name of the body in messages.
template <int D>
std::string bodyLabel(const BodyDef<D>& def);

/// Checks a definition and computes the body's mass and shapes. Throws UserError for poses, velocities or sizes that
/// are not finite; a dynamic body without mass; masses that overflow; a plane or surface on a body that is not static.
template <int D>
CheckedBody<D> checkBody(const BodyDef<D>& def);

/// Merges two bodies into one, in place, with the shapes and the momenta of both. Throws UserError unless both are
/// dynamic or both are static.
template <int D>
BodyDef<D> merged(const BodyDef<D>& a, const BodyDef<D>& b);

/// Makes one body of each shape, in place. Each keeps the motion that it had as a part of the whole; `center` is the
/// centre of mass of the whole. The first gets the velocity of the whole. Throws UserError when a shape alone makes no
/// valid body.
template <int D>
std::vector<BodyDef<D>> splitDefinition(const BodyDef<D>& whole, const Vec<D>& center);

}}  // namespace lpc::LPC_PRECISION
