// SPDX-License-Identifier: Zlib
#include <ccd/ccd.h>

#include "framework/shape/support_map.h"
#include "oracles/witnesses/adapter.h"
#include "oracles/witnesses/prisms.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A whole shape for libccd, rounding included: a support function in the frame of the pair's first shape.
struct CcdPlaced {
  ShapeView<3> shape;
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

void setVector(ccd_vec3_t* out, const Eigen::Vector3d& v) { ccdVec3Set(out, v[0], v[1], v[2]); }
Eigen::Vector3d vectorOf(const ccd_vec3_t* v) { return {ccdVec3X(v), ccdVec3Y(v), ccdVec3Z(v)}; }

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& placed = *static_cast<const CcdPlaced*>(object);
  const Eigen::Vector3d d = vectorOf(direction), local = placed.r.transpose() * d;
  Eigen::Vector3d v = placed.r * coreSupport(placed.shape, Vec<3>(local.cast<Real>())).cast<double>() + placed.p;
  if (const double length = d.norm(); length > 0) v += double(placed.shape.radius) / length * d;
  setVector(out, v);
}

void center(const void* object, ccd_vec3_t* out) {
  const auto& placed = *static_cast<const CcdPlaced*>(object);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  if (placed.shape.hull) {
    for (const auto& v : placed.shape.hull->vertices) middle += v.cast<double>();
    middle /= double(placed.shape.hull->vertices.size());
  }
  setVector(out, placed.r * middle + placed.p);
}

// One of libccd's two methods, and its tolerance.
struct CcdMethod {
  int (*call)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);
  ccd_real_t ccd_t::*tolerance;
  std::string callName, toleranceName;  // names for the program
};

// libccd 2.1 computes depths only. For separated shapes it reports no distance.
class LibccdWitness : public IsolatedWitness<3> {
 public:
  LibccdWitness(PairFrame frame, const CcdMethod& method, Real tolerance)
      : IsolatedWitness<3>(frame), m_method(method), m_tolerance(tolerance) {}
  bool claimsGap(ShapeKind, ShapeKind) const override { return false; }

 private:
  void place(const PairView<3>& pair) override {
    m_a = placed(pair.a, placeOfA()), m_b = placed(pair.b, placeOfB(pair));
  }
  static CcdPlaced placed(const ShapeView<3>& shape, const Pose<3>& X) {
    return {shape, X.q.matrix().cast<double>(), X.p.cast<double>()};
  }
  PairAnswer<3> measure() override {
    ccd_t settings;
    CCD_INIT(&settings);
    settings.support1 = settings.support2 = support;
    settings.center1 = settings.center2 = center;  // not used by GJK
    settings.max_iterations = 500;                 // the default is unlimited
    settings.*m_method.tolerance = m_tolerance;
    ccd_real_t depth = 0;
    ccd_vec3_t direction, position;
    ccdVec3Set(&direction, 0, 0, 0), ccdVec3Set(&position, 0, 0, 0);
    const int result = m_method.call(&m_a, &m_b, &settings, &depth, &direction, &position);
    if (result == -1) return apartAnswer<3>(0);
    PairAnswer<3> answer = depthAnswer<3>(depth, vectorOf(&direction).normalized(), vectorOf(&position), 0, 0);
    if (result < -1) answer.status = QueryStatus::failed;  // out of memory
    return answer;
  }
  Snippet snippet(const PairView<3>& pair) const override {
    const CcdPlaced a = placed(pair.a, placeOfA()), b = placed(pair.b, placeOfB(pair));
    Snippet out{.flags = "-lccd -lm"};
    out.head =
        "#include <ccd/ccd.h>\n#include <cmath>\n#include <cstdio>\n\n"
        "// Support point of the core along d, in its own frame.\n" +
        coreSupportText("coreA", pair.a) + coreSupportText("coreB", pair.b) +
        "struct Shape {\n"
        "  void (*core)(const double*, double*);\n"
        "  double r[3][3], p[3], radius, middle[3];  // pose, radius around the core, interior point\n"
        "};\n"
        "static const Shape a = " +
        written("coreA", a) + ";\nstatic const Shape b = " + written("coreB", b) + ";\n" +
        "static void support(const void* shape, const ccd_vec3_t* dir, ccd_vec3_t* out) {\n"
        "  const Shape& s = *static_cast<const Shape*>(shape);\n"
        "  const double* d = dir->v;\n"
        "  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);\n"
        "  double local[3], v[3] = {0, 0, 0};\n"
        "  for (int i = 0; i < 3; ++i) local[i] = s.r[0][i] * d[0] + s.r[1][i] * d[1] + s.r[2][i] * d[2];\n"
        "  s.core(local, v);\n"
        "  for (int i = 0; i < 3; ++i) {\n"
        "    const double *r = s.r[i], x = r[0] * v[0], y = r[1] * v[1], z = r[2] * v[2];\n"
        "    out->v[i] = (i < 2 ? x + y + z : x + (y + z)) + s.p[i];  // in this order, for the same rounding\n"
        "    if (length > 0) out->v[i] += s.radius / length * d[i];\n"
        "  }\n"
        "}\n"
        "static void center(const void* shape, ccd_vec3_t* out) {\n"
        "  const double* m = static_cast<const Shape*>(shape)->middle;\n"
        "  ccdVec3Set(out, m[0], m[1], m[2]);\n"
        "}\n";
    out.body =
        "  ccd_t settings;\n"
        "  CCD_INIT(&settings);\n"
        "  settings.support1 = settings.support2 = support;\n"
        "  settings.center1 = settings.center2 = center;\n"
        "  settings.max_iterations = 500;\n"
        "  settings." +
        m_method.toleranceName + " = " + literal(static_cast<double>(m_tolerance)) + ";\n" +
        "  ccd_real_t depth = 0;\n"
        "  ccd_vec3_t direction = {{0, 0, 0}}, position = {{0, 0, 0}};\n"
        "  const int result = " +
        m_method.callName + "(&a, &b, &settings, &depth, &direction, &position);\n" +
        "  double distance = result == 0 ? -depth : result == -1 ? INFINITY : NAN;  // infinite: apart\n"
        "  for (int i = 0; i < 3; ++i) {\n"
        "    if (!std::isfinite(direction.v[i] + position.v[i])) distance = NAN;  // no answer\n"
        "  }\n";
    return out;
  }
  static std::string written(const std::string& core, const CcdPlaced& placed) {
    ccd_vec3_t middle;
    center(&placed, &middle);
    std::string rows;
    for (int i = 0; i < 3; ++i) rows += (i ? ", {" : "{") + literals(placed.r.row(i)) + "}";
    return "{" + core + ", {" + rows + "}, {" + literals(placed.p) + "}, " + literal(double(placed.shape.radius)) +
           ", {" + literals(vectorOf(&middle)) + "}}";
  }

