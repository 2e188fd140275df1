// SPDX-License-Identifier: Zlib
// Bullet in double precision: Debian builds the library twice, and this file is compiled for the one whose btScalar is
// double. The usual one computes in float and is no witness for the last ten digits.
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

#include "framework/curved_core.h"
#include "oracles/adapter.h"
#include "oracles/prisms.h"

namespace lpc::inline LPC_PRECISION {
namespace {

static_assert(sizeof(btScalar) == sizeof(double), "BT_USE_DOUBLE_PRECISION and the -float64 libraries");

btVector3 vector(const Vec<3>& v) { return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])}; }
Eigen::Vector3d vectorOf(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform transform(const Pose<3>& X) {
  const Eigen::Matrix3d r = X.q.matrix().cast<double>();
  return btTransform({r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}, vector(X.p));
}

// A curved core by its support function: Bullet adds the margin.
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

// Bullet rounds every shape by its margin, 4 cm unless told. Ours is the shape's own radius, around the core: Bullet's
// boxes count their margin into the half extents.
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

// Bullet's normals point from B to A, its points lie on B.
PairAnswer<3> answerOf(const btPointCollector& found, double roundingA, double roundingB) {
  const Eigen::Vector3d normal = -vectorOf(found.m_normalOnBInWorld), onB = vectorOf(found.m_pointInWorld);
  const double depth = -found.m_distance;
  return depthAnswer(depth, normal, onB + depth / 2 * normal, roundingA, roundingB);
}

template <int D>
class BulletGjkEpa final : public IsolatedWitness {
 public:
  using Params = NoParams;
  explicit BulletGjkEpa(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "bullet_gjk_epa",
            .summary = "Bullet's btGjkPairDetector with its EPA as depth solver, in double precision",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "boxes of equal orientation, one deep in the other",
                          .symptom = "a depth that is too small, along no separating direction (0.346 for 0.5)",
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
    m_input.m_transformA.setIdentity(), m_input.m_transformB = transform(pair.X_AB);
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

  std::unique_ptr<btConvexShape> m_a, m_b;
  btGjkPairDetector::ClosestPointInput m_input;
};

template <int D>
class BulletBoxBox final : public IsolatedWitness {
 public:
  using Params = NoParams;
  explicit BulletBoxBox(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "bullet_box_box",
            .summary = "Bullet's btBoxBoxDetector: separating axes of ODE, depths only, in double precision",
            .paper = "",
            .complexity = "15 axes",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "the least depth is between two edges, by less than 5 %",
                          .symptom = "the depth of a face: the two are weighed 1 to 1.05",
                          .test = "Witnesses.BulletBoxBoxPrefersFaces"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{box, box, 3e-3}};
    return kBars;
  }

 private:
  // The cores without a margin: this detector takes a margin for a part of a sharp box.
  void place(const PairView<3>& pair) override {
    m_a.emplace(vector(pair.a.half)), m_b.emplace(vector(pair.b.half));
    m_a->setMargin(0), m_b->setMargin(0);
    m_input.m_transformA.setIdentity(), m_input.m_transformB = transform(pair.X_AB);
    m_roundingA = static_cast<double>(pair.a.radius), m_roundingB = static_cast<double>(pair.b.radius);
  }
  PairAnswer<3> measure() override {
    btBoxBoxDetector detector(&*m_a, &*m_b);
    btPointCollector found;  // keeps the deepest of up to eight
    detector.getClosestPoints(m_input, found, nullptr);
    if (!found.m_hasResult) return apartAnswer(m_roundingA + m_roundingB);
    return answerOf(found, m_roundingA, m_roundingB);
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

}  // namespace lpc::inline LPC_PRECISION
