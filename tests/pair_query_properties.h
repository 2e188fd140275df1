// SPDX-License-Identifier: Zlib
// What is true of every signed distance of two convex shapes, whoever computes it. No property needs another method to
// be right: the support functions of the two shapes prove or refute an answer.
#pragma once

#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "framework/stage_narrowphase.h"
#include "tests/generators.h"

namespace lpc::inline LPC_PRECISION::test {

/// What an answer may be off by, against the size of the pair; of a witness point, which is ill-conditioned where the
/// answer is not, more (a vertex that slides along a nearly parallel face).
inline constexpr double kPairTolerance = sizeof(Real) == 8 ? 1e-12 : 1e-5;
inline constexpr double kWitnessTolerance = sizeof(Real) == 8 ? 1e-6 : 1e-3;

/// A pair whose poses no longer matter, only X_AB.
template <int D>
struct Asked {
  Shape<D> a, b;
  Pose<D> X_AB;
};

/// min over B of n . b - max over A of n . a in long double, n of any length: a lower bound of the signed distance.
template <int D>
long double boundAlong(const Asked<D>& pair, const Vec<D>& direction) {
  using V = Eigen::Matrix<long double, D, 1>;
  V n = direction.template cast<long double>();
  n /= n.norm();
  const auto reach = [](const ShapeView<D>& shape, const V& d) {
    long double farthest = 0;
    if (shape.kind == ShapeKind::polytope) {
      farthest = -std::numeric_limits<long double>::infinity();
      for (const Vec<D>& v : shape.hull->vertices) {
        farthest = std::max<long double>(farthest, v.template cast<long double>().dot(d));
      }
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

/// s of the error measure: extent, distance and largest coordinate (m).
template <int D>
double sizeOf(const Asked<D>& pair, double distance) {
  return std::max(extentOf(pair.a.view()), extentOf(pair.b.view())) + std::max(0.0, distance) +
         static_cast<double>(pair.X_AB.p.cwiseAbs().maxCoeff());
}

/// The same shape, k times as large and with r more rounding.
template <int D>
Shape<D> resized(const Shape<D>& shape, Real k, Real r = 0) {
  const ShapeView<D>& v = shape.view();
  switch (v.kind) {
    case ShapeKind::sphere:
      return Shape<D>::sphere(k * v.radius + r);
    case ShapeKind::capsule:
      return Shape<D>::capsule(k * v.half[0], k * v.radius + r);
    case ShapeKind::segment:
      return r > 0 ? Shape<D>::capsule(k * v.half[0], r) : Shape<D>::segment(k * v.half[0]);
    case ShapeKind::box:
      return Shape<D>::box(k * v.half, k * v.radius + r);
    case ShapeKind::polytope:
      break;
  }
  std::vector<Vec<D>> points;
  for (const Vec<D>& p : v.hull->vertices) points.push_back(k * p);
  return Shape<D>::polytope(std::span<const Vec<D>>(points), k * v.radius + r);
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

/// One method under test. `fault` of a case is the name of the first property that does not hold and why; else empty.
template <int D>
class PairQueryProperties {
 public:
  explicit PairQueryProperties(PairQuery<D>& method) : m_method(method) {}

  bool takes(const Shape<D>& a, const Shape<D>& b) const {
    return m_method.supports(std::min(a.kind(), b.kind()), std::max(a.kind(), b.kind()));
  }

  std::string fault(const Asked<D>& pair, Draw& draw) {
    const PairAnswer<D> answer = ask(pair);
    const double size = sizeOf(pair, answer.distance), T = kPairTolerance * size;
    if (answer.status != QueryStatus::converged) return say("status", queryStatusName(answer.status));
    if (!std::isfinite(answer.distance) || !answer.normal.allFinite()) return say("finite", answer.distance);
    if (!(std::abs(answer.normal.norm() - 1) < Real(1e-5))) return say("unit normal", answer.normal.norm());
    // N8: a proof for shapes apart, and for shapes that penetrate the depth that suffices (N5).
    const double worth = static_cast<double>(boundAlong(pair, answer.normal));
    if (worth < answer.distance - T) return say("certificate", (answer.distance - worth) / size);
    // N5: no direction gets out with less depth or shows a wider gap.
    auto directions = tellingDirections(pair);
    for (int i = 0; i < 16; ++i) directions.push_back(drawDirection<D>(draw));
    for (const Vec<D>& d : directions) {
      const double shown = static_cast<double>(boundAlong(pair, d));
      if (shown > answer.distance + T) return say("minimal", (shown - answer.distance) / size);
    }
    for (const auto& part : {witnesses(pair, answer, size), sameAgain(pair, answer, draw), moved(pair, answer, draw),
                             remembered(pair, answer)}) {
      if (!part.empty()) return part;
    }
    return "";
  }

 private:
  template <class T>
  static std::string say(const char* property, const T& value) {
    std::ostringstream out;
    out << property << ": " << value;
    return out.str();
  }
  PairAnswer<D> ask(const Asked<D>& pair, Need need = Need::witnesses) {
    return queryPair<D>(m_method, pair.a.view(), pair.b.view(), pair.X_AB, need);
  }
  static bool near(double x, double y, double T) { return std::abs(x - y) <= T; }

  // N7
  std::string witnesses(const Asked<D>& pair, const PairAnswer<D>& answer, double size) {
    const double T = 4 * kPairTolerance * size, loose = kWitnessTolerance * size;
    const double along = (answer.pB - answer.pA - answer.distance * answer.normal).norm();
    if (!(along <= T)) return say("witnesses differ by the distance", along / size);
    const Vec<D> nB = pair.X_AB.q.inverse() * Vec<D>(-answer.normal);
    const double onA = answer.pA.dot(answer.normal) - supportValue(pair.a.view(), answer.normal);
    const double onB = (pair.X_AB.inverse() * answer.pB).dot(nB) - supportValue(pair.b.view(), nB);
    if (!(std::abs(onA) <= T && std::abs(onB) <= T)) return say("witnesses are extreme", std::max(onA, onB) / size);
    const Pose<D> identity;
    const Asked<D> inA{pair.a, Shape<D>::sphere(0), {answer.pA, {}}},
        inB{pair.b, Shape<D>::sphere(0), {pair.X_AB.inverse() * answer.pB, {}}};
    for (const Asked<D>& point : {inA, inB}) {
      const auto sat = createStage<PairQuery<D>>(Spec{"sat", {}});
      const double out = queryPair<D>(*sat, point.a.view(), point.b.view(), point.X_AB, Need::distance).distance;
      if (!(out <= loose)) return say("witnesses are in their shapes", out / size);
    }
    return "";
  }

  // N1 swap, N2 motion of both, N3 scale, N9 boolean, N11 rounding
  std::string sameAgain(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const double phi = answer.distance, size = sizeOf(pair, phi), T = 2 * kPairTolerance * size;
    const PairAnswer<D> swapped = ask({pair.b, pair.a, pair.X_AB.inverse()});
    if (!near(swapped.distance, phi, T)) return say("swap", swapped.distance);
    const Pose<D> X = drawPose<D>(draw, static_cast<Real>(size));
    const PairAnswer<D> carried = ask({pair.a, pair.b, X.inverse() * (X * pair.X_AB)});
    if (!near(carried.distance, phi, 16 * T)) return say("rigid motion", carried.distance);
    for (const Real k : {Real(1e-3), Real(1e3)}) {
      const Pose<D> scaled{k * pair.X_AB.p, pair.X_AB.q};
      const PairAnswer<D> other = ask({resized(pair.a, k), resized(pair.b, k), scaled});
      if (!near(other.distance / k, phi, T)) return say("scale", other.distance / k);
    }
    const PairAnswer<D> side = ask(pair, Need::boolean);
    if (std::abs(phi) > T && (side.distance < 0) != (phi < 0)) return say("boolean", side.distance);
    const Real r = static_cast<Real>(size) / 8;
    const Asked<D> rounded{resized(pair.a, 1, r), resized(pair.b, 1, r), pair.X_AB};
    if (takes(rounded.a, rounded.b)) {
      const PairAnswer<D> other = ask(rounded);
      if (!near(other.distance, phi - 2 * static_cast<double>(r), 2 * T)) return say("rounding", other.distance);
    }
    return "";
  }

  // N5 by moving, N6 Lipschitz
  std::string moved(const Asked<D>& pair, const PairAnswer<D>& answer, Draw& draw) {
    const double phi = answer.distance, T = 4 * kPairTolerance * sizeOf(pair, phi);
    const Vec<D> v =
        static_cast<Real>(sizeOf(pair, phi)) * draw.pick({Real(1e-9), Real(1e-3), Real(0.5)}) * drawDirection<D>(draw);
    const PairAnswer<D> there = ask({pair.a, pair.b, {pair.X_AB.p + v, pair.X_AB.q}});
    if (std::abs(there.distance - phi) > v.norm() + T) return say("Lipschitz", there.distance);
    if (phi < 0) {
      const PairAnswer<D> apart = ask({pair.a, pair.b, {pair.X_AB.p - answer.distance * answer.normal, pair.X_AB.q}});
      if (std::abs(apart.distance) > T) return say("depth suffices", apart.distance);
    }
    return "";
  }

  // N16: memory of another place must not change the answer.
  std::string remembered(const Asked<D>& pair, const PairAnswer<D>& answer) {
    if (pair.a.kind() > pair.b.kind()) return "";
    const double T = kPairTolerance * sizeOf(pair, answer.distance);
    const auto batch = std::make_unique<PairBatch<D>>();
    const auto answers = std::make_unique<PairAnswers<D>>();
    std::vector<PairMemory> memory(1);
    Work work;
    for (const Real shift : {Real(0.1), Real(0)}) {
      Pose<D> X = pair.X_AB;
      X.p[0] += shift * static_cast<Real>(sizeOf(pair, answer.distance));
      batch->clear(pair.a.kind(), pair.b.kind());
      batch->add(pair.a.view(), pair.b.view(), X);
      m_method.query(*batch, Need::witnesses, *answers, memory, work);
    }
    if (!near(answers->distance[0], answer.distance, 2 * T)) return say("memory", answers->distance[0]);
    return "";
  }

  PairQuery<D>& m_method;
};

}  // namespace lpc::inline LPC_PRECISION::test
