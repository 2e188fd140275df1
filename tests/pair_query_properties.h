// SPDX-License-Identifier: Zlib
// Properties of the signed distance of two convex shapes, for every method. No property needs another method as a
// reference: the support functions of the two shapes prove or refute an answer.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "framework/math/check.h"
#include "framework/stage/stage_narrowphase.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Tolerances of an answer, relative to the size of the pair. Closest points get a larger one, because they are
/// ill-conditioned where the distance is not: a vertex slides along a nearly parallel face.
inline constexpr double kPairTolerance = sizeof(Real) == 8 ? 1e-12 : 1e-5;
inline constexpr double kWitnessTolerance = sizeof(Real) == 8 ? 1e-6 : 1e-3;

/// A pair of shapes in relative pose only.
template <int D>
struct Asked {
  Shape<D> a, b;
  Pose<D> X_AB;
};

/// min over B of n . b minus max over A of n . a, in long double, for n of any length: a lower bound of the signed
/// distance.
template <int D>
long double boundAlong(const Asked<D>& pair, const Vec<D>& direction) {
  using V = Eigen::Matrix<long double, D, 1>;
  V n = direction.template cast<long double>();
  n /= n.norm();
  const auto reach = [](const ShapeView<D>& shape, const V& d) {
    long double farthest = 0;
    if (shape.hull) {
      farthest = -std::numeric_limits<long double>::infinity();
      for (const Vec<D>& v : shape.hull->vertices) {
        farthest = std::max<long double>(farthest, v.template cast<long double>().dot(d));
      }
    } else if (shape.curved) {
      std::array<long double, static_cast<std::size_t>(D)> along;
      std::copy_n(d.data(), D, along.begin());
      const auto p = shape.curved->support(along);
      for (int k = 0; k < D; ++k) farthest += p[static_cast<std::size_t>(k)] * d[k];
    } else {
      farthest = shape.half.template cast<long double>().dot(d.cwiseAbs());
    }
    return farthest + static_cast<long double>(shape.radius) * d.norm();
  };
  const Eigen::Matrix<long double, D, D> r = pair.X_AB.q.matrix().template cast<long double>();
  return n.dot(pair.X_AB.p.template cast<long double>()) - reach(pair.a.view(), n) -
         reach(pair.b.view(), V(-(r.transpose() * n)));
}

template <int D>
double extentOf(const ShapeView<D>& shape) {
  Real reach = shape.half.maxCoeff();
  if (shape.hull) {
    for (const Vec<D>& v : shape.hull->vertices) reach = std::max(reach, v.cwiseAbs().maxCoeff());
  }
  return reach + shape.radius;
}

/// Size s of the error measure: extent, distance and largest coordinate (m).
template <int D>
double sizeOf(const Asked<D>& pair, double distance) {
  return std::max(extentOf(pair.a.view()), extentOf(pair.b.view())) + std::max(0.0, distance) +
         static_cast<double>(pair.X_AB.p.cwiseAbs().maxCoeff());
}

/// The same shape, scaled by k and with r more rounding.
template <int D>
Shape<D> resized(const Shape<D>& shape, Real k, Real r = 0) {
  const ShapeView<D>& v = shape.view();
  switch (v.core()) {
    case CoreClass::point:
      return Shape<D>::sphere(k * v.radius + r);
    case CoreClass::segment:
      return k * v.radius + r > 0 ? Shape<D>::capsule(k * v.half[0], k * v.radius + r)
                                  : Shape<D>::segment(k * v.half[0]);
    case CoreClass::box:
      return Shape<D>::box(k * v.half, k * v.radius + r);
    case CoreClass::curved: {
      std::vector<Real> sizes;
      for (const Real size : v.curved->sizes()) sizes.push_back(k * size);
      return Shape<D>::curved(v.kind, sizes, k * v.radius + r);
    }
    case CoreClass::plane:
      return shape;
    case CoreClass::hull:
      break;
  }
  std::vector<Vec<D>> points;
  for (const Vec<D>& p : v.hull->vertices) points.push_back(k * p);
  return Shape<D>::ofCorners(v.kind, points, k * v.radius + r);
}

