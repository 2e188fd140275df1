// SPDX-License-Identifier: Zlib
// Queries of one shape with points, boxes and rays. Exact except for rounding, and closed: no tolerance; iterative only
// for curved cores. A rounded shape is the set of points within `radius` of its core, so each query reduces to the
// core's features.
#include <algorithm>
#include <limits>

#include "framework/math/aabb.h"
#include "framework/shape/curved_ray.h"
#include "framework/shape/shape_tolerances.h"
#include "framework/shape/support_gap.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kInf = std::numeric_limits<Real>::infinity();

Real planeOffset(const Polytope<2>& hull, std::size_t i) { return hull.normals[i].dot(hull.vertices[i]); }

// Calls f(normal, offset); inside is normal . p <= offset.
template <class F>
void forEachPlane(const Polytope<2>& hull, F&& f) {
  for (std::size_t i = 0; i < hull.normals.size(); ++i) f(hull.normals[i], planeOffset(hull, i));
}
template <class F>
void forEachPlane(const Polytope<3>& hull, F&& f) {
  for (const auto& face : hull.faces) f(face.normal, face.offset);
}

template <class F>
void forEachEdge(const Polytope<2>& hull, F&& f) {
  const std::size_t n = hull.vertices.size();
  for (std::size_t i = 0; i < n; ++i) f(hull.vertices[i], hull.vertices[(i + 1) % n]);
}
template <class F>
void forEachEdge(const Polytope<3>& hull, F&& f) {
  for (const auto& e : hull.edges) {
    f(hull.vertices[e.v0], hull.vertices[e.v1]);
  }
}

template <int D>
Vec<D> corner(const Vec<D>& half, int bits) {
  Vec<D> v;
  for (int k = 0; k < D; ++k) v[k] = (bits >> k) & 1 ? half[k] : -half[k];
  return v;
}

// Calls f(a, b) for every edge of the core; a point core is one edge of length zero. Curved cores and planes have none.
template <int D, class F>
void forEachEdge(const ShapeView<D>& shape, F&& f) {
  switch (shape.core()) {
    case CoreClass::point:
    case CoreClass::segment:
      return f(Vec<D>(-shape.half), shape.half);
    case CoreClass::hull:
      return forEachEdge(*shape.hull, f);
    case CoreClass::curved:
    case CoreClass::plane:
      return;
    case CoreClass::box:
      break;
  }
  for (int k = 0; k < D; ++k) {
    for (int bits = 0; bits < 1 << D; ++bits) {
      if (!((bits >> k) & 1)) f(corner<D>(shape.half, bits), corner<D>(shape.half, bits | 1 << k));
    }
  }
}

// In 2D faces are edges, which are handled elsewhere; only 3D has more faces.
bool insideFace(const Polytope<3>& hull, const Polytope<3>::Face& face, const Vec<3>& p) {
  if (face.end - face.begin < 3) return false;  // a triangle's side has no area: it is an edge
  for (int i = face.begin; i < face.end; ++i) {
    const int j = i + 1 < face.end ? i + 1 : face.begin;
    const Vec<3>& a = hull.vertices[hull.loop[i]];
    const Vec<3>& b = hull.vertices[hull.loop[j]];
    if (cross(Vec<3>(b - a), Vec<3>(p - a)).dot(face.normal) < 0) return false;
  }
  return true;
}

// Distance of an outer point to the nearest face with the point's projection in its interior.
Real faceDistance(const Polytope<2>&, const Vec<2>&) { return kInf; }
Real faceDistance(const Polytope<3>& hull, const Vec<3>& p) {
  Real best = kInf;
  for (const auto& face : hull.faces) {
    const Real d = face.normal.dot(p) - face.offset;
    if (d >= 0 && d < best && insideFace(hull, face, p)) best = d;
  }
  return best;
}

