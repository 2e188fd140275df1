// SPDX-License-Identifier: Zlib
// Properties of contact manifolds, one function each. Each function draws its own cases.
#pragma once

#include <set>

#include "tests/assertion.h"
#include "tests/contact_scene.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// A drawn pair with a margin. In half of the cases the shapes' frames differ from their bodies' frames.
template <int D>
ContactScene<D> drawScene(Draw& draw) {
  const auto drawn = [&] {
    for (;;) {
      try {
        return drawShapePair<D>(draw);
      } catch (const UserError&) {  // points too flat for a hull: draw again
      }
    }
  };
  const ShapePairCase<D> c = drawn();
  const Real size = std::min(sizeOf(c.a), sizeOf(c.b));
  const Real margin = draw.pick({kContactMargin, Real(0), Real(0.1) * size});
  if (draw.coin()) return ContactScene<D>(c, margin);
  return ContactScene<D>(c.a, c.b, c.X_WA, c.X_WB, margin, drawPose<D>(draw, size), drawPose<D>(draw, size));
}

template <int D>
ContactScene<D> anyScene() {
  const auto scene = *Gen(drawScene<D>);
  return scene;
}

template <int D>
std::ostream& operator<<(std::ostream& out, const ContactScene<D>& s) {
  out << "\nmargin = " << s.margin << '\n';
  for (std::size_t i : {0u, 1u}) {
    showBody(out, i ? "B" : "A", s.shapes[i].shape, s.shapePose(i));
    out << "# the shape in the frame of its body's centre of mass: position = " << listText<D>(s.shapes[i].X_CS.p)
        << ", angle = " << s.shapes[i].X_CS.q << '\n';
  }
  return out;
}

template <int D>
std::ostream& operator<<(std::ostream& out, const Manifold<D>& m) {
  out.precision(17);
  out << "normal (" << m.normal.transpose() << ')';
  for (int i = 0; i < m.count; ++i) {
    const auto& p = m.points[static_cast<std::size_t>(i)];
    out << "\n  feature " << std::hex << p.feature << std::dec << " separation " << p.separation << " A ("
        << p.localA.transpose() << ") B (" << p.localB.transpose() << ')';
  }
  return out << '\n';
}

/// At most one manifold, with 1 to kManifoldPoints points sorted by unique features. The normal has unit length. Each
/// separation equals that of the closest points and stays within the margin; impulses are zero.
template <int D>
void isWellFormed(const ContactScene<D>& scene, const std::vector<Manifold<D>>& fresh) {
  RC_ASSERT(fresh.size() <= 1u);
  if (fresh.empty()) return;
  const Manifold<D>& m = fresh[0];
  RC_LOG() << m;
  RC_ASSERT(m.key() == std::tuple(0, 0, 1, 1, 0, 0));
  RC_ASSERT(m.count >= 1 && m.count <= kManifoldPoints<D>);
  RC_ASSERT(std::abs(m.normal.norm() - 1) <= kUnitTolerance);
  for (int i = 0; i < m.count; ++i) {
    const ContactPoint<D>& p = m.points[static_cast<std::size_t>(i)];
    if (i > 0) RC_ASSERT(m.points[static_cast<std::size_t>(i - 1)].feature < p.feature);
    RC_ASSERT(std::abs(separationNow(m, p, scene.pose[0], scene.pose[1]) - p.separation) <= scene.rounding());
    RC_ASSERT(p.separation <= scene.margin + scene.rounding());
    for (Real impulse : p.impulse) RC_ASSERT(impulse == 0);
  }
}
template <int D>
void wellFormed(ContactGenerator<D>& generator) {
  const ContactScene<D> scene = anyScene<D>();
  isWellFormed(scene, scene.run(generator));
}

/// Each closest point lies on its shape: never outside, and on the surface. With rounding it may lie inside.
template <int D>
void areOnShapes(const ContactScene<D>& scene, const std::vector<Manifold<D>>& fresh) {
  for (const Manifold<D>& m : fresh) {
    RC_LOG() << m;
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& p = m.points[static_cast<std::size_t>(i)];
      for (std::size_t side : {0u, 1u}) {
        const Vec<D> p_W = scene.pose[side] * (side == 0 ? p.localA : p.localB);
        const Real d = pointDistance(scene, side, p_W);
        RC_ASSERT(d <= scene.tolerance());
        if (scene.view(side).radius == 0) RC_ASSERT(d >= -scene.tolerance());
      }
    }
  }
}
template <int D>
void witnessesOnShapes(ContactGenerator<D>& generator) {
  const ContactScene<D> scene = anyScene<D>();
  areOnShapes(scene, scene.run(generator));
}

