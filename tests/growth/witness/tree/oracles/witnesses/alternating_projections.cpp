// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <array>

#include "oracles/witnesses/witness_process.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Spheres and capsules are rounded segments. A point is projected onto the nearest point of the other segment and back,
// a fixed number of times. The points converge to the segments' closest points (Cheney and Goldstein, 1959), slowly for
// nearly parallel segments. Segments hardly ever intersect, so their distance minus the radii is the signed distance.
template <int D>
class AlternatingProjections final : public IsolatedWitness<3> {
 public:
  struct Params {
    int rounds = 20;
    void visit(ParamVisitor& v) {
      v.integer("rounds", rounds, 1, 10000, "projections onto each segment", ParamRole::effort);
    }
  };
  explicit AlternatingProjections(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "alternating_projections",
            .summary = "nearest points of two segments by projections to and fro",
            .paper = "",
            .complexity = "rounds",
            .guarantee = Guarantee::approximate,
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 1e-15}, ErrorBar{sphere, capsule, 1e-15},
                                         ErrorBar{capsule, capsule, 2e-4}};
    return kBars;
  }

 private:
  struct Segment {
    Eigen::Vector3d middle, half;

    Eigen::Vector3d nearest(const Eigen::Vector3d& p) const {
      if (half.isZero(0)) return middle;
      return middle + std::clamp((p - middle).dot(half) / half.squaredNorm(), -1.0, 1.0) * half;
    }
  };
  static Eigen::Vector3d halfOf(const ShapeView<3>& shape) {
    return {shape.kind == ShapeKind::capsule ? double(shape.half[0]) : 0.0, 0, 0};
  }

  void place(const PairView<3>& pair) override {
    m_a = {Eigen::Vector3d::Zero(), halfOf(pair.a)};
    m_b = {pair.X_AB.p.cast<double>(), pair.X_AB.q.matrix().cast<double>() * halfOf(pair.b)};
    m_radiusA = double(pair.a.radius), m_radiusB = double(pair.b.radius);
  }
  PairAnswer<3> measure() override {
    Eigen::Vector3d a = m_a.middle, b = m_b.middle;
    for (int i = 0; i < m_params.rounds; ++i) a = m_a.nearest(b), b = m_b.nearest(a);
    const double apart = (b - a).norm();
    const Eigen::Vector3d normal = (b - a).normalized();  // zero if the segments meet: no direction
    PairAnswer<3> answer;
    answer.status = QueryStatus::converged;
    answer.distance = static_cast<Real>(apart - m_radiusA - m_radiusB);
    answer.normal = normal.cast<Real>();
    answer.pA = (a + m_radiusA * normal).cast<Real>(), answer.pB = (b - m_radiusB * normal).cast<Real>();
    return answer;
  }

  Params m_params;
  Segment m_a, m_b;
  double m_radiusA = 0, m_radiusB = 0;
};

}  // namespace

LPC_REGISTER(PairQuery, AlternatingProjections, 3);

}}  // namespace lpc::LPC_PRECISION