  CcdMethod m_method;
  Real m_tolerance;
  CcdPlaced m_a, m_b;
};

template <int D>
class LibccdGjk final : public LibccdWitness {
 public:
  struct Params : PairFrameParams {
    Real tolerance = Real(1e-8);
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, Real(1e-14), 1, "1", "tolerance of EPA; libccd's default is 1e-4",
             ParamRole::tolerance);
      PairFrameParams::visit(v);
    }
  };
  explicit LibccdGjk(const Params& params)
      : LibccdWitness(params.frame, {ccdGJKPenetration, &ccd_t::epa_tolerance, "ccdGJKPenetration", "epa_tolerance"},
                      params.tolerance) {}

  static AlgorithmInfo info() {
    return {.name = "libccd_gjk",
            .summary = "libccd's GJK with EPA: depths only",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "faces, edges or vertices just touch",
                          .symptom = "depth 0 without a direction",
                          .test = "Witnesses.LibccdGjkHasNoDirectionAtTouch"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 4e-1},      ErrorBar{sphere, capsule, 5e-5},
                                         ErrorBar{sphere, box, 3e-5},         ErrorBar{sphere, polytope, 4e-5},
                                         ErrorBar{capsule, capsule, 5e-2},    ErrorBar{capsule, box, 7e-5},
                                         ErrorBar{capsule, polytope, 3e-5},   ErrorBar{box, box, 2e-5},
                                         ErrorBar{box, polytope, 2e-5},       ErrorBar{polytope, polytope, 3e-5},
                                         ErrorBar{sphere, cylinder, 5e-5},    ErrorBar{capsule, cylinder, 5e-5},
                                         ErrorBar{box, cylinder, 3e-5},       ErrorBar{polytope, cylinder, 4e-5},
                                         ErrorBar{cylinder, cylinder, 6e-5},  ErrorBar{sphere, ellipsoid, 7e-5},
                                         ErrorBar{capsule, ellipsoid, 5e-5},  ErrorBar{box, ellipsoid, 5e-5},
                                         ErrorBar{polytope, ellipsoid, 4e-5}, ErrorBar{cylinder, ellipsoid, 7e-5},
                                         ErrorBar{ellipsoid, ellipsoid, 6e-5}};
    return kBars;
  }
};

