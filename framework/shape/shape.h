// SPDX-License-Identifier: Zlib
// Shapes are "vertices plus a radius" (the 2009 report, 6.2): a convex core and a rounding radius. Each core has a
// class. The set of classes is closed: code switches over classes without a default, so that a new class is a compile
// error wherever it matters. A new kind in an existing class is one more file (framework/shape/curved_core.h).
//
// A composite shape has several convex parts: a compound, or a surface of triangles (3D) or segments (2D). It has no
// kind and no view: methods get only its parts.
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

/// Batches of pairs are sorted in this order: kindA <= kindB. Append new kinds, because saved worlds contain the
/// numbers. `custom` is a shape that a plugin defines by its support function.
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

/// The geometry of a shape's core, without its rounding.
enum class CoreClass : unsigned char {
  point,
  segment,  // along x, half[0] long on each side of the origin
  box,
  hull,
  curved,  // known only by its support points and support features
  plane    // a half-space, y <= 0 in its own frame: unbounded, for static bodies
};
/// Class of each kind. Not inside `coreClass`, where it would be written to the stack at each call.
inline constexpr IndexedArray<CoreClass, kShapeKinds> kCoreClasses = {
    CoreClass::point,  CoreClass::segment, CoreClass::segment, CoreClass::box,  CoreClass::hull,  CoreClass::curved,
    CoreClass::curved, CoreClass::plane,   CoreClass::curved,  CoreClass::hull, CoreClass::curved};
constexpr CoreClass coreClass(ShapeKind kind) { return kCoreClasses[kind]; }
/// True when the kind exists in this dimension. A segment has no area, so it is 2D only. Cylinder, cone and triangle
/// are 3D only: their 2D counterparts are a box and polygons. `custom` exists as soon as a plugin has registered it
/// (framework/shape/curved_core.h).
bool kindExists(ShapeKind kind, int dimension);
std::string_view shapeKindName(ShapeKind kind);
/// The kind with this name. Throws UserError with the valid names.
ShapeKind shapeKindFromName(std::string_view name);

/// A convex polygon (2D) or polytope (3D), immutable. It is made by `convexHull`, or is a flat triangle
/// (`flatTriangle`).
template <int D>
struct Polytope;

template <>
struct Polytope<2> {
  IndexedVector<Vec<2>> vertices;  // counter-clockwise, no three collinear
  IndexedVector<Vec<2>> normals;   // unit, outward, of the edge from vertex i to i + 1
};

template <>
struct Polytope<3> {
  struct Face {
    Vec<3> normal;  // unit, outward
    Real offset;    // normal . p = offset on the face
    // Vertices of the face: loop[begin..end), counter-clockwise from outside; coplanar triangles are merged. A side
    // face of a flat triangle has two vertices and no area.
    int begin, end;
  };
  struct Edge {
    int v0, v1;  // in the order of faceA's loop
    int faceA, faceB;
  };
  /// An edge as seen from one of its vertices.
  struct Spoke {
    int to, edge;
  };
  IndexedVector<Vec<3>> vertices;
  IndexedVector<Face> faces;
  IndexedVector<int> loop;
  IndexedVector<Edge> edges;  // each edge once

  // Derived data (`linkVertices`).
  IndexedVector<Spoke> spokes;    // spokes of vertex i: spokes[firstSpoke[i]..firstSpoke[i + 1])
  IndexedVector<int> firstSpoke;  // one entry more than there are vertices
  // A vertex is the support point along a unit direction when all its neighbours are lower along it by at least this
  // (m). Allows for rounding errors of the hull and of the computation. Infinite when convexity is not proved.
  Real slack = std::numeric_limits<Real>::infinity();

  std::span<const Spoke> spokesOf(int vertex) const {
    const int* first = firstSpoke.data() + vertex;
    return spokes.part(first[0], first[1] - first[0]);
  }
};

