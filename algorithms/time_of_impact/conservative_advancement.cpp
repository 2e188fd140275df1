// SPDX-License-Identifier: Zlib
#include "algorithms/time_of_impact/motion_bounds.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace continuous;

// Advances by the time in which the gap cannot have closed, queries the gap, and repeats. The approach of both bodies
// along the normal is bounded over the whole step, so no impact is skipped. Where bodies graze, steps become short and
// many.
template <int D>
class ConservativeAdvancement final : public TimeOfImpact<D> {
 public:
  struct Params {
    Spec query{"gjk_epa", {}};
    Real tolerance = kContactBand;
    int iterations = 1000;
    void visit(ParamVisitor& v) {
      v.stage("query", query, StageKind::pairQuery, "pair query that gives the separation and its normal");
      v.real("tolerance", tolerance, 0, Real(0.1), "1", "gap that counts as contact, relative to the size of the pair",
             ParamRole::tolerance);
      v.integer("iterations", iterations, 1, 1000000, "steps", ParamRole::effort);
    }
  };
  explicit ConservativeAdvancement(const Params& params)
      : m_params(params), m_query(createStage<PairQuery<D>>(params.query)) {}

  static AlgorithmInfo info() {
    return {.name = "conservative_advancement",
            .summary = "conservative advancement: steps of the gap over a bound on the approach speed",
            .paper = "mirtich1996",
            .complexity = "a few distance queries; log(1 / tolerance) for rotating bodies",
            .failures = {
                {"a rotating body that passes by closely",
                 "steps become tiny, and the iteration limit may end the search", "TimeOfImpact.CloseMissesAreDecided"},
                {"surfaces that move fast and close slowly", "the iteration limit ends the search before the impact",
                 "TimeOfImpact.SlowClosingsAreDecided"}}};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_query->supports(a, b); }

  void cast(std::span<const MovingPair<D>> pairs, Real duration, std::span<TimeOfImpactAnswer<D>> answers,
            WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) answers[i] = advance(pairs[i], duration, work);
  }

 private:
  TimeOfImpactAnswer<D> advance(const MovingPair<D>& pair, Real duration, WorkDone& work) {
    const MotionBounds<D> bounds(pair);
    TimeOfImpactAnswer<D> out;
    PairMemory memory;
    GapSeen<D> seen;
    Real next = 0;
    for (int k = 0; k < m_params.iterations; ++k) {
      out.t = next;
      if (!look(*m_query, pair, bounds, m_params.tolerance, memory, out, seen, work) || out.t >= duration) return out;
      const Real step = seen.gap / seen.speed;
      next = seen.speed > 0 && step < duration - out.t ? std::min(duration, out.t + step) : duration;
    }
    out.status = QueryStatus::iterationLimit;
    return out;
  }

  Params m_params;
  std::unique_ptr<PairQuery<D>> m_query;
};

}  // namespace

LPC_REGISTER(TimeOfImpact, ConservativeAdvancement, 2, 3);

}}  // namespace lpc::LPC_PRECISION
