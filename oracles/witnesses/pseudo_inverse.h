// SPDX-License-Identifier: Zlib
#pragma once

#include <Eigen/Core>
#include <memory>

namespace lpc {

/// Solves m x = b in the least squares sense, with the smallest x when m is singular. Computes in double in each
/// precision, so that Eigen's templates are compiled once.
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
