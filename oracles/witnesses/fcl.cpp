// SPDX-License-Identifier: Zlib
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "oracles/witnesses/adapter.h"
#include "oracles/witnesses/prisms.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometry<double>>;
using Transform = fcl::Transform3<double>;

Geometry convex(const Polytope<3>& hull) {
  auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>();
  for (const Vec<3>& v : hull.vertices) vertices->push_back(v.cast<double>());
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& f : hull.faces) {
    faces->push_back(f.end - f.begin);
    for (int i = f.begin; i < f.end; ++i) faces->push_back(hull.loop[static_cast<std::size_t>(i)]);
  }
  return std::make_shared<fcl::Convex<double>>(vertices, static_cast<int>(hull.faces.size()), faces);
}

// A shape in FCL's terms. FCL has no rounding of boxes and polytopes: their cores are queried, and `rounding` is
// subtracted from the distance, which is exact.
struct FclPlaced {
  Geometry geometry;
  Transform X_WS = Transform::Identity();
  double rounding = 0;

  void place(const ShapeView<3>& shape, const Pose<3>& pose) {
    X_WS.linear() = pose.q.matrix().cast<double>(), X_WS.translation() = pose.p.cast<double>();
    rounding = 0;
    const auto lieAlongX = [&] { X_WS.linear() = X_WS.linear() * turnFromZ(); };
    switch (shape.kind) {
      case ShapeKind::sphere:
        geometry = std::make_shared<fcl::Sphere<double>>(shape.radius);
        break;
      case ShapeKind::capsule:
      case ShapeKind::segment:
        geometry = std::make_shared<fcl::Capsule<double>>(shape.radius, 2 * shape.half[0]);
        lieAlongX();
        break;
      case ShapeKind::box:
        geometry = std::make_shared<fcl::Box<double>>(2 * shape.half.cast<double>());
        rounding = shape.radius;
        break;
      case ShapeKind::polytope:
        geometry = convex(*shape.hull);
        rounding = shape.radius;
        break;
      case ShapeKind::cylinder:
        geometry = std::make_shared<fcl::Cylinder<double>>(shape.half[1], 2 * shape.half[0]);
        lieAlongX();
        rounding = shape.radius;
        break;
      case ShapeKind::ellipsoid:
        geometry = std::make_shared<fcl::Ellipsoid<double>>(shape.half[0], shape.half[1], shape.half[2]);
        rounding = shape.radius;
        break;
      case ShapeKind::cone:  // centred at half its height, tip up, as ours
        geometry = std::make_shared<fcl::Cone<double>>(shape.half[1], 2 * shape.half[0]);
        lieAlongX();
        rounding = shape.radius;
        break;
      default:  // errorBars() has no pair of other kinds: unsupported, never queried
        break;
    }
  }
};

