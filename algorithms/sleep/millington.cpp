// SPDX-License-Identifier: Zlib
#include <cmath>

#include "algorithms/sleep/wake_rules.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// base^exponent, exponent > 0, by square roots alone: std::pow is not the same everywhere.
double power(double base, double exponent) {
  int scale = 0;
  double rest = std::frexp(exponent, &scale), root = base, result = 1;
  while (rest > 0) {
    root = std::sqrt(root), rest *= 2;
    if (rest >= 1) result *= root, rest -= 1;
  }
  for (; scale > 0; --scale) result *= result;
  for (; scale < 0; ++scale) result = std::sqrt(result);
  return result;
}

// Sleeping of Millington's book: one recency-weighted average of v^2 + w^2, in metres and radians alike. The bias is
// that of his code, bias^dt per step, which decays over seconds; the 2009 report prints it per step (6.5). In the book
// a body wakes if an awake body hits it with a resolvable speed, or if the user pushes it. With these rules alone a
// pile hangs in the air when its support is removed, slow throws freeze at their apex, and joints pull at walls
// (BookAlone in tests/planted_bugs/sleep_bugs.h). Therefore the report's repairs decide which bodies wake and which
// may sleep.
template <int D>
class Millington final : public SleepPolicy<D> {
 public:
  struct Params {
    Real epsilon = Real(0.3);
    Real bias = Real(0.5);
    Real wakeSeparation = Real(0.05);
    void visit(ParamVisitor& v) {
      v.real("epsilon", epsilon, 0, Real(1e12), "m^2/s^2",
             "a body falls asleep below this average of v^2 + w^2 (rad/s counts as m/s)");
      v.real("bias", bias, 0, Real(0.999), "1", "weight of the old average after one second");
      v.real("wake_separation", wakeSeparation, 0, Real(1e6), "m/s",
             "wakes when a contact opens, or its support slides away, faster than this");
    }
  };
  explicit Millington(const Params& params) : m_params(params), m_rules(params.wakeSeparation) {}

  static AlgorithmInfo info() {
    return {.name = "millington",
            .summary = "sleeps by one recency-weighted average of v^2 + w^2, weighted by time; wakes as split_average",
            .paper = "millington2007",
            .complexity = "bodies + contacts; passes over the contacts while a body may fall asleep",
            .guarantee = Guarantee::approximate,
            .failures = {{"a body slides or rolls slower than sqrt(`epsilon`)", "it falls asleep while moving",
                          "Sleep.SteadySliderStaysAwake"},
                         {"a ball rolls at a centimetre per second", "it falls asleep while moving",
                          "Sleep.SlowRollerStaysAwake"},
                         {"a sleeping stack that loses its support",
                          "its bodies wake and fall one after the other, a step apart", "Sleep.StackWakesAsAWhole"},
                         {"a body moves by position correction alone",
                          "it falls asleep before its joint error is corrected", "Sleep.CreeperStaysAwake"},
                         {"a sleeping body is pushed slower than the restitution threshold, or its load grows",
                          "it does not wake and acts as a static body", "Sleep.SlowPushWakes"},
                         {"a support slides away slower than `wake_separation`",
                          "the sleeping load does not wake and stays in place", "Sleep.CreepingSupportWakes"},
                         {"a body hangs on joints alone", "it never falls asleep", "Sleep.PendulumSleeps"}}};
  }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    m_rules.byEvents(in, awake);
    m_rules.byBlows(in, awake);
    m_rules.bySlides(in, awake);
    m_rules.byJoints(in, awake);
    const auto bias = static_cast<Real>(power(double(m_params.bias), double(in.dt)));
    m_calm.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!sleep::dynamic(in, static_cast<std::int32_t>(i))) continue;
      if (m_rules.woken()[i] || !awake[i]) {
        memory[i] = {};
        continue;
      }
      const Motion<D>& motion = in.bodies.motion[i];
      const Real now = motion.v.squaredNorm() + motion.w.squaredNorm();
      m_calm[i] = sleep::recentAverage(memory[i][0], bias, now, m_params.epsilon) && in.bodies.canSleep[i];
    }
    m_rules.fallAsleep(in, m_calm, awake);
  }

 private:
  Params m_params;
  sleep::WakeRules<D> m_rules;
  std::vector<std::uint8_t> m_calm;
};

}  // namespace

LPC_REGISTER(SleepPolicy, Millington, 2, 3);

}}  // namespace lpc::LPC_PRECISION