/// A manifold exists if and only if the shapes are within the margin. The normal is a direction of least depth, and the
/// deepest point is as deep as the shapes penetrate.
template <int D>
void areTrulyDeep(const ContactScene<D>& scene, const std::vector<Manifold<D>>& fresh) {
  const Real truth = scene.trueDistance(), tolerance = 2 * scene.tolerance();
  RC_LOG() << "true distance " << truth << " tolerance " << tolerance << '\n';
  if (truth > scene.margin + tolerance) RC_ASSERT(fresh.empty());
  if (truth < scene.margin - tolerance) RC_ASSERT(fresh.size() == 1u);
  if (fresh.empty()) return;
  const Manifold<D>& m = fresh[0];
  RC_LOG() << m;
  RC_ASSERT(worldSeparation<D>(scene, m.normal) >= truth - tolerance);
  RC_ASSERT(deepest(m) >= truth - tolerance);
  RC_ASSERT(deepest(m) <= truth + tolerance);
}
template <int D>
void depthIsTrue(ContactGenerator<D>& generator) {
  const ContactScene<D> scene = anyScene<D>();
  areTrulyDeep(scene, scene.run(generator));
}

/// Swapping the bodies keeps the depth. For shapes of different kinds it also keeps the points.
template <int D>
void swapMirrors(ContactGenerator<D>& generator) {
  const ContactScene<D> scene = anyScene<D>();
  const auto one = scene.run(generator), other = scene.swapped().run(generator);
  const Real tolerance = 2 * scene.tolerance();
  if (one.empty() || other.empty()) {  // at the margin, one order may give a contact and the other none
    if (!one.empty()) RC_ASSERT(deepest(one[0]) >= scene.margin - tolerance);
    if (!other.empty()) RC_ASSERT(deepest(other[0]) >= scene.margin - tolerance);
    return;
  }
  const Manifold<D>&m = one[0], &w = other[0];
  RC_LOG() << m << w;
  RC_ASSERT(std::abs(deepest(m) - deepest(w)) <= tolerance);
  // Opposite normals, except in ties: each must be as good for the other order.
  RC_ASSERT(worldSeparation<D>(scene, -w.normal) >= worldSeparation<D>(scene, m.normal) - tolerance);
  RC_ASSERT(worldSeparation<D>(scene.swapped(), -m.normal) >=
            worldSeparation<D>(scene.swapped(), w.normal) - tolerance);
  if (scene.view(0).kind == scene.view(1).kind) return;
  RC_ASSERT(m.count == w.count);
  RC_ASSERT((m.normal + w.normal).norm() <= 1000 * kEps);
  for (int i = 0; i < m.count; ++i) {
    const auto& p = m.points[static_cast<std::size_t>(i)];
    bool found = false;
    for (int k = 0; k < w.count; ++k) {
      const auto& q = w.points[static_cast<std::size_t>(k)];
      found = found || ((p.localA - q.localB).norm() + (p.localB - q.localA).norm() <= scene.rounding());
    }
    RC_ASSERT(found);
  }
}

/// Two boxes, rotated at random, that nearly touch or penetrate slightly: no two features tie.
template <int D>
ContactScene<D> drawBoxes(Draw& draw) {
  const auto box = [&] { return Shape<D>::box(drawHalf<D>(draw), draw.below(4) == 3 ? Real(0.1) : Real(0)); };
  const Shape<D> a = box(), b = box();
  const Vec<D> n = drawDirection<D>(draw);
  Pose<D> X_AB;
  X_AB.q = drawRotation<D>(draw);
  X_AB.p = (supportValue(a.view(), n) + supportValue(b.view(), Vec<D>(X_AB.q.inverse() * Vec<D>(-n)))) * n;
  X_AB.p += (draw.real(0, 0.1) - Real(0.08)) * n + Real(0.1) * drawVector<D>(draw);
  const Pose<D> X_WA = drawPose<D>(draw, 3);
  return {a, b, X_WA, X_WA * X_AB, kContactMargin};
}

