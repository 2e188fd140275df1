// SPDX-License-Identifier: Zlib
#pragma once

#include <limits>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Physical invariants of a state. They are computed from poses, velocities and the scene's masses, independently of
/// the algorithms, in double for both precisions.
template <int D>
struct StateInvariants {
  double kinetic = 0, potential = 0;  // J; potential of gravity only, zero at the height of the origin
  Eigen::Matrix<double, D, 1> momentum = Eigen::Matrix<double, D, 1>::Zero();  // kg m/s
  Eigen::Matrix<double, kAngDim<D>, 1> angularMomentum =
      Eigen::Matrix<double, kAngDim<D>, 1>::Zero();  // about the origin
  double maxSpeed = 0;                               // m/s, dynamic bodies
  double jointError = 0, jointTurn = 0;              // m and rad, each the maximum over all joints
  bool finite = true;                                // no NaN or infinity anywhere
};

/// Invariants of the contacts of the step. They are NaN when the simulation does not report contacts.
struct ContactInvariants {
  static constexpr double kNotTold = std::numeric_limits<double>::quiet_NaN();
  // m, over the contact points, at the poses after the step
  double maxPenetration = kNotTold, meanPenetration = kNotTold;
  // Largest |lambda_n * u_n| over contact points without restitution, J: either the impulse or the closing speed must
  // be 0. The speed u_n includes separation / dt, because a contact within the margin may close its gap.
  double complementarity = kNotTold;
  double coneExcess = kNotTold;  // largest max(0, |lambda_t| - mu lambda_n), N s
};

template <int D>
struct Invariants : StateInvariants<D>, ContactInvariants {};

template <int D>
StateInvariants<D> stateInvariants(const Simulation<D>& simulation);
/// Computes only `finite` of stateInvariants, which is cheaper.
template <int D>
bool stateIsFinite(const Simulation<D>& simulation);
template <int D>
ContactInvariants contactInvariants(const Simulation<D>& simulation);
template <int D>
Invariants<D> invariants(const Simulation<D>& simulation) {
  return {stateInvariants(simulation), contactInvariants(simulation)};
}

}}  // namespace lpc::LPC_PRECISION
