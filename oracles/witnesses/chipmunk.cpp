// SPDX-License-Identifier: Zlib
// Chipmunk 7 in double precision, as Debian builds it: all our bounded 2D kinds, rounding included. It has a signed
// distance of a circle from every shape; other pairs have contacts only.
#include <chipmunk/chipmunk.h>

#include <array>

#include "oracles/witnesses/adapter.h"
#include "oracles/witnesses/witness_process.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

static_assert(sizeof(cpFloat) == sizeof(double), "the witness is Chipmunk's double precision build");

cpVect chipmunkVector(const Vec<2>& v) { return {static_cast<double>(v[0]), static_cast<double>(v[1])}; }
Eigen::Vector2d vectorOf(const cpVect& v) { return {v.x, v.y}; }

class ChipmunkPlaced {
 public:
  ChipmunkPlaced() = default;
  ~ChipmunkPlaced() {
    clear();
    if (m_body) cpBodyFree(m_body);
  }
  ChipmunkPlaced(const ChipmunkPlaced&) = delete;
  ChipmunkPlaced& operator=(const ChipmunkPlaced&) = delete;

  const cpShape* shape() const { return m_shape; }

  void place(const ShapeView<2>& shape, const Pose<2>& X) {
    clear();
    if (!m_body) m_body = cpBodyNewStatic();  // its pose is not used
    const double radius = static_cast<double>(shape.radius);
    const cpVect half = chipmunkVector(shape.half);
    switch (shape.core()) {
      case CoreClass::point:
        m_shape = cpCircleShapeNew(m_body, radius, cpvzero);
        break;
      case CoreClass::segment:
        m_shape = cpSegmentShapeNew(m_body, cpv(-half.x, 0), cpv(half.x, 0), radius);
        break;
      case CoreClass::box:
        m_shape = cpBoxShapeNew(m_body, 2 * half.x, 2 * half.y, radius);
        break;
      case CoreClass::hull: {
        std::vector<cpVect> corners;
        for (const Vec<2>& v : shape.hull->vertices) corners.push_back(chipmunkVector(v));
        m_shape = cpPolyShapeNewRaw(m_body, static_cast<int>(corners.size()), corners.data(), radius);
        break;
      }
      case CoreClass::curved:
      case CoreClass::plane:  // not in the table of kinds
        return;
    }
    const double c = static_cast<double>(X.q.c), s = static_cast<double>(X.q.s);
    const cpVect p = chipmunkVector(X.p);
    cpShapeUpdate(m_shape, cpTransformNewTranspose(c, -s, p.x, s, c, p.y));
  }

 private:
  void clear() {
    if (m_shape) cpShapeFree(m_shape);
    m_shape = nullptr;
  }

  cpBody* m_body = nullptr;
  cpShape* m_shape = nullptr;
};

template <int D>
class Chipmunk final : public IsolatedWitness<2> {
 public:
  using Params = PairFrameParams;
  explicit Chipmunk(const Params& params) : IsolatedWitness<2>(params.frame) {}

