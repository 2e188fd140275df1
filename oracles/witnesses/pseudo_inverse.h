// SPDX-License-Identifier: Zlib
#pragma once

#include <Eigen/Core>
#include <memory>

namespace lpc {

/// Solves m x = b in the sense of least squares, with the smallest x where m is singular. It computes in doubles in
/// each precision, so that Eigen's templates for it are compiled once.
class PseudoInverse {
 public:
  explicit PseudoInverse(const Eigen::MatrixXd& m);
  ~PseudoInverse();
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;  // one column for each right-hand side

 private:
  struct Factors;
  std::unique_ptr<Factors> m_factors;
};

}  // namespace lpc
