// SPDX-License-Identifier: Zlib
#include "framework/world/internal_edges.h"

#include <algorithm>

#include "framework/shape/shape_tolerances.h"
#include "framework/shape/support_map.h"
#include "framework/shape/surface.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// As kLeans, for a curved body: its normals come from an iteration with a tolerance (1, the sine). Larger: the error
/// that remains slows the body. Smaller: the tolerance decides whether a standing cylinder has one point or four.
constexpr Real kCurvedLeans = sizeof(Real) == 8 ? Real(1e-6) : Real(5e-3);

/// A normal of which at most this part is left once it does not lean over level neighbours (1) becomes the triangle's
/// own. Larger: normals that truly lean over a border are lost. Smaller: rounding noise is taken for a direction.
constexpr Real kRemains = sizeof(Real) == 8 ? Real(1e-2) : Real(1e-1);

/// The correction of a normal, in the surface's frame.
template <int D>
struct Correction {
  enum Verdict { stays, changes, goes } verdict = stays;
  Vec<D> normal;
  Vec<D> at;                       // a point of the plane perpendicular to the normal that touches the part
  Vec<D> across = Vec<D>::Zero();  // beyond `at` along this, the neighbour carries the body; zero: no neighbour does
};

/// A border over which the normal leans, and how far (1, the sine).
template <int D>
struct Lean {
  typename Surface<D>::Border border;
  Real by = 0;
};

// Finds the borders over which the normal leans, from the part's support feature along the normal: an edge gives one
// border; a corner gives two, between which the lean is divided. A dot product with the outward direction of each
// border would name edges away from the contact, on triangles with an obtuse corner.
std::array<Lean<2>, 2> leansOf(const Surface<2>& surface, std::int32_t part, const Vec<2>& aside) {
  const auto end = surface.border(part, 1);
  const Real by = aside.dot(end.outward);
  return {Lean<2>{by > 0 ? end : surface.border(part, 0), std::abs(by)}, Lean<2>{end, 0}};
}
std::array<Lean<3>, 2> leansOf(const Surface<3>& surface, std::int32_t part, const Vec<3>& aside) {
  const Vec<3>& n = surface.normal(part);
  std::array<Lean<3>, 2> best;
  Real least = -std::numeric_limits<Real>::infinity();
  for (int corner = 0; corner < 3; ++corner) {
    const auto before = surface.border(part, (corner + 2) % 3), after = surface.border(part, corner);
    const Real turn = cross(before.outward, after.outward).dot(n);
    const Real byBefore = cross(aside, after.outward).dot(n) / turn;
    const Real byAfter = cross(before.outward, aside).dot(n) / turn;
    if (!(std::min(byBefore, byAfter) > least)) continue;
    least = std::min(byBefore, byAfter);
    best = {Lean<3>{before, byBefore}, Lean<3>{after, byAfter}};
  }
  return best;
}

// `least`: a smaller lean counts as upright.
template <int D>
Correction<D> correct(const Surface<D>& surface, std::int32_t part, const Vec<D>& n, Real least) {
  Correction<D> out;
  const Vec<D>& own = surface.normal(part);
  const Real up = n.dot(own);
  if (!(up >= -kAgainstSolid)) return out.verdict = Correction<D>::goes, out;
  const Vec<D> aside = n - up * own;
  if (aside.norm() <= least) return out;
  std::array<Lean<D>, 2> leans = leansOf(surface, part, aside);
  const auto normalOf = [&](const Lean<D>& lean) -> const Vec<D>& { return surface.normal(lean.border.neighbour); };
  // No lean counts over a neighbour that is level or rises.
  for (Lean<D>& lean : leans) {
    if (lean.by <= least) {
      lean.by = 0;
    } else if (lean.border.neighbour >= 0) {
      const Vec<D>& other = normalOf(lean);
      if (other.dot(lean.border.outward) > 0 || other.dot(own) < kBackToBack) continue;
      lean.by = 0, out.verdict = Correction<D>::changes;
    }
  }
  // At an acute corner the two borders face almost opposite ways, so that either lean may be far greater than the
  // whole.
  if (out.verdict == Correction<D>::changes) {
    for (Lean<D>& lean : leans) lean.by = std::clamp(aside.dot(lean.border.outward), Real(0), lean.by);
  }
  out.at = (leans[0].by > 0 ? leans[0] : leans[1]).border.at;
  out.normal = n;
  if (out.verdict == Correction<D>::changes) {
    out.normal = own;
    const Vec<D> rest = up * own + leans[0].by * leans[0].border.outward + leans[1].by * leans[1].border.outward;
    if (leans[0].by + leans[1].by > 0 && rest.norm() > kRemains) out.normal = rest.normalized();
  }
  Real farthest = least;
  const Vec<D> reached = out.normal;
  for (const Lean<D>& lean : leans) {
    if (!(lean.by > 0) || lean.border.neighbour < 0) continue;
    const Vec<D>& other = normalOf(lean);
    const Vec<D> across = other.dot(own) * lean.border.outward - other.dot(lean.border.outward) * own;
    if (!(reached.dot(across) > farthest)) continue;
    farthest = reached.dot(across);
    out.verdict = Correction<D>::changes, out.normal = other, out.at = lean.border.at, out.across = across;
  }
  return out;
}

template <int D>
ShapeView<D> viewOf(const Shape<D>& shape, std::int32_t number, Pose<D>& X_SP) {
  if (shape.convex()) return shape.view();
  const ShapePart<D>& part = shape.parts()[static_cast<std::size_t>(number)];
  X_SP = part.X_SP;
  return part.shape.view();
}

