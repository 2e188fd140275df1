// SPDX-License-Identifier: Zlib
#include "framework/world/flush_contacts.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "framework/math/tolerances.h"
#include "framework/shape/support_map.h"
#include "framework/shape/surface.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// A feature that stands out of the plane on which a body rests by at most this is flush with it (m). Larger: bodies
/// climb steps that should stop them. Smaller: bodies stop at steps far below the depth that contacts keep on purpose.
constexpr Real kFlush = kLinearSlop / 5;

/// Normals of two contacts that differ by at most this are equal (1). Larger: balls feel the corners of tiles. Smaller:
/// rounding decides, which costs time only.
constexpr Real kEqualNormals = sizeof(Real) == 8 ? Real(1e-9) : Real(1e-4);

/// A covered contact supports a body when the cosine of the angle between its normal and the plane's is at least this
/// (1). Larger: corners no longer support round bodies. Smaller: sides of tiles do.
constexpr Real kSupports = Real(0.7);

/// The touched feature of a part is its support point along the contact normal, tilted by this towards the plane's
/// normal (1, the tangent): the top of a side that stands at a right angle. Larger: slopes count as walls. Smaller:
/// errors of the contact normal choose the foot of a wall instead of its top, so that the wall does not stop a body.
constexpr Real kTopLean = Real(0.01);

constexpr std::int32_t kStill = -1, kAlone = -2;  // groups: static and kinematic bodies; a body with one part

// Bodies of one convex part have no neighbours.
template <int D>
std::int32_t groupOf(const BodyTable<D>& table, std::int32_t body) {
  const auto b = static_cast<std::size_t>(body);
  if (table.bodies.type[b] != BodyType::dynamic) return kStill;
  const auto shapes = table.shapesOf(b);
  return shapes.size() > 1 || !table.shapes[static_cast<std::size_t>(shapes[0])].shape.convex() ? body : kAlone;
}

template <int D>
PlacedView<D> partOf(const Shape<D>& shape, std::int32_t number) {
  if (shape.convex()) return {shape.view(), {}};
  const auto i = static_cast<std::size_t>(number);
  if (shape.surface()) return shape.surface()->parts()[i];
  return {shape.parts()[i].shape.view(), shape.parts()[i].X_SP};
}

// At the current poses. `n`: from A to B. No point: minus infinity.
template <int D>
Real depthOf(const BodyTable<D>& table, const Manifold<D>& m, const Vec<D>& n) {
  const Pose<D>&X_WA = table.bodies.pose[static_cast<std::size_t>(m.bodyA)],
        &X_WB = table.bodies.pose[static_cast<std::size_t>(m.bodyB)];
  Real depth = -std::numeric_limits<Real>::infinity();
  for (std::int32_t i = 0; i < m.count; ++i)
    depth = std::max(depth, -ContactArms<D>(m.points[i], n, X_WA, X_WB).separation);
  return depth;
}

}  // namespace

// One part of a manifold. Positions are relative to Q's centre of mass: far from the origin they would lose digits.
template <int D>
struct FlushContacts<D>::Side {
  ShapeView<D> view;
  Pose<D> X_WC, X_WP;  // of the body, of the part

  Side(const BodyTable<D>& table, std::int32_t shape, std::int32_t part, const Vec<D>& origin) {
    const ShapeRecord<D>& record = table.shapes[static_cast<std::size_t>(shape)];
    const PlacedView<D> placed = partOf(record.shape, part);
    X_WC = table.bodies.pose[static_cast<std::size_t>(record.body)];
    X_WC.p -= origin;
    X_WP = X_WC * record.X_CS * placed.X_SP;
    view = placed.view;
  }
  Vec<D> support(const Vec<D>& d) const {
    return X_WP * coreSupport(view, Vec<D>(X_WP.q.inverse() * d)) + view.radius * d.normalized();
  }
};

template <int D>
const Manifold<D>& FlushContacts<D>::manifold(const Touch& t) const {
  const auto i = static_cast<std::size_t>(t.index);
  return i < m_fresh.size() ? m_fresh[i] : *m_kept[i - m_fresh.size()];
}

