// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/frame_rows.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Joint of a ragdoll: a pivot that keeps the x axis of B's frame within a cone about the x axis of A's frame. Swing is
// the angle between the two axes. Twist is the remaining rotation about x, after the shortest rotation from A's x to
// B's. In 2D there is no twist, and the cone is two limits.
template <int D>
class ConeTwist final : public JointKind<D> {
 public:
  struct Params {
    Real swing = 1, twist = Real(0.5), friction = 0;
    void visit(ParamVisitor& v) {
      v.real("swing", swing, 0, kFree, "rad", "largest angle between the x of both frames, > 0; 3.1416: any");
      v.real("twist", twist, 0, kFree, "rad", "largest turn about x, to either side; 3.1416: any; 2D has none");
      v.real("friction", friction, 0, Real(1e12), "N m", "torque that brakes, at most, about each axis of A's frame");
    }
  };
  explicit ConeTwist(const Params& params) : m_params(params) {
    if (params.swing == 0) throw UserError("'cone_twist' has a cone of no width; valid: swing > 0, or a hinge or weld");
  }

  static AlgorithmInfo info() {
    return {.name = "cone_twist",
            .summary = "a point stays together, a bone within a cone and a twist: ragdolls; in 2D a pivot with limits",
            .paper = "baerlocher2001",
            .complexity = "D rows, solved as one block, and 2 in 2D, 5 in 3D for limits and friction",
            .guarantee = Guarantee::approximate,
            .failures = {{"both sides of the limits within reach of one step", "only the nearer holds",
                          "JointConformance.OfTwoStopsTheNearerHoldsAlone"}}};
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    for (int i = 0; i < D; ++i) out.point(Vec<D>::Unit(i), at.rA, at.rB, at.gap[i]);
    limits(at, out);
    for (int i = 0; i < kAngDim<D>; ++i) {
      if (m_params.friction == 0) {
        out.absent();
      } else {
        drive(out.turn(axisOfTurn(at, i), 0), 0, m_params.friction);
      }
    }
  }

 private:
  static constexpr Real kFree = Real(3.1416);  // rad: no limit

  void limits(const JointFrames<2>& at, JointRows<2>& out) const {
    if (m_params.swing == kFree) {
      out.absent();
    } else {
      keepBetween(out.turn(axisOfTurn(at, 0), turnInA(at)[0]), -m_params.swing, m_params.swing);
    }
  }

  void limits(const JointFrames<3>& at, JointRows<3>& out) const {
    const Vec<3> xA = at.qA * Vec<3>(1, 0, 0), xB = at.qB * Vec<3>(1, 0, 0);
    if (m_params.swing == kFree) {
      out.absent();
    } else {
      const Vec<3> bent = cross(xA, xB);
      const Real sine = bent.norm(), angle = static_cast<Real>(angleOf(sine, xA.dot(xB)));
      // A straight joint may swing to any side; pick one.
      const Vec<3> axis = sine > 0 ? Vec<3>(bent / sine) : Vec<3>(at.qA * Vec<3>(0, 0, 1));
      ConstraintRow<3>& row = out.turn(axis, angle - m_params.swing);
      row.block = RowBlock::box, row.hi = 0;
    }
    // The rate of twist is w . (xA + xB) / (1 + cos(swing)). Along the unit bisector of the two axes it is cos(swing /
    // 2) of that, which also scales the error: zero where the axes are opposite and twist is undefined.
    const Vec<3> middle = xA + xB;
    const Real length = middle.norm();
    if (m_params.twist == kFree || !(length > 0)) {
      out.absent();
    } else {
      const Rot<3> q = at.qA.inverse() * at.qB;
      const double twist = 2 * (q.w < 0 ? angleOf(-q.x, -q.w) : angleOf(q.x, q.w));
      ConstraintRow<3>& row = out.turn(middle / length, static_cast<Real>(twist));
      keepBetween(row, -m_params.twist, m_params.twist);
      row.error *= length / 2;
    }
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, ConeTwist, 2, 3);

}}  // namespace lpc::LPC_PRECISION
