// SPDX-License-Identifier: Zlib
#include "framework/force.h"

namespace lpc::inline LPC_PRECISION {

template <int D>
void Spring<D>::apply(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const {
  struct End {
    Vec<D> p = Vec<D>::Zero(), arm = Vec<D>::Zero(), v = Vec<D>::Zero();
    std::size_t slot = 0;
    bool moves = false, gone = false;
  };
  const auto look = [&](const Handle& body, const Vec<D>& local) {
    End end;
    end.p = local;
    if (body.slot < 0) return end;  // a point of the world
    end.slot = static_cast<std::size_t>(body.slot);
    end.gone = end.slot >= state.pose.size() || !state.bodies.used[end.slot] ||
               state.bodies.generation[end.slot] != body.generation;
    if (end.gone) return end;
    const Motion<D>& motion = state.motion[end.slot];
    end.arm = state.pose[end.slot].q * local;
    end.p = state.pose[end.slot].p + end.arm;
    end.v = motion.v + cross(motion.w, end.arm);
    end.moves = state.bodies.type[end.slot] == BodyType::dynamic;
    return end;
  };
  const End a = look(bodyA, localA), b = look(bodyB, localB);
  if (a.gone || b.gone) return;  // an end was removed from the world: the spring has come off
  const Vec<D> apart = b.p - a.p;
  const Real length = apart.norm();
  if (!(length > 0)) return;  // no direction to push in
  const Vec<D> n = apart / length;
  const Vec<D> force = (stiffness * (length - restLength) + damping * (b.v - a.v).dot(n)) * n;  // on A
  if (a.moves) out[a.slot].force += force, out[a.slot].torque += cross(a.arm, force);
  if (b.moves) out[b.slot].force -= force, out[b.slot].torque -= cross(b.arm, force);
}

template <int D>
void Drag<D>::apply(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const {
  for (std::size_t i = 0; i < state.motion.size(); ++i) {
    if (!state.bodies.used[i] || state.bodies.type[i] != BodyType::dynamic) continue;
    const Motion<D>& motion = state.motion[i];
    out[i].force -= (linear + quadratic * motion.v.norm()) * motion.v;
    out[i].torque -= (linear + quadratic * motion.w.norm()) * motion.w;
  }
}

template class Spring<2>;
template class Spring<3>;
template class Drag<2>;
template class Drag<3>;

}  // namespace lpc::inline LPC_PRECISION
