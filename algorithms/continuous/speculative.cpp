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
             "a part counts as fast above this fraction of its inscribed ball's radius per step");
    }
  };
  explicit Speculative(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "speculative",
            .summary = "speculative contacts with everything that fast bodies could reach in the step",
            .paper = "catto2013",
            .complexity = "a broadphase query per fast part, contacts of those pairs",
            .failures = {{"a body that passes by an edge", "it bounces off the extended plane of a neighbouring face",
                          "Continuous.PassesBy"},
                         {"a body that is struck and moves off within the step", "it passes through",
                          "Continuous.SentOnItsWayIsStopped"},
                         {"two bodies of equal speed, one behind the other, and the first is stopped",
                          "the second passes through the first", "Continuous.StoppedOnesStandInTheWay"},
                         {"a long body that rotates about its point of impact", "its ends pass through",
                          "Continuous.BulletIsStopped"},
                         {"a long or pointed body that meets a mesh or chain, and turns about its point of impact",
                          "its ends pass through, and nothing pushes them back", "Continuous.SurfaceIsNotPassed"},
                         {"several bullets in a row", "a bullet that is hit from behind passes through",
                          "Continuous.QueueIsStopped"}}};
  }

  CcdPhase ccdPhase() const override { return CcdPhase::before; }
  Real threshold() const override { return m_params.threshold; }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(ContinuousCollision, Speculative, 2, 3);

}}  // namespace lpc::LPC_PRECISION
