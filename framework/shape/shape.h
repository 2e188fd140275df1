// SPDX-License-Identifier: Zlib
// Shapes are "vertices plus a radius" (the 2009 report, 6.2): a convex core and a rounding. The set is closed: shapes
// are the vocabulary of scenes, algorithms are the variable. What a core is made of is its class: code switches over
// classes, without a default, so that a new class is a compile error where it matters; a new kind of a class that is
// there is one more file (framework/shape/curved_core.h).
//
// A composite shape has several convex parts: a compound, or a surface of triangles (3D) or segments (2D). It has no
// kind and no view: no method can be handed one, only its parts.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "framework/math/aabb.h"
#include "framework/math/check.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION {

/// In this order batches are sorted: a pair of kinds always comes with kindA <= kindB. New kinds are appended: the
/// numbers stand in saved worlds. `custom` is whatever a plugin gives by its support function.
enum class ShapeKind : unsigned char {
  sphere,
  capsule,
  segment,
  box,
  polytope,
  cylinder,
  ellipsoid,
  plane,
  cone,
  triangle,
  custom
};
inline constexpr int kShapeKinds = 11;

/// What the core of a shape is made of, its rounding left out.
enum class CoreClass : unsigned char {
  point,
  segment,  // along x, half[0] long on both sides
  box,
  hull,
  curved,  // known by its support function and its support faces alone
  plane    // a half-space, y <= 0 in its own frame: unbounded, for bodies that never move
};
/// Of each kind; by itself, since one inside of `coreClass` would be written to the stack for each question.
inline constexpr IndexedArray<CoreClass, kShapeKinds> kCoreClasses = {
    CoreClass::point,  CoreClass::segment, CoreClass::segment, CoreClass::box,  CoreClass::hull,  CoreClass::curved,
    CoreClass::curved, CoreClass::plane,   CoreClass::curved,  CoreClass::hull, CoreClass::curved};
constexpr CoreClass coreClass(ShapeKind kind) { return kCoreClasses[kind]; }
/// Is there such a kind in this dimension? A segment is a curve without area, a cylinder has no planar twin but the
/// box, a cone none but a polygon, and so has a triangle; `custom` is there as soon as a plugin has registered it
/// (framework/shape/curved_core.h).
bool kindExists(ShapeKind kind, int dimension);
std::string_view shapeKindName(ShapeKind kind);
/// Throws UserError with the valid names.
ShapeKind shapeKindFromName(std::string_view name);

/// A convex polygon (2D) or polytope (3D), immutable, made by `convexHull`; or a flat triangle (`flatTriangle`).
template <int D>
struct Polytope;

template <>
struct Polytope<2> {
  IndexedVector<Vec<2>> vertices;  // counter-clockwise, no three on a line
  IndexedVector<Vec<2>> normals;   // unit, outward, of the edge from vertex i to i + 1
};

template <>
struct Polytope<3> {
  struct Face {
    Vec<3> normal;  // unit, outward
    Real offset;    // normal . p = offset on the face
    // Its vertices: loop[begin..end), counter-clockwise seen from outside; coplanar triangles are merged. Two for a
    // side of a flat triangle, which is an edge: it has no area.
    int begin, end;
  };
  struct Edge {
    int v0, v1;  // as they follow each other in faceA's loop
    int faceA, faceB;
  };
  /// An edge as one of its vertices sees it.
  struct Spoke {
    int to, edge;
  };
  IndexedVector<Vec<3>> vertices;
  IndexedVector<Face> faces;
  IndexedVector<int> loop;
  IndexedVector<Edge> edges;  // each once

  // Follow from the above (`linkVertices`).
  IndexedVector<Spoke> spokes;    // those of vertex i: spokes[firstSpoke[i]..firstSpoke[i + 1])
  IndexedVector<int> firstSpoke;  // one more than there are vertices
  // A vertex whose neighbours all lie this much (m) deeper along some unit direction is the farthest along it, also as
  // computed: what rounding has left of convexity. Infinite where that proves nothing.
  Real slack = std::numeric_limits<Real>::infinity();

  std::span<const Spoke> spokesOf(int vertex) const {
    const int* first = firstSpoke.data() + vertex;
    return spokes.part(first[0], first[1] - first[0]);
  }
};