// Entry of a ray through the faces, moved outwards by r.
RayEntry<2> faceRay(const Polytope<2>&, Real, const Vec<2>&, const Vec<2>&) { return {kInf}; }
RayEntry<3> faceRay(const Polytope<3>& hull, Real r, const Vec<3>& p, const Vec<3>& d) {
  RayEntry<3> best{kInf};
  for (const auto& face : hull.faces) {
    const Real speed = face.normal.dot(d);
    if (!(speed < 0)) continue;
    const Real t = (face.offset + r - face.normal.dot(p)) / speed;
    if (t >= 0 && t < best.t && insideFace(hull, face, p + t * d)) best = {t, face.normal};
  }
  return best;
}

template <int D>
Real pointSegmentSquared(const Vec<D>& p, const Vec<D>& a, const Vec<D>& b) {
  const Vec<D> u = b - a;
  const Real uu = u.squaredNorm();
  const Real t = uu > 0 ? std::clamp((p - a).dot(u) / uu, Real(0), Real(1)) : Real(0);
  return (p - (a + t * u)).squaredNorm();
}

// Distance of p, in the shape's frame, from a curved core, and the direction from p to the core.
template <int D>
Gap<D> pointCurvedGap(const CurvedCore<D>& core, const Vec<D>& p) {
  return gapToOrigin<D>([&](const Vec<D>& d) { return Vec<D>(core.support(d) - p); }, -p);
}

// Squared distance of p, in the shape's frame, from the core.
template <int D>
Real pointCoreSquared(const ShapeView<D>& shape, const Vec<D>& p) {
  switch (shape.core()) {
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
      return (p.cwiseAbs() - shape.half).cwiseMax(Real(0)).squaredNorm();
    case CoreClass::curved: {
      const Real gap = std::max(Real(0), pointCurvedGap<D>(*shape.curved, p).gap);
      return gap * gap;
    }
    case CoreClass::plane: {
      const Real height = std::max(Real(0), Real(p[1]));
      return height * height;
    }
    case CoreClass::hull:
      break;
  }
  bool inside = true;
  forEachPlane(*shape.hull, [&](const Vec<D>& n, Real offset) { inside = inside && n.dot(p) <= offset; });
  if (inside) return 0;
  const Real d = faceDistance(*shape.hull, p);
  Real best = d * d;
  forEachEdge(*shape.hull,
              [&](const Vec<D>& a, const Vec<D>& b) { best = std::min(best, pointSegmentSquared<D>(p, a, b)); });
  return best;
}

// Squared distance of the segment a b from the box |x_k| <= half_k. The squared distance at a + t (b - a) is convex and
// piecewise quadratic in t, so its slope is piecewise linear and has its zero between two neighbouring breaks.
template <int D>
Real segmentBoxSquared(const Vec<D>& a, const Vec<D>& b, const Vec<D>& half) {
  const Vec<D> u = b - a;
  const auto excess = [&](Real t) {
    const Vec<D> p = a + t * u;
    return Vec<D>(p - p.cwiseMax(-half).cwiseMin(half));
  };
  IndexedArray<Real, 2 * D + 2> breaks{Real(0), Real(1)};
  std::size_t n = 2;
  for (int k = 0; k < D; ++k) {
    for (const Real face : {-half[k], half[k]}) {
      const Real t = (face - a[k]) / u[k];
      if (t > 0 && t < 1) breaks[n++] = t;
    }
  }
  std::sort(breaks.begin(), breaks.begin() + n);
  Real t0 = 0, slope0 = excess(0).dot(u);
  Real best = excess(0).squaredNorm();
  for (std::size_t i = 1; i < n && slope0 < 0; ++i) {
    const Real t1 = breaks[i], slope1 = excess(t1).dot(u);
    const Real t = slope1 > 0 ? t0 + (t1 - t0) * (slope0 / (slope0 - slope1)) : t1;
    best = std::min(best, excess(t).squaredNorm());
    t0 = t1, slope0 = slope1;
  }
  return best;
}

template <int D>
void takeNearer(RayEntry<D>& best, const RayEntry<D>& other) {
  if (other.t < best.t) best = other;
}

