// SPDX-License-Identifier: Zlib
#include "algorithms/sleep/wake_rules.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Sleeping of the 2009 report (6.5, 6.5.1): recency-weighted averages of speed and of angular speed, each with its own
// threshold. A body wakes when its support is removed. wake_rules.h lists the added rules.
template <int D>
class SplitAverage final : public SleepPolicy<D> {
 public:
  struct Params {
    Real linear = Real(1.5);
    Real angular = Real(0.01);
    Real bias = Real(0.5);
    Real wakeSeparation = Real(0.05);
    void visit(ParamVisitor& v) {
      v.real("linear", linear, 0, Real(1e6), "m/s", "a body falls asleep below this average speed");
      v.real("angular", angular, 0, Real(1e6), "rad/s", "and below this average angular velocity");
      v.real("bias", bias, 0, Real(0.999), "1", "weight of the old average against the current step, per step");
      v.real("wake_separation", wakeSeparation, 0, Real(1e6), "m/s",
             "wakes when a contact opens, or its support slides away, faster than this");
    }
  };
  explicit SplitAverage(const Params& params) : m_params(params), m_rules(params.wakeSeparation) {}

  static AlgorithmInfo info() {
    return {
        .name = "split_average",
        .summary =
            "sleeps by recency-weighted averages of speed and angular velocity; wakes on impacts and loss of support",
        .paper = "lpc2009",
        .complexity = "bodies + contacts; passes over the contacts while a body may fall asleep",
        .guarantee = Guarantee::approximate,
        .failures = {{"a body slides without rotation slower than `linear`", "it falls asleep on the slope",
                      "Sleep.SlowSliderStaysAwake"},
                     {"a body slides at a constant speed below `linear`", "it falls asleep while moving",
                      "Sleep.SteadySliderStaysAwake"},
                     {"a support slides away slower than `wake_separation`",
                      "the sleeping load does not wake and stays in place", "Sleep.CreepingSupportWakes"},
                     {"a sleeping stack that loses its support",
                      "its bodies wake and fall one after the other, a step apart", "Sleep.StackWakesAsAWhole"},
                     {"a body moves by position correction alone",
                      "it falls asleep before its joint error is corrected", "Sleep.CreeperStaysAwake"},
                     {"a sleeping body is pushed slower than the restitution threshold, or its load grows",
                      "it does not wake and acts as a static body", "Sleep.SlowPushWakes"},
                     {"the time step is halved", "the averages decay twice as fast", "Sleep.BySeconds"},
                     {"a body hangs on joints alone", "it never falls asleep", "Sleep.PendulumSleeps"}}};
  }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    m_rules.byEvents(in, awake);
    m_rules.byBlows(in, awake);
    m_rules.bySlides(in, awake);
    m_rules.byJoints(in, awake);
    m_calm.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!sleep::dynamic(in, static_cast<std::int32_t>(i))) continue;
      if (m_rules.woken()[i] || !awake[i]) {
        memory[i] = {};
        continue;
      }
      const Motion<D>& motion = in.bodies.motion[i];
      const bool slow = sleep::recentAverage(memory[i][0], m_params.bias, motion.v.norm(), m_params.linear);
      const bool still = sleep::recentAverage(memory[i][1], m_params.bias, motion.w.norm(), m_params.angular);
      m_calm[i] = slow && still && in.bodies.canSleep[i];
    }
    m_rules.fallAsleep(in, m_calm, awake);
  }

 private:
  Params m_params;
  sleep::WakeRules<D> m_rules;
  std::vector<std::uint8_t> m_calm;
};

}  // namespace

LPC_REGISTER(SleepPolicy, SplitAverage, 2, 3);

}}  // namespace lpc::LPC_PRECISION
