// SPDX-License-Identifier: Zlib
// Seeded pairs of two given kinds. Two thirds of them come from the families of inputs in which collision libraries
// were reported wrong; uniform random poses find almost none of those bugs.
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
  /// What polytopes are hulls of. A hull of its vertices alone may have other faces: points near a face decide which.
  std::vector<Vec<D>> pointsA = {}, pointsB = {};
  Pose<D> X_WA = {}, X_WB = {};
  /// X_WA^-1 * X_WB as computed in Real, which far from the origin is not what was meant. It is what a pair query is
  /// asked, so it is what the referee judges.
  Pose<D> X_AB = {};
  /// X_WB after a motion of a micrometre (f32: ten), under which faces at rest keep their features; others have none.
  std::optional<Pose<D>> X_WBNudged = {};
  std::string_view family = "random";
  double scale = 1;   // size of the shapes (m)
  double offset = 0;  // distance of the pair from the world's origin, in scales
};

/// All families, "random" first. `nasty_hulls` needs a polytope.
std::span<const std::string_view> hardPairFamilies();

/// The index-th pair, of which one at most is a plane, whatever was drawn before: a pair is named by (kinds, seed,
/// index).
template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, std::uint64_t seed, int index);

/// As a line of a file of cases, as tests/regressions/*.json, with the very bits that a method of the stage is asked:
/// of a pair query X_AB, of a contact generator both world poses. `more` is appended to it, as `, "name": value`.
template <int D>
std::string caseText(const std::string& id, StageKind stage, const HardPair<D>& pair, const std::string& more);

/// Of a case of a pair query what a picture of it shows, to be appended: `, "outlineA": [[x, y], ...], "outlineB": ...`
/// (m). In space they are shadows from one side, and of a half-space the part that is near the other.
template <int D>
std::string outlinesText(const HardPair<D>& pair);

/// What must come out, by the referee, to be appended to a line of a file of cases.
template <int D>
std::string expectedText(const RefereeAnswer<D>& truth);

/// As JSON, with all digits; null when it is not finite.
std::string numberText(double x);

/// How simple a pair is to look at: vertices of the shape without its rounding.
template <int D>
int coreVertexCount(const ShapeView<D>& shape);

}}  // namespace lpc::LPC_PRECISION