/// The rotations that map axes onto axes: 24 in 3D, 4 in 2D.
template <int D>
std::vector<Rot<D>> axisTurns() {
  const double quarter = 1.5707963267948966;
  std::vector<Rot<D>> out;
  for (int k = 0; k < 4; ++k) {
    if constexpr (D == 2) {
      out.push_back(Rot<2>::angle(k * quarter));
    } else {  // k quarter turns about x, then x into each of the six directions
      const Rot<3> about = Rot<3>::vector({static_cast<Real>(k * quarter), 0, 0});
      for (int turns = 0; turns < 4; ++turns) {
        out.push_back(Rot<3>::vector({0, 0, static_cast<Real>(turns * quarter)}) * about);
      }
      for (const int side : {-1, 1}) out.push_back(Rot<3>::vector({0, static_cast<Real>(side * quarter), 0}) * about);
    }
  }
  return out;
}

/// Permuting or reversing a box's axes leaves the same box. It gives the same normal and the same points, up to the
/// tolerance within which a generator may merge points.
template <int D>
void relabelledBoxes(ContactGenerator<D>& generator) {
  const auto scene = *Gen(drawBoxes<D>);
  const auto turns = axisTurns<D>();
  const Rot<D> turn = turns[drawIndex(turns.size())];
  const std::size_t side = drawIndex(2);
  ContactScene<D> other = scene;
  const ShapeView<D>& box = scene.view(side);
  other.shapes[side].shape = Shape<D>::box((turn.inverse().matrix() * box.half).cwiseAbs(), box.radius);
  other.shapes[side].X_CS.q = scene.shapes[side].X_CS.q * turn;
  const auto one = scene.run(generator), same = other.run(generator);
  const Real tolerance = 2 * scene.tolerance();
  if (one.empty() || same.empty()) {  // at the margin, one may give none
    if (!one.empty()) RC_ASSERT(deepest(one[0]) >= scene.margin - tolerance);
    if (!same.empty()) RC_ASSERT(deepest(same[0]) >= scene.margin - tolerance);
    return;
  }
  const Manifold<D>&m = one[0], &w = same[0];
  RC_LOG() << scene << m << w;
  RC_ASSERT(worldSeparation<D>(scene, w.normal) >= worldSeparation<D>(scene, m.normal) - tolerance);
  if ((m.normal - w.normal).norm() > 1000 * kEps) return;  // another axis, equally good within the tolerance
  const auto covers = [&](const Manifold<D>& all, const ContactPoint<D>& p) {
    const auto near = [&](const auto& q) {
      return (p.localA - q.localA).norm() <= tolerance && (p.localB - q.localB).norm() <= tolerance;
    };
    return std::any_of(all.points.begin(), all.points.begin() + all.count, near);
  };
  for (int i = 0; i < m.count; ++i) RC_ASSERT(covers(w, m.points[static_cast<std::size_t>(i)]));
  for (int i = 0; i < w.count; ++i) RC_ASSERT(covers(m, w.points[static_cast<std::size_t>(i)]));
}

/// B rests face on face on A. Both are boxes, hulls or rounded shapes, shifted and rotated about the normal. In half of
/// the cases equal shapes coincide in the plane, so rounding decides which corner is inside the other face.
template <int D>
struct FaceContact {
  ContactScene<D> scene;
  Pose<D> X_A;                // its z axis (3D) or y axis (2D) is the normal
  std::vector<Vec<2>> patch;  // 3D: corners of the common area, x and y in X_A; 2D: its ends, x
  bool flush = false;         // equal shapes, corner on corner
};

inline bool insideConvex(const std::vector<Vec<2>>& polygon, const Vec<2>& p) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec<2> e = polygon[(i + 1) % polygon.size()] - polygon[i], d = p - polygon[i];
    if (e[0] * d[1] - e[1] * d[0] < 0) return false;
  }
  return true;
}

/// Corners of the intersection of two convex polygons, unordered.
inline std::vector<Vec<2>> commonCorners(const std::vector<Vec<2>>& a, const std::vector<Vec<2>>& b) {
  std::vector<Vec<2>> out;
  for (const Vec<2>& p : a) {
    if (insideConvex(b, p)) out.push_back(p);
  }
  for (const Vec<2>& p : b) {
    if (insideConvex(a, p)) out.push_back(p);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      const Vec<2> p = a[i], u = a[(i + 1) % a.size()] - p, q = b[k], w = b[(k + 1) % b.size()] - q;
      const Real det = u[0] * w[1] - u[1] * w[0];
      if (det == 0) continue;
      const Real s = ((q - p)[0] * w[1] - (q - p)[1] * w[0]) / det, t = ((q - p)[0] * u[1] - (q - p)[1] * u[0]) / det;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1) out.push_back(p + s * u);
    }
  }
  return out;
}

