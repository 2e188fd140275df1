// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/contact_rows.h"
#include "framework/math/tolerances.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// The first method of the 2009 engine: bodies are moved apart along the normal, each by its share of inverse mass, and
// never turned. A tilted box that touches with one corner is lifted as a whole.
template <int D>
class Linear final : public PositionResolver<D> {
 public:
  struct Params {
    int iterations = 1;
    Real factor = 1;
    Real slop = kLinearSlop;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 10000, "passes over all joints and contacts", ParamRole::effort);
      v.real("factor", factor, 0, 1, "1", "fraction of the error corrected per pass");
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
    }
  };
  explicit Linear(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "linear",
            .summary = "moves bodies apart along the contact normal without rotating them",
            .paper = "lpc2009",
            .complexity = "iterations x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {{"two pinned bodies", "they cannot be moved at all", "PositionError.TurnsPinnedBodies"},
                         {"a joint with an angular error", "the error stays", "Joint.ErrorsShrink"},
                         {"bodies that pass each other", "position correction changes their angular momentum",
                          "PositionError.KeepsAngularMomentum"}}};
  }

  void correct(const PositionInput<D>& in) override {
    Bodies<D>& bodies = in.bodies;
    const auto push = [&](std::int32_t bodyA, std::int32_t b, const Vec<D>& apart) {
      const Real ofA = bodyA < 0 ? Real(0) : bodies.invMass[bodyA], sum = ofA + bodies.invMass[b];
      if (!(sum > 0)) return;
      if (ofA > 0) bodies.pose[bodyA].p -= (ofA / sum) * apart;
      bodies.pose[b].p += (bodies.invMass[b] / sum) * apart;
    };
    for (int i = 0; i < m_params.iterations; ++i) {
      for (const JointRecord<D>& j : in.joints) {
        if (!j.active() || !in.model.joints) continue;
        jointRows(j, bodies, m_rows);
        Vec<D> error = Vec<D>::Zero();  // errors that only a rotation could correct remain
        for (const ConstraintRow<D>& row : m_rows.all()) {
          if (row.binds()) error += row.error * row.d;
        }
        push(j.bodyA, j.bodyB, -m_params.factor * error);
        countRows<D>(in.work, m_rows.all().size());
      }
      for (int k : in.order) {
        const Manifold<D>& m = in.manifolds[k];
        const auto a = m.bodyA, b = m.bodyB;
        for (int p = 0; p < m.count; ++p) {
          const ContactPoint<D>& c = m.points[p];
          const Real depth = -ContactArms<D>(c, m.normal, bodies.pose[a], bodies.pose[b]).separation - m_params.slop;
          if (depth > 0) push(m.bodyA, m.bodyB, m_params.factor * depth * m.normal);
          countRows<D>(in.work, 1);
        }
      }
    }
  }

 private:
  Params m_params;
  JointRows<D> m_rows;
};

}  // namespace

LPC_REGISTER(PositionResolver, Linear, 2, 3);

}}  // namespace lpc::LPC_PRECISION
