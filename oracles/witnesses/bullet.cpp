// SPDX-License-Identifier: Zlib
// Bullet in double precision: Debian builds the library twice, and this file is compiled for the build with double as
// btScalar. The usual one computes in float and cannot check the last ten digits.
#define BT_USE_DOUBLE_PRECISION
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <array>
#include <optional>

#include "framework/shape/curved_core.h"
#include "oracles/witnesses/adapter.h"
#include "oracles/witnesses/prisms.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

static_assert(sizeof(btScalar) == sizeof(double), "BT_USE_DOUBLE_PRECISION and the -float64 libraries");

btVector3 vector(const Vec<3>& v) { return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])}; }
Eigen::Vector3d vectorOf(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform transform(const Pose<3>& X) {
  const Eigen::Matrix3d r = X.q.matrix().cast<double>();
  return btTransform({r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}, vector(X.p));
}

// A curved core by its support function; Bullet adds the margin.
class CurvedShape final : public btConvexInternalShape {
 public:
  explicit CurvedShape(const ShapeView<3>& shape) : m_core(*shape.curved) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    setMargin(static_cast<double>(shape.radius));
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
    return vector(m_core.support(vectorOf(d).cast<Real>()));
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* d, btVector3* out, int count) const override {
    for (int i = 0; i < count; ++i) out[i] = localGetSupportingVertexWithoutMargin(d[i]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "curved"; }

 private:
  const CurvedCore<3>& m_core;
};

// Bullet rounds every shape by its margin, by default 4 cm. Our margin is the shape's own radius, around the core: the
// half extents of Bullet's boxes include the margin.
std::unique_ptr<btConvexShape> shapeOf(const ShapeView<3>& shape) {
  const double radius = static_cast<double>(shape.radius);
  switch (shape.core()) {
    case CoreClass::point:
      return std::make_unique<btSphereShape>(radius);
    case CoreClass::segment:
      return std::make_unique<btCapsuleShapeX>(radius, 2 * static_cast<double>(shape.half[0]));
    case CoreClass::box: {
      auto box = std::make_unique<btBoxShape>(vector(shape.half) + btVector3(radius, radius, radius));
      box->setMargin(radius);
      return box;
    }
    case CoreClass::curved:
      return std::make_unique<CurvedShape>(shape);
    case CoreClass::hull:
    case CoreClass::plane:  // not in the table of kinds
      break;
  }
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec<3>& v : shape.hull->vertices) hull->addPoint(vector(v), false);
  hull->recalcLocalAabb();
  hull->setMargin(radius);
  return hull;
}

// The same as text of a program: `a` or `b`. A curved core needs a class before `main`.
std::string bulletShape(const std::string& name, const ShapeView<3>& shape, std::string& head) {
  const double radius = static_cast<double>(shape.radius);
  const std::string margin = "  " + name + ".setMargin(" + literal(radius) + ");\n";
  const Eigen::Vector3d half = shape.half.cast<double>();
  switch (shape.core()) {
    case CoreClass::point:
      return "  btSphereShape " + name + "(" + literal(radius) + ");\n";
    case CoreClass::segment:
      return "  btCapsuleShapeX " + name + "(" + literal(radius) + ", " + literal(2 * half[0]) + ");\n";
    case CoreClass::box:
      return "  btBoxShape " + name + "(btVector3(" + literals((half.array() + radius).matrix()) + "));\n" + margin;
    case CoreClass::curved: {
      const std::string type = "Shape_" + name, core = "core_" + name;
      head += coreSupportText(core, shape) + "struct " + type + " : btConvexInternalShape {\n" + "  " + type +
              "() { m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE; }\n"
              "  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {\n"
              "    double p[3];\n"
              "    " +
              core + "(d, p);\n" +
              "    return btVector3(p[0], p[1], p[2]);\n"
              "  }\n"
              "  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* d, btVector3* p, int n) const "
              "override {\n"
              "    for (int i = 0; i < n; ++i) p[i] = localGetSupportingVertexWithoutMargin(d[i]);\n"
              "  }\n"
              "  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }\n"
              "  const char* getName() const override { return \"curved\"; }\n"
              "};\n";
      return "  " + type + " " + name + ";\n" + margin;
    }
    case CoreClass::hull:
    case CoreClass::plane:  // not in the table of kinds
      break;
  }
  std::string points;
  for (const Vec<3>& v : shape.hull->vertices) {
    points += (points.empty() ? "{" : ", {") + literals(v.cast<double>()) + "}";
  }
  return "  const btScalar points_" + name + "[][3] = {" + points + "};\n" + "  btConvexHullShape " + name + ";\n" +
         "  for (const auto& p : points_" + name + ") " + name + ".addPoint(btVector3(p[0], p[1], p[2]), false);\n" +
         "  " + name + ".recalcLocalAabb();\n" + margin;
}