/// The mirror image across the plane x_k = 0.
template <int D>
Shape<D> mirrored(const Shape<D>& shape, int k) {
  if (!shape.view().hull) return shape;
  std::vector<Vec<D>> points = shape.view().hull->vertices;
  for (Vec<D>& p : points) p[k] = -p[k];
  return Shape<D>::ofCorners(shape.kind(), points, shape.view().radius);
}
inline Rot<2> mirrored(const Rot<2>& q, int) { return q.inverse(); }
inline Rot<3> mirrored(const Rot<3>& q, int k) {
  return {q.w, k == 0 ? q.x : -q.x, k == 1 ? q.y : -q.y, k == 2 ? q.z : -q.z};
}
template <int D>
Asked<D> mirrored(const Asked<D>& pair, int k) {
  Asked<D> image{mirrored(pair.a, k), mirrored(pair.b, k), {pair.X_AB.p, mirrored(pair.X_AB.q, k)}};
  image.X_AB.p[k] = -image.X_AB.p[k];
  return image;
}

/// Directions in which a wrong answer is likely to show: the axes of both shapes and the line of centres.
template <int D>
std::vector<Vec<D>> tellingDirections(const Asked<D>& pair) {
  std::vector<Vec<D>> out;
  for (int k = 0; k < D; ++k) {
    for (const Vec<D>& e : {Vec<D>(Vec<D>::Unit(k)), Vec<D>(pair.X_AB.q.matrix().col(k))}) {
      out.push_back(e), out.push_back(-e);
    }
  }
  if (pair.X_AB.p.norm() > 0) out.push_back(pair.X_AB.p);
  return out;
}

/// The method under test and the properties that it must satisfy.
template <int D>
class PairQueryProperties {
 public:
  explicit PairQueryProperties(PairQuery<D>& method) : m_method(method) {}

  struct Named {
    const char* name;
    // Empty if the property holds; otherwise what was observed.
    std::string (PairQueryProperties::*fault)(const Asked<D>&, const PairAnswer<D>&, Draw&);
  };
  static const std::vector<Named>& all() {
    using P = PairQueryProperties;
    static const std::vector<Named> list = {{"N1 swap", &P::swapped},
                                            {"N2 motion of both", &P::carried},
                                            {"N3 scale", &P::scaled},
                                            {"N4 mirror", &P::mirrorImage},
                                            {"N5 depth is minimal", &P::minimal},
                                            {"N5 depth suffices", &P::suffices},
                                            {"N6 Lipschitz", &P::lipschitz},
                                            {"N6 convex along lines", &P::convex},
                                            {"N7 witnesses", &P::witnesses},
                                            {"N8 certificate", &P::certificate},
                                            {"N9 boolean", &P::boolean},
                                            {"N10 always a normal", &P::normal},
                                            {"N11 rounding", &P::rounding},
                                            {"N16 memory", &P::remembered},
                                            {"N16 bytes of others", &P::foreign},
                                            {"N16 vertex order", &P::vertexOrder}};
    return list;
  }

  bool takes(const Shape<D>& a, const Shape<D>& b) const {
    return m_method.supports(std::min(a.kind(), b.kind()), std::max(a.kind(), b.kind()));
  }

  /// Name and reason of the first property that fails, or of the property `only`; empty if all hold.
  std::string fault(const Asked<D>& pair, Draw& draw, const std::string& only = "") {
    const PairAnswer<D> answer = ask(pair);
    m_size = sizeOf(pair, std::isfinite(answer.distance) ? double(answer.distance) : 0), m_T = kPairTolerance * m_size;
    if (only.empty()) {  // the other properties use the answer
      if (answer.status != QueryStatus::converged) return say("status ", queryStatusName(answer.status));
      if (const std::string text = normal(pair, answer, draw); !text.empty()) return text;
    }
    for (const Named& property : all()) {
      if (!only.empty() && only != property.name) continue;
      std::string text;
      try {
        text = (this->*property.fault)(pair, answer, draw);
      } catch (const UserError&) {  // in single precision a sliver may be too flat to rebuild its hull
        if (sizeof(Real) == 8) throw;
      }
      if (!text.empty()) return std::string(property.name) + ": " + text;
    }
    return "";
  }

 private:
  template <class T>
  static std::string say(const char* what, const T& value) {
    std::ostringstream out;
    out << what << value;
    return out.str();
  }
  PairAnswer<D> ask(const Asked<D>& pair, QueryNeed need = QueryNeed::closestPoints) {
    return queryPair<D>(m_method, pair.a.view(), pair.b.view(), pair.X_AB, need);
  }
  double askDistance(const Asked<D>& pair) { return static_cast<double>(ask(pair, QueryNeed::distance).distance); }
  // Whether `value` equals `expected` within T tolerances.
  std::string near(double value, double expected, double T) const {
    return std::abs(value - expected) <= T * m_T ? "" : say("off by s times ", (value - expected) / m_size);
  }