/// Fills what follows of a hull from its vertices, faces and edges. One with numbers that do not exist, from a damaged
/// file, is left without.
void linkVertices(Polytope<3>& hull);

/// The hull of `points` (m), by monotone chain in 2D and Qhull in 3D. Points that lie on the hull within rounding are
/// dropped. Throws UserError when there are fewer than D+1 points, all lie on one line (plane), or one is not finite.
std::shared_ptr<const Polytope<2>> convexHull(std::span<const Vec<2>> points);
std::shared_ptr<const Polytope<3>> convexHull(std::span<const Vec<3>> points);

/// A prism without height: both its sides, and the three that have no area, with normals in its plane. So its edges
/// have two faces each, a right angle apart, as any hull's. Throws UserError when corners are not finite or on one line
/// within rounding; `who` begins the message.
std::shared_ptr<const Polytope<3>> flatTriangle(const std::array<Vec<3>, 3>& corners, std::string_view who);

template <int D>
class CurvedCore;
template <int D>
class Surface;

/// A shape as algorithms see it: plain data, no ownership. Its own frame has its centre at the origin, except a
/// polytope's, whose points are used as given.
template <int D>
struct ShapeView {
  ShapeKind kind = ShapeKind::sphere;
  Real radius = 0;                    // rounding around the core (m): a sphere is a rounded point
  Vec<D> half = Vec<D>::Zero();       // half extents of a box around the origin that holds the core (m); for all but a
                                      // hull the tightest, of a segment (h, 0, 0)
  const Polytope<D>* hull = nullptr;  // hull only
  const CurvedCore<D>* curved = nullptr;  // curved only

  CoreClass core() const { return coreClass(kind); }
};

template <int D>
struct ShapePart;
template <int D>
struct PlacedView;

/// May the parts of a compound share more than their surfaces?
enum class PartOverlap { counted, refused };

/// A shape as users hold it. The factories throw UserError for sizes that are negative, not finite, or without volume.
template <int D>
class Shape {
 public:
  static Shape sphere(Real radius);                                // radius 0 is a point: for queries only
  static Shape box(const Vec<D>& halfExtents, Real rounding = 0);  // the rounding is added outside
  static Shape capsule(Real halfLength, Real radius);              // along x
  static Shape segment(Real halfLength);                           // along x, 2D only
  static Shape polytope(std::span<const Vec<D>> points, Real rounding = 0);
  static Shape polytope(std::shared_ptr<const Polytope<D>> hull, Real rounding = 0);
  /// 3D only; its outside is where the corners go round counter-clockwise. It has no mass.
  static Shape triangle(const Vec<D>& p0, const Vec<D>& p1, const Vec<D>& p2, Real rounding = 0);
  /// A shape whose core is a hull, by its corners: a polytope or a triangle.
  static Shape ofCorners(ShapeKind kind, std::span<const Vec<D>> corners, Real rounding = 0);
  /// Of a curved kind, by its sizes in the order of `curvedKind(kind).sizes`; the rounding is added outside.
  static Shape curved(ShapeKind kind, std::span<const Real> sizes, Real rounding = 0);
  static Shape plane();  // the half-space y <= 0
  /// Several convex shapes as one, an L or a gear, in the frame that they are posed in. Where parts overlap, their mass
  /// counts as often as there are parts; `refused` throws UserError for two that share more than kPartOverlap of their
  /// sizes. Parts are bounded.
  static Shape compound(std::span<const ShapePart<D>> parts, PartOverlap overlap = PartOverlap::counted);

  /// 3D only: a surface of triangles, three numbers of points each, counter-clockwise seen from outside. What lies
  /// behind a triangle is solid: nothing is pushed there. A mesh need not be closed. Each triangle stands for itself,
  /// so that a mesh may run through itself. For fixed bodies only. Throws UserError for what is no such surface, and
  /// says where.
  static Shape mesh(std::span<const Vec<D>> points, std::span<const std::array<int, 3>> triangles);
  /// 2D only: a curve of segments from point to point, and from the last to the first when closed. What lies to its
  /// left is solid, its normals look to the right, as those of Box2D's chains: ground runs from right to left, an
  /// island counter-clockwise. Else as a mesh.
  static Shape chain(std::span<const Vec<D>> points, bool closed);