std::string transformText(const Pose<3>& X) {
  return "btTransform(btMatrix3x3(" + literals(X.q.matrix().cast<double>()) + "), btVector3(" +
         literals(X.p.cast<double>()) + "))";
}

// `made`: the two shapes; `detector`: the detector to call.
Snippet bulletProgram(const Pose<3>& X_WA, const Pose<3>& X_WB, const std::string& head, const std::string& made,
                      const std::string& detector, const char* otherwise) {
  Snippet out{.flags =
                  "-DBT_USE_DOUBLE_PRECISION -I/usr/include/bullet -lBulletCollision-float64 -lLinearMath-float64"};
  out.head =
      "#include <btBulletCollisionCommon.h>\n#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>\n"
      "#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>\n"
      "#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>\n"
      "#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>\n"
      "#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>\n\n"
      "#include <cmath>\n#include <cstdio>\n" +
      head;
  out.body =
      made + detector +
      "  btDiscreteCollisionDetectorInterface::ClosestPointInput input;\n"
      "  input.m_transformA = " +
      transformText(X_WA) + ";\n" + "  input.m_transformB = " + transformText(X_WB) + ";\n" +
      "  btPointCollector found;\n"
      "  detector.getClosestPoints(input, found, nullptr);\n"
      "  double distance = found.m_hasResult ? found.m_distance : " +
      otherwise +
      ";\n"
      "  for (int i = 0; i < 3 && found.m_hasResult; ++i) {\n"
      "    if (!std::isfinite(found.m_normalOnBInWorld[i] + found.m_pointInWorld[i])) distance = NAN;  // no answer\n"
      "  }\n";
  return out;
}

// Bullet's normals point from B to A; its points are on B.
PairAnswer<3> answerOf(const btPointCollector& found, double roundingA, double roundingB) {
  const Eigen::Vector3d normal = -vectorOf(found.m_normalOnBInWorld), onB = vectorOf(found.m_pointInWorld);
  const double depth = -found.m_distance;
  return depthAnswer<3>(depth, normal, onB + depth / 2 * normal, roundingA, roundingB);
}

template <int D>
class BulletGjkEpa final : public IsolatedWitness<3> {
 public:
  using Params = PairFrameParams;
  explicit BulletGjkEpa(const Params& params) : IsolatedWitness<3>(params.frame) {}

