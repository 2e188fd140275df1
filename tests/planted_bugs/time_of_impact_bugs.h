// SPDX-License-Identifier: Zlib
// Planted bugs of times of impact; the properties must catch each.
#pragma once

#include "framework/stage/stage_time_of_impact.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace wrong_casts {

/// The correct method of all bugs; each spoils the query or the answer.
template <int D>
class SpoiledCast : public TimeOfImpact<D> {
 public:
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void cast(std::span<const MovingPair<D>> pairs, Real duration, std::span<TimeOfImpactAnswer<D>> answers,
            WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) answers[i] = one(pairs[i], duration, work);
  }

 protected:
  virtual TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) = 0;
  TimeOfImpactAnswer<D> right(const MovingPair<D>& pair, Real duration, WorkDone& work) {
    TimeOfImpactAnswer<D> answer;
    m_right->cast({&pair, 1}, duration, {&answer, 1}, work);
    return answer;
  }
  static TimeOfImpactAnswer<D> says(bool hit, Real t) { return {QueryStatus::converged, hit, t, {}}; }
  static Real distance(const MovingPair<D>& pair, Real t) {
    const PairView<D> view = pair.at(t);
    return queryPair(*createStage<PairQuery<D>>(Spec{"gjk_epa", {}}), view.a, view.b, view.X_AB).distance;
  }

 private:
  std::unique_ptr<TimeOfImpact<D>> m_right = createStage<TimeOfImpact<D>>(Spec{"bilateral", {}});
};

/// Checks the ends of the step only: a body that has passed through by then is missed.
template <int D>
class LooksAtTheEnds final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    if (this->distance(pair, 0) > 0 && this->distance(pair, duration) > 0) return this->says(false, duration);
    return this->right(pair, duration, work);
  }
};

/// Slightly late, so that the bodies surely touch.
template <int D>
class WaitsForOverlap final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    TimeOfImpactAnswer<D> answer = this->right(pair, duration, work);
    if (answer.hit && answer.t > 0) answer.t += (duration - answer.t) / 100;
    return answer;
  }
};

/// Separating bodies hit, too, because their speed is taken as an absolute value.
template <int D>
class SpeedWithoutSign final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    TimeOfImpactAnswer<D> answer = this->right(pair, duration, work);
    MovingPair<D> back = pair;
    back.A.motion.v = -back.A.motion.v, back.B.motion.v = -back.B.motion.v;
    if (!answer.hit) answer = this->right(back, duration, work);
    return answer;
  }
};

/// Only the second body moves.
template <int D>
class ForgetsTheFirst final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    MovingPair<D> still = pair;
    still.A.motion = {};
    return this->right(still, duration, work);
  }
};

/// Bodies move without turning.
template <int D>
class ForgetsTurning final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    MovingPair<D> straight = pair;
    straight.A.motion.w.setZero(), straight.B.motion.w.setZero();
    return this->right(straight, duration, work);
  }
};

/// Beside a plane, ignores the rotation of the other body, as if the plane turned with it.
template <int D>
class PlaneTurnsAlong final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    MovingPair<D> straight = pair;
    if (pair.b.core() == CoreClass::plane) straight.A.motion.w.setZero();
    return this->right(straight, duration, work);
  }
};

/// Shapes turn about their own origins instead of their bodies' centres.
template <int D>
class TurnsAboutTheShape final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    MovingPair<D> moved = pair;
    for (ShapeMotion<D>* m : {&moved.A, &moved.B}) m->X_WC = m->X_WC * m->X_CS, m->X_CS = {};
    return this->right(moved, duration, work);
  }
};

/// Times are rounded up to milliseconds.
template <int D>
class WholeMilliseconds final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    TimeOfImpactAnswer<D> answer = this->right(pair, duration, work);
    if (answer.hit) answer.t = std::min(duration, std::ceil(answer.t * 1000) / 1000);
    return answer;
  }
};

/// Divides the gap by the speed, even if the speed is zero or the time then exceeds the duration.
template <int D>
class DividesByTheSpeed final : public SpoiledCast<D> {
  TimeOfImpactAnswer<D> one(const MovingPair<D>& pair, Real duration, WorkDone& work) override {
    TimeOfImpactAnswer<D> answer = this->right(pair, duration, work);
    const Real speed = (pair.A.motion.v - pair.B.motion.v).norm();
    if (!answer.hit && speed * duration < 1) answer.t = std::max(duration, answer.there.distance / speed);
    return answer;
  }
};

}}}}  // namespace lpc::LPC_PRECISION::test::wrong_casts
