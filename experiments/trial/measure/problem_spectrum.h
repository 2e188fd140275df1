// SPDX-License-Identifier: Zlib
// What the matrix of a frozen problem says of iterations on it, before any is run.
#pragma once

#include <cstddef>
#include <span>

namespace lpc {

struct Spectrum {
  int rank = 0;
  double gaussSeidel = 0;  // spectral radius of the iteration, on what it changes at all
};

/// Of the matrix `w` (n x n, row by row, symmetric, diagonal > 0), rows in the order in which they are solved. What W
/// maps to zero stays as it is: those eigenvalues 1 are left out.
Spectrum spectrumOf(std::span<const double> w, std::size_t n);

}  // namespace lpc