// Entry of a ray into the ball of radius r around c. The chord is measured from the closest point of the ray: the
// textbook discriminant loses all digits for far balls (Haines, Guenther, Akenine-Moeller 2019).
template <int D>
RayEntry<D> ballRay(const Vec<D>& c, Real r, const Vec<D>& p, const Vec<D>& d) {
  const Real dd = d.squaredNorm();
  const Vec<D> m = p - c;
  const Real t0 = -m.dot(d) / dd;
  const Vec<D> closest = m + t0 * d;
  const Real chord = r * r - closest.squaredNorm();
  if (!(chord >= 0)) return {kInf};
  const Real back = std::sqrt(chord / dd), t = t0 - back;
  if (!(t >= 0)) return {kInf};
  return {t, Vec<D>(closest - back * d).normalized()};
}

// Entry of a ray that starts outside into the capsule around segment a b.
template <int D>
RayEntry<D> capsuleRay(const Vec<D>& a, const Vec<D>& b, Real r, const Vec<D>& p, const Vec<D>& d) {
  const Vec<D> u = b - a;
  const Real uu = u.squaredNorm();
  RayEntry<D> best = ballRay<D>(a, r, p, d);
  takeNearer(best, ballRay<D>(b, r, p, d));
  if (!(uu > 0)) return best;
  // Seen along the axis, the lateral surface is a ball (a strip in 2D) around a.
  const Vec<D> m = p - a;
  const Vec<D> mSide = m - u * (m.dot(u) / uu), dSide = d - u * (d.dot(u) / uu);
  if (dSide.squaredNorm() > 0) {
    const RayEntry<D> mantle = ballRay<D>(Vec<D>::Zero(), r, mSide, dSide);
    if (mantle.t < best.t) {
      const Real along = (m + mantle.t * d).dot(u);
      if (along >= 0 && along <= uu) best = mantle;
    }
  }
  return best;
}

// Entry of a ray into the box |x_k| <= half_k with faces moved outwards by r; edges are handled elsewhere.
template <int D>
RayEntry<D> boxFaceRay(const Vec<D>& half, Real r, const Vec<D>& p, const Vec<D>& d) {
  RayEntry<D> best{kInf};
  for (int k = 0; k < D; ++k) {
    if (d[k] == 0) continue;
    const Real t = ((d[k] > 0 ? -half[k] - r : half[k] + r) - p[k]) / d[k];
    if (!(t >= 0 && t < best.t)) continue;
    Vec<D> at = p + t * d;
    at[k] = 0;
    if ((at.cwiseAbs().array() <= half.array()).all()) best = {t, Vec<D>(Vec<D>::Unit(k) * (d[k] > 0 ? -1 : 1))};
  }
  return best;
}

// Entry of a ray into a box core without rounding, even a flat one. The entry face is the last of the facing planes
// that the ray crosses.
template <int D>
RayEntry<D> sharpBoxRay(const Vec<D>& half, const Vec<D>& p, const Vec<D>& d, Real maxT) {
  RayEntry<D> entry{castRay(Aabb<D>{-half, half}, p, d, maxT)};
  if (entry.t < 0) return entry;
  Real last = -kInf;
  for (int k = 0; k < D; ++k) {
    if (d[k] == 0) continue;
    const Real t = ((d[k] > 0 ? -half[k] : half[k]) - p[k]) / d[k];
    if (t > last) last = t, entry.normal = Vec<D>::Unit(k) * (d[k] > 0 ? -1 : 1);
  }
  return entry;
}

// Entry of a ray into a polytope without rounding, by clipping with its planes, moved outwards by `slack` (m).
template <int D>
RayEntry<D> planesRay(const Polytope<D>& hull, const Vec<D>& p, const Vec<D>& d, Real slack) {
  RayEntry<D> enter{0};
  Real leave = kInf;
  forEachPlane(hull, [&](const Vec<D>& n, Real offset) {
    const Real gap = offset + slack - n.dot(p), speed = n.dot(d);
    if (speed < 0) {
      if (gap / speed >= enter.t) enter = {gap / speed, n};
    } else if (speed > 0) {
      leave = std::min(leave, gap / speed);
    } else if (gap < 0) {
      leave = -1;
    }
  });
  return enter.t <= leave ? enter : RayEntry<D>{kInf};
}