// Where all touches of a shape are kept, nothing is corrected.
template <int D>
void FlushContacts<D>::findTouches(const BodyTable<D>& table) {
  m_count.assign(table.shapes.size(), 0), m_touches.clear();
  for (std::size_t i = 0; i < m_fresh.size() + m_kept.size(); ++i) {
    const bool isFresh = i < m_fresh.size();
    const Manifold<D>& m = isFresh ? m_fresh[i] : *m_kept[i - m_fresh.size()];
    const auto add = [&](const Touch& t) {
      std::int32_t& count = m_count[static_cast<std::size_t>(t.shape)];
      if (!isFresh && count == 0) return;
      ++count, m_touches.push_back(t);
    };
    const std::int32_t a = groupOf(table, m.bodyA), b = groupOf(table, m.bodyB);
    if (b != kAlone) add({m.shapeA, m.partA, b, static_cast<std::int32_t>(i), true});
    if (a != kAlone) add({m.shapeB, m.partB, a, static_cast<std::int32_t>(i), false});
  }
}

template <int D>
bool FlushContacts<D>::vetoed(const Manifold<D>& m) const {
  const auto at = std::partition_point(m_before.begin(), m_before.end(),
                                       [&](const Manifold<D>& other) { return other.shapeKey() < m.shapeKey(); });
  return at != m_before.end() && at->shapeKey() == m.shapeKey() && at->ignored;
}

// The deepest rest that covers the touch; null when there is none.
template <int D>
const typename FlushContacts<D>::Rest* FlushContacts<D>::coverOf(const BodyTable<D>& table, const Touch& touch,
                                                                 const Rest& own) const {
  const auto covers = [&](const Rest& rest, const Touch& t, const Vec<D>& n) {
    const Vec<D>& up = rest.normal;
    const Real along = n.dot(up);
    if (!(along > -kSupports)) return false;
    const Manifold<D>& m = manifold(t);
    const Vec<D>& origin = table.bodies.pose[static_cast<std::size_t>(t.isA ? m.bodyA : m.bodyB)].p;
    const Side q(table, t.shape, t.part, origin);
    const Side p(table, t.isA ? m.shapeB : m.shapeA, t.isA ? m.partB : m.partA, origin);
    if (p.view.core() == CoreClass::plane || q.view.core() == CoreClass::plane) return false;
    const Real level = q.support(-up).dot(up) + rest.depth;
    // A part that is wholly below is flush, also where the generator's points are not quite on it.
    const bool below = p.support(up).dot(up) - level <= kFlush;
    if (!below && !(p.support(n + kTopLean * up).dot(up) - level <= kFlush)) return false;
    Real lowest = std::numeric_limits<Real>::infinity(), separation = lowest;  // of the deepest point
    for (std::int32_t i = 0; i < m.count; ++i) {
      const ContactPoint<D>& c = m.points[i];
      const Real height = (p.X_WC * (t.isA ? c.localB : c.localA)).dot(up) - level;
      if (!below && !(height <= kFlush)) return false;
      if (c.separation < separation) lowest = height, separation = c.separation;
    }
    return along < kSupports || lowest >= -std::max(rest.depth, Real(0)) - kFlush;
  };
  for (const std::size_t r : m_deepestFirst) {
    const Rest& rest = m_rests[r];
    if (&rest == &own || rest.covered) continue;
    if (!covers(rest, touch, own.normal)) continue;
    if (own.depth >= rest.depth && covers(own, *rest.by, rest.normal)) continue;
    if (!vetoed(manifold(*rest.by))) return &rest;
  }
  return nullptr;
}

