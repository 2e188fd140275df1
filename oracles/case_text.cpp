// SPDX-License-Identifier: Zlib
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <sstream>

#include "framework/curved_core.h"
#include "oracles/hard_pairs.h"
#include "oracles/posed_core.h"

namespace lpc::inline LPC_PRECISION {
namespace {

std::ostringstream exactStream() {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  return out;
}

template <int D>
std::string listed(const Vec<D>& v) {
  std::ostringstream out = exactStream();
  for (int k = 0; k < D; ++k) out << (k ? ", " : "[") << static_cast<double>(v[k]);
  return out.str() + "]";
}

template <int D>
std::string shapeText(const ShapeView<D>& s) {
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
      out << R"({"type": "convex", "points": [)";
      for (std::size_t i = 0; i < s.hull->vertices.size(); ++i)
        out << (i ? ", " : "") << listed<D>(s.hull->vertices[i]);
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

std::string poseText(const Vec<2>& p, double angle, const Rot<2>&) {
  std::ostringstream out = exactStream();
  out << "{\"t\": " << listed<2>(p) << ", \"angle\": " << angle << "}";
  return out.str();
}
std::string poseText(const Vec<3>& p, double, const Rot<3>& q) {
  std::ostringstream out = exactStream();
  out << "{\"t\": " << listed<3>(p) << ", \"q_wxyz\": [" << static_cast<double>(q.w) << ", " << static_cast<double>(q.x)
      << ", " << static_cast<double>(q.y) << ", " << static_cast<double>(q.z) << "]}";
  return out.str();
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
std::string caseText(const std::string& id, const HardPair<D>& pair, const std::string& more) {
  return "{\"id\": \"" + id + "\", \"source\": \"lpc verify\", \"dim\": " + std::to_string(D) +
         ", \"query\": \"signed_distance\", \"note\": \"" + std::string(pair.family) +
         "\", \"shapeA\": " + shapeText<D>(pair.a.view()) + ", \"poseA\": " + poseText(Vec<D>::Zero(), 0, Rot<D>{}) +
         ", \"shapeB\": " + shapeText<D>(pair.b.view()) +
         ", \"poseB\": " + poseText(pair.X_AB.p, pair.angle, pair.X_AB.q) + more + "}";
}

template int coreVertexCount(const ShapeView<2>&);
template int coreVertexCount(const ShapeView<3>&);
template std::string caseText(const std::string&, const HardPair<2>&, const std::string&);
template std::string caseText(const std::string&, const HardPair<3>&, const std::string&);

}  // namespace lpc::inline LPC_PRECISION