// Solves support(n) + r n = x across n by Newton's steps, for x on the surface of a smooth core. A step that comes no
// nearer, or to a plane that cuts off x, as on a face or an edge, is not made.
template <int D>
void settleNormal(const CurvedCore<D>& core, Real r, const Vec<D>& x, Vec<D>& n) {
  const Real rounding = kRayRounding * (x.norm() + core.half().norm() + r);
  const auto offset = [&](const Vec<D>& along) { return Vec<D>(core.support(along) + r * along - x); };
  for (int step = 0; step < kSettleNormal; ++step) {
    const RealMatrix<D, D - 1> t = tangents(n);
    RealMatrix<D - 1, D - 1> turns;
    for (int k = 0; k < D - 1; ++k) {
      const Vec<D> change = core.support(n + kNormalTurn * t.col(k)) - core.support(n - kNormalTurn * t.col(k));
      turns.col(k) = t.transpose() * change / (2 * kNormalTurn);
    }
    turns.diagonal().array() += r;
    const Vec<D> before = offset(n);
    const RealMatrix<D - 1, 1> aside = t.transpose() * before;
    const Vec<D> next = (n - t * (turns.inverse() * aside)).normalized();
    if (!next.allFinite()) return;
    const Vec<D> after = offset(next);
    if (after.dot(next) > before.dot(n) + rounding || !((after - after.dot(next) * next).norm() < aside.norm())) return;
    n = next;
  }
}

// Entry of a ray that starts outside a curved core with rounding r. The tangent plane at the nearest point lies before
// the whole surface, so the ray may advance to that plane. Near the surface this is Newton's iteration.
template <int D>
RayEntry<D> curvedRay(const CurvedCore<D>& core, Real r, const Vec<D>& p, const Vec<D>& d) {
  const auto* exact = dynamic_cast<const ExactRays<D>*>(&core);
  const Real size = core.half().norm() + r, length = d.norm();
  if (exact && r <= kRayRounding * size) return exact->ray(p, d);
  const auto gapAt = [&](const Vec<D>& at) {
    if (!exact) return pointCurvedGap<D>(core, at);
    const Vec<D> n = exact->outwards(at);
    return Gap<D>{n.dot(at - core.support(n)), -n};
  };
  // A far ray starts again before the core's ball, where coordinates have the core's own rounding.
  const Real skipped = std::max(Real(0), -p.dot(d) / (length * length) - 2 * size / length);
  const Vec<D> start = p + skipped * d;
  Real t = 0;
  for (int step = 0; step < kMostRaySteps; ++step) {
    const Vec<D> at = start + t * d;
    Gap<D> gap = gapAt(at);
    const Real ahead = gap.gap - r, speed = gap.n.dot(d);
    if (ahead <= kRayRounding * (at.norm() + size)) {
      // On the surface of a core without rounding a gap has no direction: it is that from a little before.
      if (!exact && !(r > 0)) gap = gapAt(at - kBeforeSurface * size / length * d);
      Vec<D> n = -gap.n;
      if (!exact) settleNormal(core, r, at, n);
      return {skipped + t, n};
    }
    if (!(speed > 0)) return {kInf};
    t += ahead / speed;
  }
  return {kInf};  // grazing: closer and closer along the surface
}