// The same as text of a program: `a` and its pose `xa`, or `b`.
std::string fclPlaced(const std::string& name, const ShapeView<3>& shape, const Pose<3>& X, double& rounding) {
  const std::string radius = literal(static_cast<double>(shape.radius));
  const Eigen::Vector3d half = shape.half.cast<double>();
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = X.q.matrix().cast<double>(), pose.topRightCorner<3, 1>() = X.p.cast<double>();
  std::string out, type, sizes;
  if (shape.kind == ShapeKind::sphere) {
    type = "Sphere", sizes = radius;
  } else if (shape.kind == ShapeKind::capsule || shape.kind == ShapeKind::segment) {
    type = "Capsule", sizes = radius + ", " + literal(2 * half[0]);
  } else if (shape.kind == ShapeKind::box) {
    type = "Box", sizes = literals(2 * half.transpose());
  } else if (shape.kind == ShapeKind::cylinder) {
    type = "Cylinder", sizes = literal(half[1]) + ", " + literal(2 * half[0]);
  } else if (shape.kind == ShapeKind::cone) {
    type = "Cone", sizes = literal(half[1]) + ", " + literal(2 * half[0]);
  } else if (shape.kind == ShapeKind::ellipsoid) {
    type = "Ellipsoid", sizes = literals(half.transpose());
  } else {
    std::string vertices, faces;
    for (const Vec<3>& v : shape.hull->vertices) {
      vertices += (vertices.empty() ? "{" : ", {") + literals(v.cast<double>()) + "}";
    }
    for (const auto& f : shape.hull->faces) {
      faces += (faces.empty() ? "" : ", ") + std::to_string(f.end - f.begin);
      for (int i = f.begin; i < f.end; ++i)
        faces += ", " + std::to_string(shape.hull->loop[static_cast<std::size_t>(i)]);
    }
    out = "  const std::vector<Eigen::Vector3d> vertices_" + name + " = {" + vertices + "};\n" +
          "  const std::vector<int> faces_" + name + " = {" + faces + "};  // corners of each, and which\n";
    type = "Convex";
    sizes = "std::make_shared<std::vector<Eigen::Vector3d>>(vertices_" + name + "), " +
            std::to_string(shape.hull->faces.size()) + ", std::make_shared<std::vector<int>>(faces_" + name + ")";
  }
  const bool alongZ =
      shape.core() == CoreClass::segment || shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone;
  if (alongZ) pose.topLeftCorner<3, 3>() = pose.topLeftCorner<3, 3>().eval() * turnFromZ();
  if (shape.core() != CoreClass::point && shape.core() != CoreClass::segment) {
    rounding += static_cast<double>(shape.radius);
  }
  return out + "  fcl::" + type + "<double> " + name + "(" + sizes + ");\n  fcl::Transform3<double> x" + name +
         ";\n  x" + name + ".matrix() << " + literals(pose) + ";\n";
}

