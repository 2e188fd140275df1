// SPDX-License-Identifier: Zlib
#include "algorithms/time_of_impact/motion_bounds.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace continuous;

// Looks along one axis from both ends of the step. With the normal of the gap at t, the time until which the separation
// along that axis lasts is a root of a function of time that needs support points only. The axis is fixed in the world
// or on one of the bodies, whichever lasts longest: between a face and a corner it is fixed on the face. Catto takes
// the latest such time and may skip a moment in which rotation closed and reopened the gap. Here a root is accepted
// only as far as the second derivative of the separation proves that nothing lies before it; the next axis handles the
// rest.
template <int D>
class Bilateral final : public TimeOfImpact<D> {
 public:
  struct Params {
    Spec query{"gjk_epa", {}};
    Real tolerance = kContactBand;
    int iterations = 100;
    void visit(ParamVisitor& v) {
      v.stage("query", query, StageKind::pairQuery, "pair query that gives the separation and its normal");
      v.real("tolerance", tolerance, 0, Real(0.1), "1", "gap that counts as contact, relative to the size of the pair",
             ParamRole::tolerance);
      v.integer("iterations", iterations, 1, 1000000, "axes tried", ParamRole::effort);
    }
  };
  explicit Bilateral(const Params& params) : m_params(params), m_query(createStage<PairQuery<D>>(params.query)) {}

  static AlgorithmInfo info() {
    return {
        .name = "bilateral",
        .summary = "root of the separation along a fixed axis; a bound on its curvature proves that it is the first",
        .paper = "catto2013",
        .complexity = "a few distance queries, about ten support points along each axis"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_query->supports(a, b); }

  void cast(std::span<const MovingPair<D>> pairs, Real duration, std::span<TimeOfImpactAnswer<D>> answers,
            WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) answers[i] = advance(pairs[i], duration, work);
  }

 private:
  // A time and the separation then, less half the contact band.
  struct Moment {
    Real t, gap;
  };

  TimeOfImpactAnswer<D> advance(const MovingPair<D>& pair, Real duration, WorkDone& work) {
    const MotionBounds<D> bounds(pair);
    TimeOfImpactAnswer<D> out;
    PairMemory memory;
    GapSeen<D> seen;
    Real next = 0;
    for (int k = 0; k < m_params.iterations; ++k) {
      out.t = next;
      if (!look(*m_query, pair, bounds, m_params.tolerance, memory, out, seen, work) || out.t >= duration) return out;
      next = duration;
      if (!(seen.speed * (duration - out.t) > seen.gap)) continue;
      next = std::min(duration, out.t + seen.gap / seen.speed);
      for (const AxisFrame frame : {AxisFrame::world, AxisFrame::bodyA, AxisFrame::bodyB}) {
        if (next >= duration) break;
        if (frame != AxisFrame::world && !bounds.turns(frame)) continue;
        next = std::max(next, lastsUntil(bounds, frame, seen.n, {out.t, seen.gap}, seen.band, duration, work));
      }
    }
    out.status = QueryStatus::iterationLimit;
    return out;
  }

  // A time up to which the shapes are certainly separated along this axis.
  static Real lastsUntil(const MotionBounds<D>& bounds, AxisFrame frame, const Vec<D>& n, const Moment& now, Real band,
                         Real duration, WorkDone& work) {
    const auto gapAt = [&](Real t) {
      work[WorkCount::supportCalls] += 2;
      return bounds.separation(frame, n, now.t, t) - band / 2;
    };
    // The chord from gap a to gap b over a time h, less the bend, stays above 0 if and only if (sqrt a + sqrt b)^2 >=
    // bend h^2 / 2. That certainly holds while h is at most sqrt(2 a / bend). The bend is that of the interval
    // examined, and the second pass examines a shorter one.
    Real end = duration;
    for (int look = 0; look < 3; ++look) {
      const Real bend = bounds.bend(frame, now.t, end);
      const Moment last = lastApart(gapAt, now, end, band);
      const Real root = std::sqrt(now.gap) + std::sqrt(last.gap), h = last.t - now.t;
      if (root * root >= bend * h * h / 2) return last.t;
      const Real sure = now.t + kAlmost * std::sqrt(2 * now.gap / bend);
      end = std::min(last.t, look == 0 ? now.t + 4 * (sure - now.t) : sure);
    }
    return now.t;
  }

  // Returns a root of the gap in (now, end], from its positive side; `end` if the gap is positive there.
  template <class GapAt>
  static Moment lastApart(const GapAt& gapAt, Moment apart, Real end, Real band) {
    Moment closed{end, gapAt(end)};
    if (closed.gap >= 0) return closed;
    // Regula falsi with halved weights (Illinois), and an occasional bisection for functions with corners.
    Real weightApart = apart.gap, weightClosed = closed.gap;
    for (int k = 0; k < kRootSteps && apart.gap > band / 4; ++k) {
      const Real share = k % 4 == 3 ? Real(0.5) : weightApart / (weightApart - weightClosed);
      const Real t = apart.t + share * (closed.t - apart.t), gap = gapAt(t);
      if (!(t > apart.t && t < closed.t)) break;
      if (gap >= 0) {
        apart = {t, gap}, weightApart = gap, weightClosed /= 2;
      } else {
        closed = {t, gap}, weightClosed = gap, weightApart /= 2;
      }
    }
    return apart;
  }

  static constexpr int kRootSteps = 60;
  static constexpr Real kAlmost =
      1 - 16 * std::numeric_limits<Real>::epsilon();  // the bound must hold after rounding, too

  Params m_params;
  std::unique_ptr<PairQuery<D>> m_query;
};

}  // namespace

LPC_REGISTER(TimeOfImpact, Bilateral, 2, 3);

}}  // namespace lpc::LPC_PRECISION
