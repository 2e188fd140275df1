// SPDX-License-Identifier: Zlib
// Pairs of shapes from the kinds of input behind reported collision bugs, and random pairs. Uniform random poses find
// almost none of these bugs. Ten cases of sixteen come from such a family.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "framework/math/check.h"
#include "framework/shape/support_map.h"
#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D>
struct ShapePairCase {
  Shape<D> a = Shape<D>::sphere(1), b = Shape<D>::sphere(1);
  Pose<D> X_WA, X_WB;
  std::string family;
  /// The true signed distance (m) if it is known by construction, up to a few roundings of sizes and positions.
  std::optional<Real> distance;

  Pose<D> X_AB() const { return X_WA.inverse() * X_WB; }
};

template <int D>
std::ostream& operator<<(std::ostream& out, const ShapePairCase<D>& c) {
  out << "\n# of the family " << c.family;
  if (c.distance) out << ", truly " << *c.distance << " m apart";
  out << '\n';
  showBody(out, "A", c.a, c.X_WA);
  showBody(out, "B", c.b, c.X_WB);
  return out;
}

/// In the order of Layouts::draw; "random" is the simplest.
inline constexpr std::array<std::string_view, 11> kFamilies = {
    "random",  "kissing_faces",   "near_parallel", "shared_planes",  "ties",           "size_ratio",
    "slivers", "far_from_origin", "core_contact",  "curved_on_edge", "below_tolerance"};

/// Two shapes at scale 1 and the pose of B in A's frame.
template <int D>
struct Layout {
  Sketch<D> a, b;
  Pose<D> X_AB;
  std::optional<Real> distance;
};

template <int D>
class Layouts {
 public:
  explicit Layouts(Draw& draw) : m_draw(draw) {}

  Layout<D> draw(int family) {
    switch (family) {
      case 1:
        return kissingFaces();
      case 2:
        return nearParallel();
      case 3:
        return sharedPlanes();
      case 4:
        return ties();
      case 5:
        return sizeRatio();
      case 6:
        return slivers();
      case 8:
        return coreContact();
      case 9:
        return curvedOnEdge();
      case 10:
        return belowTolerance();
      default:
        return random();  // far_from_origin is a random pair that is moved away later
    }
  }

 private:
  Sketch<D> any() { return drawSketch<D>(m_draw, drawKind<D>(m_draw)); }
  Sketch<D> flat() { return drawSketch<D>(m_draw, m_draw.pick({ShapeKind::box, ShapeKind::polytope})); }
  Sketch<D> cube(Real half) {
    Sketch<D> s;
    s.kind = ShapeKind::box, s.half = Vec<D>::Constant(half);
    return s;
  }
  /// A direction in which several features tie, or a random one.
  Vec<D> telling() {
    const int k = m_draw.below(4);
    if (k == 0) return Vec<D>::Unit(m_draw.below(D));
    if (k == 1) return Vec<D>(Vec<D>::Ones() / Vec<D>::Ones().norm());
    return drawDirection<D>(m_draw);
  }
  Aabb<D> bounds(const Sketch<D>& s) { return boundingBox(s.build(1).view(), Pose<D>{}); }

  // Places B so that its lowest point along n lies `gap` above A's highest point. For gap >= 0, `gap` is the distance.
  void touchAt(Layout<D>& c, const Vec<D>& n, Real gap) {
    const Shape<D> a = c.a.build(1), b = c.b.build(1);
    const Vec<D> down = c.X_AB.q.inverse() * Vec<D>(-n);
    const Vec<D> top = coreSupport(a.view(), n) + a.view().radius * n;
    const Vec<D> bottom = c.X_AB.q * coreSupport(b.view(), down) - b.view().radius * n;
    c.X_AB.p = top - bottom + gap * n;
    c.distance.reset();
    if (gap >= 0) c.distance = gap;
  }

  Layout<D> random() {
    Layout<D> c{any(), any(), {}, {}};
    const Real reach = sizeOf(c.a.build(1)) + sizeOf(c.b.build(1));
    c.X_AB.q = drawRotation<D>(m_draw);
    c.X_AB.p = reach * m_draw.real(0, 1.3) * drawDirection<D>(m_draw);
    return c;
  }

