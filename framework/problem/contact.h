// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "framework/math/indexed.h"
#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct ContactPoint {
  Vec<D> localA = Vec<D>::Zero();   // p_CaA: the closest point on A, in A's centre-of-mass frame
  Vec<D> localB = Vec<D>::Zero();   // p_CbB: the closest point on B, in B's centre-of-mass frame
  Real separation = 0;              // (p_WB - p_WA) . n, m; negative when penetrating
  std::uint64_t feature = 0;        // the same pair of features has the same number in the next step
  IndexedArray<Real, D> impulse{};  // N s, along n, then along tangents(n); warm starts the next step. Zero: cold
  IndexedArray<Real, D> memory{};   // data of the solver, carried with the point
  /// Total impulse along n over the whole step, N s. Each solver writes it. Impacts of a separate impact law
  /// (split_solver's poisson and sequential) are not included. When sub-steps warm start from each other, `impulse` is
  /// the impulse of the last sub-step times the number of sub-steps, not a sum.
  Real load = 0;
};

template <int D>
inline constexpr int kManifoldPoints = D == 2 ? 2 : 4;

/// The contact points of two convex parts, one part of each shape; bodyA < bodyB.
template <int D>
struct Manifold {
  std::int32_t bodyA = -1, bodyB = -1;
  std::int32_t shapeA = -1, shapeB = -1;  // slots in the world's shapes
  std::int32_t partA = 0, partB = 0;      // index of the convex part; 0 for a convex shape
  std::int32_t count = 0;                 // of points
  Vec<D> normal = Vec<D>::Zero();         // n_AB, unit, world
  Real friction = 0, restitution = 0;     // of the pair
  std::uint8_t begun = 0;                 // 1 in the first step in which the pair has contacts
  std::uint8_t ignored = 0;               // 1 when a listener vetoed it: kept, but not solved
  IndexedArray<ContactPoint<D>, kManifoldPoints<D>> points{};
  /// Pose of B's centre-of-mass frame in A's, and the normal in A's frame, at the time when the points were made. The
  /// world writes both.
  Pose<D> X_AB{};
  Vec<D> normalA = Vec<D>::Zero();

  /// Manifolds are sorted by this key, so that the order in which a broadphase finds pairs has no effect. The part
  /// indices come last: manifolds of one pair of shapes are adjacent.
  auto key() const { return std::tuple(bodyA, shapeA, bodyB, shapeB, partA, partB); }
  auto shapeKey() const { return std::tuple(bodyA, shapeA, bodyB, shapeB); }
};

/// Separation of a contact point at the bodies' current poses (m), after a solver has moved them.
template <int D>
Real separationNow(const Manifold<D>& m, const ContactPoint<D>& c, const Pose<D>& X_WA, const Pose<D>& X_WB) {
  return (X_WB * c.localB - X_WA * c.localA).dot(m.normal);
}

/// Both arms from the centres of mass to the midpoint between the closest points (m, world axes), and the separation at
/// the current poses. Positions are subtracted first: far from the origin, position plus arm would lose digits.
template <int D>
struct ContactArms {
  Vec<D> rA, rB;
  Real separation;  // m

  ContactArms(const ContactPoint<D>& c, const Vec<D>& n, const Pose<D>& X_WA, const Pose<D>& X_WB) {
    const Vec<D> fromA = X_WA.q * c.localA, fromB = X_WB.q * c.localB, centers = X_WB.p - X_WA.p;
    const Vec<D> gap = centers + fromB - fromA;
    separation = gap.dot(n);
    rA = fromA + gap / 2, rB = fromB - gap / 2;
  }
};

/// How a contact's coefficient follows from the two shapes' coefficients.
enum class MixRule : std::uint8_t { geometricMean, arithmeticMean, minimum, maximum, product };
inline constexpr std::array<std::string_view, 5> kMixRuleNames = {"geometric_mean", "arithmetic_mean", "minimum",
                                                                  "maximum", "product"};
inline Real mix(MixRule rule, Real a, Real b) {
  switch (rule) {
    case MixRule::geometricMean:
      return std::sqrt(a * b);
    case MixRule::arithmeticMean:
      return (a + b) / 2;
    case MixRule::minimum:
      return std::min(a, b);
    case MixRule::maximum:
      return std::max(a, b);
    case MixRule::product:
      return a * b;
  }
  return 0;
}
/// Rules for friction and for restitution. The defaults are those of the 2009 engine.
struct MixRules {
  MixRule friction = MixRule::geometricMean, restitution = MixRule::arithmeticMean;
  bool operator==(const MixRules&) const = default;
};

}}  // namespace lpc::LPC_PRECISION
