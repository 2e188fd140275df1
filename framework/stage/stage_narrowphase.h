// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/work.h"
#include "framework/problem/contact.h"
#include "framework/shape/parts_near.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Two shapes as a method gets them, kind of a <= kind of b. All vectors are in A's frame.
template <int D>
struct PairView {
  ShapeView<D> a, b;
  Pose<D> X_AB;
};

enum class QueryStatus : std::uint8_t {
  converged,
  iterationLimit,  // the value is the best found, without proof
  degenerate,      // a special case that the method cannot finish; the value is the best found
  refused,         // not computed: the method does not support these kinds
  failed           // no value (an external library threw, crashed or returned NaN)
};
std::string_view queryStatusName(QueryStatus status);

template <int D>
struct PairAnswer {
  QueryStatus status = QueryStatus::refused;
  Real distance = 0;               // m; negative: minus the depth
  Vec<D> normal = Vec<D>::Zero();  // n_AB, unit, in A's frame; any correct one at a tie; zero: the method gives none
  Vec<D> pA = Vec<D>::Zero();      // closest points, in A's frame; pB - pA = distance * normal
  Vec<D> pB = Vec<D>::Zero();
};

/// The part of an answer that the caller will read. A method may compute less when less is needed: for `boolean` only
/// the sign of the distance counts.
enum class QueryNeed { boolean, distance, closestPoints };

/// Data that a method keeps for a pair from step to step, owned by the caller; zero = cold. It is the only state from
/// which a method may warm start. The bytes may come from a file: a method must not trust them, and its answer must be
/// correct for any bytes.
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

  /// True when the method supports these kinds. Called only with a <= b.
  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// True when the method computes the distance of separated shapes of these kinds. Otherwise it only reports that they
  /// are separated: the distance is some lower bound, and is not compared with ground truth. All methods compute
  /// depths. Called only with a <= b.
  virtual bool claimsGap(ShapeKind, ShapeKind) const { return true; }
  /// True when the method reads and writes the memory of pairs.
  virtual bool remembers() const { return false; }
  /// Answers any number of pairs, all of the same two kinds, which the method supports. `answers` has one entry per
  /// pair. So has `memory`, unless it is empty (cold).
  virtual void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
                     std::span<PairMemory> memory, WorkDone& work) = 0;

  /// True when the method can record its steps for pairs of these kinds.
  virtual bool traces(ShapeKind, ShapeKind) const { return false; }
  /// Traces one pair of kinds for which traces() is true, cold, with closest points: the steps, the answer and the work
  /// of `query` (pair_trace.h).
  virtual void trace(const PairView<D>&, PairTrace<D>&) { LPC_ASSERT(false); }
};

/// Queries one pair, in any order of kinds. The answer is for (a, b) as given, in A's frame. For unsupported kinds its
/// status is QueryStatus::refused.
template <int D>
PairAnswer<D> queryPair(PairQuery<D>& method, const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB,
                        QueryNeed need = QueryNeed::closestPoints);

/// A pair of shape slots with body(a) < body(b).
struct ShapePair {
  std::int32_t a, b;
  auto operator<=>(const ShapePair&) const = default;
};

/// Two convex parts of a pair of shapes, as input of a contact generator.
template <int D>
struct ConvexPair {
  ShapePair shapes;
  std::int32_t partA = 0, partB = 0;
  ShapeView<D> a, b;
  /// Poses of the parts in their bodies' centre-of-mass frames, not in the world. Far from the origin the difference of
  /// the two body poses is exact, the sum of pose and offset is not.
  Pose<D> X_CA, X_CB;
};

/// Memory of a pair of convex parts while their boxes are near each other. The contacts themselves are in the manifold.
struct PairRecord {
  std::int32_t bodyA = -1, shapeA = -1, bodyB = -1, shapeB = -1, partA = 0, partB = 0;
  PairMemory memory{};

  /// Records are sorted by this key, as manifolds are.
  auto key() const { return std::tuple(bodyA, shapeA, bodyB, shapeB, partA, partB); }
};

/// Splits pairs of shapes into pairs of convex parts.
template <int D>
class PartPairs {
 public:
  /// All pairs of parts with boxes within the margin (m), in order. A convex shape has a single part, number 0, which
  /// is the shape itself; for two convex shapes the boxes are not tested again. `pose` is X_WC by body slot.
  std::span<const ConvexPair<D>> of(std::span<const ShapePair> pairs, IndexedSpan<const ShapeRecord<D>> shapes,
                                    IndexedSpan<const Pose<D>> pose, Real margin, WorkDone& work);

 private:
  IndexedVector<ConvexPair<D>> m_pairs;
  /// The same as `of`, when one of the shapes is a surface.
  void ofSurface(const ShapePair& p, const ShapeRecord<D>& a, const ShapeRecord<D>& b, const Pose<D>& X_WA,
                 const Pose<D>& X_WB, Real margin, WorkDone& work);

  IndexedVector<Aabb<D>> m_boxes;      // of the second shape's parts
  IndexedVector<std::int32_t> m_near;  // indices of a surface's parts
};

