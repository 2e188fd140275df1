// SPDX-License-Identifier: Zlib
// Velocity resolvers, registered ones and twins, made by how often they iterate: for what sweeps come to.
#pragma once

#include <functional>
#include <memory>

#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_twins.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Somebody who solves, by how often.
template <int D>
using Solves = std::function<std::unique_ptr<VelocityResolver<D>>(int iterations)>;

/// A registered one, in the manner that `spec` says.
template <int D>
Solves<D> registered(const Registered& entry, const Spec& spec = {}) {
  return [&entry, spec](int iterations) {
    Spec often = withIterations(entry, iterations, iterations);
    for (const auto& [key, value] : spec.fields) often.set(key, value);
    return createStage<VelocityResolver<D>>(often);
  };
}
template <int D>
Solves<D> twin(Bug bug) {
  return [bug](int iterations) { return std::make_unique<TwinResolver<D>>(bug, iterations); };
}

}}}  // namespace lpc::LPC_PRECISION::test