  static AlgorithmInfo info() {
    return {.name = "bullet_gjk_epa",
            .summary = "Bullet's btGjkPairDetector with its EPA as depth solver; double precision",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures =
                {{.when = "boxes of equal orientation that overlap deeply",
                  .symptom =
                      "the depth is too small, and moving along its normal does not separate the boxes (0.346 for 0.5)",
                  .test = "Witnesses.BulletDepthOfAlignedBoxesIsOff"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {
        ErrorBar{sphere, sphere, 1e-15},     ErrorBar{sphere, capsule, 1e-15},    ErrorBar{sphere, box, 2e-13},
        ErrorBar{sphere, polytope, 2e-14},   ErrorBar{capsule, capsule, 8e-15},   ErrorBar{capsule, box, 2e-13},
        ErrorBar{capsule, polytope, 7e-14},  ErrorBar{box, box, 1e-13},           ErrorBar{box, polytope, 5e-14},
        ErrorBar{polytope, polytope, 7e-14}, ErrorBar{sphere, cylinder, 2e-6},    ErrorBar{capsule, cylinder, 3e-6},
        ErrorBar{box, cylinder, 2e-6},       ErrorBar{polytope, cylinder, 2e-6},  ErrorBar{cylinder, cylinder, 3e-5},
        ErrorBar{sphere, ellipsoid, 1e-1},   ErrorBar{capsule, ellipsoid, 1e-1},  ErrorBar{box, ellipsoid, 4e-5},
        ErrorBar{polytope, ellipsoid, 2e-5}, ErrorBar{cylinder, ellipsoid, 4e-2}, ErrorBar{ellipsoid, ellipsoid, 1e-1}};
    return kBars;
  }

 private:
  void place(const PairView<3>& pair) override {
    m_a = shapeOf(pair.a), m_b = shapeOf(pair.b);
    m_input.m_transformA = transform(placeOfA()), m_input.m_transformB = transform(placeOfB(pair));
  }
  PairAnswer<3> measure() override {
    btVoronoiSimplexSolver simplex;
    btGjkEpaPenetrationDepthSolver depth;
    btGjkPairDetector detector(m_a.get(), m_b.get(), &simplex, &depth);
    btPointCollector found;
    detector.getClosestPoints(m_input, found, nullptr);
    if (found.m_hasResult) return answerOf(found, 0, 0);
    PairAnswer<3> answer;
    answer.status = QueryStatus::failed;
    return answer;
  }
  Snippet snippet(const PairView<3>& pair) const override {
    std::string head;
    const std::string a = bulletShape("a", pair.a, head), b = bulletShape("b", pair.b, head);
    return bulletProgram(placeOfA(), placeOfB(pair), head, a + b,
                         "  btVoronoiSimplexSolver simplex;\n"
                         "  btGjkEpaPenetrationDepthSolver depth;\n"
                         "  btGjkPairDetector detector(&a, &b, &simplex, &depth);\n",
                         "NAN");
  }

  std::unique_ptr<btConvexShape> m_a, m_b;
  btGjkPairDetector::ClosestPointInput m_input;
};

template <int D>
class BulletBoxBox final : public IsolatedWitness<3> {
 public:
  using Params = PairFrameParams;
  explicit BulletBoxBox(const Params& params) : IsolatedWitness<3>(params.frame) {}

  static AlgorithmInfo info() {
    return {.name = "bullet_box_box",
            .summary = "Bullet's btBoxBoxDetector (ODE's separating axis test): depths only; double precision",
            .paper = "",
            .complexity = "15 axes",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "the least depth is between two edges, by less than 5 %",
                          .symptom = "the depth of a face is returned, because edges are weighted by 1.05",
                          .test = "Witnesses.BulletBoxBoxPrefersFaces"}},
            .role = AlgorithmRole::witness};
  }
  bool claimsGap(ShapeKind, ShapeKind) const override { return false; }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{box, box, 3e-3}};
    return kBars;
  }

 private:
  // Cores without a margin: this detector treats the margin as part of a sharp box.
  void place(const PairView<3>& pair) override {
    m_a.emplace(vector(pair.a.half)), m_b.emplace(vector(pair.b.half));
    m_a->setMargin(0), m_b->setMargin(0);
    m_input.m_transformA = transform(placeOfA()), m_input.m_transformB = transform(placeOfB(pair));
    m_roundingA = static_cast<double>(pair.a.radius), m_roundingB = static_cast<double>(pair.b.radius);
  }
  PairAnswer<3> measure() override {
    btBoxBoxDetector detector(&*m_a, &*m_b);
    btPointCollector found;  // keeps the deepest of up to eight points
    detector.getClosestPoints(m_input, found, nullptr);
    if (!found.m_hasResult) return apartAnswer<3>(m_roundingA + m_roundingB);
    return answerOf(found, m_roundingA, m_roundingB);
  }
  Snippet snippet(const PairView<3>& pair) const override {
    std::string none;
    PairView<3> cores = pair;
    cores.a.radius = cores.b.radius = 0;
    Snippet out =
        bulletProgram(placeOfA(), placeOfB(pair), "", bulletShape("a", cores.a, none) + bulletShape("b", cores.b, none),
                      "  btBoxBoxDetector detector(&a, &b);\n", "INFINITY");
    out.rounding = static_cast<double>(pair.a.radius) + static_cast<double>(pair.b.radius);
    return out;
  }

  std::optional<btBoxShape> m_a, m_b;
  double m_roundingA = 0, m_roundingB = 0;
  btBoxBoxDetector::ClosestPointInput m_input;
};

template <>
class BulletGjkEpa<2> final : public Prisms<BulletGjkEpa<3>> {
 public:
  using Prisms::Prisms;
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {
        ErrorBar{sphere, sphere, 1e-15},   ErrorBar{sphere, capsule, 1e-15},  ErrorBar{sphere, segment, 1e-15},
        ErrorBar{sphere, box, 7e-13},      ErrorBar{sphere, polytope, 4e-13}, ErrorBar{capsule, capsule, 6e-13},
        ErrorBar{capsule, segment, 8e-13}, ErrorBar{capsule, box, 6e-13},     ErrorBar{capsule, polytope, 6e-13},
        ErrorBar{segment, segment, 1e-15}, ErrorBar{segment, box, 4e-13},     ErrorBar{segment, polytope, 4e-14},
        ErrorBar{box, box, 4e-13},         ErrorBar{box, polytope, 2e-13},    ErrorBar{polytope, polytope, 9e-14}};
    return kBars;
  }
};

template <>
class BulletBoxBox<2> final : public Prisms<BulletBoxBox<3>> {
 public:
  using Prisms::Prisms;
  std::span<const ErrorBar> errorBars() const override {
    static constexpr std::array kBars = {ErrorBar{ShapeKind::box, ShapeKind::box, 1e-15}};
    return kBars;
  }
};

}  // namespace

LPC_REGISTER(PairQuery, BulletGjkEpa, 2, 3);
LPC_REGISTER(PairQuery, BulletBoxBox, 2, 3);

}}  // namespace lpc::LPC_PRECISION