/// A regular polygon with 4 to 8 corners; one with 4 may become a box.
inline std::vector<Vec<2>> drawBase(Draw& draw, Real turn) {
  const int n = 4 + draw.below(5);
  const Real x = draw.real(0.3, 1), y = draw.real(0.3, 1);
  std::vector<Vec<2>> base;
  for (int i = 0; i < n; ++i) {
    const Real angle = turn + Real(6.283185307179586) * (Real(i) + Real(0.5)) / Real(n);
    base.emplace_back(x * std::cos(angle), y * std::sin(angle));
  }
  return base;
}

template <int D>
FaceContact<D> drawFaceContact(Draw& draw);

template <>
inline FaceContact<2> drawFaceContact<2>(Draw& draw) {
  const Real x1 = draw.real(0.3, 1), h1 = draw.real(0.1, 1);
  const bool same = draw.coin();
  const Real x2 = same ? x1 : draw.real(0.3, 1), h2 = same ? h1 : draw.real(0.1, 1);
  const Real r1 = draw.below(4) == 3 ? Real(0.1) : Real(0), r2 = draw.below(4) == 3 ? Real(0.1) : Real(0);
  const auto make = [&](Real x, Real h, Real r) {
    const std::array<Vec<2>, 5> points = {Vec<2>(-x, -h), {x, -h}, {x, h}, {-x, h}, {x + h / 3, 0}};
    switch (draw.below(3)) {
      case 0:
        return Shape<2>::box({x, h}, r);
      case 1:
        return Shape<2>::polytope(std::span(points.data(), 4), r);
      default:
        return Shape<2>::polytope(points, r);
    }
  };
  const Shape<2> a = make(x1, h1, r1), b = make(x2, h2, r2);
  Pose<2> X_AB;
  X_AB.p[0] = same ? Real(0) : Real(0.7) * (x1 + x2) * draw.signedUnit();
  X_AB.p[1] = h1 + h2 + r1 + r2 + kLinearSlop * draw.signedUnit();
  X_AB.q = Rot<2>::angle(draw.pick({0.0, 1e-9, 1e-4}));
  const Pose<2> X_WA = draw.coin() ? drawPose<2>(draw, 3) : Pose<2>{};
  const Real lo = std::max(-x1, X_AB.p[0] - x2), hi = std::min(x1, X_AB.p[0] + x2);
  return {ContactScene<2>(a, b, X_WA, X_WA * X_AB, kContactMargin), X_WA, {{lo, 0}, {hi, 0}}, same};
}

template <>
inline FaceContact<3> drawFaceContact<3>(Draw& draw) {
  const Real turn1 = Real(0.7) * draw.signedUnit();
  std::vector<Vec<2>> base1 = drawBase(draw, turn1), base2 = base1;
  const bool same = draw.coin();
  const Real h1 = draw.real(0.1, 1), h2 = draw.real(0.1, 1);
  if (!same) base2 = drawBase(draw, 0);
  const Real r1 = draw.below(4) == 3 ? Real(0.1) : Real(0), r2 = draw.below(4) == 3 ? Real(0.1) : Real(0);
  const auto make = [&](std::vector<Vec<2>>& base, Real h, Real r) {
    if (draw.below(2) == 0) {  // a box of this breadth
      const Real x = std::abs(base[0][0]) + Real(0.1), y = std::abs(base[0][1]) + Real(0.1);
      base = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
      return Shape<3>::box({x, y, h}, r);
    }
    std::vector<Vec<3>> points;
    for (const Vec<2>& p : base) points.push_back({p[0], p[1], -h}), points.push_back({p[0], p[1], h});
    return Shape<3>::polytope(points, r);
  };
  const Shape<3> a = make(base1, h1, r1);
  Shape<3> b = a;
  if (same) {
    base2 = base1;
  } else {
    b = make(base2, h2, r2);
  }
  Pose<3> X_AB;
  X_AB.p[2] = h1 + (same ? h1 : h2) + a.view().radius + b.view().radius + kLinearSlop * draw.signedUnit();
  if (!same) {
    X_AB.p[0] = Real(0.5) * draw.signedUnit(), X_AB.p[1] = Real(0.5) * draw.signedUnit();
    X_AB.q = Rot<3>::vector({0, 0, draw.signedUnit()});
  }
  for (Vec<2>& p : base2) p = (X_AB * Vec<3>(p[0], p[1], 0)).template head<2>();
  const double tilt = draw.pick({0.0, 1e-9, 1e-4});
  X_AB.q = Rot<3>::vector({static_cast<Real>(tilt), 0, 0}) * X_AB.q;
  const Pose<3> X_WA = draw.coin() ? drawPose<3>(draw, 3) : Pose<3>{};
  return {ContactScene<3>(a, b, X_WA, X_WA * X_AB, kContactMargin), X_WA, commonCorners(base1, base2), same};
}