template <int D>
class LibccdMpr final : public LibccdWitness {
 public:
  struct Params : PairFrameParams {
    Real tolerance = Real(1e-8);
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, Real(1e-14), 1, "1",
             "tolerance of the portal refinement; libccd's default is 1e-4", ParamRole::tolerance);
      PairFrameParams::visit(v);
    }
  };
  explicit LibccdMpr(const Params& params)
      : LibccdWitness(params.frame, {ccdMPRPenetration, &ccd_t::mpr_tolerance, "ccdMPRPenetration", "mpr_tolerance"},
                      params.tolerance) {}

  static AlgorithmInfo info() {
    return {.name = "libccd_mpr",
            .summary = "libccd's portal refinement: depths along the line of centres, an upper bound of the least",
            .paper = "",
            .complexity = "5 to 20 support points",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "the least depth is not along the line of centres",
                          .symptom = "the depth is too large, up to many times the least",
                          .test = "Witnesses.LibccdMprDepthIsNotMinimal"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 1e-15},     ErrorBar{sphere, capsule, 2e-1},
                                         ErrorBar{sphere, box, 2e-1},         ErrorBar{sphere, polytope, 2e-1},
                                         ErrorBar{capsule, capsule, 2e-1},    ErrorBar{capsule, box, 2e-1},
                                         ErrorBar{capsule, polytope, 2e-1},   ErrorBar{box, box, 2e-1},
                                         ErrorBar{box, polytope, 6e-2},       ErrorBar{polytope, polytope, 9e-2},
                                         ErrorBar{sphere, cylinder, 2e-1},    ErrorBar{capsule, cylinder, 2e-1},
                                         ErrorBar{box, cylinder, 2e-1},       ErrorBar{polytope, cylinder, 2e-1},
                                         ErrorBar{cylinder, cylinder, 2e-1},  ErrorBar{sphere, ellipsoid, 2e-1},
                                         ErrorBar{capsule, ellipsoid, 2e-1},  ErrorBar{box, ellipsoid, 2e-1},
                                         ErrorBar{polytope, ellipsoid, 1e-1}, ErrorBar{cylinder, ellipsoid, 2e-1},
                                         ErrorBar{ellipsoid, ellipsoid, 2e-1}};
    return kBars;
  }
};

template <>
class LibccdGjk<2> final : public Prisms<LibccdGjk<3>> {
 public:
  using Prisms::Prisms;
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {
        ErrorBar{sphere, sphere, 5e-1},    ErrorBar{sphere, capsule, 2e-1},  ErrorBar{sphere, segment, 2e-1},
        ErrorBar{sphere, box, 2e-4},       ErrorBar{sphere, polytope, 8e-5}, ErrorBar{capsule, capsule, 1e-4},
        ErrorBar{capsule, segment, 9e-5},  ErrorBar{capsule, box, 1e-4},     ErrorBar{capsule, polytope, 2e-4},
        ErrorBar{segment, segment, 1e-15}, ErrorBar{segment, box, 3e-5},     ErrorBar{segment, polytope, 5e-5},
        ErrorBar{box, box, 2e-4},          ErrorBar{box, polytope, 6e-5},    ErrorBar{polytope, polytope, 8e-5}};
    return kBars;
  }
};

template <>
class LibccdMpr<2> final : public Prisms<LibccdMpr<3>> {
 public:
  using Prisms::Prisms;
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {
        ErrorBar{sphere, sphere, 2e-8},   ErrorBar{sphere, capsule, 2e-1},  ErrorBar{sphere, segment, 3e-1},
        ErrorBar{sphere, box, 2e-1},      ErrorBar{sphere, polytope, 2e-1}, ErrorBar{capsule, capsule, 2e-1},
        ErrorBar{capsule, segment, 3e-1}, ErrorBar{capsule, box, 2e-1},     ErrorBar{capsule, polytope, 3e-1},
        ErrorBar{segment, segment, 2e-1}, ErrorBar{segment, box, 2e-1},     ErrorBar{segment, polytope, 2e-1},
        ErrorBar{box, box, 8e-2},         ErrorBar{box, polytope, 2e-1},    ErrorBar{polytope, polytope, 2e-1}};
    return kBars;
  }
};

}  // namespace

LPC_REGISTER(PairQuery, LibccdGjk, 2, 3);
LPC_REGISTER(PairQuery, LibccdMpr, 2, 3);

}}  // namespace lpc::LPC_PRECISION