  Layout<D> kissingFaces() {
    Layout<D> c{any(), any(), {}, {}};
    const int k = m_draw.below(D);
    const Real steps = Real(m_draw.pick({0, 1, -1, 2, -2, 3, -3, 4, -4}));
    if (m_draw.coin()) c.X_AB.p = Real(0.3) * drawVector<D>(m_draw);
    c.X_AB.p[k] = (bounds(c.a).hi[k] - bounds(c.b).lo[k]) * (1 + steps * kEps);
    return c;
  }

  Layout<D> nearParallel() {
    Layout<D> c{flat(), m_draw.below(4) == 3 ? any() : flat(), {}, {}};
    const double angle = m_draw.pick({0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3});
    Ang<D> v;
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = static_cast<Real>(angle * m_draw.pick({1, 0, -1}));
    c.X_AB.q = turn(v);
    const int k = m_draw.below(D);
    c.X_AB.p = Real(0.3) * drawVector<D>(m_draw);
    c.X_AB.p[k] = (bounds(c.a).hi[k] - bounds(c.b).lo[k]) * m_draw.real(0.7, 1.3);
    return c;
  }

  // Two prisms between the same two planes.
  Layout<D> sharedPlanes() {
    Layout<D> c;
    const Real h = drawHalf<D>(m_draw)[0];
    for (Sketch<D>* s : {&c.a, &c.b}) {
      *s = flat();
      s->radius = 0;
      s->half[D - 1] = h;
      const std::vector<Vec<D>> base = s->points;
      s->points.clear();
      for (Vec<D> p : base) {
        p[D - 1] = h;
        s->points.push_back(p);
        p[D - 1] = -h;
        s->points.push_back(p);
      }
    }
    c.X_AB.p[0] = (bounds(c.a).hi[0] - bounds(c.b).lo[0]) * m_draw.real(0, 1.5);
    return c;
  }

  Layout<D> ties() {
    Layout<D> c;
    const Real half = drawHalf<D>(m_draw)[0];
    switch (m_draw.below(3)) {
      case 0:  // the same shape in the same place, or moved by its own size
        c.a = c.b = any();
        if (m_draw.coin()) c.X_AB.p[0] = bounds(c.a).hi[0] - bounds(c.a).lo[0];
        break;
      case 1:  // corner to corner
        c.a = cube(half), c.b = cube(drawHalf<D>(m_draw)[0]);
        c.X_AB.p = Vec<D>::Constant((half + c.b.half[0]) * m_draw.real(0, 2));
        break;
      default:  // crossing at 45 degrees
        c.a = c.b = cube(half);
        Ang<D> v = Ang<D>::Zero();
        v[0] = Real(0.78539816339744831);
        c.X_AB.q = turn(v);
        c.X_AB.p[m_draw.below(D)] = half * m_draw.real(0, 4);
        break;
    }
    return c;
  }

  Layout<D> sizeRatio() {
    Layout<D> c{cube(1), any(), {}, {}};
    c.a.half *= m_draw.pick({Real(1e2), Real(1e3), Real(1e4)}) / 3;
    if (m_draw.coin()) c.a.half[1] = drawHalf<D>(m_draw)[0];
    c.X_AB.q = drawRotation<D>(m_draw);
    const Real gap = m_draw.signedUnit() / 2;
    touchAt(c, Vec<D>::Unit(1), gap);
    const Vec<D> aside = drawVector<D>(m_draw);
    for (int k = 0; k < D; ++k) {
      if (k != 1) c.X_AB.p[k] = Real(0.9) * c.a.half[k] * aside[k];  // still above A: the distance is unchanged
    }
    return c;
  }

  Layout<D> slivers() {
    Layout<D> c{flat(), any(), {}, {}};
    const auto squeeze = [&](Sketch<D>& s) {
      const int k = m_draw.below(D);
      s.half[k] *= Real(1e-4);
      for (Vec<D>& p : s.points) p[k] *= Real(1e-4);
      s.radius = s.kind == ShapeKind::capsule ? s.radius * Real(1e-4) : Real(0);
    };
    squeeze(c.a);
    if (c.b.kind == ShapeKind::box || c.b.kind == ShapeKind::polytope) squeeze(c.b);
    c.X_AB.q = drawRotation<D>(m_draw);
    if (m_draw.coin()) {  // a point inside A coincides with one inside B
      const Vec<D> a = coreSupport(c.a.build(1).view(), drawDirection<D>(m_draw));
      const Vec<D> b = coreSupport(c.b.build(1).view(), drawDirection<D>(m_draw));
      c.X_AB.p = m_draw.real(0, 1) * a - c.X_AB.q * Vec<D>(m_draw.real(0, 1) * b);
    } else {
      touchAt(c, telling(), m_draw.signedUnit() * m_draw.pick({Real(0.1), Real(1e-4), Real(1e-5)}));
    }
    return c;
  }

