// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/work.h"
#include "framework/problem/contact.h"
#include "framework/shape/parts_near.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Two shapes as a method sees them, kind of a <= kind of b: everything is expressed in A's frame.
template <int D>
struct PairView {
  ShapeView<D> a, b;
  Pose<D> X_AB;
};

enum class QueryStatus : std::uint8_t {
  converged,
  iterationLimit,  // the value is the best found, not proved
  degenerate,      // a special case was met that the method cannot finish; the value is the best found
  refused,         // not asked: the method does not support these kinds
  failed           // no value (a witness that threw, crashed or returned NaN)
};
std::string_view queryStatusName(QueryStatus status);

template <int D>
struct PairAnswer {
  QueryStatus status = QueryStatus::refused;
  Real distance = 0;  // m; negative: minus the depth
  Vec<D> normal =
      Vec<D>::Zero();          // n_AB, unit, in A's frame; at a tie one of the right ones; zero: the method has none
  Vec<D> pA = Vec<D>::Zero();  // witnesses, in A's frame; pB - pA = distance * normal
  Vec<D> pB = Vec<D>::Zero();
};

/// What the caller will read. A method may do less when less is asked: for `boolean` only the sign of the distance
/// counts.
enum class QueryNeed { boolean, distance, witnesses };

/// What a method remembers of a pair from one step to the next: the caller's, zero = cold. The only warm-start path.
/// The bytes may come from a file: a method trusts none, and its answer is right whatever they say.
struct PairMemory {
  std::array<std::byte, 32> bytes{};
  bool operator==(const PairMemory&) const = default;
};

template <int D>
struct PairTrace;

/// Signed distance of two shapes.
template <int D>
class PairQuery : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::pairQuery;
  static constexpr int kDimension = D;

  /// Only a <= b is asked.
  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// Does it claim the distance of such shapes that are apart? Else it says no more than that they are: the distance is
  /// some lower bound, and is not judged. Depths are claimed by all. Only a <= b is asked.
  virtual bool claimsGap(ShapeKind, ShapeKind) const { return true; }
  /// Does it read and write the memory of pairs?
  virtual bool remembers() const { return false; }
  /// Any number of pairs of one pair of kinds, which it supports. `answers` has as many entries, `memory` too, or none
  /// (cold).
  virtual void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
                     std::span<PairMemory> memory, WorkDone& work) = 0;

  /// Can it show its steps with a pair of these kinds, which it supports?
  virtual bool traces(ShapeKind, ShapeKind) const { return false; }
  /// One pair of such kinds, cold, for witnesses: the steps, the answer and the work of `query` (pair_trace.h).
  virtual void trace(const PairView<D>&, PairTrace<D>&) { LPC_ASSERT(false); }
};

/// One pair, any order of kinds. The answer is in A's frame for (a, b) as given. Unsupported kinds give
/// QueryStatus::refused.
template <int D>
PairAnswer<D> queryPair(PairQuery<D>& method, const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB,
                        QueryNeed need = QueryNeed::witnesses);

/// A pair of shape slots with body(a) < body(b).
struct ShapePair {
  std::int32_t a, b;
  auto operator<=>(const ShapePair&) const = default;
};

/// Two convex parts (children) of a pair of shapes, as a contact generator is given them.
template <int D>
struct ConvexPair {
  ShapePair shapes;
  std::int32_t childA = 0, childB = 0;
  ShapeView<D> a, b;
  /// Of each child in its body's centre-of-mass frame, not in the world: far from the origin the difference of the two
  /// bodies is exact, the sum of pose and offset is not.
  Pose<D> X_CA, X_CB;
};

/// What is remembered of a pair of convex parts while their boxes come near each other: all of it but the contacts,
/// which are the manifold's.
struct PairRecord {
  std::int32_t bodyA = -1, shapeA = -1, bodyB = -1, shapeB = -1, childA = 0, childB = 0;
  PairMemory memory{};

  /// Records are sorted by this, as manifolds are.
  auto key() const { return std::tuple(bodyA, shapeA, bodyB, shapeB, childA, childB); }
};

/// The pairs of children of pairs of shapes.
template <int D>
class ChildPairs {
 public:
  /// In order: all whose boxes come within the margin (m) of each other. A convex shape is its own one child, number 0;
  /// two of them are not asked for their boxes again. `pose` is X_WC by body slot.
  std::span<const ConvexPair<D>> of(std::span<const ShapePair> pairs, IndexedSpan<const ShapeRecord<D>> shapes,
                                    IndexedSpan<const Pose<D>> pose, Real margin, WorkDone& work);

