// SPDX-License-Identifier: Zlib
// Computes the data that follow from a body's definition alone, before the body is in a world.
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

/// Merges two bodies into one: shapes keep their place in the world, momenta are added. Throws UserError unless both
/// are dynamic or both are static.
template <int D>
BodyDef<D> merged(const BodyDef<D>& a, const BodyDef<D>& b);

/// Makes one body of each shape, which keeps its place in the world. `center` is the centre of mass of the whole. Each
/// body moves as it did as a part of the whole. The first definition still has the velocity of the whole's centre:
/// BodyTable::rewrite() converts it. Throws UserError when a shape alone makes no valid body.
template <int D>
std::vector<BodyDef<D>> splitDefinition(const BodyDef<D>& whole, const Vec<D>& center);

}}  // namespace lpc::LPC_PRECISION