template <int D>
struct ContactInput {
  IndexedSpan<const ConvexPair<D>> pairs;
  IndexedSpan<const ShapeRecord<D>> shapes;  // by slot
  IndexedSpan<const Pose<D>> pose;           // X_WC by body slot
  Real margin;                               // m: contacts are made up to this separation
  bool friction = true;                      // false: the scene needs no friction, and mixing is skipped
  MixRules mixing = {};
  IndexedSpan<PairMemory> memory = {};      // one per pair, or empty: cold
  IndexedSpan<const Manifold<D>> old = {};  // of the last step, sorted by Manifold::key; empty when nothing is cached
};

/// A manifold with all data that does not depend on geometry.
template <int D>
Manifold<D> startManifold(const ContactInput<D>& in, const ConvexPair<D>& pair) {
  const ShapeRecord<D>& a = in.shapes[pair.shapes.a];
  const ShapeRecord<D>& b = in.shapes[pair.shapes.b];
  static const Manifold<D> kBlank;  // copying takes half the time that g++'s zero filling takes
  Manifold<D> m = kBlank;
  m.bodyA = a.body, m.bodyB = b.body, m.shapeA = pair.shapes.a, m.shapeB = pair.shapes.b;
  m.partA = pair.partA, m.partB = pair.partB;
  m.friction = in.friction ? mix(in.mixing.friction, a.friction, b.friction) : Real(0);
  m.restitution = mix(in.mixing.restitution, a.restitution, b.restitution);
  return m;
}

template <int D>
class ContactGenerator;

/// Marks the kinds of a shape's convex parts.
template <int D>
void markKinds(const Shape<D>& shape, std::array<bool, kShapeKinds>& kinds);

using PairSupport = std::function<bool(ShapeKind, ShapeKind)>;
/// Throws UserError, "`subject` does not support ...; valid: ...", unless every pair of these kinds is supported. A
/// pair of two planes is not required, because two planes never touch. `others` gives the names and the support of all
/// methods that may be valid; it is called before the throw only.
void requirePairs(const PairSupport& supports, const std::array<bool, kShapeKinds>& kinds, const std::string& subject,
                  const std::function<std::vector<std::pair<std::string, PairSupport>>()>& others);
/// The registered methods of a stage, with default parameters, and what each supports.
template <class S>
std::vector<std::pair<std::string, PairSupport>> registeredSupport() {
  std::vector<std::pair<std::string, PairSupport>> out;
  for (const Registered* r : Registry::instance().list(S::kStage, S::kDimension)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    const std::shared_ptr<S> stage = createStage<S>(Spec{r->info.name, {}});
    out.emplace_back(r->info.name, [stage](ShapeKind a, ShapeKind b) { return stage->supports(a, b); });
  }
  return out;
}
template <int D>
void requireContacts(const ContactGenerator<D>& contacts, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& subject);

/// Makes contact points. Writes only fresh manifolds: at most one per pair of parts, none without points, in any order.
/// Impulses are zero, and the material is that of the shapes, which listeners may change. The points of a manifold are
/// sorted by feature. A generator may copy points of the old manifolds, but must recompute their separations. It keeps
/// no copies itself.
template <int D>
class ContactGenerator : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::contacts;
  static constexpr int kDimension = D;

  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// True when the generator reads and writes the memory of pairs. Otherwise the world keeps none.
  virtual bool remembers() const { return false; }
  /// Appends the manifolds of the pairs to `fresh`. Unsupported pairs of kinds do not occur: the world rejects bodies
  /// that would make such a pair.
  virtual void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) = 0;
};

template <int D>
struct CacheInput {
  IndexedSpan<const ShapePair> pairs;        // all pairs with near boxes, sorted by body and shape of A, then of B
  IndexedSpan<const Manifold<D>> old;        // of the last step, sorted by Manifold::key
  IndexedSpan<const ShapeRecord<D>> shapes;  // by slot
  IndexedSpan<const Pose<D>> pose;           // X_WC by body slot
  Real margin;                               // m: contacts are made up to this separation
};

/// Transfers impulses and other data from the old manifolds to the fresh ones. May keep old manifolds.
template <int D>
class ContactCache : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::cache;
  static constexpr int kDimension = D;

  /// Selects the pairs that need new contacts, in their order; default: all pairs. The old manifolds of each other pair
  /// stay, and renew() updates them. A pair without old manifolds must be selected.
  virtual void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) {
    regenerate.assign(in.pairs.begin(), in.pairs.end());
  }
  /// Transfers data to `fresh`, the manifolds of selected pairs, sorted by Manifold::key. Called after select(), with
  /// the same input.
  virtual void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) = 0;
  /// Updates the manifolds of one pair that select() left out to the present poses, in place. They may be those of
  /// `in.old`. Called after carry(), with the same input, for one pair after the other.
  virtual void renew(const CacheInput<D>&, std::span<Manifold<D>>) {}
};

}}  // namespace lpc::LPC_PRECISION
