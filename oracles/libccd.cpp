// SPDX-License-Identifier: Zlib
#include <ccd/ccd.h>

#include "framework/support_map.h"
#include "oracles/adapter.h"
#include "oracles/witness_process.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// A whole shape, rounding included, as libccd sees it: a support function in the frame of the pair's first shape.
struct Placed {
  ShapeView<3> shape;
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

void setVector(ccd_vec3_t* out, const Eigen::Vector3d& v) { ccdVec3Set(out, v[0], v[1], v[2]); }
Eigen::Vector3d vectorOf(const ccd_vec3_t* v) { return {ccdVec3X(v), ccdVec3Y(v), ccdVec3Z(v)}; }

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& placed = *static_cast<const Placed*>(object);
  const Eigen::Vector3d d = vectorOf(direction), local = placed.r.transpose() * d;
  Eigen::Vector3d v = placed.r * coreSupport(placed.shape, Vec<3>(local.cast<Real>())).cast<double>() + placed.p;
  if (const double length = d.norm(); length > 0) v += double(placed.shape.radius) / length * d;
  setVector(out, v);
}

void center(const void* object, ccd_vec3_t* out) {
  const auto& placed = *static_cast<const Placed*>(object);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  if (placed.shape.hull) {
    for (const auto& v : placed.shape.hull->vertices) middle += v.cast<double>();
    middle /= double(placed.shape.hull->vertices.size());
  }
  setVector(out, placed.r * middle + placed.p);
}

// libccd 2.1 measures depths only. Of shapes that are apart it says no more than that.
class LibccdWitness : public IsolatedWitness {
 public:
  bool supports(ShapeKind a, ShapeKind b) const override { return kAllKinds.has(a, b); }

 protected:
  using Call = int (*)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);

  void place(const PairView<3>& pair) override {
    m_a = {pair.a}, m_b = {pair.b, pair.X_AB.q.matrix().cast<double>(), pair.X_AB.p.cast<double>()};
  }
  PairAnswer<3> depth(const ccd_t& settings, Call call) const {
    ccd_real_t depth = 0;
    ccd_vec3_t direction, position;
    ccdVec3Set(&direction, 0, 0, 0), ccdVec3Set(&position, 0, 0, 0);
    const int result = call(&m_a, &m_b, &settings, &depth, &direction, &position);
    if (result == -1) return apartAnswer(0);
    PairAnswer<3> answer = depthAnswer(depth, vectorOf(&direction).normalized(), vectorOf(&position), 0, 0);
    if (result < -1) answer.status = QueryStatus::failed;  // out of memory
    return answer;
  }

 private:
  Placed m_a, m_b;
};

template <int D>
class LibccdGjk final : public LibccdWitness {
 public:
  struct Params {
    Real tolerance = Real(1e-8);
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, Real(1e-14), 1, "1", "EPA stops below; libccd's own default is 1e-4");
    }
  };
  explicit LibccdGjk(const Params& params) : m_params(params) {}

  static Info info() {
    return {.name = "libccd_gjk",
            .summary = "libccd's GJK with EPA: depths only",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "faces, edges or vertices just touch",
                          .symptom = "depth 0 without a direction",
                          .test = "Witnesses.LibccdGjkHasNoDirectionAtTouch"}},
            .role = Role::witness};
  }

 private:
  PairAnswer<3> measure() override {
    ccd_t settings;
    CCD_INIT(&settings);
    settings.support1 = settings.support2 = support;
    settings.max_iterations = 500;  // the default has no end
    settings.epa_tolerance = m_params.tolerance;
    return depth(settings, ccdGJKPenetration);
  }

  Params m_params;
};

template <int D>
class LibccdMpr final : public LibccdWitness {
 public:
  struct Params {
    Real tolerance = Real(1e-8);
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, Real(1e-14), 1, "1", "the portal stops below; libccd's own default is 1e-4");
    }
  };
  explicit LibccdMpr(const Params& params) : m_params(params) {}

  static Info info() {
    return {.name = "libccd_mpr",
            .summary = "libccd's portal refinement: depths along the line of centres, an upper bound",
            .paper = "",
            .complexity = "5 to 20 support points",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "the least depth is not along the line of centres",
                          .symptom = "the depth is too large, up to many times",
                          .test = "Witnesses.LibccdMprDepthIsNotMinimal"}},
            .role = Role::witness};
  }

 private:
  PairAnswer<3> measure() override {
    ccd_t settings;
    CCD_INIT(&settings);
    settings.support1 = settings.support2 = support;
    settings.center1 = settings.center2 = center;
    settings.max_iterations = 500;
    settings.mpr_tolerance = m_params.tolerance;
    return depth(settings, ccdMPRPenetration);
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(PairQuery, LibccdGjk, 3);
LPC_REGISTER(PairQuery, LibccdMpr, 3);

}  // namespace lpc::inline LPC_PRECISION
