// SPDX-License-Identifier: Zlib
// Velocity resolvers, registered and planted, as functions of the number of iterations, for tests of convergence.
#pragma once

#include <functional>
#include <memory>

#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Makes a resolver with a number of iterations.
template <int D>
using Solves = std::function<std::unique_ptr<VelocityResolver<D>>(int iterations)>;

/// A registered resolver with the parameters of `spec`.
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