  std::string normal(const Asked<D>&, const PairAnswer<D>& answer, Draw&) {
    if (!std::isfinite(answer.distance) || !answer.normal.allFinite()) return say("distance ", answer.distance);
    return std::abs(answer.normal.norm() - 1) < Real(1e-5) ? "" : say("length of the normal ", answer.normal.norm());
  }

  // A separating axis proves the distance of separate shapes, and for penetrating ones that the depth suffices. In a
  // tie this holds for each of the normals (N20).
  std::string certificate(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    const double worth = static_cast<double>(boundAlong(pair, answer.normal));
    return worth >= answer.distance - m_T ? "" : say("short by s times ", (answer.distance - worth) / m_size);
  }

  // No direction gives a smaller depth or a wider gap.
  std::string minimal(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    auto directions = tellingDirections(pair);
    PlainDraw plain(static_cast<std::uint64_t>(draw.below(1 << 30)));
    for (int i = 0; i < 200; ++i) directions.push_back(drawDirection<D>(plain));
    for (const Vec<D>& d : directions) {
      const double shown = static_cast<double>(boundAlong(pair, d));
      if (shown > answer.distance + m_T) return say("better by s times ", (shown - answer.distance) / m_size);
    }
    return "";
  }

  std::string suffices(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    if (!(answer.distance < 0)) return "";
    return near(askDistance({pair.a, pair.b, {pair.X_AB.p - answer.distance * answer.normal, pair.X_AB.q}}), 0, 4);
  }

  std::string witnesses(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    const double T = 4 * m_T, loose = kWitnessTolerance * m_size;
    const double along = (answer.pB - answer.pA - answer.distance * answer.normal).norm();
    if (!(along <= T)) return say("they differ by the distance but for s times ", along / m_size);
    const Vec<D> nB = pair.X_AB.q.inverse() * Vec<D>(-answer.normal);
    const double onA = answer.pA.dot(answer.normal) - supportValue(pair.a.view(), answer.normal);
    const double onB = (pair.X_AB.inverse() * answer.pB).dot(nB) - supportValue(pair.b.view(), nB);
    if (!(std::abs(onA) <= T && std::abs(onB) <= T)) return say("not extreme by s times ", std::max(onA, onB) / m_size);
    const Asked<D> inA{pair.a, Shape<D>::sphere(0), {answer.pA, {}}},
        inB{pair.b, Shape<D>::sphere(0), {pair.X_AB.inverse() * answer.pB, {}}};
    for (const Asked<D>& point : {inA, inB}) {
      const auto sat = createStage<PairQuery<D>>(Spec{"sat", {}});
      const double out = queryPair<D>(*sat, point.a.view(), point.b.view(), point.X_AB, QueryNeed::distance).distance;
      if (!(out <= loose)) return say("outside by s times ", out / m_size);
    }
    return "";
  }

  std::string swapped(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    return near(askDistance({pair.b, pair.a, pair.X_AB.inverse()}), answer.distance, 2);
  }
  std::string carried(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const Pose<D> X = drawPose<D>(draw, static_cast<Real>(m_size));
    return near(askDistance({pair.a, pair.b, X.inverse() * (X * pair.X_AB)}), answer.distance, 32);
  }
  std::string scaled(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    for (const Real k : {Real(1e-3), Real(1e3)}) {
      const Pose<D> X{k * pair.X_AB.p, pair.X_AB.q};
      const std::string text = near(askDistance({resized(pair.a, k), resized(pair.b, k), X}) / k, answer.distance, 2);
      if (!text.empty()) return text;
    }
    return "";
  }
  std::string mirrorImage(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const int k = draw.below(D);
    const Asked<D> image = mirrored(pair, k);
    const PairAnswer<D> seen = ask(image);
    if (const std::string text = near(seen.distance, answer.distance, 2); !text.empty()) return text;
    Vec<D> n = seen.normal;  // must be as good for the original pair as its own normal, also in ties
    n[k] = -n[k];
    return certificate(pair, {QueryStatus::converged, seen.distance - static_cast<Real>(2 * m_T), n, {}, {}}, draw);
  }

  std::string boolean(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    const PairAnswer<D> side = ask(pair, QueryNeed::boolean);
    const bool wrong = std::abs(answer.distance) > 2 * m_T && (side.distance < 0) != (answer.distance < 0);
    return wrong ? say("says ", side.distance) : "";
  }

