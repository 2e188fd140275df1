// SPDX-License-Identifier: Zlib
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <numbers>
#include <sstream>

#include "framework/shape/support_map.h"
#include "oracles/corpus/box_script.h"
#include "oracles/corpus/hard_pairs.h"
#include "oracles/referee/posed_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::ostringstream exactStream() {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  return out;
}

template <int N>
std::string listed(const RealMatrix<N, 1>& v) {
  std::ostringstream out = exactStream();
  for (int k = 0; k < N; ++k) out << (k ? ", " : "[") << static_cast<double>(v[k]);
  return out.str() + "]";
}

template <int D>
std::string shapeText(const ShapeView<D>& s, const std::vector<Vec<D>>& given) {
  const std::vector<Vec<D>>& points = s.hull && given.empty() ? s.hull->vertices : given;
  std::ostringstream out = exactStream();
  switch (s.core()) {
    case CoreClass::point:
      out << R"({"type": "sphere")";
      break;
    case CoreClass::segment:
      if (s.radius > 0) {
        out << R"({"type": "capsule", "axis": "x", "half_length": )" << static_cast<double>(s.half[0]);
        break;
      }
      out << R"({"type": "segment", "points": [)" << listed<D>(-s.half) << ", " << listed<D>(s.half) << ']';
      break;
    case CoreClass::box:
      out << R"({"type": "box", "half_extents": )" << listed<D>(s.half);
      break;
    case CoreClass::hull:
      out << R"({"type": ")" << (s.kind == ShapeKind::triangle ? "triangle" : "convex") << R"(", "points": [)";
      for (std::size_t i = 0; i < points.size(); ++i) out << (i ? ", " : "") << listed<D>(points[i]);
      out << ']';
      break;
    case CoreClass::curved: {
      out << R"({"type": ")" << shapeKindName(s.kind) << '"';
      const std::span<const Real> sizes = s.curved->sizes();
      for (std::size_t i = 0; i < sizes.size(); ++i) {
        out << ", \"" << curvedKind<D>(s.kind).sizes[i] << "\": " << static_cast<double>(sizes[i]);
      }
      if (s.radius > 0) out << ", \"rounding\": " << static_cast<double>(s.radius);
      return out.str() + "}";
    }
    case CoreClass::plane:
      return R"({"type": "half_space"})";
  }
  if (s.radius > 0 || s.core() == CoreClass::point) out << ", \"radius\": " << static_cast<double>(s.radius);
  return out.str() + "}";
}

std::string rotationText(const Rot<2>& q) { return "\"cos_sin\": " + listed<2>(Vec<2>(q.c, q.s)); }
std::string rotationText(const Rot<3>& q) { return "\"q_wxyz\": " + listed<4>(RealMatrix<4, 1>(q.w, q.x, q.y, q.z)); }

template <int D>
std::string poseText(const Pose<D>& X) {
  return "{\"t\": " + listed<D>(X.p) + ", " + rotationText(X.q) + "}";
}

constexpr int kTurns = 96;  // directions of an outline; all directions between a corner's edges give this corner

// Axes of a 3D picture, right and up: seen slightly from the side and from above.
const Vec<3> kRight = Vec<3>(Real(0.87), 0, Real(-0.49)).normalized(),
             kUp = Vec<3>(Real(-0.19), Real(0.92), Real(-0.34)).normalized();
template <int D>
Vec<D> across(const Vec<2>& d) {
  if constexpr (D == 2)
    return d;
  else
    return d[0] * kRight + d[1] * kUp;
}
template <int D>
Vec<2> picture(const Vec<D>& p) {
  if constexpr (D == 2)
    return p;
  else
    return {kRight.dot(p), kUp.dot(p)};
}

template <int D>
Real reachOf(const ShapeView<D>& s) {
  return s.half.norm() + s.radius;
}

// A block of the half-space, below the other shape.
template <int D>
Pose<D> blockBelow(const Pose<D>& X, const ShapeView<D>& other, const Pose<D>& X_other, Shape<D>& block) {
  Vec<D> middle = X.inverse() * X_other.p;
  const Real size = reachOf(other) + std::abs(middle[1]);
  block = Shape<D>::box(size * Vec<D>::Ones());
  middle[1] = -size;
  return {X * middle, X.q};
}