template <int D>
bool standsOn(const Surface<D>& surface, std::int32_t part, const Vec<D>& foot, const Correction<D>& correction) {
  if ((foot - correction.at).dot(correction.across) > kFootOff) return false;
  for (int k = 0; k < Surface<D>::kBorders; ++k) {
    const auto border = surface.border(part, k);
    if ((foot - border.at).dot(border.outward) > kFootOff) return false;
  }
  return true;
}

// Measures the points along the new normal. On a rounded core each point moves around the core's point. A curved core
// that touches at one point now touches at its lowest point. Returns false when no point is left.
template <int D>
bool measureAnew(Manifold<D>& m, bool isA, const Surface<D>& surface, const Correction<D>& correction,
                 const Vec<D>& old, std::span<const ShapeRecord<D>> shapes, std::span<const Pose<D>> pose,
                 Real margin) {
  const ShapeRecord<D>& mine = shapes[static_cast<std::size_t>(isA ? m.shapeA : m.shapeB)];
  const ShapeRecord<D>& other = shapes[static_cast<std::size_t>(isA ? m.shapeB : m.shapeA)];
  const Pose<D> X_SC = mine.X_CS.inverse();
  const Pose<D> X_SO = X_SC * poseBetween(pose[static_cast<std::size_t>(mine.body)],
                                          pose[static_cast<std::size_t>(other.body)]);  // of the other shape's body
  const Pose<D> X_OS = X_SO.inverse();
  Pose<D> X_OP;
  const ShapeView<D> view = viewOf(other.shape, isA ? m.partB : m.partA, X_OP);
  X_OP = other.X_CS * X_OP;
  const std::int32_t part = isA ? m.partA : m.partB, count = m.count;
  const Vec<D>& n = correction.normal;
  const bool rolls = view.core() == CoreClass::curved && count == 1;
  m.count = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    ContactPoint<D> c = m.points[static_cast<std::size_t>(i)];
    Vec<D>&onMine = isA ? c.localA : c.localB, &onOther = isA ? c.localB : c.localA;
    Vec<D> q = X_SO * onOther + view.radius * (old - n);
    if (rolls) {
      const Pose<D> X_SP = X_SO * X_OP;
      q = X_SP * coreSupport(view, Vec<D>(X_SP.q.inverse() * Vec<D>(-n))) - view.radius * n;
    }
    c.separation = (q - correction.at).dot(n);
    const Vec<D> foot = q - c.separation * n;
    if (!(c.separation <= margin) || !standsOn(surface, part, foot, correction)) continue;
    onMine = mine.X_CS * foot, onOther = X_OS * q;
    m.points[static_cast<std::size_t>(m.count++)] = c;
  }
  for (std::int32_t i = m.count; i < count; ++i) m.points[static_cast<std::size_t>(i)] = {};
  const Vec<D> n_W = pose[static_cast<std::size_t>(mine.body)].q * (mine.X_CS.q * n);
  m.normal = isA ? n_W : Vec<D>(-n_W);
  return m.count > 0;
}

// False: the manifold is removed.
template <int D>
bool correctManifold(Manifold<D>& m, std::span<const ShapeRecord<D>> shapes, std::span<const Pose<D>> pose,
                     Real margin) {
  const Surface<D>* const a = shapes[static_cast<std::size_t>(m.shapeA)].shape.surface();
  const Surface<D>* const b = shapes[static_cast<std::size_t>(m.shapeB)].shape.surface();
  if (!a && !b) return true;
  const Surface<D>& surface = a ? *a : *b;
  const ShapeRecord<D>& mine = shapes[static_cast<std::size_t>(a ? m.shapeA : m.shapeB)];
  const Rot<D> R_WS = pose[static_cast<std::size_t>(mine.body)].q * mine.X_CS.q;
  const Vec<D> n = R_WS.inverse() * (a ? m.normal : Vec<D>(-m.normal));
  Pose<D> unused;
  const ShapeView<D> view =
      viewOf(shapes[static_cast<std::size_t>(a ? m.shapeB : m.shapeA)].shape, a ? m.partB : m.partA, unused);
  const Real least = view.core() == CoreClass::curved ? kCurvedLeans : kLeans;
  const Correction<D> correction = correct(surface, a ? m.partA : m.partB, n, least);
  if (correction.verdict == Correction<D>::stays) return true;
  return correction.verdict == Correction<D>::changes &&
         measureAnew(m, a != nullptr, surface, correction, n, shapes, pose, margin);
}

}  // namespace

template <int D>
void correctSurfaceContacts(std::span<const ShapeRecord<D>> shapes, std::span<const Pose<D>> pose, Real margin,
                            std::size_t first, std::vector<Manifold<D>>& manifolds) {
  std::size_t kept = first;
  for (std::size_t i = first; i < manifolds.size(); ++i) {
    if (!correctManifold(manifolds[i], shapes, pose, margin)) continue;
    if (kept != i) manifolds[kept] = manifolds[i];
    ++kept;
  }
  manifolds.resize(kept);
}

template void correctSurfaceContacts(std::span<const ShapeRecord<2>>, std::span<const Pose<2>>, Real, std::size_t,
                                     std::vector<Manifold<2>>&);
template void correctSurfaceContacts(std::span<const ShapeRecord<3>>, std::span<const Pose<3>>, Real, std::size_t,
                                     std::vector<Manifold<3>>&);

}}  // namespace lpc::LPC_PRECISION