// Calls f(axis) for every separating axis of a box or hull and an axis-aligned box. Cross products with the box's axes
// only swap components, so that a small one is as exact as a large one: none has to be skipped.
template <class F>
void forEachAxis(const ShapeView<2>& shape, const Rot<2>& q, F&& f) {
  for (int k = 0; k < 2; ++k) f(Vec<2>(Vec<2>::Unit(k)));
  forEachEdge(shape, [&](const Vec<2>& a, const Vec<2>& b) { f(Vec<2>(q * Vec<2>(tangents(Vec<2>(b - a))))); });
}
template <class F>
void forEachAxis(const ShapeView<3>& shape, const Rot<3>& q, F&& f) {
  for (int k = 0; k < 3; ++k) f(Vec<3>(Vec<3>::Unit(k)));
  if (shape.hull) {
    for (const auto& face : shape.hull->faces) f(q * face.normal);
  } else {
    for (int k = 0; k < 3; ++k) f(q * Vec<3>(Vec<3>::Unit(k)));
  }
  forEachEdge(shape, [&](const Vec<3>& a, const Vec<3>& b) {
    const Vec<3> u = q * Vec<3>(b - a);
    for (int k = 0; k < 3; ++k) f(cross(Vec<3>(Vec<3>::Unit(k)), u));
  });
}

}  // namespace

template <int D>
bool containsPoint(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p_W) {
  const Vec<D> p = X_WS.q.inverse() * Vec<D>(p_W - X_WS.p);
  return pointCoreSquared(shape, p) <= shape.radius * shape.radius;
}

template <int D>
bool overlapsBox(const ShapeView<D>& shape, const Pose<D>& X_WS, const Aabb<D>& box) {
  // Cut off what is far from the shape: this makes huge and unbounded boxes harmless.
  if (shape.core() == CoreClass::plane) {  // test the lowest corner of the box
    const Vec<D> up = X_WS.q * Vec<D>(Vec<D>::Unit(1));
    Real lowest = 0;
    for (int k = 0; k < D; ++k) lowest += up[k] == 0 ? Real(0) : up[k] * ((up[k] > 0 ? box.lo : box.hi)[k] - X_WS.p[k]);
    return lowest <= shape.radius;
  }
  const Aabb<D> bounds = boundingBox(shape, X_WS);
  if (!bounds.overlaps(box)) return false;
  const Aabb<D> near = bounds.grown((bounds.hi - bounds.lo).maxCoeff() + shape.radius);
  const Vec<D> lo = box.lo.cwiseMax(near.lo), hi = box.hi.cwiseMin(near.hi);
  const Vec<D> center = lo + Real(0.5) * (hi - lo), half = Real(0.5) * (hi - lo);
  const Vec<D> offset = X_WS.p - center;

  const auto edgesNear = [&] {
    Real best = kInf;
    forEachEdge(shape, [&](const Vec<D>& a, const Vec<D>& b) {
      best = std::min(best, segmentBoxSquared<D>(offset + X_WS.q * a, offset + X_WS.q * b, half));
    });
    return best <= shape.radius * shape.radius;
  };
  switch (shape.core()) {
    case CoreClass::point:
      return edgesNear();
    case CoreClass::segment: {
      if (shape.radius > 0) return edgesNear();
      const Vec<D> u = X_WS.q * shape.half;
      return castRay(Aabb<D>{-half, half}, Vec<D>(offset - u), Vec<D>(2 * u), Real(1)) >= 0;
    }
    case CoreClass::curved: {
      const auto difference = [&](const Vec<D>& d) {
        const Vec<D> p = offset + X_WS.q * shape.curved->support(X_WS.q.inverse() * d);
        return Vec<D>(p + (d.array() < 0).select(-half, half));
      };
      return gapToOrigin<D>(difference, offset).gap <= shape.radius;
    }
    case CoreClass::box:
    case CoreClass::hull:
    case CoreClass::plane:
      break;
  }

  bool separated = false, far = false;
  forEachAxis(shape, X_WS.q, [&](const Vec<D>& axis) {
    const Vec<D> local = X_WS.q.inverse() * axis;
    const Real reach = half.dot(axis.cwiseAbs()), middle = offset.dot(axis);
    const Real above = middle - coreSupport<D>(shape, -local).dot(-local) - reach;
    const Real below = -middle - coreSupport<D>(shape, local).dot(local) - reach;
    const Real gap = std::max(above, below);
    separated = separated || gap > 0;
    far = far || gap > shape.radius * axis.norm();
  });
  if (!separated) return true;
  if (far || shape.radius == 0) return false;
  if (edgesNear()) return true;
  for (int bits = 0; bits < 1 << D; ++bits) {
    if (containsPoint(shape, X_WS, Vec<D>(center + corner<D>(half, bits)))) return true;
  }
  return false;
}

