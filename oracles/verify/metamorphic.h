// SPDX-License-Identifier: Zlib
// Metamorphic testing (Chen et al. 1998): pairs with related answers, so that a method can be checked by two of its own
// answers. The same pair is swapped, mirrored, put into other axes, scaled, translated, given more points, or moved.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "framework/stage/stage_narrowphase.h"
#include "oracles/corpus/hard_pairs.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class Relation { swap, mirror, permutation, scale, translation, extraVertices, motion, kCount };
inline constexpr std::size_t kRelations = static_cast<std::size_t>(Relation::kCount);
inline constexpr std::array<std::string_view, kRelations> kRelationNames = {
    "swap", "mirror", "permutation", "scale", "translation", "extra_vertices", "motion"};

/// True when phi of the image is known exactly: `factor` times that of the pair. The other relations round: the referee
/// is run on both pairs.
constexpr bool keepsTruth(Relation relation) { return relation != Relation::swap && relation != Relation::motion; }

/// The axis of these results in the ledger.
inline constexpr std::string_view kRelationAxis = "relation";

template <int D>
struct PosedPair {
  Shape<D> a, b;
  Pose<D> X_AB;
  PairView<D> view() const { return {a.view(), b.view(), X_AB}; }
};

template <int D>
struct RelatedPairs {
  PosedPair<D> before, after;
  double factor = 1;  // lengths of `after` relative to `before`
};

/// The image of a pair; empty when the relation does not apply:
///   swap            B and A, of equal kinds (others always come in one order); the inverse pose rounds
///   mirror          one coordinate negated in both shapes' frames, such that their kinds stay; exact
///   permutation     another signed permutation of the axes of both frames, likewise; exact
///   scale           a power of two; exact
///   translation     a polytope's points moved in its own frame, the pose moved back, all on one grid; exact
///   extra_vertices  polytopes as hulls of the same points in another order, some duplicated, and of midpoints of
///                   edges; what a hull drops is below the tolerance
///   motion          both moved by one motion of the world, the pose between them computed again; rounds
/// `choice` is a random number. `before` is the pair, snapped to the grid for `translation`.
template <int D>
std::optional<RelatedPairs<D>> relatedPairs(Relation relation, const HardPair<D>& pair, std::uint64_t choice);

}}  // namespace lpc::LPC_PRECISION
