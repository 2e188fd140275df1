// SPDX-License-Identifier: Zlib
#include <limits>

#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Explicit spring, stable up to w dt = 2. Use the joints `spring` or `distance` for stiffer ones.
template <int D>
class LinearSpring final : public ForceKind<D> {
 public:
  struct Params {
    Real stiffness = 100, damping = 0, restLength = 0;
    void visit(ParamVisitor& v) {
      constexpr Real kAny = std::numeric_limits<Real>::max();  // a blow-up is a result, too
      v.real("stiffness", stiffness, 0, kAny, "N/m", "pulls its ends to their distance");
      v.real("damping", damping, 0, kAny, "N s/m", "of the speed along it");
      v.real("rest_length", restLength, 0, kAny, "m", "at which it neither pulls nor pushes");
    }
  };
  explicit LinearSpring(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "spring",
            .summary = "linear spring with a damper, between two points of bodies, or the world and a body",
            .paper = "lpc2009",
            .complexity = "1"};
  }

  ForceEnds ends() const override { return {.from = true, .all = false, .anchors = true}; }

  void begin(const ForceRecord<D>& force, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    const Vec<D> a = X_WA * force.localA, b = X_WB * force.localB;
    const Real rounding = 4 * std::numeric_limits<Real>::epsilon() * (a.norm() + b.norm());
    if (m_params.restLength > 0 && (b - a).norm() <= rounding) {
      throw UserError("a spring whose ends meet has no direction to push in; valid: rest_length 0, or ends apart");
    }
  }

  void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    const ForceEnd<D> a(state, force.bodyA, force.localA), b(state, force.bodyB, force.localB);
    const Vec<D> apart = b.p - a.p;
    const Real length = apart.norm();
    if (!(length > 0)) return;  // no direction to push in
    const Vec<D> n = apart / length;
    const Real stretch = length - m_params.restLength, growth = (b.v - a.v).dot(n);
    const Vec<D> pull = (m_params.stiffness * stretch + m_params.damping * growth) * n;  // on A
    a.push(pull, state.bodies, out);
    b.push(-pull, state.bodies, out);
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(ForceKind, LinearSpring, 2, 3);

}}  // namespace lpc::LPC_PRECISION