/// Breadth of the patch in the direction with this angle (m).
inline Real breadth(const std::vector<Vec<2>>& points, Real angle) {
  Real lo = std::numeric_limits<Real>::infinity(), hi = -lo;
  for (const Vec<2>& p : points) {
    const Real t = std::cos(angle) * p[0] + std::sin(angle) * p[1];
    lo = std::min(lo, t), hi = std::max(hi, t);
  }
  return hi - lo;
}

/// Area (m^2) of the hull of points in convex position, in any order.
inline Real areaOfHull(std::vector<Vec<2>> points) {
  Vec<2> middle = Vec<2>::Zero();
  for (const Vec<2>& p : points) middle += p / Real(points.size());
  std::sort(points.begin(), points.end(), [&](const Vec<2>& p, const Vec<2>& q) {
    return std::atan2(p[1] - middle[1], p[0] - middle[0]) < std::atan2(q[1] - middle[1], q[0] - middle[0]);
  });
  Real twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec<2>&p = points[i], &q = points[(i + 1) % points.size()];
    twice += p[0] * q[1] - p[1] * q[0];
  }
  return twice / 2;
}

template <int D>
inline constexpr int kBreadths = D == 2 ? 1 : 8;

/// The common area is so small that nothing is required.
template <int D>
bool isSliver(const FaceContact<D>& c) {
  Real narrowest = c.patch.empty() ? Real(0) : std::numeric_limits<Real>::infinity();
  for (int k = 0; k < kBreadths<D> && !c.patch.empty(); ++k) {
    narrowest = std::min(narrowest, breadth(c.patch, Real(k) * Real(3.14159) / kBreadths<D>));
  }
  return !(narrowest > Real(0.05));
}

template <int D>
std::ostream& operator<<(std::ostream& out, const FaceContact<D>& c) {
  return out << c.scene;
}

/// At least two points in 2D, three in 3D, which span the given share of the common length or area.
template <int D>
void spanPatch(const FaceContact<D>& c, const std::vector<Manifold<D>>& fresh, Real share) {
  RC_ASSERT(fresh.size() == 1u);
  const Manifold<D>& m = fresh[0];
  RC_LOG() << m;
  RC_ASSERT(m.count >= (D == 2 ? 2 : 3));
  std::vector<Vec<2>> points;
  for (int i = 0; i < m.count; ++i) {
    const Vec<D> p_W = c.scene.pose[0] * m.points[static_cast<std::size_t>(i)].localA;
    const Vec<D> p = c.X_A.inverse() * p_W;
    points.push_back({p[0], D == 2 ? Real(0) : p[1]});
  }
  if (D == 2) RC_ASSERT(breadth(points, 0) >= share * breadth(c.patch, 0));
  if (D == 3) RC_ASSERT(areaOfHull(points) >= share * areaOfHull(c.patch));
}
/// Face on face: the points span the common length, or half of the common area. Two points as far apart as possible and
/// the farthest points on both sides span at least half of any convex area.
template <int D>
void facesSpanPatch(ContactGenerator<D>& generator) {
  const auto c = *Gen(drawFaceContact<D>);
  if (!isSliver(c)) spanPatch<D>(c, c.scene.run(generator), D == 2 ? Real(0.98) : Real(0.48));
}

