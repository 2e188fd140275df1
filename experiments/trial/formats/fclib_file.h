// SPDX-License-Identifier: Zlib
// Velocity problems in the format of FCLIB (Acary, Bremond, Huber: a collection of frictional contact problems), HDF5.
// Its global form has bodies, contacts with Coulomb friction and equality rows; its local form has a matrix in place of
// the bodies. Neither has limits, motors, springs, the last step's impulses, dt or gravity. Both forms are read; the
// global form is written.
#pragma once

#include <string>

#include "framework/problem/frozen_problem.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Whether the bytes begin like an HDF5 file.
bool isHdf5(const std::string& bytes);

/// The bytes of a file, made beside `path` and removed again. Throws UserError for anything that FCLIB cannot store,
/// and if this build lacks FCLIB.
template <int D>
std::string fclibBytes(const FrozenProblem<D>& problem, const std::string& path);

/// Converts such a file into our own format. Throws UserError for a file that it cannot read, and for a global form
/// that is not of rigid bodies.
std::string fclibAsProblems(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
