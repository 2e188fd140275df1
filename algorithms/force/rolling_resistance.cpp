// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <vector>

#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Rolling resistance, which the report left open: a circle on a flat floor comes to rest. The load acts ahead of the
// contact by the coefficient, so a torque of coefficient times load opposes rolling at any speed. The load is that of
// the previous step: the first step has none, and after a bounce it is that of the impact.
//
// Each of several contacts may remove at most the share of the speed that it has of the load. The new speed then lies
// between the body's own and its neighbours', and the contacts together never reverse the rotation.
template <int D>
class RollingResistance final : public ForceKind<D> {
 public:
  struct Params {
    Real coefficient = Real(0.01);
    void visit(ParamVisitor& v) {
      v.real("coefficient", coefficient, 0, Real(1e6), "m", "lever of the load against the rolling");
    }
  };
  explicit RollingResistance(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "rolling_resistance",
            .summary = "a torque of a lever times the load against the rolling of whatever touches",
            .paper = "",
            .complexity = "contacts"};
  }

  ForceEnds ends() const override { return {}; }
  bool readsContacts() const override { return true; }

  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    if (!(state.contactDt > 0)) return;
    m_load.assign(state.pose.size(), 0);
    const Bodies<D>& bodies = state.bodies;
    for (const Manifold<D>& m : state.contacts) {
      const Real load = loadOf(force, m);
      for (const std::int32_t body : {m.bodyA, m.bodyB}) {  // a fixed floor carries every load and does not turn
        const auto i = static_cast<std::size_t>(body);
        if (movedByForces(bodies, i)) m_load[i] += load;
      }
    }
    for (const Manifold<D>& m : state.contacts) {
      const Real load = loadOf(force, m);
      if (!(load > 0)) continue;
      const auto a = static_cast<std::size_t>(m.bodyA), b = static_cast<std::size_t>(m.bodyB);
      const Ang<D> rolling = withoutSpin(state.motion[b].w - state.motion[a].w, m.normal);
      const Real speed = rolling.norm();
      if (!(speed > 0)) continue;
      const Ang<D> axis = rolling / speed;
      const auto ease = [&](std::size_t i) {  // rad/s per N m s
        if (!movedByForces(bodies, i)) return Real(0);
        return axis.dot(rotateInertia(state.pose[i].q, bodies.invInertiaBody[i]) * axis);
      };
      const Real gain = (ease(a) + ease(b)) * state.dt, most = std::max(m_load[a], m_load[b]);
      if (!(most > 0)) continue;  // no forces move either body
      const Real share = load / most;
      Real torque = m_params.coefficient * load / state.contactDt;
      if (share * speed < torque * gain) torque = share * speed / gain;
      if (movedByForces(bodies, a)) out[a].torque += torque * axis;
      if (movedByForces(bodies, b)) out[b].torque -= torque * axis;
    }
  }

 private:
  // Load (N s); 0 for a contact that this force does not act on.
  static Real loadOf(const ForceRecord<D>& force, const Manifold<D>& m) {
    if (m.ignored || (force.bodyB >= 0 && m.bodyA != force.bodyB && m.bodyB != force.bodyB)) return 0;
    Real sum = 0;
    for (int k = 0; k < m.count; ++k) sum += std::max(m.points[k].load, Real(0));
    return sum;
  }
  static Ang<2> withoutSpin(const Ang<2>& w, const Vec<2>&) { return w; }
  static Ang<3> withoutSpin(const Ang<3>& w, const Vec<3>& n) { return w - w.dot(n) * n; }

  Params m_params;
  mutable std::vector<Real> m_load;  // scratch, per body, N s
};

}  // namespace

LPC_REGISTER(ForceKind, RollingResistance, 2, 3);

}}  // namespace lpc::LPC_PRECISION
