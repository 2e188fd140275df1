// SPDX-License-Identifier: Zlib
// The gyroscopic term by backward Euler in the body frame, where the inertia is constant:
//
// f(w) = I (w - w0) + dt w x I w = 0, f'(w) = I + dt ([w]x I - [I w]x)
//
// The solution has less energy and less angular momentum than w0 for every step length (multiply by w and by I w).
// Catto takes one Newton step from w0, which is most of the way.
#pragma once

#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Failure of solvers that integrate themselves.
inline const FailureMode kNoGyroscopicTerm = {
    "a spinning body in 3D", "its axis goes round its angular velocity, not its momentum; gyroscopic=true precesses",
    "KnownAnswer.free_precession"};

inline Mat<3> skew(const Vec<3>& v) {
  Mat<3> m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

/// Changes the angular velocity of every turning body by dt of the gyroscopic torque, at the present poses.
inline void gyroscopicStep(Bodies<2>&, Real, int) {}
inline void gyroscopicStep(Bodies<3>& b, Real dt, int iterations) {
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    const Inertia<3>& inverse = b.invInertiaBody[i];
    if (!(b.invInertia[i].trace() > 0) || !(inverse.determinant() > 0)) continue;
    const Inertia<3> inertia = inverse.inverse();
    const Rot<3>& q = b.pose[i].q;
    const Vec<3> start = q.inverse() * b.motion[i].w;
    Vec<3> w = start;
    for (int k = 0; k < iterations; ++k) {
      const Vec<3> momentum = inertia * w;
      const Vec<3> f = inertia * Vec<3>(w - start) + dt * cross(w, momentum);
      const Mat<3> slope = inertia + dt * (skew(w) * inertia - skew(momentum));
      if (!(std::abs(slope.determinant()) > 0)) break;
      w -= slope.inverse() * f;
    }
    b.motion[i].w = q * w;
  }
}

}}}  // namespace lpc::LPC_PRECISION::solver