template <int D>
std::string outlineText(ShapeView<D> s, Pose<D> X, const ShapeView<D>& other, const Pose<D>& X_other) {
  Shape<D> block = Shape<D>::sphere(1);
  if (s.core() == CoreClass::plane) X = blockBelow(X, other, X_other, block), s = block.view();
  std::vector<std::string> points;
  for (int i = 0; i < kTurns; ++i) {
    const double turn = 2 * std::numbers::pi * (i + 0.1) / kTurns;  // not along any axis
    const Vec<D> d = (X.q.inverse() * across<D>({Real(std::cos(turn)), Real(std::sin(turn))})).normalized();
    const Vec<2> p = picture<D>(X * Vec<D>(coreSupport(s, d) + s.radius * d));
    if (!p.allFinite()) continue;
    char text[64];
    std::snprintf(text, sizeof text, "[%.5g, %.5g]", static_cast<double>(p[0]), static_cast<double>(p[1]));
    if (points.empty() || points.back() != text) points.emplace_back(text);
  }
  if (points.size() > 1 && points.front() == points.back()) points.pop_back();
  std::string out;
  for (const std::string& p : points) out += (out.empty() ? "" : ", ") + p;
  return '[' + out + ']';
}

}  // namespace

template <int D>
std::string outlinesText(const HardPair<D>& pair) {
  const ShapeView<D> a = pair.a.view(), b = pair.b.view();
  return ", \"outlineA\": " + outlineText<D>(a, {}, b, pair.X_AB) +
         ", \"outlineB\": " + outlineText<D>(b, pair.X_AB, a, {});
}

std::string numberText(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return std::isfinite(x) ? text : "null";
}

template <int D>
int coreVertexCount(const ShapeView<D>& shape) {
  std::vector<Vec<D>> core;
  coreVertices(shape, core);
  return static_cast<int>(core.size());
}

template <int D>
std::string caseText(const std::string& id, StageKind stage, const HardPair<D>& pair, const std::string& more) {
  const bool inWorld = stage == StageKind::contacts;
  return "{\"id\": \"" + id + "\", \"source\": \"lpc verify\", \"dim\": " + std::to_string(D) + ", \"query\": \"" +
         (inWorld ? "contacts" : "signed_distance") + "\", \"note\": \"" + std::string(pair.family) +
         "\", \"shapeA\": " + shapeText<D>(pair.a.view(), pair.pointsA) +
         ", \"poseA\": " + poseText(inWorld ? pair.X_WA : Pose<D>{}) +
         ", \"shapeB\": " + shapeText<D>(pair.b.view(), pair.pointsB) +
         ", \"poseB\": " + poseText(inWorld ? pair.X_WB : pair.X_AB) +
         (pair.X_WBNudged ? ", \"poseB_nudged\": " + poseText(*pair.X_WBNudged) : "") + more + "}";
}

template <int D>
std::string expectedText(const RefereeAnswer<D>& truth) {
  return ", \"expected\": {\"signed_distance\": " + numberText(truth.interval().middle()) +
         ", \"tolerance_of_this_value\": " + numberText(truth.interval().width()) +
         ", \"derived\": true, \"method\": \"referee, " + std::string(truth.method) + "\"}";
}

template <int D>
std::string scriptText(const BoxScript<D>& script) {
  std::ostringstream out = exactStream();
  out << "\"slots\": " << script.slots << ", \"steps\": [";
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    out << (i ? ", [" : "[");
    for (const BoxChange<D>& c : script.steps[i]) {
      using What = typename BoxChange<D>::What;
      const char* const what = c.what == What::added ? "added" : c.what == What::removed ? "removed" : "moved";
      out << (&c == script.steps[i].data() ? "{\"" : ", {\"") << what << "\": " << c.slot;
      if (c.what != What::removed) out << ", \"lo\": " << listed<D>(c.box.lo) << ", \"hi\": " << listed<D>(c.box.hi);
      if (c.what == What::added) {
        out << ", \"body\": " << c.body << ", \"active\": " << (c.active ? "true" : "false")
            << ", \"category\": " << c.category << ", \"mask\": " << c.mask;
      }
      out << '}';
    }
    out << ']';
  }
  return out.str() + "]";
}

template std::string outlinesText(const HardPair<2>&);
template std::string outlinesText(const HardPair<3>&);
template std::string scriptText(const BoxScript<2>&);
template std::string scriptText(const BoxScript<3>&);
template int coreVertexCount(const ShapeView<2>&);
template int coreVertexCount(const ShapeView<3>&);
template std::string expectedText(const RefereeAnswer<2>&);
template std::string expectedText(const RefereeAnswer<3>&);
template std::string caseText(const std::string&, StageKind, const HardPair<2>&, const std::string&);
template std::string caseText(const std::string&, StageKind, const HardPair<3>&, const std::string&);

}}  // namespace lpc::LPC_PRECISION