template <int D>
void FlushContacts<D>::correctRun(const BodyTable<D>& table, std::span<const Touch> run) {
  m_rests.clear(), m_restOf.clear();
  for (const Touch& t : run) {
    const Manifold<D>& m = manifold(t);
    const bool isKept = static_cast<std::size_t>(t.index) >= m_fresh.size();
    const Vec<D> fromA = isKept ? Vec<D>(table.bodies.pose[static_cast<std::size_t>(m.bodyA)].q * m.normalA) : m.normal;
    const Vec<D> n = t.isA ? Vec<D>(-fromA) : fromA;
    const Real depth = depthOf(table, m, fromA);
    if (!(depth > -std::numeric_limits<Real>::infinity())) {  // removed
      m_restOf.push_back(-1);
      continue;
    }
    std::size_t r = 0;
    while (r < m_rests.size() && !((m_rests[r].normal - n).norm() <= kEqualNormals)) ++r;
    if (r == m_rests.size()) m_rests.push_back({n, depth, &t, false});
    if (depth > m_rests[r].depth) m_rests[r].normal = n, m_rests[r].depth = depth, m_rests[r].by = &t;
    m_restOf.push_back(static_cast<int>(r));
  }
  if (m_rests.size() < 2) return;
  // One after the other: in a ring of rests that cover each other one stays.
  m_order.resize(m_rests.size());
  std::iota(m_order.begin(), m_order.end(), 0);
  std::sort(m_order.begin(), m_order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(m_rests[a].depth, a) < std::tuple(m_rests[b].depth, b);
  });
  m_deepestFirst = m_order;
  std::sort(m_deepestFirst.begin(), m_deepestFirst.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(-m_rests[a].depth, a) < std::tuple(-m_rests[b].depth, b);
  });
  for (const std::size_t r : m_order) m_rests[r].covered = coverOf(table, *m_rests[r].by, m_rests[r]) != nullptr;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Touch& t = run[i];
    if (m_restOf[i] < 0 || static_cast<std::size_t>(t.index) >= m_fresh.size()) continue;
    const Rest& own = m_rests[static_cast<std::size_t>(m_restOf[i])];
    if (const Rest* rest = coverOf(table, t, own)) turn(table, t, own.normal, rest->normal);
  }
}

// Measures the points along the new normal. The count is 0 when no point is left.
template <int D>
void FlushContacts<D>::turn(const BodyTable<D>& table, const Touch& t, const Vec<D>& old, const Vec<D>& n) {
  Manifold<D>& m = m_fresh[static_cast<std::size_t>(t.index)];
  const std::int32_t count = std::exchange(m.count, 0);
  if (old.dot(n) >= kSupports) {
    const Vec<D>& origin = table.bodies.pose[static_cast<std::size_t>(t.isA ? m.bodyA : m.bodyB)].p;
    const Side mine(table, t.shape, t.part, origin);
    const Side other(table, t.isA ? m.shapeB : m.shapeA, t.isA ? m.partB : m.partA, origin);
    // On a rounded core each point moves around the core's point. A curved core that touches at one point now touches
    // at its lowest point.
    const bool rolls = mine.view.core() == CoreClass::curved && count == 1;
    for (std::int32_t i = 0; i < count; ++i) {
      ContactPoint<D> c = m.points[i];
      Vec<D>&onMine = t.isA ? c.localA : c.localB, &onOther = t.isA ? c.localB : c.localA;
      const Vec<D> q = rolls ? mine.support(-n) : Vec<D>(mine.X_WC * onMine + mine.view.radius * (old - n));
      const Vec<D> gap = q - (other.X_WC * onOther - other.view.radius * (old - n));
      c.separation = gap.dot(n);
      if (!((gap - c.separation * n).norm() <= kFlush)) continue;
      onMine = mine.X_WC.inverse() * q, onOther = other.X_WC.inverse() * Vec<D>(q - c.separation * n);
      m.points[m.count++] = c;
    }
    m.normal = t.isA ? Vec<D>(-n) : n;
  }
  for (std::int32_t i = m.count; i < count; ++i) m.points[i] = {};
}

template <int D>
void FlushContacts<D>::correct(const BodyTable<D>& table, std::span<const Manifold<D>* const> kept,
                               std::span<const Manifold<D>> before, std::vector<Manifold<D>>& fresh) {
  m_fresh = fresh, m_kept = kept, m_before = before;
  findTouches(table);
  // Most parts touch one other part of a group at most.
  std::erase_if(m_touches, [&](const Touch& t) { return m_count[static_cast<std::size_t>(t.shape)] < 2; });
  std::sort(m_touches.begin(), m_touches.end());
  for (std::span<const Touch> rest = m_touches; !rest.empty();) {
    const auto differs = [&](const Touch& t) {
      return t.shape != rest[0].shape || t.part != rest[0].part || t.group != rest[0].group;
    };
    const auto n = static_cast<std::size_t>(std::find_if(rest.begin(), rest.end(), differs) - rest.begin());
    if (n > 1) correctRun(table, rest.first(n));
    rest = rest.subspan(n);
  }
  std::erase_if(fresh, [](const Manifold<D>& m) { return m.count == 0; });
}

template class FlushContacts<2>;
template class FlushContacts<3>;

}}  // namespace lpc::LPC_PRECISION
