// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/contact.h"
#include "framework/registry.h"
#include "framework/work.h"

namespace lpc::inline LPC_PRECISION {

/// Two shapes as a scalar method sees them: everything is expressed in A's frame.
template <int D>
struct PairView {
  ShapeView<D> a, b;
  Pose<D> X_AB;
};

/// Up to kCapacity pairs of one pair of kinds, kindA <= kindB, as a structure of arrays gathered by the framework.
template <int D>
struct PairBatch {
  static constexpr int kCapacity = 1024;

  ShapeKind kindA = ShapeKind::sphere, kindB = ShapeKind::sphere;
  int count = 0;
  std::array<Real, kCapacity> radiusA{}, radiusB{};
  std::array<std::array<Real, kCapacity>, D> halfA{}, halfB{};
  std::array<std::array<Real, kCapacity>, D> p;      // p_AB
  std::array<std::array<Real, kCapacity>, D * D> r;  // R_AB, row by row
  std::array<const Polytope<D>*, kCapacity> hullA{}, hullB{};
  std::array<const CurvedCore<D>*, kCapacity> curvedA{}, curvedB{};
  std::array<Rot<D>, kCapacity> q{};

  void clear(ShapeKind a, ShapeKind b) { kindA = a, kindB = b, count = 0; }
  /// Precondition: a.kind and b.kind are the batch's, and count < kCapacity.
  void add(const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB);
  PairView<D> pair(int i) const {
    const auto n = static_cast<std::size_t>(i);
    PairView<D> v;
    v.a.kind = kindA, v.a.radius = radiusA[n], v.a.hull = hullA[n], v.a.curved = curvedA[n];
    v.b.kind = kindB, v.b.radius = radiusB[n], v.b.hull = hullB[n], v.b.curved = curvedB[n];
    for (int d = 0; d < D; ++d) {
      const auto k = static_cast<std::size_t>(d);
      v.a.half[d] = halfA[k][n], v.b.half[d] = halfB[k][n], v.X_AB.p[d] = p[k][n];
    }
    v.X_AB.q = q[n];
    return v;
  }
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

/// What the caller will read. A method may do less when less is asked.
enum class QueryNeed { boolean, distance, witnesses };

/// The answers of one batch, as arrays too. For QueryNeed::boolean only the sign of `distance` counts.
template <int D>
struct PairAnswers {
  std::array<QueryStatus, PairBatch<D>::kCapacity> status{};
  std::array<Real, PairBatch<D>::kCapacity> distance{};
  std::array<std::array<Real, PairBatch<D>::kCapacity>, D> normal{}, pA{}, pB{};

  void set(int i, const PairAnswer<D>& a) {
    const auto n = static_cast<std::size_t>(i);
    status[n] = a.status, distance[n] = a.distance;
    for (int d = 0; d < D; ++d) {
      const auto k = static_cast<std::size_t>(d);
      normal[k][n] = a.normal[d], pA[k][n] = a.pA[d], pB[k][n] = a.pB[d];
    }
  }
  PairAnswer<D> get(int i) const {
    const auto n = static_cast<std::size_t>(i);
    PairAnswer<D> a;
    a.status = status[n], a.distance = distance[n];
    for (int d = 0; d < D; ++d) {
      const auto k = static_cast<std::size_t>(d);
      a.normal[d] = normal[k][n], a.pA[d] = pA[k][n], a.pB[d] = pB[k][n];
    }
    return a;
  }
};

/// What a method remembers of a pair from one step to the next: the caller's, zero = cold. The only warm-start path.
struct PairMemory {
  std::array<std::byte, 32> bytes{};
};

/// Signed distance of two shapes.
template <int D>
class PairQuery : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::pairQuery;
  static constexpr int kDimension = D;