  // B's origin on A's core: at a corner, on an edge or face, at the centre, or half-way.
  Layout<D> coreContact() {
    Layout<D> c{any(), any(), {}, {}};
    if (m_draw.coin()) c.X_AB.q = drawRotation<D>(m_draw);
    c.X_AB.p = m_draw.pick({Real(1), Real(0.5), Real(0)}) * coreSupport(c.a.build(1).view(), telling());
    if (m_draw.coin()) c.X_AB.p[m_draw.below(D)] = 0;
    return c;
  }

  Layout<D> curvedOnEdge() {
    Layout<D> c{any(), drawSketch<D>(m_draw, m_draw.pick({ShapeKind::sphere, ShapeKind::capsule})), {}, {}};
    c.X_AB.q = drawRotation<D>(m_draw);
    touchAt(c, telling(), m_draw.pick({Real(0), Real(1e-8), Real(-1e-8), Real(1e-4), Real(-1e-4)}));
    return c;
  }

  Layout<D> belowTolerance() {
    Layout<D> c{any(), any(), {}, {}};
    if (m_draw.coin()) c.X_AB.q = drawRotation<D>(m_draw);
    const Real size = m_draw.pick({Real(1e-6), Real(1e-7), Real(1e-8), Real(1e-9)});
    touchAt(c, telling(), m_draw.coin() ? -size : size);
    return c;
  }

  Draw& m_draw;
};

/// One case. Both shapes are scaled by 1, 1e-3 or 1e3 and moved together.
template <int D>
ShapePairCase<D> drawShapePairOnce(Draw& draw) {
  const int number = draw.below(16);
  const int family = number > 10 ? 0 : number;
  Layout<D> layout = Layouts<D>(draw).draw(family);
  if (draw.coin()) {
    std::swap(layout.a, layout.b);
    layout.X_AB = layout.X_AB.inverse();
  }
  const Real scale = drawScale(draw);
  ShapePairCase<D> c;
  c.family = kFamilies[static_cast<std::size_t>(family)];
  c.a = layout.a.build(scale), c.b = layout.b.build(scale);
  layout.X_AB.p *= scale;
  if (draw.coin()) c.X_WA = drawPose<D>(draw, 3 * scale);
  if (c.family == "far_from_origin") {
    const int digits = draw.below(sizeof(Real) == 8 ? 6 : 2);  // beyond 1e3 a float has no digits left for the shapes
    c.X_WA.p += scale * static_cast<Real>(std::pow(10, 2 + digits)) * drawDirection<D>(draw);
  }
  c.X_WB = c.X_WA * layout.X_AB;
  if (layout.distance && c.family != "far_from_origin") c.distance = scale * *layout.distance;
  return c;
}

/// In single precision, points squeezed flat may be rejected by the hull factory, as they must: draw again.
template <int D>
ShapePairCase<D> drawShapePair(Draw& draw) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    try {
      return drawShapePairOnce<D>(draw);
    } catch (const UserError&) {
    }
  }
  return drawShapePairOnce<D>(draw);  // no coincidence any more: let the error escape
}

extern template ShapePairCase<2> drawShapePair<2>(Draw&);
extern template ShapePairCase<3> drawShapePair<3>(Draw&);
extern template std::ostream& operator<< <2>(std::ostream&, const ShapePairCase<2>&);
extern template std::ostream& operator<< <3>(std::ostream&, const ShapePairCase<3>&);
extern template class Gen<ShapePairCase<2>>;
extern template class Gen<ShapePairCase<3>>;

// --- for use inside properties: const auto c = *shapePairs<3>(); ----------------------------------------------------

template <int D>
Gen<ShapePairCase<D>> shapePairs() {
  return Gen<ShapePairCase<D>>(drawShapePair<D>);
}
template <int D>
Gen<Shape<D>> shapes() {
  return Gen<Shape<D>>(drawShape<D>);
}
template <int D>
Gen<Pose<D>> poses(Real extent) {
  return Gen<Pose<D>>([extent](Draw& draw) { return drawPose<D>(draw, extent); });
}
template <int D>
Gen<Vec<D>> directions() {
  return Gen<Vec<D>>(drawDirection<D>);
}

}}}  // namespace lpc::LPC_PRECISION::test