// Shared by the three FCL witnesses.
template <int D>
class FclWitness : public IsolatedWitness<3> {
 public:
  struct Params : PairFrameParams {
    Real tolerance = Real(1e-6);
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, Real(1e-14), 1, "1",
             "tolerance of FCL's GJK and EPA; FCL's distance aborts on spheres at 1e-10", ParamRole::tolerance);
      PairFrameParams::visit(v);
    }
  };
  explicit FclWitness(const Params& params) : IsolatedWitness<3>(params.frame), m_params(params) {}

 protected:
  void place(const PairView<3>& pair) override { m_a.place(pair.a, placeOfA()), m_b.place(pair.b, placeOfB(pair)); }

  PairAnswer<3> distance(fcl::GJKSolverType solver, bool isSigned) const {
    fcl::DistanceRequest<double> request(true, isSigned);
    request.gjk_solver_type = solver;
    request.distance_tolerance = static_cast<double>(m_params.tolerance);
    fcl::DistanceResult<double> result;
    const double distance = fcl::distance(m_a.geometry.get(), m_a.X_WS, m_b.geometry.get(), m_b.X_WS, request, result);
    PairAnswer<3> answer;
    // The unsigned distance of an overlap is -1, without a depth.
    answer.status = distance < 0 && !isSigned ? QueryStatus::failed : QueryStatus::converged;
    answer.distance = static_cast<Real>(distance - m_a.rounding - m_b.rounding);
    Eigen::Vector3d n = result.nearest_points[1] - result.nearest_points[0];
    if (distance < 0) n = -n;
    const double length = n.norm();
    if (length > 0) answer.normal = (n / length).cast<Real>();  // FCL gives no normal at a touch
    answer.pA = result.nearest_points[0].cast<Real>() + static_cast<Real>(m_a.rounding) * answer.normal;
    answer.pB = result.nearest_points[1].cast<Real>() - static_cast<Real>(m_b.rounding) * answer.normal;
    return answer;
  }

  PairAnswer<3> collide(fcl::GJKSolverType solver) const {
    constexpr std::size_t kContacts = 8;  // more than a box pair makes; the deepest is used
    fcl::CollisionRequest<double> request(kContacts, true);
    request.gjk_solver_type = solver;
    request.gjk_tolerance = static_cast<double>(m_params.tolerance);
    fcl::CollisionResult<double> result;
    fcl::collide(m_a.geometry.get(), m_a.X_WS, m_b.geometry.get(), m_b.X_WS, request, result);
    if (!result.isCollision()) return apartAnswer<3>(m_a.rounding + m_b.rounding);
    // GST_INDEP reports minus the depth when its EPA answers, and the depth when a closed form does.
    const auto depth = [&](std::size_t i) { return std::abs(result.getContact(i).penetration_depth); };
    std::size_t deepest = 0;
    for (std::size_t i = 1; i < result.numContacts(); ++i) {
      if (depth(i) > depth(deepest)) deepest = i;
    }
    const fcl::Contact<double>& contact = result.getContact(deepest);
    return depthAnswer<3>(depth(deepest), contact.normal, contact.pos, m_a.rounding, m_b.rounding);
  }

  // `ask`: the statements that set `distance`; an exception leaves it unchanged.
  Snippet program(const PairView<3>& pair, const std::string& ask) const {
    Snippet out{.flags = "-I/usr/include/eigen3 -lfcl -lccd"};
    out.head =
        "#include <fcl/narrowphase/collision.h>\n#include <fcl/narrowphase/distance.h>\n\n"
        "#include <cmath>\n#include <cstdio>\n#include <exception>\n";
    out.body = fclPlaced("a", pair.a, placeOfA(), out.rounding) + fclPlaced("b", pair.b, placeOfB(pair), out.rounding) +
               "  double distance = NAN;\n"
               "  bool known = false;  // points and normals are finite\n"
               "  try {\n" +
               ask +
               "  } catch (const std::exception& error) {\n"
               "    std::printf(\"it throws: %s\\n\", error.what());\n"
               "  }\n"
               "  if (!known) distance = NAN;\n";
    return out;
  }
  std::string distanceText(const std::string& solver, bool isSigned) const {
    return "    fcl::DistanceRequest<double> request(true, " + std::string(isSigned ? "true" : "false") + ");\n" +
           "    request.gjk_solver_type = fcl::" + solver + ";\n" + "    request.distance_tolerance = " + tolerance() +
           ";\n" +
           "    fcl::DistanceResult<double> result;\n"
           "    distance = fcl::distance(&a, xa, &b, xb, request, result);\n"
           "    known = (result.nearest_points[0] + result.nearest_points[1]).allFinite();\n";
  }
  std::string collideText(const std::string& solver, const std::string& otherwise) const {
    return "    fcl::CollisionRequest<double> asked(8, true);\n"
           "    asked.gjk_solver_type = fcl::" +
           solver + ";\n" + "    asked.gjk_tolerance = " + tolerance() + ";\n" +
           "    fcl::CollisionResult<double> found;\n"
           "    fcl::collide(&a, xa, &b, xb, asked, found);\n"
           "    const auto depth = [&](std::size_t i) { return std::fabs(found.getContact(i).penetration_depth); };\n"
           "    std::size_t deepest = 0;\n"
           "    for (std::size_t i = 1; i < found.numContacts(); ++i) {\n"
           "      if (depth(i) > depth(deepest)) deepest = i;\n"
           "    }\n"
           "    distance = found.isCollision() ? -depth(deepest) : " +
           otherwise + ";\n" +
           "    known = !found.isCollision() || (found.getContact(deepest).normal + "
           "found.getContact(deepest).pos).allFinite();\n";
  }

 private:
  std::string tolerance() const { return literal(static_cast<double>(m_params.tolerance)); }

  Params m_params;
  FclPlaced m_a, m_b;
};

template <int D>
class FclLibccd final : public FclWitness<D> {
 public:
  using FclWitness<D>::FclWitness;
  using typename FclWitness<D>::Params;

