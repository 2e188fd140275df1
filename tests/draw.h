// SPDX-License-Identifier: Zlib
// Random shapes and poses, drawn from small whole numbers so that RapidCheck can shrink them: 0 is always the simplest
// choice. The same code draws from a plain generator for counting and for long loops.
#pragma once

#include <rapidcheck/Show.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/math/random.h"
#include "framework/shape/curved_core.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr Real kEps = std::numeric_limits<Real>::epsilon();

/// A source of whole numbers.
class Draw {
 public:
  virtual ~Draw() = default;
  /// In [0, n).
  virtual int below(int n) = 0;

  bool coin() { return below(2) == 1; }
  /// In [lo, hi]; the simplest is lo. Steps of 1e-6 of the range: rarely a round binary number.
  Real real(double lo, double hi) { return static_cast<Real>(lo + (hi - lo) * below(1000001) / 1e6); }
  /// In [-1, 1]; the simplest is 0.
  Real signedUnit() {
    const int k = below(2000001);
    return static_cast<Real>((k % 2 ? -1 : 1) * ((k + 1) / 2) / 1e6);
  }
  template <class T>
  T pick(std::initializer_list<T> values) {
    return values.begin()[below(static_cast<int>(values.size()))];
  }
};

/// Inside a property: shrinks.
class RapidCheckDraw final : public Draw {
 public:
  int below(int n) override;
};

/// Inside a property: in [lo, hi), wider from case to case.
int growingNumber(int lo, int hi);
/// Inside a property: any, and it does not shrink.
std::size_t drawIndex(std::size_t count);
/// Inside a property: the seed of a plain generator.
std::uint32_t drawSeed();

/// A value of any type, with what shows it in a counterexample.
struct DrawnValue {
  std::shared_ptr<const void> value;
  void (*show)(const void*, std::ostream&) = nullptr;

  friend std::ostream& operator<<(std::ostream& out, const DrawnValue& drawn) {
    drawn.show(drawn.value.get(), out);
    return out;
  }
};

/// Inside a property: what `body` draws, shrunk on its own. RapidCheck knows one type of these, in draw.cpp.
DrawnValue drawValue(const std::function<DrawnValue(Draw&)>& body);

/// What can be drawn inside a property: const auto c = *shapePairs<3>();
template <class T>
class Gen {
 public:
  template <class Body>
  explicit Gen(Body body) : m_body(std::move(body)) {}

  T operator*() const {
    const DrawnValue drawn = drawValue([body = m_body](Draw& draw) {
      return DrawnValue{std::make_shared<const T>(body(draw)),
                        [](const void* value, std::ostream& out) { rc::show(*static_cast<const T*>(value), out); }};
    });
    return *static_cast<const T*>(drawn.value.get());
  }

 private:
  std::function<T(Draw&)> m_body;
};
template <class Body>
Gen(Body) -> Gen<std::decay_t<std::invoke_result_t<Body, Draw&>>>;

/// For loops without shrinking.
class PlainDraw final : public Draw {
 public:
  explicit PlainDraw(std::uint64_t seed) : m_random(seed) {}
  int below(int n) override { return static_cast<int>(m_random.below(static_cast<std::uint64_t>(n))); }

 private:
  Random m_random;
};

template <int D>
Vec<D> drawVector(Draw& draw) {
  Vec<D> v;
  for (int k = 0; k < D; ++k) v[k] = draw.signedUnit();
  return v;
}

/// A unit vector, every fourth along an axis; the simplest is the x axis.
template <int D>
Vec<D> drawDirection(Draw& draw) {
  if (draw.below(4) == 0) {
    const int k = draw.below(D);
    return draw.coin() ? Vec<D>(-Vec<D>::Unit(k)) : Vec<D>(Vec<D>::Unit(k));
  }
  const Vec<D> v = drawVector<D>(draw);
  return v.norm() > Real(1e-3) ? Vec<D>(v / v.norm()) : Vec<D>(Vec<D>::Unit(0));
}

inline Rot<2> turn(const Ang<2>& v) { return Rot<2>::angle(v[0]); }
inline Rot<3> turn(const Ang<3>& v) { return Rot<3>::vector(v); }

