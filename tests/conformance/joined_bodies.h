// SPDX-License-Identifier: Zlib
// Every registered kind of joint, between bodies made by hand or drawn at random, without a world.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D>
using Kind = std::shared_ptr<const JointKind<D>>;

template <int D>
Kind<D> kindOf(const std::string& spec) {
  return createStage<JointKind<D>>(Spec::parse(spec));
}

/// All kinds with their defaults, with each of their choices, and some with other numbers.
template <int D>
std::vector<std::string> everyKind() {
  std::vector<std::string> specs;
  for (const Registered* r : Registry::instance().list(StageKind::joint, D)) {
    if (!competes(*r)) continue;
    specs.push_back(r->info.name);
    for (const ParamInfo& p : r->params) {
      for (const std::string& choice : p.choices) {
        if (choice != p.defaultText) specs.push_back(r->info.name + "{" + p.name + "=" + choice + "}");
      }
    }
  }
  for (const char* more :
       {"hinge{lower=-0.1,upper=0.2}", "hinge{lower=0,upper=0}", "hinge{motor_speed=2,motor_torque=3}",
        "hinge{stiffness=20,damping=1}", "distance{mode=spring,damping=3}", "prismatic{lower=-0.1,upper=0.2}",
        "prismatic{motor_speed=2,motor_force=3,stiffness=20}", "wheel{lower=0,upper=0,stiffness=0,damping=0}",
        "cone_twist{swing=0.1,twist=0.1,friction=2}", "gear{ratio=-2.5}", "mouse{max_force=30}"}) {
    specs.push_back(more);
  }
  return specs;
}

/// Every solver, except variants of the order of contacts: there are no contacts.
template <int D>
std::vector<std::string> everySolverOfJoints() {
  std::vector<std::string> specs = everySolver<D>();
  std::erase_if(specs, [](const std::string& spec) { return spec.find("{order=") != spec.npos; });
  return specs;
}

/// Rows of frames that are apart; otherwise some rows would be absent.
template <int D>
JointRows<D> someRows(const Kind<D>& kind) {
  JointRows<D> rows;
  kind->rows({}, {}, {Vec<D>::Unit(0), {}}, rows);
  return rows;
}
/// Does it stay at rest without load? So no motor, except one that brakes.
template <int D>
bool passive(const Kind<D>& kind) {
  const JointRows<D> rows = someRows(kind);
  return std::none_of(rows.all().begin(), rows.all().end(), [](const ConstraintRow<D>& row) {
    return row.law == RowLaw::motor && !row.absent() && row.speed != 0;
  });
}
/// Are all its rows rigid? Springs and motors take time, and no single solve ends their work.
template <int D>
bool rigid(const Kind<D>& kind) {
  const JointRows<D> rows = someRows(kind);
  return std::all_of(rows.all().begin(), rows.all().end(),
                     [](const ConstraintRow<D>& row) { return row.law == RowLaw::rigid || row.absent(); });
}

/// Does it have a one-sided row, or a rigid row solved on its own?
template <int D>
bool hasStop(const Kind<D>& kind) {
  const JointRows<D> rows = someRows(kind);
  return std::any_of(rows.all().begin(), rows.all().end(), [](const ConstraintRow<D>& row) {
    return row.law == RowLaw::rigid && row.block == RowBlock::box && !row.absent();
  });
}

/// Is an error large, or does a spring pull it in?
template <int D>
bool strained(const JointRows<D>& rows) {
  return std::any_of(rows.all().begin(), rows.all().end(), [](const ConstraintRow<D>& row) {
    return (row.binds() || (row.law == RowLaw::spring && !row.absent())) && std::abs(row.error) > Real(0.1);
  });
}

/// Each frame is a point of its body; they are `apart` from each other if the kind has two ends. a = -1: the world.
template <int D>
void join(ImpactScene<D>& s, const Kind<D>& kind, int a, int b, const Pose<D>& X_WJ, const Vec<D>& apart) {
  JointRecord<D> j;
  j.kind = kind, j.spec = "drawn", j.bodyA = a, j.bodyB = b;
  const auto place = [&](const Vec<D>& way) {
    const Pose<D> X_WA = poseOf(s.bodies, a), A = X_WA.inverse(), B = s.pose(b).inverse();
    j.state = {};
    j.X_CaJ = {A * X_WJ.p, A.q * X_WJ.q};
    j.X_CbJ = {B * Vec<D>(X_WJ.p + way), B.q * X_WJ.q};
    kind->begin(j, X_WA, s.pose(b)), kind->weigh(j, massBetween(s.bodies, a, b));
  };
  place(apart);
  if (strained(s.rows(j))) place(Vec<D>::Zero());  // a kind with both ends at one point
  s.joints.push_back(j);
}

/// Starts the state of the joints anew from the poses of the bodies. A moved scene gets the same state, except where
/// joints refer to the world.
template <int D>
void beginAnew(ImpactScene<D>& s) {
  for (JointRecord<D>& j : s.joints) {
    j.kind->begin(j, poseOf(s.bodies, j.bodyA), s.pose(j.bodyB));
    j.kind->weigh(j, massBetween(s.bodies, j.bodyA, j.bodyB));
  }
}

/// Do its torques balance without the world?
template <int D>
bool balanced(const JointRows<D>& rows) {
  return std::all_of(rows.all().begin(), rows.all().end(),
                     [](const ConstraintRow<D>& row) { return !row.angular || row.absent() || row.armA == row.armB; });
}

/// Bodies 0 and 1, joined; body 0 may be fixed.
template <int D>
ImpactScene<D> drawJointed(Draw& draw, const Kind<D>& kind, bool fixed = false) {
  ImpactScene<D> s;
  for (int i = 0; i < 2; ++i) {
    Ang<D> inertia;
    for (int k = 0; k < kAngDim<D>; ++k) inertia[k] = draw.real(0.5, 2);
    Motion<D> motion;
    motion.v = 2 * drawVector<D>(draw);
    for (int k = 0; k < kAngDim<D>; ++k) motion.w[k] = 2 * draw.signedUnit();
    const Real mass = fixed && i == 0 ? Real(0) : draw.real(1, 5);
    s.add(mass, inertia, drawPose<D>(draw, 1), mass > 0 ? motion : Motion<D>{});
  }
  const Pose<D> X_WJ{drawVector<D>(draw), drawRotation<D>(draw)};
  join<D>(s, kind, 0, 1, X_WJ, Real(0.7) * drawDirection<D>(draw));
  return s;
}

template <int D>
void nudge(ImpactScene<D>& s, Draw& draw, Real amount) {
  s.bodies.pose[1].p += amount * drawVector<D>(draw);
  Ang<D> turn;
  for (int k = 0; k < kAngDim<D>; ++k) turn[k] = amount * draw.signedUnit();
  s.bodies.pose[1].q = integrateRotation(s.bodies.pose[1].q, turn);
  s.bodies.invInertia[1] = rotateInertia(s.bodies.pose[1].q, s.bodies.invInertiaBody[1]);
}

/// One step; then each joint updates its state.
template <int D>
void stepJoined(ImpactScene<D>& s, Solver<D>& solver) {
  s.step(solver);
  for (JointRecord<D>& j : s.joints) j.kind->finish(j, poseOf(s.bodies, j.bodyA), s.pose(j.bodyB));
}

/// One property of a table, applied to `on`, with RapidCheck's draws.
template <class Named, class Subject>
auto drawn(const Named& p, const Subject& on) {
  return [&p, on] {
    RapidCheckDraw draw;
    p.property(on, draw);
  };
}

}}}  // namespace lpc::LPC_PRECISION::test