  std::string rounding(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    const Real r = static_cast<Real>(m_size) / 8;
    const Asked<D> rounded{resized(pair.a, 1, r), resized(pair.b, 1, r), pair.X_AB};
    if (!takes(rounded.a, rounded.b)) return "";
    return near(askDistance(rounded), answer.distance - 2 * static_cast<double>(r), 4);
  }

  Vec<D> drawStep(Draw& draw) {
    const Real length = static_cast<Real>(m_size) * draw.pick({Real(1e-9), Real(1e-3), Real(0.5)});
    return length * drawDirection<D>(draw);
  }
  Asked<D> movedBy(const Asked<D>& pair, const Vec<D>& v) const {
    return {pair.a, pair.b, {pair.X_AB.p + v, pair.X_AB.q}};
  }
  std::string lipschitz(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const Vec<D> v = drawStep(draw);
    return near(askDistance(movedBy(pair, v)), answer.distance, 4 + v.norm() / m_T);
  }
  // The distance is convex in the position: it is the maximum over all directions of bounds that are linear in the
  // position.
  std::string convex(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const Vec<D> v = 2 * drawStep(draw);
    const double between = (askDistance(movedBy(pair, v)) + askDistance(movedBy(pair, -v))) / 2;
    return answer.distance <= between + 4 * m_T ? "" : say("above by s times ", (answer.distance - between) / m_size);
  }

  // The distance of the pair with B shifted along x, computed with this memory.
  double askWith(PairMemory& memory, const Asked<D>& pair, double shift = 0,
                 QueryNeed need = QueryNeed::closestPoints) {
    PairView<D> view{pair.a.view(), pair.b.view(), pair.X_AB};
    view.X_AB.p[0] += static_cast<Real>(shift);
    PairAnswer<D> warm;
    WorkDone work;
    m_method.query({&view, 1}, need, {&warm, 1}, {&memory, 1}, work);
    return static_cast<double>(warm.distance);
  }
  // Memory from another pose must not change the answer.
  std::string remembered(const Asked<D>& pair, const PairAnswer<D>& answer, Draw&) {
    if (pair.a.kind() > pair.b.kind()) return "";
    PairMemory memory;
    askWith(memory, pair, m_size / 10);
    return near(askWith(memory, pair), answer.distance, 2);
  }
  // Memory with arbitrary bytes must not change the answer.
  std::string foreign(const Asked<D>& pair, const PairAnswer<D>&, Draw& draw) {
    if (pair.a.kind() > pair.b.kind()) return "";
    PairMemory memory;
    for (std::byte& b : memory.bytes) b = static_cast<std::byte>(draw.below(256));
    if (draw.coin()) {  // numbers as small as indices and counts
      for (std::size_t i = 12; i < memory.bytes.size(); i += 2) {
        memory.bytes[i] = static_cast<std::byte>(draw.below(10)), memory.bytes[i + 1] = std::byte{0};
      }
      memory.bytes[28] = static_cast<std::byte>(draw.below(6));
      memory.bytes[30] = std::byte{0};
    }
    if (draw.coin()) {  // kinds and indices of features
      for (std::size_t i = 0; i < memory.bytes.size(); i += 4) {
        memory.bytes[i] = static_cast<std::byte>(draw.below(8));
        memory.bytes[i + 1] = memory.bytes[i + 2] = memory.bytes[i + 3] = std::byte{0};
      }
      if (draw.coin()) memory.bytes[0] = std::byte{1};
    }
    // A query for closest points examines one more direction, which may hide the damage of wrong memory.
    const QueryNeed need = draw.coin() ? QueryNeed::closestPoints : QueryNeed::distance;
    PairMemory cold;
    return near(askWith(memory, pair, 0, need), askWith(cold, pair, 0, need), 2);
  }
  // The order of a hull's points must not change the answer.
  std::string vertexOrder(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const auto reordered = [&](const Shape<D>& shape) {
      if (!shape.view().hull) return shape;
      std::vector<Vec<D>> points = shape.view().hull->vertices;
      for (std::size_t i = points.size(); i > 1; --i) {
        std::swap(points[i - 1], points[static_cast<std::size_t>(draw.below(static_cast<int>(i)))]);
      }
      return Shape<D>::ofCorners(shape.kind(), points, shape.view().radius);
    };
    return near(askDistance({reordered(pair.a), reordered(pair.b), pair.X_AB}), answer.distance, 2);
  }

  PairQuery<D>& m_method;
  double m_size = 0, m_T = 0;  // of the pair under test
};

}}}  // namespace lpc::LPC_PRECISION::test
