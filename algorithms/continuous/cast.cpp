// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cmath>
#include <memory>

#include "algorithms/time_of_impact/motion_bounds.h"
#include "framework/math/tolerances.h"
#include "framework/stage/stage_continuous.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace continuous;

// Casts the whole shapes, translating and turning. An impact counts only if the shapes would become deeper than
// contacts usually are. A body that slides, rolls or grazes, also over the seam between two floors, therefore
// continues. The depth grows no faster than points move, so the time of that depth is found like a time of impact. A
// pair that touches at the start is stopped at that depth, not earlier.
template <int D>
class Cast final : public ContinuousCollision<D> {
 public:
  struct Params {
    Spec method{"conservative_advancement", {}}, query{"gjk_epa", {}};
    Real threshold = Real(0.5), depth = 2 * kLinearSlop;
    int iterations = 1000;
    void visit(ParamVisitor& v) {
      v.stage("method", method, StageKind::timeOfImpact, "time of impact method");
      v.real(
          "threshold", threshold, 0, 1000, "1",
          "motion per step that needs no test, and allowed penetration, over the radius of the part's inscribed ball");
      v.real("depth", depth, 0, 1000, "m",
             "allowed penetration of a part, where its inscribed ball sets no smaller limit");
      v.stage("query", query, StageKind::pairQuery, "pair query that measures the penetration");
      v.integer("iterations", iterations, 1, 1000000, "largest number of steps of the search for that penetration",
                ParamRole::effort);
    }
  };
  explicit Cast(const Params& params)
      : m_params(params),
        m_method(createStage<TimeOfImpact<D>>(params.method)),
        m_query(createStage<PairQuery<D>>(params.query)) {}

  static AlgorithmInfo info() {
    return {.name = "cast",
            .summary = "stops fast bodies at their first time of impact",
            .paper = "catto2013",
            .complexity = "a broadphase query per fast part, a time of impact per pair"};
  }

  CcdPhase ccdPhase() const override { return CcdPhase::after; }
  Real threshold() const override { return m_params.threshold; }
  bool supports(ShapeKind a, ShapeKind b) const override { return m_method->supports(a, b) && m_query->supports(a, b); }

  void timesOfImpact(std::span<const FastPair<D>> pairs, Real duration, std::span<Real> t, WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) t[i] = timeOfImpact(pairs[i], duration, work);
  }

 private:
  static constexpr Real kNever = std::numeric_limits<Real>::infinity();

  Real timeOfImpact(const FastPair<D>& p, Real duration, WorkDone& work) {
    TimeOfImpactAnswer<D> found;
    m_method->cast({&p.pair, 1}, duration, {&found, 1}, work);
    if (!(found.t < duration)) return kNever;
    const Real deep = tooDeep(p, found.t, duration, work);
    return found.t > 0 && deep < duration ? found.t : deep;
  }

  // Finds, from time t on, when the depth reaches the allowed one, or grows by half of it if it is nearly reached
  // already, but not to more than the inner ball's radius unless it is deeper already. A body that rests inside another
  // may thus move on; otherwise it would never move again. Along the normal the depth grows no faster than the bodies
  // approach: conservative advancement on the far side of contact.
  Real tooDeep(const FastPair<D>& p, Real t, Real duration, WorkDone& work) {
    const Real ball = std::min(p.fastA ? p.a.inner : kNever, p.fastB ? p.b.inner : kNever);
    const Real inner = std::max(ball, m_params.depth);  // a segment has no inner ball
    Real allowed = std::min(m_params.depth, m_params.threshold * inner);
    const MotionBounds<D> bounds(p.pair);
    PairMemory memory;
    Real atStart = 0;  // m, the growth of the depth that is allowed
    for (int k = 0; k < m_params.iterations; ++k) {
      const PairView<D> view = p.pair.at(t);
      PairAnswer<D> answer;
      m_query->query({&view, 1}, QueryNeed::distance, {&answer, 1}, {&memory, 1}, work);
      if (k == 0 && -answer.distance > allowed / 2) {
        const Real more = std::min(allowed, inner + answer.distance);  // at most to the inner ball's radius
        allowed = (more > 0 ? more : allowed) / 2 - answer.distance;
      }
      const Real left = allowed + answer.distance;  // m
      if (k == 0) atStart = left;
      const Real speed = bounds.closingSpeed(p.pair.A.bodyAt(t).q * (p.pair.A.X_CS.q * answer.normal));
      if (!std::isfinite(left) || !std::isfinite(speed) || answer.normal.isZero(0)) return t;
      if (!(speed * (duration - t) > left)) return kNever;  // also a body that leaves
      if (!(left > kAlmostThere * atStart)) return t;
      t += left / speed;
    }
    return t;
  }

  Params m_params;
  std::unique_ptr<TimeOfImpact<D>> m_method;
  std::unique_ptr<PairQuery<D>> m_query;
};

}  // namespace

LPC_REGISTER(ContinuousCollision, Cast, 2, 3);

}}  // namespace lpc::LPC_PRECISION