  static AlgorithmInfo info() {
    return {.name = "fcl_libccd",
            .summary = "FCL's signed distance with its libccd solver: libccd's GJK, and its EPA with FCL's fixes",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "two separated boxes, closest at an edge and a face",
                          .symptom = "the distance is too large (FCL issue 508: 3.16228 for 3)",
                          .test = "Witnesses.FclDistanceOfCubesIsWrong"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {
        ErrorBar{sphere, sphere, 9e-7},      ErrorBar{sphere, capsule, 5e-6},     ErrorBar{sphere, box, 2e-6},
        ErrorBar{sphere, polytope, 7e-7},    ErrorBar{capsule, capsule, 6e-6},    ErrorBar{capsule, box, 4e-6},
        ErrorBar{capsule, polytope, 3e-6},   ErrorBar{box, box, 1e-15},           ErrorBar{box, polytope, 1e-15},
        ErrorBar{polytope, polytope, 1e-15}, ErrorBar{sphere, cylinder, 2e-5},    ErrorBar{capsule, cylinder, 6e-6},
        ErrorBar{box, cylinder, 4e-6},       ErrorBar{polytope, cylinder, 3e-6},  ErrorBar{cylinder, cylinder, 7e-6},
        ErrorBar{sphere, ellipsoid, 5e-5},   ErrorBar{capsule, ellipsoid, 2e-5},  ErrorBar{box, ellipsoid, 5e-6},
        ErrorBar{polytope, ellipsoid, 6e-6}, ErrorBar{cylinder, ellipsoid, 6e-6}, ErrorBar{ellipsoid, ellipsoid, 7e-6},
        ErrorBar{sphere, cone, 5e-6},        ErrorBar{capsule, cone, 5e-6},       ErrorBar{box, cone, 6e-7},
        ErrorBar{polytope, cone, 2e-6},      ErrorBar{cylinder, cone, 4e-6},      ErrorBar{ellipsoid, cone, 7e-6},
        ErrorBar{cone, cone, 3e-6}};
    return kBars;
  }

 private:
  PairAnswer<3> measure() override { return this->distance(fcl::GST_LIBCCD, true); }
  Snippet snippet(const PairView<3>& pair) const override {
    return this->program(pair, this->distanceText("GST_LIBCCD", true));
  }
};

template <int D>
class FclLibccdCollide final : public FclWitness<D> {
 public:
  using FclWitness<D>::FclWitness;
  using typename FclWitness<D>::Params;

  static AlgorithmInfo info() {
    return {
        .name = "fcl_libccd_collide",
        .summary =
            "FCL's collide with its libccd solver: portal refinement; closed forms for spheres, ODE's test for boxes",
        .paper = "",
        .complexity = "5 to 20 support points",
        .guarantee = Guarantee::approximate,
        .failures = {{.when = "the least depth is not along the line of centres",
                      .symptom = "the depth is too large, up to many times the least",
                      .test = "Witnesses.FclCollideDepthIsNotMinimal"}},
        .role = AlgorithmRole::witness};
  }
  bool claimsGap(ShapeKind, ShapeKind) const override { return false; }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 1e-15},      ErrorBar{sphere, capsule, 1e-15},
                                         ErrorBar{sphere, box, 1e-15},         ErrorBar{sphere, polytope, 2e-1},
                                         ErrorBar{capsule, capsule, 2e-1},     ErrorBar{capsule, box, 2e-1},
                                         ErrorBar{capsule, polytope, 2e-1},    ErrorBar{box, box, 3e-3},
                                         ErrorBar{box, polytope, 8e-2},        ErrorBar{polytope, polytope, 9e-2},
                                         ErrorBar{sphere, cylinder, 1e-15},    ErrorBar{capsule, cylinder, 2e-1},
                                         ErrorBar{box, cylinder, 2e-1},        ErrorBar{polytope, cylinder, 2e-1},
                                         ErrorBar{cylinder, cylinder, 2e-1},   ErrorBar{sphere, ellipsoid, 2e-1},
                                         ErrorBar{capsule, ellipsoid, 2e-1},   ErrorBar{box, ellipsoid, 2e-1},
                                         ErrorBar{polytope, ellipsoid, 1e-1},  ErrorBar{cylinder, ellipsoid, 2e-1},
                                         ErrorBar{ellipsoid, ellipsoid, 2e-1}, ErrorBar{sphere, cone, 2e-1},
                                         ErrorBar{capsule, cone, 3e-1},        ErrorBar{box, cone, 3e-1},
                                         ErrorBar{polytope, cone, 1e-1},       ErrorBar{cylinder, cone, 2e-1},
                                         ErrorBar{ellipsoid, cone, 2e-1},      ErrorBar{cone, cone, 2e-1}};
    return kBars;
  }

 private:
  PairAnswer<3> measure() override { return this->collide(fcl::GST_LIBCCD); }
  Snippet snippet(const PairView<3>& pair) const override {
    return this->program(pair, this->collideText("GST_LIBCCD", "INFINITY"));
  }
};

