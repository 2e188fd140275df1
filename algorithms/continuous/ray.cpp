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
             "a part is fast that may go farther than this share of its inner ball");
    }
  };
  explicit Ray(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "ray",
            .summary = "the way of a fast body's centre as a ray: the 2009 report's plan",
            .paper = "lpc2009",
            .complexity = "fast parts, a query of boxes each; a ray for each pair",
            .failures = {
                {"a long body that turns about where it has hit", "it passes through by its ends",
                 "Continuous.BulletIsStopped"},
                {"an obstacle beside the way of the centre", "it is not seen", "Continuous.EdgeIsMet"},
                {"a rod that turns once in a step, its centre standing", "the end passes through",
                 "Continuous.WholeTurnsAreSeen"},
                {"bullets that touch and are pressed on", "they sink into each other", "Continuous.QueueIsStopped"},
                {"a rod whose end is fast and whose centre stands still", "the end passes through",
                 "Continuous.SpinningRodIsStopped"}}};
  }

  Lookout lookout() const override { return Lookout::after; }
  Real threshold() const override { return m_params.threshold; }

  void meetings(std::span<const FastPair<D>> pairs, Real duration, std::span<Real> t, WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const FastPair<D>& p = pairs[i];
      t[i] = std::numeric_limits<Real>::infinity();
      if (p.fastA) t[i] = std::min(t[i], meeting(p.a, p.pair.A, p.pair.b, p.pair.B, duration));
      if (p.fastB) t[i] = std::min(t[i], meeting(p.b, p.pair.B, p.pair.a, p.pair.A, duration));
      work[WorkCount::pairQueries] += p.fastA + p.fastB;
    }
  }

 private:
  static Real meeting(const Girth<D>& girth, const ShapeMotion<D>& motion, const ShapeView<D>& other,
                      const ShapeMotion<D>& others, Real duration) {
    const auto centerAt = [&](Real t) {
      const Pose<D> X_OM = others.X_CS.inverse() * poseBetween(others.bodyAt(t), motion.bodyAt(t)) * motion.X_CS;
      return Vec<D>(X_OM * girth.center);
    };
    const Vec<D> from = centerAt(0), way = centerAt(duration) - from;
    const RayEntry<D> entry = rayEntry(other, Pose<D>{}, from, way, Real(1));
    const Real closing = -way.dot(entry.normal);  // m over the whole step
    // The ray misses, or starts inside.
    if (entry.t < 0 || !(closing > 0)) return std::numeric_limits<Real>::infinity();
    // A segment has no inner ball.
    const Real clearance = std::max(girth.inner, kLinearSlop);
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