template <int D>
Rot<D> drawRotation(Draw& draw) {
  Ang<D> v;
  for (int k = 0; k < kAngDim<D>; ++k) v[k] = Real(3.14159) * draw.signedUnit();
  return turn(v);
}

/// Positions within `extent` of the origin.
template <int D>
Pose<D> drawPose(Draw& draw, Real extent) {
  Pose<D> X;
  X.p = extent * drawVector<D>(draw);
  X.q = drawRotation<D>(draw);
  return X;
}

/// What a shape is made from, at scale 1: sizes around 1 m.
template <int D>
struct Sketch {
  ShapeKind kind = ShapeKind::sphere;
  Vec<D> half = Vec<D>::Zero();
  Real radius = 0;
  std::vector<Vec<D>> points;

  Shape<D> build(Real scale) const {
    switch (coreClass(kind)) {
      case CoreClass::point:
        return Shape<D>::sphere(scale * radius);
      case CoreClass::segment:
        if (kind == ShapeKind::segment) return Shape<D>::segment(scale * half[0]);
        return Shape<D>::capsule(scale * half[0], scale * radius);
      case CoreClass::box:
        return Shape<D>::box(scale * half, scale * radius);
      case CoreClass::curved: {
        std::vector<Real> sizes;
        for (std::size_t i = 0; i < curvedKind<D>(kind).sizes.size(); ++i) {
          sizes.push_back(scale * half[static_cast<int>(i)]);
        }
        return Shape<D>::curved(kind, sizes, scale * radius);
      }
      case CoreClass::plane:
        return Shape<D>::plane();
      case CoreClass::hull:
        break;
    }
    std::vector<Vec<D>> scaled;
    for (const Vec<D>& p : points) scaled.push_back(scale * p);
    return Shape<D>::ofCorners(kind, scaled, scale * radius);
  }
};

/// Sizes are thirds: never exactly representable.
template <int D>
Vec<D> drawHalf(Draw& draw) {
  Vec<D> half;
  for (int k = 0; k < D; ++k) half[k] = Real(1 + draw.below(9)) / 3;
  return half;
}

/// A simplex around the origin and up to 12 more points.
template <int D>
std::vector<Vec<D>> drawPoints(Draw& draw) {
  std::vector<Vec<D>> points;
  const Vec<D> half = drawHalf<D>(draw);
  points.push_back(-half);
  for (int k = 0; k < D; ++k) {
    Vec<D> p = -half;
    p[k] = 2 * half[k];
    points.push_back(p);
  }
  for (int n = draw.below(13); n > 0; --n) points.push_back(half.cwiseProduct(drawVector<D>(draw)) * Real(1.5));
  return points;
}

template <int D>
Sketch<D> drawSketch(Draw& draw, ShapeKind kind) {
  Sketch<D> s;
  s.kind = kind;
  const Real rounding = draw.below(4) == 3 ? draw.real(0.01, 0.3) : Real(0);
  if (kind == ShapeKind::polytope) {
    s.points = drawPoints<D>(draw), s.radius = rounding;
  } else if (kind == ShapeKind::triangle) {  // two edges along axes, the third corner anywhere near its place
    const Vec<D> half = drawHalf<D>(draw);
    s.points.assign(3, -half), s.radius = rounding;
    s.points[1][0] = s.points[2][1] = 2 * half[0];
    if (draw.coin()) s.points[2] += half.cwiseProduct(drawVector<D>(draw)) / 2;
  } else if (kind == ShapeKind::box || coreClass(kind) == CoreClass::curved) {
    s.half = drawHalf<D>(draw), s.radius = rounding;
  } else {
    if (kind != ShapeKind::sphere) s.half[0] = drawHalf<D>(draw)[0];
    if (kind != ShapeKind::segment) s.radius = drawHalf<D>(draw)[0] / 2;
  }
  return s;
}

/// Every kind that exists in this dimension, the simplest first.
template <int D>
ShapeKind drawKind(Draw& draw) {
  return D == 2 ? draw.pick(
                      {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::polytope, ShapeKind::segment})
                : draw.pick({ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::polytope});
}

inline Real drawScale(Draw& draw) { return draw.pick({Real(1), Real(1e-3), Real(1e3)}); }

template <int D>
Shape<D> drawShape(Draw& draw) {
  const Sketch<D> sketch = drawSketch<D>(draw, drawKind<D>(draw));
  return sketch.build(drawScale(draw));
}

