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

/// Selects the shapes that a ray can hit: shapes that collide with this category and mask. Without a filter the ray can
/// hit every shape.
template <int D>
struct RayFilter {
  std::uint32_t category = 1;
  std::uint32_t mask = ~0u;
  /// Accepts or rejects a shape; empty: accepts all shapes. Called before the ray is tested against the shape, in no
  /// particular order.
  std::function<bool(BodyHandle body, const ShapeRecord<D>& shape)> accepts = {};
};

/// Answers queries on exact shapes at the current poses. Uses the boxes of the table: call BodyTable::sync() first.
template <int D>
class BodyQueries {
 public:
  explicit BodyQueries(const BodyTable<D>& table) : m_table(table) {}

  std::vector<BodyHandle> at(const Vec<D>& point) const;
  std::vector<BodyHandle> overlap(const Aabb<D>& box) const;
  bool contains(std::size_t body, const Vec<D>& point) const;
  bool intersects(std::size_t body, const Aabb<D>& box) const;
  /// Hits of the ray p + t * direction, 0 <= t <= maxT, sorted by t. Without a filter the ray can hit every shape.
  /// Throws UserError when the point or direction is not finite, or maxT is negative.
  std::vector<BodyRayHit<D>> rayAll(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                    const RayFilter<D>* filter = nullptr) const;
  /// The hit with the smallest t.
  std::optional<BodyRayHit<D>> rayFirst(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                        const RayFilter<D>* filter = nullptr) const;

 private:
  template <class Holds>
  std::vector<BodyHandle> bodiesOf(std::vector<ProxyId>& found, const Aabb<D>& box, const Holds& holds) const;
  template <class Holds>
  bool anyPart(std::size_t body, const Aabb<D>& box, const Holds& holds) const;

  const BodyTable<D>& m_table;
};

}}  // namespace lpc::LPC_PRECISION
