// SPDX-License-Identifier: Zlib
// Planted bugs of forces and of rotated inertias.
#pragma once

#include <memory>
#include <vector>

#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

enum class ForceBug {
  none,
  oneEnd,        // acts on B and not on A
  noArm,         // acts at B's anchor without a moment
  remembers,     // a little more at each evaluation
  movesAll,      // moves bodies that forces must not move
  strays,        // acts on a third body, too
  dividesByGap,  // NaN for two bodies at one place
  grows          // a hundredth larger
};

template <int D>
class SpoiledForce final : public ForceKind<D> {
 public:
  SpoiledForce(std::shared_ptr<const ForceKind<D>> right, ForceBug bug) : m_right(std::move(right)), m_bug(bug) {}

  ForceEnds ends() const override { return m_right->ends(); }
  bool readsContacts() const override { return m_right->readsContacts(); }
  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override {
    const std::vector<Wrench<D>> before(out.begin(), out.end());
    m_right->apply(force, state, t, out);
    const auto a = static_cast<std::size_t>(force.bodyA), b = static_cast<std::size_t>(force.bodyB);
    switch (m_bug) {
      case ForceBug::none:
        break;
      case ForceBug::oneEnd:
        if (force.bodyA >= 0) out[a] = before[a];
        break;
      case ForceBug::noArm:
        if (force.bodyB >= 0) out[b].torque = before[b].torque;
        break;
      case ForceBug::remembers:
        ++m_times;
        for (Wrench<D>& w : out) w.torque *= m_times, w.force *= m_times;
        break;
      case ForceBug::grows:
        for (Wrench<D>& w : out) w.torque *= Real(1.01);
        break;
      case ForceBug::movesAll:
        for (Wrench<D>& w : out) w.force[0] += 1;
        break;
      case ForceBug::strays:
        for (std::size_t i = 0; i < out.size(); ++i) {
          if (movedByForces(state.bodies, i)) out[i].force[0] += 1;
        }
        break;
      case ForceBug::dividesByGap:
        for (std::size_t i = 1; i < out.size(); ++i) {
          out[i].force += (state.pose[i].p - state.pose[0].p) / (state.pose[i].p - state.pose[0].p).norm();
        }
        break;
    }
  }

 private:
  std::shared_ptr<const ForceKind<D>> m_right;
  ForceBug m_bug;
  mutable Real m_times = 0;
};

/// R^T I R.
inline Inertia<3> inertiaTurnedBack(const Rot<3>& q, const Inertia<3>& inertia) {
  return rotateInertia(q.inverse(), inertia);
}

/// Treats inertia as a scalar.
inline Inertia<3> inertiaNotTurned(const Rot<3>&, const Inertia<3>& inertia) { return inertia; }

}}}  // namespace lpc::LPC_PRECISION::test