  bool convex() const { return !m_compound && !m_surface; }
  bool isPlane() const { return convex() && m_view.core() == CoreClass::plane; }
  // Precondition of both: convex().
  ShapeKind kind() const { return view().kind; }
  const ShapeView<D>& view() const {
    LPC_ASSERT(convex());
    return m_view;
  }
  /// Of a compound; none of others. See forParts.
  std::span<const ShapePart<D>> parts() const;
  /// Of a mesh or chain; null of others.
  const Surface<D>* surface() const { return m_surface.get(); }
  std::span<const PlacedView<D>> surfaceParts() const;
  /// Has no end, or no inside: only a fixed body may have it.
  bool staysFixed() const { return isPlane() || m_surface; }
  /// A copy of it: equal numbers, and hulls, parts and surfaces that are shared and not only alike.
  bool same(const Shape& o) const {
    return m_view.kind == o.m_view.kind && m_view.radius == o.m_view.radius && m_view.half == o.m_view.half &&
           m_hull == o.m_hull && m_curved == o.m_curved && m_compound == o.m_compound && m_surface == o.m_surface;
  }

 private:
  ShapeView<D> m_view;
  std::shared_ptr<const Polytope<D>> m_hull;
  std::shared_ptr<const CurvedCore<D>> m_curved;
  std::shared_ptr<const std::vector<ShapePart<D>>> m_compound;
  std::shared_ptr<const Surface<D>> m_surface;
};

/// A convex part of a compound.
template <int D>
struct ShapePart {
  Shape<D> shape;
  Pose<D> X_SP{};  // in the compound's frame
};

template <int D>
std::span<const ShapePart<D>> Shape<D>::parts() const {
  return m_compound ? std::span<const ShapePart<D>>(*m_compound) : std::span<const ShapePart<D>>();
}

/// A hull that lies farther than kFarHull of its sizes from its frame's origin, around its own middle, and posed so
/// that it is where it was: queries of it then lose no digits to a frame that its pose brings back. Any other part as
/// it is, to the last bit. What a world is given and compounds are made of goes through here.
template <int D>
ShapePart<D> centredPart(const ShapePart<D>& part);

/// A triangle or segment of a surface.
template <int D>
struct PlacedView {
  ShapeView<D> view;
  Pose<D> X_SP{};  // in the surface's frame
};

/// f(view, X_AP) for each convex part of a shape posed by X_AS, in order. A convex shape is its own one part. Of a
/// surface there may be millions: see forPartsNear (framework/shape/parts_near.h).
template <int D, class F>
void forParts(const Shape<D>& shape, const Pose<D>& X_AS, F&& f) {
  if (shape.convex()) return f(shape.view(), X_AS);
  for (const ShapePart<D>& part : shape.parts()) f(part.shape.view(), X_AS * part.X_SP);
  for (const PlacedView<D>& part : shape.surfaceParts()) f(part.view, X_AS * part.X_SP);
}

/// The tight box of the shape posed by X_WS; of a plane all space.
template <int D>
Aabb<D> boundingBox(const ShapeView<D>& shape, const Pose<D>& X_WS);
template <int D>
Aabb<D> boundingBox(const Shape<D>& shape, const Pose<D>& X_WS);

/// Radius of a sphere around the shape's own origin that contains it, of a curved core the one around its box (m); of a
/// plane infinite.
template <int D>
Real boundingRadius(const ShapeView<D>& shape);

/// Is the world point p_W in the closed shape?
template <int D>
bool containsPoint(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p_W);

/// Do the closed shape and the closed box overlap? Exact but for rounding.
template <int D>
bool overlapsBox(const ShapeView<D>& shape, const Pose<D>& X_WS, const Aabb<D>& box);

template <int D>
struct RayEntry {
  Real t = -1;                     // a negative number when the ray misses
  Vec<D> normal = Vec<D>::Zero();  // unit, world, out of the shape; zero when it misses or starts inside
};

/// Where the ray p + t * direction (0 <= t <= maxT) enters the shape. One that starts inside does so at once, t = 0. On
/// an edge the normal is that of a face that the ray enters by.
template <int D>
RayEntry<D> rayEntry(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p, const Vec<D>& direction,
                     Real maxT);

}}  // namespace lpc::LPC_PRECISION
