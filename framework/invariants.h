// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {

/// What physics says about a state, whatever the algorithms are. Computed in double for both precisions.
template <int D>
struct Invariants {
  double kinetic = 0, potential = 0;  // J; potential of gravity only, zero at the origin's height
  Eigen::Matrix<double, D, 1> momentum = Eigen::Matrix<double, D, 1>::Zero();  // kg m/s
  Eigen::Matrix<double, kAngDim<D>, 1> angularMomentum =
      Eigen::Matrix<double, kAngDim<D>, 1>::Zero();  // about the origin
  double maxSpeed = 0;                               // m/s, dynamic bodies
  double maxPenetration = 0, meanPenetration = 0;    // m, over the step's contact points, at the poses after the step
  double jointError = 0, jointTurn = 0;              // m and rad, each the worst
  // Worst |lambda_n * u_n| over contact points without restitution, J: either the impulse or the closing speed must be
  // 0. u_n counts the gap still open at detection, since a contact within the margin may close it.
  double signorini = 0;
  double coulomb = 0;  // worst max(0, |lambda_t| - mu lambda_n), N s
  bool finite = true;  // no NaN or infinity anywhere
};

template <int D>
Invariants<D> invariants(const World<D>& world);

}  // namespace lpc::inline LPC_PRECISION