// Two calls, because this solver has no signed distance.
template <int D>
class FclIndep final : public FclWitness<D> {
 public:
  using FclWitness<D>::FclWitness;
  using typename FclWitness<D>::Params;

  static AlgorithmInfo info() {
    return {.name = "fcl_indep",
            .summary = "FCL's own GJK for the distance; its own EPA (collide) for overlapping shapes",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "capsules, cones or polytopes that overlap deeply",
                          .symptom = "EPA stops early: the depth is off by up to a third of the size",
                          .test = "Witnesses.FclIndepDepthOfCapsulesIsOff"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 1e-15},      ErrorBar{sphere, capsule, 1e-15},
                                         ErrorBar{sphere, box, 1e-15},         ErrorBar{sphere, polytope, 1e-1},
                                         ErrorBar{capsule, capsule, 2e-1},     ErrorBar{capsule, box, 2e-1},
                                         ErrorBar{capsule, polytope, 1e-1},    ErrorBar{box, box, 5e-3},
                                         ErrorBar{box, polytope, 7e-2},        ErrorBar{polytope, polytope, 6e-2},
                                         ErrorBar{sphere, cylinder, 1e-15},    ErrorBar{capsule, cylinder, 2e-1},
                                         ErrorBar{box, cylinder, 2e-1},        ErrorBar{polytope, cylinder, 2e-1},
                                         ErrorBar{cylinder, cylinder, 3e-1},   ErrorBar{sphere, ellipsoid, 2e-1},
                                         ErrorBar{capsule, ellipsoid, 2e-1},   ErrorBar{box, ellipsoid, 2e-1},
                                         ErrorBar{polytope, ellipsoid, 2e-1},  ErrorBar{cylinder, ellipsoid, 3e-1},
                                         ErrorBar{ellipsoid, ellipsoid, 3e-1}, ErrorBar{sphere, cone, 3e-1},
                                         ErrorBar{capsule, cone, 2e-1},        ErrorBar{box, cone, 1e-1},
                                         ErrorBar{polytope, cone, 8e-2},       ErrorBar{cylinder, cone, 2e-1},
                                         ErrorBar{ellipsoid, cone, 2e-1},      ErrorBar{cone, cone, 2e-1}};
    return kBars;
  }

 private:
  PairAnswer<3> measure() override {
    const PairAnswer<3> apart = this->distance(fcl::GST_INDEP, false);
    if (apart.status == QueryStatus::converged) return apart;
    const PairAnswer<3> overlap = this->collide(fcl::GST_INDEP);
    return overlap.status == QueryStatus::converged ? overlap : apart;  // neither separated nor in contact: no value
  }
  Snippet snippet(const PairView<3>& pair) const override {
    return this->program(pair, this->distanceText("GST_INDEP", false) +
                                   "    if (distance < 0) {  // overlap: collide gives the depth\n" +
                                   this->collideText("GST_INDEP", "NAN") + "    }\n");
  }
};

// Circles are excluded: as capsules along z they take 0.1 s per pair, and some never end.
template <>
class FclLibccd<2> final : public Prisms<FclLibccd<3>> {
 public:
  using Prisms::Prisms;
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{box, box, 1e-15}, ErrorBar{box, polytope, 1e-15},
                                         ErrorBar{polytope, polytope, 1e-15}};
    return kBars;
  }
};

}  // namespace

LPC_REGISTER(PairQuery, FclLibccd, 2, 3);
LPC_REGISTER(PairQuery, FclLibccdCollide, 3);
LPC_REGISTER(PairQuery, FclIndep, 3);

}}  // namespace lpc::LPC_PRECISION
