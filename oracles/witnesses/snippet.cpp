// SPDX-License-Identifier: Zlib
#include "oracles/witnesses/snippet.h"

#include <cmath>
#include <cstdio>

#include "framework/math/check.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::string coordinate(int k, const std::string& half) {
  const std::string i = "[" + std::to_string(k) + "]";
  return "p" + i + " = d" + i + " >= 0 ? " + half + " : -" + half;
}

// The same as CurvedCore::support of the kind.
std::string curvedBody(const ShapeView<3>& shape) {
  const auto size = [&](std::size_t i) { return literal(static_cast<double>(shape.curved->sizes()[i])); };
  if (shape.kind == ShapeKind::cylinder) {
    return "  " + coordinate(0, size(0)) + ", p[1] = p[2] = 0;\n" +
           "  const double most = std::fmax(std::fabs(d[1]), std::fabs(d[2]));\n"
           "  if (!(most > 0)) return;\n"
           "  const double y = d[1] / most, z = d[2] / most, length = std::sqrt(y * y + z * z);\n" +
           "  p[1] = " + size(1) + " * (y / length), p[2] = " + size(1) + " * (z / length);\n";
  }
  if (shape.kind == ShapeKind::ellipsoid) {
    return "  const double s[3] = {" + size(0) + ", " + size(1) + ", " + size(2) + "};\n" +
           "  double most = 0, square = 0;\n"
           "  for (int k = 0; k < 3; ++k) p[k] = d[k] * s[k], most = std::fmax(most, std::fabs(p[k]));\n"
           "  if (!(most > 0)) { p[0] = s[0]; return; }\n"
           "  for (int k = 0; k < 3; ++k) p[k] /= most, square += p[k] * p[k];\n"
           "  const double length = std::sqrt(square);\n"
           "  for (int k = 0; k < 3; ++k) p[k] = s[k] * (p[k] / length);\n";
  }
  throw UserError("no program can be written for a shape of kind " + std::string(shapeKindName(shape.kind)));
}

std::string coreBody(const ShapeView<3>& shape) {
  const auto half = [&](int k) { return literal(static_cast<double>(shape.half[k])); };
  switch (shape.core()) {
    case CoreClass::point:
      return "  (void)d, p[0] = p[1] = p[2] = 0;\n";
    case CoreClass::segment:
      return "  " + coordinate(0, half(0)) + ", p[1] = p[2] = 0;\n";
    case CoreClass::box:
      return "  " + coordinate(0, half(0)) + ", " + coordinate(1, half(1)) + ", " + coordinate(2, half(2)) + ";\n";
    case CoreClass::hull: {
      std::string vertices;
      for (const Vec<3>& v : shape.hull->vertices) {
        vertices += (vertices.empty() ? "{" : ", {") + literals(v.cast<double>()) + "}";
      }
      return "  static const double vertices[][3] = {" + vertices + "};\n" +
             "  double most = -INFINITY;\n"
             "  for (const auto& v : vertices) {\n"
             "    const double dot = v[0] * d[0] + v[1] * d[1] + v[2] * d[2];\n"
             "    if (dot > most) most = dot, p[0] = v[0], p[1] = v[1], p[2] = v[2];\n"
             "  }\n";
    }
    case CoreClass::curved:
      return curvedBody(shape);
    case CoreClass::plane:  // unbounded: there is no support point
      break;
  }
  throw UserError("no program can be written for a shape of kind " + std::string(shapeKindName(shape.kind)));
}

}  // namespace

std::string literal(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string literals(const Eigen::MatrixXd& m) {
  std::string out;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) out += (out.empty() ? "" : ", ") + literal(m(i, j));
  }
  return out;
}

std::string coreSupportText(const std::string& name, const ShapeView<3>& shape) {
  return "static void " + name + "(const double* d, double* p) {\n" + coreBody(shape) + "}\n";
}

bool Question::isRight(double distance) const {
  if (std::isinf(distance)) return distance > 0 ? truth.hi >= -allowed : truth.lo <= allowed;
  return distance >= truth.lo - allowed && distance <= truth.hi + allowed;
}

std::string Question::program(const std::string& title) const {
  return title + snippet.head + "\nint main() {\n" + snippet.body +
         "  // The true signed distance is proved to lie in [lo, hi]; `allowed` covers rounding.\n"
         "  const double lo = " +
         literal(truth.lo) + ", hi = " + literal(truth.hi) + ", allowed = " + literal(allowed) +
         ";\n"
         "  const bool apart = distance == INFINITY, overlapping = distance == -INFINITY;  // without a distance\n"
         "  const bool right = apart ? hi >= -allowed : overlapping ? lo <= allowed\n"
         "                           : distance >= lo - allowed && distance <= hi + allowed;\n"
         "  std::printf(\"answer %.17g, truth [%.17g, %.17g]: %s\\n\", distance, lo, hi, right ? \"right\" : "
         "\"WRONG\");\n"
         "  return right ? 0 : 1;\n"
         "}\n";
}

}}  // namespace lpc::LPC_PRECISION
