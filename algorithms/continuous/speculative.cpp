// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_continuous.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Speculative contacts: the solver may close an open gap within the step, but no more. A body that would pass by can
// meet the plane of a face that it would never touch, and is deflected: a ghost collision. Motion that the solver
// itself adds within the step is not predicted.
template <int D>
class Speculative final : public ContinuousCollision<D> {
 public:
  struct Params {
    Real threshold = Real(0.5);
    void visit(ParamVisitor& v) {
      v.real("threshold", threshold, 0, 1000, "1",
             "a part is fast that may go farther than this share of its inner ball");
    }
  };
  explicit Speculative(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "speculative",
        .summary = "contacts with all that fast bodies would reach in the step",
        .paper = "catto2013",
        .complexity = "fast parts, a query of boxes each; contacts of those pairs",
        .failures = {
            {"a body that passes by an edge", "it bounces off the plane of a face beside it", "Continuous.PassesBy"},
            {"a floor of tiles", "the side of the next tile stops who slides", "Continuous.SlidesOverSeams"},
            {"a body that is hit and flies off within the step", "it passes through",
             "Continuous.SentOnItsWayIsStopped"},
            {"two of one speed, of which the first is stopped", "the second passes through it",
             "Continuous.StoppedOnesStandInTheWay"},
            {"a long body that turns about where it has hit", "it passes through by its ends",
             "Continuous.BulletIsStopped"},
            {"several bullets in a row", "who is hit from behind passes through", "Continuous.QueueIsStopped"}}};
  }

  Lookout lookout() const override { return Lookout::before; }
  Real threshold() const override { return m_params.threshold; }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(ContinuousCollision, Speculative, 2, 3);

}}  // namespace lpc::LPC_PRECISION
