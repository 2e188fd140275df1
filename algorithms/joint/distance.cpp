// SPDX-License-Identifier: Zlib
#include <limits>

#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class DistanceMode { rod, spring, rope };

// One row along the line between two points. If the points coincide there is no line: a rope or spring of length zero
// then has no row. A rod of length zero is a pivot and is refused.
template <int D>
class Distance final : public JointKind<D> {
 public:
  struct Params {
    DistanceMode mode = DistanceMode::rod;
    Real length = -1, stiffness = 100, damping = 0;
    void visit(ParamVisitor& v) {
      v.choice("mode", mode, {"rod", "spring", "rope"},
               "rod: fixed length; spring: damped spring; rope: largest length");
      v.real("length", length, -1, Real(1e9), "m", "length; -1: the distance at creation");
      v.real("stiffness", stiffness, 0, Real(1e12), "N/m", "stiffness of the spring");
      v.real("damping", damping, 0, Real(1e12), "N s/m", "damping of the spring");
    }
  };
  explicit Distance(const Params& params) : m_params(params) {
    if (params.length < 0 && params.length != -1)
      throw UserError("'distance' has a negative length; valid: -1 or >= 0");
    if (params.mode == DistanceMode::spring) return;
    if (params.damping != 0) throw UserError("'distance' has damping, but its mode is not spring; valid: mode=spring");
    if (params.stiffness != Params().stiffness) {
      throw UserError("'distance' has stiffness, but its mode is not spring; valid: mode=spring");
    }
  }

  static AlgorithmInfo info() {
    return {.name = "distance",
            .summary = "distance constraint between two points: rod, damped spring or rope",
            .paper = "catto2011",
            .complexity = "1 row"};
  }

  void begin(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    joint.state[0] = m_params.length < 0 ? JointFrames<D>(joint, X_WA, X_WB).gap.norm() : m_params.length;
    // Two frames made at one point differ by the rounding of their bodies' poses.
    const Real reach = joint.X_CaJ.p.norm() + joint.X_CbJ.p.norm() + X_WA.p.norm() + X_WB.p.norm();
    if (m_params.mode == DistanceMode::rod && !(joint.state[0] > 16 * std::numeric_limits<Real>::epsilon() * reach)) {
      throw UserError("'distance' is a rod of length 0; valid: two points apart, or a pivot");
    }
  }

  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    const JointFrames<D> at(joint, X_WA, X_WB);
    const Real distance = at.gap.norm();
    const Vec<D> d = distance > 0 ? Vec<D>(at.gap / distance) : Vec<D>(Vec<D>::Unit(0));
    if (!(distance > 0) && m_params.mode != DistanceMode::rod) {
      out.absent();
      return;
    }
    ConstraintRow<D>& row = out.point(d, at.rA, at.rB, distance - joint.state[0]);
    if (distance > 0) row.bend = 1 / distance;
    switch (m_params.mode) {
      case DistanceMode::rod:
        break;
      case DistanceMode::spring:
        row.block = RowBlock::box, row.law = RowLaw::spring;
        row.stiffness = m_params.stiffness, row.damping = m_params.damping;
        break;
      case DistanceMode::rope:
        row.block = RowBlock::box;
        row.hi = 0;  // pulls only, towards A
        break;
    }
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(JointKind, Distance, 2, 3);

}}  // namespace lpc::LPC_PRECISION
