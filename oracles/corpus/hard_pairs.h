// SPDX-License-Identifier: Zlib
// Seeded pairs of two given kinds. Two thirds come from families of inputs for which collision libraries were reported
// wrong; uniform random poses find almost none of those bugs.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/shape/shape.h"
#include "framework/stage/params.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct HardPair {
  Shape<D> a, b;
  /// The points from which the polytopes' hulls were made. The hull of a polytope's vertices alone may have other
  /// faces: points near a face decide.
  std::vector<Vec<D>> pointsA = {}, pointsB = {};
  Pose<D> X_WA = {}, X_WB = {};
  /// X_WA^-1 * X_WB computed in Real, which loses digits far from the origin. It is the input of a pair query, so the
  /// referee uses it too.
  Pose<D> X_AB = {};
  /// X_WB after a motion of a micrometre (f32: ten), under which faces at rest keep their features; empty for other
  /// pairs.
  std::optional<Pose<D>> X_WBNudged = {};
  std::string_view family = "random";
  double scale = 1;   // size of the shapes (m)
  double offset = 0;  // distance of the pair from the world's origin, in scales
};

/// All families, "random" first. `nasty_hulls` needs a polytope.
std::span<const std::string_view> hardPairFamilies();

/// The index-th pair, with at most one plane. Independent of earlier calls: kinds, seed and index name a pair.
template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, std::uint64_t seed, int index);

/// The pair as a line of a file of cases, such as tests/regressions/*.json. It has the exact bits of the stage's input:
/// X_AB for a pair query, both world poses for a contact generator. Appends `more`, as `, "name": value`.
template <int D>
std::string caseText(const std::string& id, StageKind stage, const HardPair<D>& pair, const std::string& more);

/// Outlines for a picture of a pair query's case, to be appended: `, "outlineA": [[x, y], ...], "outlineB": ...` (m).
/// In 3D they are projections from one side; of a half-space only the part near the other shape.
template <int D>
std::string outlinesText(const HardPair<D>& pair);

/// The referee's expected result, to be appended to a line of a file of cases.
template <int D>
std::string expectedText(const RefereeAnswer<D>& truth);

/// A number as JSON, with all digits; null when it is not finite.
std::string numberText(double x);

/// How simple a pair is to look at: number of vertices of the shape without its rounding.
template <int D>
int coreVertexCount(const ShapeView<D>& shape);

}}  // namespace lpc::LPC_PRECISION
