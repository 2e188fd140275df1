// SPDX-License-Identifier: Zlib
// Planted bugs of traces. Each spoils one step with a support point or an axis, if there is one, and returns whether
// the trace is now wrong.
#pragma once

#include "framework/shape/support_map.h"
#include "framework/stage/pair_trace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace wrong_traces {

/// The middle one of these steps.
template <int D>
std::size_t middleStep(const PairTrace<D>& trace) {
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    const TraceKind kind = trace.steps[i].kind;
    const bool asks = kind == TraceKind::support || kind == TraceKind::expansion || kind == TraceKind::axis;
    if (asks) asked.push_back(i);
  }
  return asked.empty() ? trace.steps.size() : asked[asked.size() / 2];
}

struct DropsAnIteration {
  static constexpr const char* kName = "an iteration is dropped";
  template <int D>
  bool operator()(PairTrace<D>& trace) const {
    const std::size_t i = middleStep(trace);
    if (i == trace.steps.size()) return false;
    trace.steps.erase(trace.steps.begin() + static_cast<std::ptrdiff_t>(i));
    return true;
  }
};

/// Names another axis. The trace is wrong unless that axis proves the same bound by chance, or the search along the old
/// one stopped early.
struct NamesAnotherAxis {
  static constexpr const char* kName = "another axis is named";
  template <int D>
  bool operator()(PairTrace<D>& trace) const {
    const std::size_t i = middleStep(trace);
    if (i == trace.steps.size()) return false;
    Vec<D>& n = trace.steps[i].direction;
    n = n[0] < Real(0.5) ? Vec<D>(Vec<D>::Unit(0)) : Vec<D>(Vec<D>::Unit(1));
    const PairView<D>& pair = trace.pair;
    const Vec<D> b = pair.X_AB * coreSupport(pair.b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n)));
    const Real proved = n.dot(b - coreSupport(pair.a, n));
    return !trace.steps[i].atMost && !(std::abs(proved - trace.steps[i].bound) <= Real(0.001) * std::abs(proved));
  }
};

/// The trace is wrong if the two old points are less far along the axis.
struct KeepsTheOldSupport {
  static constexpr const char* kName = "the support point is that of the step before";
  template <int D>
  bool operator()(PairTrace<D>& trace) const {
    const std::size_t i = middleStep(trace);
    if (i == trace.steps.size() || i == 0) return false;
    TraceStep<D>&step = trace.steps[i], &before = trace.steps[i - 1];
    if (before.direction.isZero(0)) return false;
    const Real nearer = step.direction.dot(before.support - step.support);
    const bool other = nearer > Real(0.001) * before.support.norm();
    step.support = before.support, step.supportA = before.supportA, step.supportB = before.supportB;
    return other;
  }
};

/// The last tested axis that proved less is called the best from then on.
struct KeepsTheLastAxis {
  static constexpr const char* kName = "the last axis is called the best";
  template <int D>
  bool operator()(PairTrace<D>& trace) const {
    auto& steps = trace.steps;
    std::size_t i = steps.size();
    while (i > 0 && (steps[i - 1].kind == TraceKind::answer || steps[i - 1].direction.isZero(0) ||
                     steps[i - 1].direction == steps[i - 1].bestAxis)) {
      --i;
    }
    if (i == 0) return false;
    for (std::size_t k = i - 1; k < steps.size(); ++k) {
      steps[k].best = steps[i - 1].bound, steps[k].bestAxis = steps[i - 1].direction;
    }
    return true;
  }
};

}}}}  // namespace lpc::LPC_PRECISION::test::wrong_traces