template <int D>
RayEntry<D> rayEntry(const ShapeView<D>& shape, const Pose<D>& X_WS, const Vec<D>& p_W, const Vec<D>& direction,
                     Real maxT) {
  const Vec<D> p = X_WS.q.inverse() * Vec<D>(p_W - X_WS.p);
  const Vec<D> d = X_WS.q.inverse() * direction;
  if (pointCoreSquared(shape, p) <= shape.radius * shape.radius) return {0};
  if (!(d.squaredNorm() > 0)) return {};
  const bool sharp = !(shape.radius > 0);
  RayEntry<D> entry{kInf};
  // Flat parts of a surface share borders, and each is rounded around its own middle. No ray may pass between two
  // parts: after a miss, test again with wider parts.
  const Real wider = kTurnedBox * (p.cwiseAbs().maxCoeff() + X_WS.p.cwiseAbs().maxCoeff() + shape.half.maxCoeff());
  const auto missed = [&] { return !(entry.t >= 0 && entry.t < kInf); };
  switch (shape.core()) {
    case CoreClass::point:
    case CoreClass::segment:  // a flat box when it has no rounding
      if (sharp) entry = sharpBoxRay<D>(shape.half, p, d, maxT);
      if (shape.kind == ShapeKind::segment && missed()) {
        entry = sharpBoxRay<D>(Vec<D>(shape.half + wider * Vec<D>::Unit(0)), p, d, maxT);
      }
      break;
    case CoreClass::box:
      entry = sharp ? sharpBoxRay<D>(shape.half, p, d, maxT) : boxFaceRay<D>(shape.half, shape.radius, p, d);
      break;
    case CoreClass::hull:
      entry = sharp ? planesRay<D>(*shape.hull, p, d, 0) : faceRay(*shape.hull, shape.radius, p, d);
      if (shape.kind == ShapeKind::triangle && sharp && missed()) entry = planesRay<D>(*shape.hull, p, d, wider);
      break;
    case CoreClass::curved:
      entry = curvedRay<D>(*shape.curved, shape.radius, p, d);
      break;
    case CoreClass::plane:
      if (d[1] < 0) entry = {(p[1] - shape.radius) / -d[1], Vec<D>(Vec<D>::Unit(1))};
      break;
  }
  if (!sharp) {
    forEachEdge(shape,
                [&](const Vec<D>& a, const Vec<D>& b) { takeNearer(entry, capsuleRay<D>(a, b, shape.radius, p, d)); });
  }
  if (!(entry.t >= 0 && entry.t <= maxT && entry.t < kInf)) return {};  // a miss is infinite; maxT may be too
  return {entry.t, X_WS.q * entry.normal};
}

template bool containsPoint(const ShapeView<2>&, const Pose<2>&, const Vec<2>&);
template bool containsPoint(const ShapeView<3>&, const Pose<3>&, const Vec<3>&);
template bool overlapsBox(const ShapeView<2>&, const Pose<2>&, const Aabb<2>&);
template bool overlapsBox(const ShapeView<3>&, const Pose<3>&, const Aabb<3>&);
template RayEntry<2> rayEntry(const ShapeView<2>&, const Pose<2>&, const Vec<2>&, const Vec<2>&, Real);
template RayEntry<3> rayEntry(const ShapeView<3>&, const Pose<3>&, const Vec<3>&, const Vec<3>&, Real);

}}  // namespace lpc::LPC_PRECISION
