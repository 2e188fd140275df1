// SPDX-License-Identifier: Zlib
#include "oracles/witnesses/pseudo_inverse.h"

#include <Eigen/QR>

namespace lpc {

struct PseudoInverse::Factors {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> of;
};

PseudoInverse::PseudoInverse(const Eigen::MatrixXd& m) : m_factors(std::make_unique<Factors>()) {
  if (m.size() > 0) m_factors->of.compute(m);
}
PseudoInverse::~PseudoInverse() = default;

Eigen::MatrixXd PseudoInverse::solve(const Eigen::MatrixXd& b) const { return m_factors->of.solve(b); }

}  // namespace lpc