/// A motion of 1 um (f32: 10 um) keeps the features of a face contact, unless a corner just crosses a threshold. Such
/// places are rare: at 32 places along a centimetre, each with and without the motion, the features change at most
/// twelve times. Where equal shapes coincide, the motion changes none.
template <int D>
void featuresAreSteady(ContactGenerator<D>& generator) {
  const auto c = *Gen(drawFaceContact<D>);
  const auto motion = *Gen([](Draw& draw) {
    return std::pair(drawVector<D>(draw), turn(Ang<D>(Ang<D>::Constant(Real(1e-7) * draw.signedUnit()))));
  });
  if (isSliver(c)) return;
  constexpr Real kStep = sizeof(Real) == 8 ? Real(1e-6) : Real(1e-5), kBeside = Real(0.01);
  constexpr int kPlaces = 32, kMostChanges = 12;
  const auto featuresOf = [&](const ContactScene<D>& scene) {
    const auto fresh = scene.run(generator);
    RC_ASSERT(fresh.size() == 1u);
    std::vector<std::uint64_t> out;
    for (int i = 0; i < fresh[0].count; ++i) out.push_back(fresh[0].points[static_cast<std::size_t>(i)].feature);
    return out;
  };
  const auto moved = [&](ContactScene<D> scene) {
    scene.pose[1].p += kStep * motion.first;
    scene.pose[1].q = motion.second * scene.pose[1].q;
    return scene;
  };
  const auto start = featuresOf(c.scene), after = featuresOf(moved(c.scene));
  if (c.flush) RC_ASSERT(start == after);
  Vec<D> way = Vec<D>::Zero();  // parallel to the faces, but to none of their edges
  way[0] = Real(0.8);
  if constexpr (D == 3) way[1] = Real(0.6);
  int changes = 0;
  std::vector<std::uint64_t> last;
  for (int i = 0; i < kPlaces; ++i) {
    ContactScene<D> beside = c.scene;
    beside.pose[1].p += kBeside * (1 + Real(i) / kPlaces) * (c.X_A.q * way);
    for (const auto& scene : {beside, moved(beside)}) {
      const auto here = featuresOf(scene);
      changes += !last.empty() && here != last;
      last = here;
    }
  }
  RC_LOG() << changes << " changes\n";
  RC_ASSERT(changes <= kMostChanges);
}

/// Two box edges, parallel and apart: two points span their common length.
inline void parallelEdges(ContactGenerator<3>& generator) {
  const auto scene = *Gen([](Draw& draw) {
    const auto half = [&] { return Vec<3>(draw.real(0.3, 1), Real(0.3), Real(0.3)); };
    const Shape<3> a = Shape<3>::box(half(), draw.coin() ? Real(0.1) : Real(0)), b = Shape<3>::box(half());
    const Pose<3> tilted{{0, 0, 0}, Rot<3>::vector({Real(0.78539816339744831), 0, 0})};
    const Real reach = 2 * Real(0.3) * std::sqrt(Real(2)) + a.view().radius;
    const Pose<3> shift{{Real(0.2) * draw.signedUnit(), reach + draw.real(0.002, 0.015), 0}, {}};
    return ContactScene<3>(a, b, tilted, shift * tilted, kContactMargin);
  });
  const auto fresh = scene.run(generator);
  RC_ASSERT(fresh.size() == 1u);
  const Manifold<3>& m = fresh[0];
  RC_LOG() << m;
  const Real x = scene.pose[1].p[0], a = scene.view(0).half[0], b = scene.view(1).half[0];
  const Real common = std::min(a, x + b) - std::max(-a, x - b);
  Real lo = 1, hi = -1;
  for (int i = 0; i < m.count; ++i) {
    const auto& p = m.points[static_cast<std::size_t>(i)];
    lo = std::min(lo, p.localA[0]), hi = std::max(hi, p.localA[0]);
  }
  RC_ASSERT(m.count >= 2);
  RC_ASSERT(hi - lo >= Real(0.98) * common);
}

/// A body that entered a plank from above is pushed back up, even when it is more than half through.
template <int D>
void deepBodiesGoBack(ContactGenerator<D>& generator) {
  const Real deep = *Gen([](Draw& draw) { return draw.real(-0.02, 0.02); });
  Vec<D> plank = Vec<D>::Constant(2);
  plank[1] = Real(0.05);
  Pose<D> X_WB;
  X_WB.p[1] = -deep;
  const ContactScene<D> scene(Shape<D>::box(plank), Shape<D>::box(Vec<D>::Constant(Real(0.5))), {}, X_WB, 0);
  const auto fresh = scene.run(generator);
  RC_ASSERT(fresh.size() == 1u);
  RC_ASSERT(fresh[0].normal[1] > 0);
}

}}}  // namespace lpc::LPC_PRECISION::test
