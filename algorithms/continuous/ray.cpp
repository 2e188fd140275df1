// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cmath>

#include "framework/math/tolerances.h"
#include "framework/stage/stage_continuous.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Casts the path of the inner ball's centre of a fast part as a ray against the other part, in the other part's frame.
// The path ends one inner radius before the surface that the ray enters, or half of that where the part is nearer at
// the start. Whatever lies outside the ball is ignored: an obstacle that the centre misses is missed.
template <int D>
class Ray final : public ContinuousCollision<D> {
 public:
  struct Params {
    Real threshold = Real(0.5);
    void visit(ParamVisitor& v) {
      v.real("threshold", threshold, 0, 1000, "1",
             "a part counts as fast above this fraction of its inscribed ball's radius per step");
    }
  };
  explicit Ray(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "ray",
        .summary = "casts a ray along the path of a fast body's centre, as planned in the 2009 report",
        .paper = "lpc2009",
        .complexity = "a broadphase query per fast part, a ray cast per pair",
        .failures = {
            {"a long body that rotates about its point of impact", "its ends pass through",
             "Continuous.BulletIsStopped"},
            {"a body other than a ball that meets a mesh or chain",
             "what lies outside its inner ball passes, and nothing pushes it back", "Continuous.SurfaceIsNotPassed"},
            {"an obstacle beside the path of the centre", "the obstacle is missed", "Continuous.EdgeIsMet"},
            {"a rod that makes a whole turn in a step while its centre rests", "its end passes through",
             "Continuous.WholeTurnsAreSeen"},
            {"bullets in contact that are pushed on", "they penetrate each other", "Continuous.QueueIsStopped"},
            {"a rod with a fast end, while its centre rests", "its end passes through",
             "Continuous.SpinningRodIsStopped"}}};
  }

  CcdPhase ccdPhase() const override { return CcdPhase::after; }
  Real threshold() const override { return m_params.threshold; }

  void timesOfImpact(std::span<const FastPair<D>> pairs, Real duration, std::span<Real> t, WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const FastPair<D>& p = pairs[i];
      t[i] = std::numeric_limits<Real>::infinity();
      if (p.fastA) t[i] = std::min(t[i], timeOfImpact(p.a, p.pair.A, p.pair.b, p.pair.B, duration));
      if (p.fastB) t[i] = std::min(t[i], timeOfImpact(p.b, p.pair.B, p.pair.a, p.pair.A, duration));
      work[WorkCount::pairQueries] += p.fastA + p.fastB;
    }
  }

 private:
  static Real timeOfImpact(const InnerOuterRadii<D>& radii, const ShapeMotion<D>& motion, const ShapeView<D>& other,
                           const ShapeMotion<D>& others, Real duration) {
    const auto centerAt = [&](Real t) {
      const Pose<D> X_OM = others.X_CS.inverse() * poseBetween(others.bodyAt(t), motion.bodyAt(t)) * motion.X_CS;
      return Vec<D>(X_OM * radii.center);
    };
    const Vec<D> from = centerAt(0), way = centerAt(duration) - from;
    const RayEntry<D> entry = rayEntry(other, Pose<D>{}, from, way, Real(1));
    const Real closing = -way.dot(entry.normal);  // m over the whole step
    // The ray misses, or starts inside.
    if (entry.t < 0 || !(closing > 0)) return std::numeric_limits<Real>::infinity();
    // A segment has no inner ball.
    const Real clearance = std::max(radii.inner, kLinearSlop);
    for (const Real before : {clearance, clearance / 2}) {
      const Real share = entry.t - before / closing;
      if (share > 0) return share * duration;
    }
    return std::numeric_limits<Real>::infinity();
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(ContinuousCollision, Ray, 2, 3);

}}  // namespace lpc::LPC_PRECISION
