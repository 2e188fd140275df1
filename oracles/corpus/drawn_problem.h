// SPDX-License-Identifier: Zlib
// Velocity problems that are drawn: some bodies over a ground, with contacts that could all be left upwards, so that a
// solution exists (Acary, Cadoux, Lemarechal, Malick 2011).
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

/// The problem of this number of a seed; the same on every machine.
///   heap         each body on one or two of those before it
///   frictionless
///   mass_ratio   of up to a million
///   hyperstatic  whole faces, whose impulses are not unique
///   sliding      much faster than gravity pulls within the step
///   jointed      each body hangs on the one before it, and some touch the ground
template <int D>
DrawnProblem<D> drawProblem(std::uint64_t seed, int number);

}}  // namespace lpc::LPC_PRECISION