/// Fills the derived data of a hull from its vertices, faces and edges. Leaves the derived data empty when an index is
/// invalid, as in a damaged file.
void linkVertices(Polytope<3>& hull);

/// Convex hull of `points` (m), by monotone chain in 2D and Qhull in 3D. Drops points that lie on the hull within
/// rounding. Throws UserError when there are fewer than D+1 points, all lie on one line (plane), or one is not finite.
std::shared_ptr<const Polytope<2>> convexHull(std::span<const Vec<2>> points);
std::shared_ptr<const Polytope<3>> convexHull(std::span<const Vec<3>> points);

/// A prism of height zero: both sides, and three side faces without area, with normals in the triangle's plane. So each
/// edge has two faces, here at a right angle, as in any hull. Throws UserError when corners are not finite or collinear
/// within rounding; `subject` starts the message.
std::shared_ptr<const Polytope<3>> flatTriangle(const std::array<Vec<3>, 3>& corners, std::string_view subject);

template <int D>
class CurvedCore;
template <int D>
class Surface;

/// A shape as algorithms see it: plain data, no ownership. The origin of its frame is its centre, except for a
/// polytope, whose points are used as given.
template <int D>
struct ShapeView {
  ShapeKind kind = ShapeKind::sphere;
  Real radius = 0;                        // rounding around the core (m): a sphere is a rounded point
  Vec<D> half = Vec<D>::Zero();           // half extents of a box around the origin that contains the core (m); the
                                          // tightest except for a hull, (h, 0, 0) for a segment
  const Polytope<D>* hull = nullptr;      // hull only
  const CurvedCore<D>* curved = nullptr;  // curved only

  CoreClass core() const { return coreClass(kind); }
};

template <int D>
struct ShapePart;
template <int D>
struct PlacedView;

/// Whether the parts of a compound may overlap.
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
  /// 3D only. Seen from outside, the corners are counter-clockwise. A triangle has no mass.
  static Shape triangle(const Vec<D>& p0, const Vec<D>& p1, const Vec<D>& p2, Real rounding = 0);
  /// A shape with a hull as core, from its corners: a polytope or a triangle.
  static Shape ofCorners(ShapeKind kind, std::span<const Vec<D>> corners, Real rounding = 0);
  /// A shape of a curved kind, from its sizes in the order of `curvedKind(kind).sizes`; the rounding is added outside.
  static Shape curved(ShapeKind kind, std::span<const Real> sizes, Real rounding = 0);
  static Shape plane();  // the half-space y <= 0
  /// Combines several bounded convex shapes, such as those of an L or a gear, at their poses in the compound's frame.
  /// The mass of an overlap counts once for each part. With `refused`, throws UserError when two parts overlap by more
  /// than kPartOverlap of their sizes.
  static Shape compound(std::span<const ShapePart<D>> parts, PartOverlap overlap = PartOverlap::counted);

  /// 3D only: a surface of triangles, each with three point indices, counter-clockwise seen from outside. The space
  /// behind a triangle is solid: no contact pushes into it. A mesh need not be closed, and may intersect itself,
  /// because each triangle is handled by itself. For static bodies only. For an invalid surface throws UserError with
  /// the place of the error.
  static Shape mesh(std::span<const Vec<D>> points, std::span<const std::array<int, 3>> triangles);
  /// 2D only: a curve of segments from point to point, and from the last to the first when closed. Its left side is
  /// solid, its normals point to the right, as in Box2D's chains: ground runs from right to left, an island
  /// counter-clockwise. In all other respects it is like a mesh.
  static Shape chain(std::span<const Vec<D>> points, bool closed);

  bool convex() const { return !m_compound && !m_surface; }
  bool isPlane() const { return convex() && m_view.core() == CoreClass::plane; }
  // Precondition of both: convex().
  ShapeKind kind() const { return view().kind; }
  const ShapeView<D>& view() const {
    LPC_ASSERT(convex());
    return m_view;
  }
  /// Parts of a compound; empty for others. See forParts.
  std::span<const ShapePart<D>> parts() const;
  /// Surface of a mesh or chain; null for others.
  const Surface<D>* surface() const { return m_surface.get(); }
  std::span<const PlacedView<D>> surfaceParts() const;
  /// True when the shape is unbounded or has no interior: only a static body may have it.
  bool staysFixed() const { return isPlane() || m_surface; }
  /// True when no part is round: each is a box, polytope, triangle, segment or plane without rounding.
  bool flat() const { return m_flat; }
  /// Radius (m) of a sphere around the shape's own origin that contains all parts (see boundingRadius).
  Real reach() const { return m_reach; }
  /// True for a copy: the numbers are equal, and the hull, core, parts and surface are the same objects, not only equal
  /// ones.
  bool same(const Shape& o) const {
    return m_view.kind == o.m_view.kind && m_view.radius == o.m_view.radius && m_view.half == o.m_view.half &&
           m_hull == o.m_hull && m_curved == o.m_curved && m_compound == o.m_compound && m_surface == o.m_surface;
  }

 private:
  Shape measured() &&;  // with the data that follow from the others

  ShapeView<D> m_view;
  std::shared_ptr<const Polytope<D>> m_hull;
  std::shared_ptr<const CurvedCore<D>> m_curved;
  std::shared_ptr<const std::vector<ShapePart<D>>> m_compound;
  std::shared_ptr<const Surface<D>> m_surface;
  Real m_reach = 0;
  bool m_flat = false;
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