// Compiled in draw.cpp.
extern template std::vector<Vec<2>> drawPoints<2>(Draw&);
extern template std::vector<Vec<3>> drawPoints<3>(Draw&);
extern template Sketch<2> drawSketch<2>(Draw&, ShapeKind);
extern template Sketch<3> drawSketch<3>(Draw&, ShapeKind);
extern template Shape<2> drawShape<2>(Draw&);
extern template Shape<3> drawShape<3>(Draw&);
extern template Pose<2> drawPose<2>(Draw&, Real);
extern template Pose<3> drawPose<3>(Draw&, Real);
extern template class Gen<Shape<2>>;
extern template class Gen<Shape<3>>;
extern template class Gen<Pose<2>>;
extern template class Gen<Pose<3>>;
extern template class Gen<Vec<2>>;
extern template class Gen<Vec<3>>;

/// Size of a shape: the largest distance of its points from its origin (m).
template <int D>
Real sizeOf(const Shape<D>& s) {
  return boundingRadius(s.view());
}

}}}  // namespace lpc::LPC_PRECISION::test

// Beside the types, so that RapidCheck and GoogleTest print counterexamples: in the terms of a scene file
// (docs/reference_scenes.md), with all digits. Rotations become angles, which may cost a bit; a kept input has them
// all.
namespace lpc { inline namespace LPC_PRECISION {

/// "[1, 2.5, 3]"
template <int D>
std::string listText(const Vec<D>& v) {
  std::ostringstream out;
  out.precision(std::numeric_limits<Real>::max_digits10);
  for (int k = 0; k < D; ++k) out << (k ? ", " : "[") << v[k];
  return out.str() + ']';
}

template <int D>
std::ostream& operator<<(std::ostream& out, const Shape<D>& shape) {
  const ShapeView<D>& v = shape.view();
  out.precision(std::numeric_limits<Real>::max_digits10);
  out << "{ kind = \"" << shapeKindName(v.kind) << '"';
  const char* rounding = ", rounding = ";
  switch (v.core()) {
    case CoreClass::point:
      rounding = ", radius = ";
      break;
    case CoreClass::segment:
      out << ", half_length = " << v.half[0];
      rounding = ", radius = ";
      break;
    case CoreClass::box:
      out << ", half = " << listText<D>(v.half);
      break;
    case CoreClass::hull:
      for (std::size_t i = 0; i < v.hull->vertices.size(); ++i) {
        out << (i ? ", " : ", points = [") << listText<D>(v.hull->vertices[i]);
      }
      out << ']';
      break;
    case CoreClass::curved: {
      int k = 0;
      for (const std::string_view size : curvedKind<D>(v.kind).sizes) out << ", " << size << " = " << v.half[k++];
      break;
    }
    case CoreClass::plane:
      break;
  }
  if (v.radius > 0 || v.core() == CoreClass::point) out << rounding << v.radius;
  return out << " }";
}
inline std::ostream& operator<<(std::ostream& out, const Rot<2>& q) { return out << q.radians(); }
inline std::ostream& operator<<(std::ostream& out, const Rot<3>& q) {
  const Vec<3> v = q.imag();
  const Real turn = 2 * std::atan2(v.norm(), q.w);
  return out << listText<3>(v.norm() > 0 ? Vec<3>(turn / v.norm() * v) : v);
}
template <int D>
std::ostream& operator<<(std::ostream& out, const Pose<D>& X) {
  out.precision(std::numeric_limits<Real>::max_digits10);
  return out << "position = " << listText<D>(X.p) << "\nangle = " << X.q;
}
/// A [[body]] of one shape.
template <int D>
void showBody(std::ostream& out, const char* name, const Shape<D>& shape, const Pose<D>& X_WB) {
  out << "[[body]]\nname = \"" << name << "\"\n" << X_WB << "\nshapes = [" << shape << "]\n";
}

extern template std::ostream& operator<< <2>(std::ostream&, const Shape<2>&);
extern template std::ostream& operator<< <3>(std::ostream&, const Shape<3>&);
extern template std::ostream& operator<< <2>(std::ostream&, const Pose<2>&);
extern template std::ostream& operator<< <3>(std::ostream&, const Pose<3>&);

}}  // namespace lpc::LPC_PRECISION
