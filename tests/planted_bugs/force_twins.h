// SPDX-License-Identifier: Zlib
// Springs and turned inertias with one bug each.
#pragma once

#include "framework/stage_solver.h"

namespace lpc::inline LPC_PRECISION::test {

/// A spring of which one end pulls only, or whose pull has no arm.
template <int D>
struct SpoiledSpring final : ForceGenerator<D> {
  enum class Bug { oneEnd, noArm };
  Spring<D> spring;
  Bug bug;
  SpoiledSpring(const Spring<D>& s, Bug b) : spring(s), bug(b) {}
  void apply(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override {
    spring.apply(state, t, out);
    if (bug == Bug::oneEnd) out[0] = {};
    if (bug == Bug::noArm) out[1].torque.setZero();
  }
};

/// R^T I R.
inline Inertia<3> inertiaTurnedBack(const Rot<3>& q, const Inertia<3>& inertia) {
  return rotateInertia(q.inverse(), inertia);
}

/// Inertia is no scalar.
inline Inertia<3> inertiaNotTurned(const Rot<3>&, const Inertia<3>& inertia) { return inertia; }

}  // namespace lpc::inline LPC_PRECISION::test
