// SPDX-License-Identifier: Zlib
// Predicts convergence from the matrix of a frozen problem, before any iteration.
#pragma once

#include <cstddef>
#include <span>

namespace lpc {

struct Spectrum {
  int rank = 0;
  double gaussSeidel = 0;  // spectral radius of the iteration, on the subspace that it changes
};

/// For the matrix `w` (n x n, row by row, symmetric, diagonal > 0), with rows in the order of solution. The null space
/// of W is unchanged by the iteration: its eigenvalues 1 are excluded.
Spectrum spectrumOf(std::span<const double> w, std::size_t n);

}  // namespace lpc
