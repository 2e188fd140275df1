// SPDX-License-Identifier: Zlib
#include "algorithms/solver/contact_rows.h"
#include "framework/profiler.h"
#include "framework/tolerances.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// The 2009 engine's first method: bodies are moved apart along the normal, each by the share of its inverse mass, and
// never turned. A tilted box that touches with one corner is lifted as a whole.
template <int D>
class Linear final : public PositionResolver<D> {
 public:
  struct Params {
    int iterations = 1;
    Real factor = 1;
    Real slop = kLinearSlop;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 10000, "passes over all joints and contacts");
      v.real("factor", factor, 0, 1, "1", "share of the error to remove in one pass");
      v.real("slop", slop, 0, 1, "m", "depth that stays, so that resting contacts do not come and go");
    }
  };
  explicit Linear(const Params& params) : m_params(params) {}

  static Info info() {
    return {.name = "linear",
            .summary = "moves bodies apart along the normal without turning them",
            .paper = "lpc2009",
            .complexity = "iterations x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {{"two pinned bodies", "cannot be moved at all", "PositionError.TurnsPinnedBodies"}}};
  }

  void correct(const PositionInput<D>& in) override {
    Bodies<D>& bodies = in.bodies;
    const auto push = [&](std::size_t a, std::size_t b, const Vec<D>& apart) {
      const Real sum = bodies.invMass[a] + bodies.invMass[b];
      if (!(sum > 0)) return;
      bodies.pose[a].p -= (bodies.invMass[a] / sum) * apart;
      bodies.pose[b].p += (bodies.invMass[b] / sum) * apart;
    };
    for (int i = 0; i < m_params.iterations; ++i) {
      for (const PivotJoint<D>& j : in.joints) {
        if (j.bodyA < 0 || !in.features.joints) continue;
        const auto a = static_cast<std::size_t>(j.bodyA), b = static_cast<std::size_t>(j.bodyB);
        const Vec<D> error =
            (bodies.pose[b].p - bodies.pose[a].p) + bodies.pose[b].q * j.localB - bodies.pose[a].q * j.localA;
        push(a, b, -m_params.factor * error);
        ++in.work[Count::rowUpdates];
      }
      for (int k : in.order) {
        const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(k)];
        const auto a = static_cast<std::size_t>(m.bodyA), b = static_cast<std::size_t>(m.bodyB);
        for (int p = 0; p < m.count; ++p) {
          const ContactPoint<D>& c = m.points[static_cast<std::size_t>(p)];
          const Real depth = -ContactArms<D>(c, m.normal, bodies.pose[a], bodies.pose[b]).separation - m_params.slop;
          if (depth > 0) push(a, b, m_params.factor * depth * m.normal);
          ++in.work[Count::rowUpdates];
        }
      }
    }
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(PositionResolver, Linear, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
