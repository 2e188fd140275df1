// SPDX-License-Identifier: Zlib
#include "algorithms/time_of_impact/closing.h"

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
      v.stage("query", query, StageKind::pairQuery, "gives the gap and its normal");
      v.real("tolerance", tolerance, 0, Real(0.1), "1", "a gap that counts as contact, against the size of the pair",
             ParamRole::tolerance);
      v.integer("iterations", iterations, 1, 1000000, "steps", ParamRole::effort);
    }
  };
  explicit ConservativeAdvancement(const Params& params)
      : m_params(params), m_query(createStage<PairQuery<D>>(params.query)) {}

  static AlgorithmInfo info() {
    return {.name = "conservative_advancement",
            .summary = "steps as long as the gap needs to close at the bound of the approach",
            .paper = "mirtich1996",
            .complexity = "distance queries: a few, log(1 / tolerance) for bodies that turn",
            .failures = {{"a turning body that passes by closely", "it creeps, and may end at its limit",
                          "TimeOfImpact.CloseMissesAreDecided"}}};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_query->supports(a, b); }

  void cast(std::span<const MovingPair<D>> pairs, Real duration, std::span<TimeOfImpactAnswer<D>> answers,
            WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) answers[i] = advance(pairs[i], duration, work);
  }

 private:
  TimeOfImpactAnswer<D> advance(const MovingPair<D>& pair, Real duration, WorkDone& work) {
    const Closing<D> closing(pair);
    TimeOfImpactAnswer<D> out;
    PairMemory memory;
    GapSeen<D> seen;
    Real next = 0;
    for (int k = 0; k < m_params.iterations; ++k) {
      out.t = next;
      if (!look(*m_query, pair, closing, m_params.tolerance, memory, out, seen, work) || out.t >= duration) return out;
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
