// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "framework/world/body_table.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct BodyRayHit {
  BodyHandle body;
  std::int32_t shape;      // index among the body's shapes
  Real t;                  // where the ray enters the shape
  Vec<D> normal;           // unit, world, out of the shape, against the ray; zero when the ray starts inside
  std::uint64_t userData;  // of the shape
};

/// Where a moving shape first touches a body.
template <int D>
struct BodyCastHit {
  BodyHandle body;
  std::int32_t shape;      // index among the body's shapes
  Real t;                  // fraction of the displacement (1)
  Vec<D> normal;           // unit, world, out of the body
  Vec<D> point;            // m, world, on the body
  std::uint64_t userData;  // of the body's shape
};

/// A body and its point nearest to a given point.
template <int D>
struct ClosestBody {
  BodyHandle body;
  std::int32_t shape;      // index among the body's shapes
  Real distance;           // m; 0 when the shape contains the given point
  Vec<D> point;            // m, world, of the shape
  std::uint64_t userData;  // of the shape
};

/// Selects the shapes that a query can find: shapes that collide with this category and mask. Without a filter a query
/// finds every shape.
template <int D>
struct QueryFilter {
  std::uint32_t category = 1;
  std::uint32_t mask = ~0u;
  /// Accepts or rejects a shape; empty: accepts all shapes. Called before the shape is tested, in no particular order.
  std::function<bool(BodyHandle body, const ShapeRecord<D>& shape)> accepts = {};
};

/// Answers queries on exact shapes at the current poses. Uses the boxes of the table: call BodyTable::sync() first.
template <int D>
class BodyQueries {
 public:
  explicit BodyQueries(const BodyTable<D>& table) : m_table(table) {}

  using Filter = std::optional<QueryFilter<D>>;

  std::vector<BodyHandle> at(const Vec<D>& point) const;
  std::vector<BodyHandle> overlap(const Aabb<D>& box) const;
  /// Bodies with a shape that overlaps `shape`. A shape that touches another one overlaps it, except for rounding. The
  /// three queries throw UserError for a plane, a surface, and numbers that are not finite.
  std::vector<BodyHandle> overlap(const Shape<D>& shape, const Pose<D>& X_WS, const Filter& filter = {}) const;
  /// First contact of `shape` moved by t * displacement (m), 0 <= t <= 1, without rotation. Of equal t the first body
  /// by slot.
  std::optional<BodyCastHit<D>> castFirst(const Shape<D>& shape, const Pose<D>& X_WS, const Vec<D>& displacement,
                                          const Filter& filter = {}) const;
  /// The body nearest to the point, within maxDistance (m). Its time grows with the number of boxes within maxDistance.
  std::optional<ClosestBody<D>> closest(const Vec<D>& point, Real maxDistance, const Filter& filter = {}) const;
  bool contains(std::size_t body, const Vec<D>& point) const;
  bool intersects(std::size_t body, const Aabb<D>& box) const;
  /// Hits of the ray p + t * direction, 0 <= t <= maxT, sorted by t. Throws UserError when the point or direction is
  /// not finite, the direction is zero, or maxT is negative.
  std::vector<BodyRayHit<D>> rayAll(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                    const Filter& filter = {}) const;
  /// The hit with the smallest t.
  std::optional<BodyRayHit<D>> rayFirst(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                        const Filter& filter = {}) const;

 private:
  template <class Holds>
  std::vector<BodyHandle> bodiesOf(std::vector<ProxyId>& found, const Aabb<D>& box, const Holds& holds) const;
  template <class F>
  void forShapesNear(const Aabb<D>& box, const Filter& filter, const F& f) const;
  template <class Holds>
  bool anyPart(std::size_t body, const Aabb<D>& box, const Holds& holds) const;

  const BodyTable<D>& m_table;
};

}}  // namespace lpc::LPC_PRECISION
