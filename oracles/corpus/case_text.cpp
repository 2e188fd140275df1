// SPDX-License-Identifier: Zlib
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <sstream>

#include "framework/shape/curved_core.h"
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

}  // namespace

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

template std::string scriptText(const BoxScript<2>&);
template std::string scriptText(const BoxScript<3>&);
template int coreVertexCount(const ShapeView<2>&);
template int coreVertexCount(const ShapeView<3>&);
template std::string expectedText(const RefereeAnswer<2>&);
template std::string expectedText(const RefereeAnswer<3>&);
template std::string caseText(const std::string&, StageKind, const HardPair<2>&, const std::string&);
template std::string caseText(const std::string&, StageKind, const HardPair<3>&, const std::string&);

}}  // namespace lpc::LPC_PRECISION