  static AlgorithmInfo info() {
    return {.name = "chipmunk",
            .summary = "deepest contact of Chipmunk's cpShapesCollide; cpShapePointQuery for circles; double precision",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "two equal shapes at the same pose",
                          .symptom = "depth 0 without a direction",
                          .test = "Witnesses.ChipmunkHasNoDepthInTheSamePlace"},
                         {.when = "collinear capsules that overlap end to end",
                          .symptom = "the depth of capsules with crossing axes (0.5 for 0.1)",
                          .test = "Witnesses.ChipmunkCapsulesOnOneLineAreTooDeep"},
                         {.when = "a circle's centre on the axis of a rotated capsule",
                          .symptom = "the normal is not rotated with the capsule",
                          .test = "Witnesses.ChipmunkForgetsTheTurnOfACapsule"}},
            .role = AlgorithmRole::witness};
  }
  bool claimsGap(ShapeKind a, ShapeKind) const override { return coreClass(a) == CoreClass::point; }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {
        ErrorBar{sphere, sphere, 1e-15},   ErrorBar{sphere, capsule, 1e-15},  ErrorBar{sphere, segment, 1e-15},
        ErrorBar{sphere, box, 1e-15},      ErrorBar{sphere, polytope, 1e-15}, ErrorBar{capsule, capsule, 1e-15},
        ErrorBar{capsule, segment, 1e-15}, ErrorBar{capsule, box, 1e-15},     ErrorBar{capsule, polytope, 1e-15},
        ErrorBar{segment, segment, 1e-15}, ErrorBar{segment, box, 1e-15},     ErrorBar{segment, polytope, 1e-15},
        ErrorBar{box, box, 1e-15},         ErrorBar{box, polytope, 1e-15},    ErrorBar{polytope, polytope, 1e-15}};
    return kBars;
  }

 private:
  void place(const PairView<2>& pair) override {
    m_a.place(pair.a, placeOfA()), m_b.place(pair.b, placeOfB(pair));
    m_isCircle = pair.a.core() == CoreClass::point;  // circles are the first of the kinds
    m_radius = static_cast<double>(pair.a.radius);
  }

  PairAnswer<2> measure() override { return m_isCircle ? fromCentre() : collide(); }

  // Chipmunk's point on B is not used: it is 0 / 0 when the centre is on B's surface. The contacts of circles are not
  // used either. On a rounded polygon they are too shallow by twice its rounding, because CircleToPoly also adds it
  // along the normal to the polygon's point.
  PairAnswer<2> fromCentre() const {
    cpPointQueryInfo nearest;
    const cpVect centre = chipmunkVector(placeOfA().p);
    cpShapePointQuery(m_b.shape(), centre, &nearest);
    const Eigen::Vector2d normal = -vectorOf(nearest.gradient);
    return depthAnswer<2>(m_radius - nearest.distance, normal,
                          vectorOf(centre) + (m_radius + nearest.distance) / 2 * normal, 0, 0);
  }

  PairAnswer<2> collide() const {
    const cpContactPointSet found = cpShapesCollide(m_a.shape(), m_b.shape());
    if (found.count == 0) return apartAnswer<2>(0);
    // Use the points: Chipmunk's own `distance` has the wrong sign when it has swapped the shapes.
    const Eigen::Vector2d normal = vectorOf(found.normal);
    double depth = -std::numeric_limits<double>::infinity();
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (int i = 0; i < found.count; ++i) {
      const Eigen::Vector2d onA = vectorOf(found.points[i].pointA), onB = vectorOf(found.points[i].pointB);
      if (const double d = (onA - onB).dot(normal); d > depth) depth = d, middle = (onA + onB) / 2;
    }
    return depthAnswer<2>(depth, normal, middle, 0, 0);
  }

  Snippet snippet(const PairView<2>& pair) const override {
    Snippet out{.flags = "-lchipmunk", .head = "#include <chipmunk/chipmunk.h>\n#include <cmath>\n#include <cstdio>\n"};
    out.body = "  cpBody* body = cpBodyNewStatic();  // its pose is not used\n";
    if (pair.a.core() == CoreClass::point) {
      const Vec<2> centre = placeOfA().p;
      out.body += placed("b", pair.b, placeOfB(pair)) +
                  "  cpPointQueryInfo nearest;\n"
                  "  cpShapePointQuery(b, cpv(" +
                  literals(centre.cast<double>().transpose()) +
                  "), &nearest);  // the circle's centre\n"
                  "  double distance = nearest.distance - " +
                  literal(static_cast<double>(pair.a.radius)) +
                  ";\n"
                  "  if (!std::isfinite(nearest.gradient.x + nearest.gradient.y)) distance = NAN;  // no answer\n";
      return out;
    }
    out.body +=
        placed("a", pair.a, placeOfA()) + placed("b", pair.b, placeOfB(pair)) +
        "  const cpContactPointSet found = cpShapesCollide(a, b);\n"
        "  double depth = -INFINITY;  // from the points: `distance` has the wrong sign when shapes are swapped\n"
        "  for (int i = 0; i < found.count; ++i) {\n"
        "    const cpVect along = cpvsub(found.points[i].pointA, found.points[i].pointB);\n"
        "    depth = std::fmax(depth, cpvdot(along, found.normal));\n"
        "  }\n"
        "  double distance = found.count > 0 ? -depth : INFINITY;  // infinite: apart\n"
        "  if (found.count > 0 && !std::isfinite(depth)) distance = NAN;  // no answer\n";
    return out;
  }
  // The same as ChipmunkPlaced.
  static std::string placed(const std::string& name, const ShapeView<2>& shape, const Pose<2>& X) {
    const std::string radius = literal(static_cast<double>(shape.radius));
    std::string corners, made;
    if (shape.core() == CoreClass::point) {
      made = "cpCircleShapeNew(body, " + radius + ", cpvzero)";
    } else if (shape.core() == CoreClass::segment) {
      const std::string half = literal(static_cast<double>(shape.half[0]));
      made = "cpSegmentShapeNew(body, cpv(-" + half + ", 0), cpv(" + half + ", 0), " + radius + ")";
    } else if (shape.core() == CoreClass::box) {
      made = "cpBoxShapeNew(body, " + literals(2 * shape.half.cast<double>().transpose()) + ", " + radius + ")";
    } else {
      for (const Vec<2>& v : shape.hull->vertices) {
        corners += (corners.empty() ? "{" : ", {") + literals(v.cast<double>().transpose()) + "}";
      }
      corners = "  const cpVect corners_" + name + "[] = {" + corners + "};\n";
      made = "cpPolyShapeNewRaw(body, " + std::to_string(shape.hull->vertices.size()) + ", corners_" + name + ", " +
             radius + ")";
    }
    const double c = static_cast<double>(X.q.c), s = static_cast<double>(X.q.s);
    const Eigen::Matrix<double, 1, 6> rows{c, -s, double(X.p[0]), s, c, double(X.p[1])};
    return corners + "  cpShape* " + name + " = " + made + ";\n  cpShapeUpdate(" + name + ", cpTransformNewTranspose(" +
           literals(rows) + "));\n";
  }

  ChipmunkPlaced m_a, m_b;
  bool m_isCircle = false;
  double m_radius = 0;
};

}  // namespace

LPC_REGISTER(PairQuery, Chipmunk, 2);

}}  // namespace lpc::LPC_PRECISION
