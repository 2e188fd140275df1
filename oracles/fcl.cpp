// SPDX-License-Identifier: Zlib
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include "oracles/guarded.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometry<double>>;

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

// A shape in FCL's terms. FCL knows no rounding of boxes and polytopes: their cores are asked, and `rounding` is
// taken off the distance, which is exact.
struct Translated {
  Geometry geometry;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // FCL's capsules lie along z
  double rounding = 0;

  explicit Translated(const ShapeView<3>& shape) {
    switch (shape.kind) {
      case ShapeKind::sphere:
        geometry = std::make_shared<fcl::Sphere<double>>(shape.radius);
        break;
      case ShapeKind::capsule:
      case ShapeKind::segment:
        geometry = std::make_shared<fcl::Capsule<double>>(shape.radius, 2 * shape.half[0]);
        turn << 0, 0, 1, 0, 1, 0, -1, 0, 0;
        break;
      case ShapeKind::box:
        geometry = std::make_shared<fcl::Box<double>>(2 * shape.half.cast<double>());
        rounding = shape.radius;
        break;
      case ShapeKind::polytope:
        geometry = convex(*shape.hull);
        rounding = shape.radius;
        break;
    }
  }
};

fcl::Transform3<double> transform(const Eigen::Matrix3d& r, const Eigen::Vector3d& p) {
  fcl::Transform3<double> X = fcl::Transform3<double>::Identity();
  X.linear() = r, X.translation() = p;
  return X;
}

// FCL's signed distance: GJK of libccd with FCL's own repair of its EPA.
template <int D>
class FclLibccd final : public PairQuery<3> {
 public:
  struct Params {
    Real tolerance = Real(1e-6);
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, Real(1e-14), 1, "m", "of FCL's distance; at 1e-10 it aborts on spheres");
    }
  };
  explicit FclLibccd(const Params& params) : m_params(params) {}

  static Info info() {
    return {.name = "fcl_libccd",
            .summary = "FCL's signed distance with its libccd solver",
            .paper = "",
            .complexity = "GJK and EPA",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "two boxes apart, nearest at an edge and a face",
                          .symptom = "a distance that is too large (FCL issue 508: 3.16228 for 3)",
                          .test = "Witnesses.FclDistanceOfCubesIsWrong"}},
            .role = Role::witness};
  }
  bool supports(ShapeKind a, ShapeKind b) const override { return a != ShapeKind::segment && b != ShapeKind::segment; }

  void query(const PairBatch<3>& batch, Need, PairAnswers<3>& answers, std::span<PairMemory>, Work& work) override {
    work[Count::pairQueries] += static_cast<std::uint64_t>(batch.count);
    askGuarded(
        batch.count, kWitnessMilliseconds, [&](int i) { return ask(batch.pair(i)); }, answers);
  }

 private:
  PairAnswer<3> ask(const PairView<3>& pair) const {
    const Translated a(pair.a), b(pair.b);
    fcl::DistanceRequest<double> request(true, true);
    request.gjk_solver_type = fcl::GST_LIBCCD;
    request.distance_tolerance = m_params.tolerance;
    fcl::DistanceResult<double> result;
    const Eigen::Matrix3d r = pair.X_AB.q.matrix().cast<double>();
    const double distance =
        fcl::distance(a.geometry.get(), transform(a.turn, Eigen::Vector3d::Zero()), b.geometry.get(),
                      transform(r * b.turn, pair.X_AB.p.cast<double>()), request, result);
    PairAnswer<3> answer;
    answer.status = QueryStatus::converged;
    answer.distance = static_cast<Real>(distance - a.rounding - b.rounding);
    // A pair of kinds that FCL lacks comes back as "infinitely far", with a warning and no error.
    if (distance >= std::numeric_limits<double>::max()) answer.status = QueryStatus::failed;
    Eigen::Vector3d n = result.nearest_points[1] - result.nearest_points[0];
    if (distance < 0) n = -n;
    const double length = n.norm();
    if (length > 0) answer.normal = (n / length).cast<Real>();  // at a touch FCL has none
    answer.pA = (result.nearest_points[0]).cast<Real>() + static_cast<Real>(a.rounding) * answer.normal;
    answer.pB = (result.nearest_points[1]).cast<Real>() - static_cast<Real>(b.rounding) * answer.normal;
    return answer;
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(PairQuery, FclLibccd, 3);

}  // namespace lpc::inline LPC_PRECISION
