// SPDX-License-Identifier: Zlib
// Planted bugs of joints.
#pragma once

#include <memory>

#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

enum class JointBug {
  none,
  pulls,       // a stop that holds in both directions
  endless,     // a motor or a spring without a force limit
  oneBody,     // turns B and not A
  jumps,       // its angle forgets whole turns
  weightless,  // ignores the masses
  wrongSign,   // increases the error
  ownAxes,     // rows along the world's axes instead of the bodies' axes
  drives,      // moves bodies that it should hold
  yields,      // a soft joint instead of a rigid one: a compliance in absolute units
  turnsLeft,   // each impulse turns B a little to the left
  ages,        // changes with every step, however short
  noArm,       // forgets B's arm where A is the world
  dividesByNothing
};

template <int D>
class WrongJoint final : public JointKind<D> {
 public:
  WrongJoint(std::shared_ptr<const JointKind<D>> right, JointBug bug) : m_right(std::move(right)), m_bug(bug) {}

  void begin(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    m_right->begin(joint, X_WA, X_WB);
  }
  void finish(JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB) const override {
    m_right->finish(joint, X_WA, X_WB);
    if (m_bug == JointBug::jumps) joint.state[0] = 0;
    if (m_bug == JointBug::ages) joint.state[0] += Real(1e-5);
  }
  void weigh(JointRecord<D>& joint, Real mass) const override {
    m_right->weigh(joint, m_bug == JointBug::weightless ? Real(1) : mass);
  }
  void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const override {
    m_right->rows(joint, X_WA, X_WB, out);
    for (int i = 0; i < out.count; ++i) spoil(out.row[static_cast<std::size_t>(i)], joint.bodyA < 0);
  }

 private:
  void spoil(ConstraintRow<D>& row, bool onTheWorld) const {
    constexpr Real kNoLimit = ConstraintRow<D>::kNoLimit;
    const bool stop = row.law == RowLaw::rigid && row.block == RowBlock::box && !row.absent();
    switch (m_bug) {
      case JointBug::none:
      case JointBug::jumps:
      case JointBug::weightless:
      case JointBug::ages:
        break;
      case JointBug::pulls:
        if (stop) row.lo = -kNoLimit, row.hi = kNoLimit;
        break;
      case JointBug::endless:
        if (row.law != RowLaw::rigid && !row.absent()) row.lo = -kNoLimit, row.hi = kNoLimit;
        break;
      case JointBug::oneBody:
        row.armA.setZero();
        break;
      case JointBug::wrongSign:
        row.error = -row.error;
        break;
      case JointBug::ownAxes:
        row.d = row.d.norm() * Vec<D>::Unit(0);
        break;
      case JointBug::drives:
        if (row.law == RowLaw::rigid) row.block = RowBlock::box, row.law = RowLaw::motor, row.speed = 5;
        break;
      case JointBug::yields:
        if (row.law == RowLaw::rigid) {
          row.block = RowBlock::box, row.law = RowLaw::spring, row.stiffness = 1000, row.damping = 10;
        }
        break;
      case JointBug::turnsLeft:
        row.armB += Ang<D>::Constant(Real(0.01));
        break;
      case JointBug::noArm:
        if (onTheWorld) row.armB.setZero();
        break;
      case JointBug::dividesByNothing:
        row.error /= row.d.norm() - 1;
        break;
    }
  }

  std::shared_ptr<const JointKind<D>> m_right;
  JointBug m_bug;
};

}}}  // namespace lpc::LPC_PRECISION::test
