// SPDX-License-Identifier: Zlib
// Pairs whose answers are related, so that a method can be judged by two of its own: the same pair swapped, mirrored,
// in other axes, larger, elsewhere, of more points, or carried (Chen et al. 1998: metamorphic testing).
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

/// Is phi of the image known, `factor` times that of the pair? The others round: the referee is asked on both.
constexpr bool keepsTruth(Relation relation) { return relation != Relation::swap && relation != Relation::motion; }

/// The axis under which the ledger has them.
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
  double factor = 1;  // of all lengths of `after` against those of `before`
};

/// The image of a pair, none where the relation has nothing to say of it:
///   swap            B and A, of equal kinds (others are always asked in one order); the inverse pose rounds
///   mirror          one coordinate negated in both shapes' frames, one that leaves their kinds as they are; exact
///   permutation     another signed permutation of the axes of both frames, likewise; exact
///   scale           a power of two; exact
///   translation     a polytope's points carried in its own frame, the pose against it, all on one grid; exact
///   extra_vertices  polytopes as hulls of the same points in another order, some of them twice, and of the middles of
///                   edges; what a hull drops is below what is owed
///   motion          both carried by one motion of the world, the pose between them computed anew; rounds
/// `choice` is chance. `before` is the pair, but snapped to the grid for `translation`.
template <int D>
std::optional<RelatedPairs<D>> relatedPairs(Relation relation, const HardPair<D>& pair, std::uint64_t choice);

}}  // namespace lpc::LPC_PRECISION