/// Moves the frame of a hull to the hull's middle, and changes its pose so that the hull stays in place. Applies only
/// to a hull farther than kFarHull times its size from its frame's origin, where queries would lose digits. Returns any
/// other part unchanged to the last bit. All shapes of a world and parts of compounds pass through it.
template <int D>
ShapePart<D> centredPart(const ShapePart<D>& part);

/// A triangle or segment of a surface.
template <int D>
struct PlacedView {
  ShapeView<D> view;
  Pose<D> X_SP{};  // in the surface's frame
};

/// Calls f(view, X_AP) for each convex part of a shape posed by X_AS, in order. A convex shape has a single part,
/// itself. A surface may have millions of parts: see forPartsNear (framework/shape/parts_near.h).
template <int D, class F>
void forParts(const Shape<D>& shape, const Pose<D>& X_AS, F&& f) {
  if (shape.convex()) return f(shape.view(), X_AS);
  for (const ShapePart<D>& part : shape.parts()) f(part.shape.view(), X_AS * part.X_SP);
  for (const PlacedView<D>& part : shape.surfaceParts()) f(part.view, X_AS * part.X_SP);
}

/// The tight box of the shape posed by X_WS; all space for a plane.
template <int D>
Aabb<D> boundingBox(const ShapeView<D>& shape, const Pose<D>& X_WS);
template <int D>
Aabb<D> boundingBox(const Shape<D>& shape, const Pose<D>& X_WS);

/// Radius (m) of a sphere around the shape's own origin that contains it. For a curved core the sphere contains its
/// box; infinite for a plane.
template <int D>
Real boundingRadius(const ShapeView<D>& shape);

/// True when the world point p_W is in the closed shape.
template <int D>
bool containsPoint(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p_W);

/// True when the closed shape and the closed box overlap. Exact except for rounding.
template <int D>
bool overlapsBox(const ShapeView<D>& shape, const Pose<D>& X_WS, const Aabb<D>& box);

template <int D>
struct RayEntry {
  Real t = -1;                     // negative when the ray misses
  Vec<D> normal = Vec<D>::Zero();  // unit, world, out of the shape; zero when it misses or starts inside
};

/// Where the ray p + t * direction (0 <= t <= maxT) enters the shape; t = 0 when it starts inside. On an edge the
/// normal is that of one face through which the ray enters.
template <int D>
RayEntry<D> rayEntry(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p, const Vec<D>& direction,
                     Real maxT);

}}  // namespace lpc::LPC_PRECISION