 private:
  IndexedVector<ConvexPair<D>> m_pairs;
  /// As `of`, one of the shapes being a surface.
  void ofSurface(const ShapePair& p, const ShapeRecord<D>& a, const ShapeRecord<D>& b, const Pose<D>& X_WA,
                 const Pose<D>& X_WB, Real margin, WorkDone& work);

  IndexedVector<Aabb<D>> m_boxes;      // of the second shape's parts
  IndexedVector<std::int32_t> m_near;  // numbers of a surface's parts
};

template <int D>
struct ContactInput {
  IndexedSpan<const ConvexPair<D>> pairs;
  IndexedSpan<const ShapeRecord<D>> shapes;  // by slot
  IndexedSpan<const Pose<D>> pose;           // X_WC by body slot
  Real margin;                               // contacts are made for separations up to this (m)
  bool friction = true;                      // false: the scene needs none, mixing is skipped
  MixRules mixing = {};
  IndexedSpan<PairMemory> memory = {};      // one per pair, or none: cold
  IndexedSpan<const Manifold<D>> old = {};  // of the last step, sorted by Manifold::key; none where nothing is cached
};

/// A manifold with everything filled in that does not depend on geometry.
template <int D>
Manifold<D> startManifold(const ContactInput<D>& in, const ConvexPair<D>& pair) {
  const ShapeRecord<D>& a = in.shapes[pair.shapes.a];
  const ShapeRecord<D>& b = in.shapes[pair.shapes.b];
  static const Manifold<D> kBlank;  // copied in half the time in which g++ fills it with zeros
  Manifold<D> m = kBlank;
  m.bodyA = a.body, m.bodyB = b.body, m.shapeA = pair.shapes.a, m.shapeB = pair.shapes.b;
  m.childA = pair.childA, m.childB = pair.childB;
  m.friction = in.friction ? mix(in.mixing.friction, a.friction, b.friction) : Real(0);
  m.restitution = mix(in.mixing.restitution, a.restitution, b.restitution);
  return m;
}

template <int D>
class ContactGenerator;

/// Marks the kinds of a shape's convex parts.
template <int D>
void markKinds(const Shape<D>& shape, std::array<bool, kShapeKinds>& kinds);

/// Throws UserError, "who does not support ...", unless every two of these kinds are supported. Two planes never meet.
void requirePairs(const std::function<bool(ShapeKind, ShapeKind)>& supports, const std::array<bool, kShapeKinds>& kinds,
                  const std::string& who);
template <int D>
void requireContacts(const ContactGenerator<D>& contacts, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& who);

/// Makes contact points. Writes only fresh manifolds, at most one per pair of children, none without points, in any
/// order, with zero impulses and the material of their shapes, which listeners start from; `points` sorted by feature.
/// It may take over points of the old ones: it must renew their separations, and holds nothing of them itself.
template <int D>
class ContactGenerator : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::contacts;
  static constexpr int kDimension = D;

  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// Does it read and write the memory of pairs? Else the world keeps none.
  virtual bool remembers() const { return false; }
  /// Appends to `fresh`. Pairs of kinds that are not supported do not occur: the world refuses such bodies.
  virtual void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) = 0;
};

template <int D>
struct CacheInput {
  IndexedSpan<const ShapePair> pairs;        // all whose boxes come near, sorted by body and shape of A, then of B
  IndexedSpan<const Manifold<D>> old;        // of the last step, sorted by Manifold::key
  IndexedSpan<const ShapeRecord<D>> shapes;  // by slot
  IndexedSpan<const Pose<D>> pose;           // X_WC by body slot
  Real margin;                               // contacts are made for separations up to this (m)
};

/// Carries knowledge from the old manifolds to the fresh ones.
template <int D>
class ContactCache : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::cache;
  static constexpr int kDimension = D;

  /// The pairs whose contacts must be made anew, in their order; default: all. What is left out, `carry` must bring
  /// back.
  virtual void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) {
    regenerate.assign(in.pairs.begin(), in.pairs.end());
  }
  /// Directly after `select`, with the same input. `fresh` is sorted by Manifold::key, and shall be afterwards.
  virtual void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) = 0;
};

}}  // namespace lpc::LPC_PRECISION
