// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Six-axis spring: each translation and each rotation of B's frame relative to A's has a damped spring, and no row is
// rigid. A stiffness in N/m means the same in every method, unlike the softness of a solver's own constraints.
template <int D>
class SpringJoint final : public JointKind<D> {
 public:
  struct Params {
    Real stiffness = 100, damping = 1, angularStiffness = 100, angularDamping = 1;
    void visit(ParamVisitor& v) {
      v.real("stiffness", stiffness, 0, Real(1e12), "N/m", "that pulls the frames together; 0: none");
      v.real("damping", damping, 0, Real(1e12), "N s/m", "of their way");
      v.real("angular_stiffness", angularStiffness, 0, Real(1e12), "N m/rad", "that turns the frames alike; 0: none");
      v.real("angular_damping", angularDamping, 0, Real(1e12), "N m s/rad", "of their turn, the shortest");
    }
  };
  explicit SpringJoint(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "spring",
            .summary = "damped springs against all that moves two frames apart: a weld that gives",
            .paper = "catto2011",
            .complexity = "3 rows in 2D, 6 in 3D, one by one"};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 0; i < D; ++i) {
      if (m_params.stiffness == 0 && m_params.damping == 0) {
        out.absent();
      } else {
        makeSpring(slide(at, i, out), m_params.stiffness, m_params.damping);
      }
    }
    const Ang<D> turn = turnInA(at);
    for (int i = 0; i < kAngDim<D>; ++i) {
      if (m_params.angularStiffness == 0 && m_params.angularDamping == 0) {
        out.absent();
      } else {
        makeSpring(out.turn(axisOfTurn(at, i), turn[i]), m_params.angularStiffness, m_params.angularDamping);
      }
    }
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, SpringJoint, 2, 3);

}}  // namespace lpc::LPC_PRECISION
