// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/ngs_sweep.h"
#include "framework/math/tolerances.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// The first method of the 2009 engine: bodies in contact are moved apart along the normal, each by its share of inverse
// mass, and not turned. A tilted box that touches with one corner is lifted as a whole. Joints are corrected by
// nonlinear Gauss-Seidel, which turns bodies: no translation closes a loop of bars that have wrong angles.
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
    return {
        .name = "linear",
        .summary = "moves bodies apart along the contact normal without rotating them; joints may rotate them",
        .paper = "lpc2009",
        .complexity = "iterations x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures = {{"two pinned bodies in contact", "they cannot be moved at all", "PositionError.TurnsPinnedBodies"},
                     {"bodies that pass each other", "position correction changes their angular momentum",
                      "PositionError.KeepsAngularMomentum"}}};
  }

  void correct(const PositionInput<D>& in) override {
    Bodies<D>& bodies = in.bodies;
    const NgsShare share{.jointFactor = m_params.factor, .stopFactor = m_params.factor};
    for (int i = 0; i < m_params.iterations; ++i) {
      if (in.model.joints) {
        m_joints.sweep({in.dt, bodies, in.manifolds, {}, in.joints, in.model, in.work, in.profiler}, share);
      }
      for (int k : in.order) {
        const Manifold<D>& m = in.manifolds[k];
        const Real ofA = bodies.invMass[m.bodyA], ofB = bodies.invMass[m.bodyB], sum = ofA + ofB;
        for (int p = 0; p < m.count; ++p) {
          const ContactArms<D> arms(m.points[p], m.normal, bodies.pose[m.bodyA], bodies.pose[m.bodyB]);
          const Real depth = -arms.separation - m_params.slop;
          countRows<D>(in.work, 1);
          if (!(depth > 0 && sum > 0)) continue;
          bodies.pose[m.bodyA].p -= (ofA / sum * m_params.factor * depth) * m.normal;
          bodies.pose[m.bodyB].p += (ofB / sum * m_params.factor * depth) * m.normal;
        }
      }
    }
  }

 private:
  Params m_params;
  NgsSweep<D> m_joints;  // of joints alone
};

}  // namespace

LPC_REGISTER(PositionResolver, Linear, 2, 3);

}}  // namespace lpc::LPC_PRECISION