  /// Only a <= b is asked.
  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// Precondition: supports(batch.kindA, batch.kindB). `memory` is empty (cold) or has batch.count entries.
  virtual void query(const PairBatch<D>& batch, QueryNeed need, PairAnswers<D>& answers, std::span<PairMemory> memory,
                     WorkDone& work) = 0;
};

/// One pair, any order of kinds; a convenience for tests and tools, which pays for a batch of one. The answer is in A's
/// frame for (a, b) as given. Unsupported kinds give QueryStatus::refused.
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

/// The pairs of children of pairs of shapes.
template <int D>
class ChildPairs {
 public:
  /// In order: all whose boxes come within the margin (m) of each other. A convex shape is its own one child, number 0;
  /// two of them are not asked for their boxes again. `pose` is X_WC by body slot.
  std::span<const ConvexPair<D>> of(std::span<const ShapePair> pairs, std::span<const ShapeRecord<D>> shapes,
                                    std::span<const Pose<D>> pose, Real margin, WorkDone& work);

 private:
  std::vector<ConvexPair<D>> m_pairs;
  std::vector<Aabb<D>> m_boxes;  // of the second shape's parts
};

template <int D>
struct ContactInput {
  std::span<const ConvexPair<D>> pairs;
  std::span<const ShapeRecord<D>> shapes;  // by slot
  std::span<const Pose<D>> pose;           // X_WC by body slot
  Real margin;                             // contacts are made for separations up to this (m)
  bool friction = true;                    // false: the scene needs none, mixing is skipped
  MixRules mixing = {};
};

/// A manifold with everything filled in that does not depend on geometry.
template <int D>
Manifold<D> startManifold(const ContactInput<D>& in, const ConvexPair<D>& pair) {
  const ShapeRecord<D>& a = in.shapes[static_cast<std::size_t>(pair.shapes.a)];
  const ShapeRecord<D>& b = in.shapes[static_cast<std::size_t>(pair.shapes.b)];
  Manifold<D> m;
  m.bodyA = a.body, m.bodyB = b.body, m.shapeA = pair.shapes.a, m.shapeB = pair.shapes.b;
  m.childA = pair.childA, m.childB = pair.childB;
  m.friction = in.friction ? mix(in.mixing.friction, a.friction, b.friction) : Real(0);
  m.restitution = mix(in.mixing.restitution, a.restitution, b.restitution);
  return m;
}

template <int D>
class ContactGenerator;

/// Throws UserError, "who does not support ...", unless every two of these kinds have contacts. Two planes never meet.
template <int D>
void requireContacts(const ContactGenerator<D>& contacts, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& who);

/// Makes contact points. Writes only fresh manifolds, at most one per pair of children, none without points, in any
/// order, with zero impulses; `points` sorted by feature.
template <int D>
class ContactGenerator : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::contacts;
  static constexpr int kDimension = D;

  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// Appends to `fresh`. Pairs of kinds that are not supported do not occur: the world refuses such bodies.
  virtual void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) = 0;
};

template <int D>
struct CacheInput {
  std::span<const ShapePair> pairs;        // all whose boxes come near, sorted by body and shape of A, then of B
  std::span<const Manifold<D>> old;        // of the last step, sorted by Manifold::key
  std::span<const ShapeRecord<D>> shapes;  // by slot
  std::span<const Pose<D>> pose;           // X_WC by body slot
  Real margin;                             // contacts are made for separations up to this (m)
};

/// Carries knowledge from the old manifolds to the fresh ones.
template <int D>
class ContactCache : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::cache;
  static constexpr int kDimension = D;

  /// The pairs whose contacts must be made anew; default: all. What is left out, `carry` must bring back.
  virtual void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) {
    regenerate.assign(in.pairs.begin(), in.pairs.end());
  }
  /// Directly after `select`, with the same input. `fresh` is sorted by Manifold::key, and shall be afterwards.
  virtual void carry(const CacheInput<D>& in, std::vector<Manifold<D>>& fresh) = 0;
};

}  // namespace lpc::inline LPC_PRECISION
