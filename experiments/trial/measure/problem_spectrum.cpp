// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/problem_spectrum.h"

#include <Eigen/Eigenvalues>

namespace lpc {

Spectrum spectrumOf(std::span<const double> w, std::size_t n) {
  using Matrix = Eigen::MatrixXd;
  Spectrum out;
  if (n == 0) return out;
  const auto size = static_cast<Eigen::Index>(n);
  const Matrix all = Eigen::Map<const Matrix>(w.data(), size, size);
  // Scaled to a unit diagonal, so that rows of light and heavy bodies count alike; the rate is unchanged.
  const Eigen::VectorXd scale = all.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix unit = scale.asDiagonal() * all * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> symmetric(unit);
  constexpr double kZero = 1e-10;
  // Restricted to the range of W: with W = B B^T, an iteration x -> x - P W x acts on y = B^T x as I - B^T P B.
  for (Eigen::Index i = 0; i < size; ++i) out.rank += symmetric.eigenvalues()[i] > kZero;
  const Matrix basis =
      symmetric.eigenvectors().rightCols(out.rank) * symmetric.eigenvalues().tail(out.rank).cwiseSqrt().asDiagonal();
  const Matrix swept = unit.triangularView<Eigen::Lower>().solve(basis);
  const Matrix iteration = Matrix::Identity(out.rank, out.rank) - basis.transpose() * swept;
  out.gaussSeidel = Eigen::EigenSolver<Matrix>(iteration, false).eigenvalues().cwiseAbs().maxCoeff();
  return out;
}

}  // namespace lpc
