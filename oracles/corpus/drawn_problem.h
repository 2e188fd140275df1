// SPDX-License-Identifier: Zlib
// Randomly drawn velocity problems of bodies above a ground. All contacts could separate upwards, so a solution exists
// (Acary, Cadoux, Lemarechal, Malick 2011).
#pragma once

#include <cstdint>
#include <string>

#include "framework/problem/frozen_problem.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct DrawnProblem {
  std::string family;
  FrozenProblem<D> problem;
};

/// The problem with this number from a seed; the same on every machine.
///   heap         each body on one or two earlier ones
///   frictionless
///   mass_ratio   of up to a million
///   hyperstatic  contacts over whole faces; their impulses are not unique
///   sliding      much faster than gravity accelerates within the step
///   jointed      each body hangs on the one before it, and some touch the ground
template <int D>
DrawnProblem<D> drawProblem(std::uint64_t seed, int number);

}}  // namespace lpc::LPC_PRECISION
