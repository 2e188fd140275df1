// SPDX-License-Identifier: Zlib
// Velocity problems in the format of FCLIB (Acary, Bremond, Huber: a collection of frictional contact problems), HDF5.
// Its global form holds bodies, contacts with Coulomb friction, equality rows; its local form a matrix in their place.
// Neither holds limits, motors, springs, the last step's impulses, dt and gravity. Both are read, the global is
// written.
#pragma once

#include <string>

#include "framework/problem/frozen_problem.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Whether the bytes begin as HDF5's do.
bool isHdf5(const std::string& bytes);

/// The bytes of a file, made beside `path` and taken away again. Throws UserError for what FCLIB does not hold, and
/// where this build is without it.
template <int D>
std::string fclibBytes(const FrozenProblem<D>& problem, const std::string& path);

/// A file of it as one of our own. Throws UserError for a file that it cannot read, and for a global form that is none
/// of rigid bodies.
std::string fclibAsProblems(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
