// SPDX-License-Identifier: Zlib
// Shared by solvers that move bodies several times per detection: contacts with separations that follow from the
// anchors, joints with renewed rows, warm starting from sub-step to sub-step, restitution at the end of the step.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "algorithms/solver/lanes/contact_lanes.h"
#include "algorithms/solver/rows/body_displacements.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "algorithms/solver/step/free_motion.h"
#include "algorithms/solver/step/gyroscopic.h"
#include "algorithms/solver/step/remade_contacts.h"
#include "framework/math/indexed.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// A contact or joint as a damped spring, solved implicitly: stable at any stiffness, in units that do not depend on
/// mass.
struct Softness : Feedback {
  Softness() = default;
  Softness(Real hertz, Real dampingRatio, Real h) {
    if (!(hertz > 0)) return;
    const Real w = Real(6.283185307179586) * hertz;
    const Real c = 2 * dampingRatio + h * w;
    rate = w / c;
    impulseScale = 1 / (1 + h * w * c);
    massScale = 1 - impulseScale;
  }
};

/// The error feedback of a sweep. By default none, so that a sweep removes the velocity that an earlier one added.
struct ErrorFeedback {
  Feedback contact, contactFixed, joint;  // contactFixed: one body cannot move, so the other may be stiffer
  Real slop = 0;                          // m, of contacts
  Real maxSpeed = 0;                      // m/s, of contacts
  bool softGaps = false;                  // springs also stop what closes a gap: a law without a jump at touch
};

/// Whether friction acts with the restitution impulse.
enum class BounceFriction { frictionless, withFriction };

/// The springs of sub-steps of length h. Joints are twice as stiff as contacts.
inline ErrorFeedback springs(Real hertz, Real dampingRatio, Real jointDampingRatio, Real maxSpeed, Real h) {
  return {Softness(hertz, dampingRatio, h), Softness(2 * hertz, dampingRatio, h),
          Softness(2 * hertz, jointDampingRatio, h), 0, maxSpeed};
}

/// Failure declared by methods that keep the arms of the detection.
inline const FailureMode kArmsStay = {
    "bodies in contact that rotate together",
    "they lose angular momentum: bodies rotate in the sub-steps, but lever arms do not",
    "Solver.TurningKeepsAngularMomentum"};
/// Failure of solvers that move bodies within a step.
inline const FailureMode kRollsExplicitly = {
    "a body that rocks or rolls on a curved one",
    "its swing grows: within a step, forces do not follow the contact point as it rolls; contacts=substep does",
    "KnownAnswer.rocking_plank"};
/// A method's own failures and those of all sub-step methods that warm start from sub-step to sub-step. `braked`
/// describes how.
inline std::vector<FailureMode> substepFailures(const std::string& braked, std::vector<FailureMode> own) {
  for (const FailureMode& shared :
       {kNoGyroscopicTerm, kRollsExplicitly,
        FailureMode{
            "bodies that separate within the step",
            "a contact that opened in a sub-step keeps its impulse, so the result depends on the order of contacts",
            "Solver.OrderDoesNotMatter"},
        FailureMode{"a heavy body that falls on a light one",
                    "each sub-step warm starts with the impact's impulse again, so the body is thrown up",
                    "Solver.HeavyIsNotThrownUp"},
        FailureMode{"a heavy body that falls on a light one", braked, "Solver.ConvergesAsPredicted"},
        FailureMode{
            "bodies that collide, with more sub-steps",
            "they have more energy than with fewer sub-steps: an impact's impulse acts again in the next sub-step",
            "Solver.MoreIsNoWorse"}}) {
    own.push_back(shared);
  }
  return own;
}

struct SubstepPlan {
  int count = 1;
  bool warmStart = true;  // from the impulses of the last step
  bool gyroscopic = false, armsAsMade = false;
  ContactsOf contacts = ContactsOf::step;
  SweepOrder order = SweepOrder::stored;
  SweepLanes lanes = SweepLanes::automatic;
};

/// The contacts and joints of a step of equal sub-steps. Directions of contacts are those of the detection, and so are
/// arms unless they are turned. Separations are those of the anchors, which move with the bodies.
///
/// The displacement of each body since the start of the step is stored besides its position. A position in f32 a
/// kilometre away is rounded to 0.06 mm; as a separation that would be a speed of 60 mm/s in a sub-step of 1 ms.
template <int D>
class Substeps {
 public:
  void prepare(const StepInput<D>& in, const SubstepPlan& plan) {
    Profiler::Scope scope(in.profiler, "solver.prepare");
    m_plan = plan, m_count = static_cast<Real>(plan.count), m_h = in.dt / m_count;
    haltUnmoving(in.bodies, in.model.rotation);
    m_start.resize(in.bodies.pose.size());
    for (std::size_t k = 0; k < m_start.size(); ++k) m_start[k] = in.bodies.pose[k].p;
    m_displacement.assign(m_start.size(), Vec<D>::Zero());
    const Real scale = lastImpulseScale(in) / m_count;
    prepareContacts(in, plan.warmStart ? scale : 0);
    m_jointImpulse.resize(in.joints.size());
    for (std::size_t j = 0; j < in.joints.size(); ++j) {
      m_jointImpulse[j] = {};
      for (std::size_t i = 0; i < kJointRows && plan.warmStart; ++i) {
        m_jointImpulse[j].substep[i] = scale * in.joints[j].memory[i];
      }
    }
    m_joints.clear();
  }

  Real h() const { return m_h; }  // s

  /// Applies the forces of sub-step i and makes the joint rows, and if so planned the contacts, at the present poses.
  void begin(const StepInput<D>& in, int i) {
    if (i > 0 && m_plan.contacts == ContactsOf::substep) makeContacts(in);
    Profiler::Scope scope(in.profiler, "solver.integrate");
    kick<D>({m_h, in.time + static_cast<Real>(i) * m_h, in.bodies, in.forces, in.model, in.work}, m_wrenches);
    if (m_plan.gyroscopic && in.model.rotation) gyroscopicStep(in.bodies, m_h, 1);
    if (!in.model.joints) return;
    m_joints.prepare(in.work, in.bodies, in.joints, 0, displacements());
    m_joints.warmStart(m_h, [&](std::int32_t joint, std::int32_t row) { return m_jointImpulse[joint].substep[row]; });
  }

  /// Solves, warm started from the previous sub-step.
  void solve(const StepInput<D>& in, const ErrorFeedback& errors, int iterations) {
    Profiler::Scope scope(in.profiler, "solver.iterate");
    m_joints.applyAccumulated(in.bodies.motion);
    m_contacts.loadMotion(in.bodies.motion);
    applyBlocks(m_contacts, in.model.rotation);
    sweep(in, errors, iterations);
    m_contacts.storeMotion(in.bodies, in.bodies.motion);
  }

  /// Moves the bodies. Separations follow unless the method keeps those of the detection.
  void move(const StepInput<D>& in, bool separationsFollow = true) {
    Profiler::Scope scope(in.profiler, "solver.move");
    m_motion.move(in.bodies, in.bodies.motion, m_h, in.model.rotation);
    for (std::size_t k = 0; k < in.bodies.pose.size(); ++k) {
      if (!travels(in.bodies, k)) continue;
      m_displacement[k] += m_h * in.bodies.motion[k].v;
      in.bodies.pose[k].p = m_start[k] + m_displacement[k];
    }
    if (separationsFollow) measure(in);
  }

  /// For position resolvers, which move bodies themselves.
  BodyDisplacements<D> displacements() { return {m_start, m_displacement}; }

  /// Turns the arms of contacts with the bodies. Shared: both bodies get the impulse at one point, so it adds no torque
  /// to the pair (sharedArms()). Not shared: each body gets the impulse at its own anchor. Contacts made at
  /// the present poses have shared arms already.
  void turnArms(const StepInput<D>& in, bool shared) {
    Profiler::Scope scope(in.profiler, "solver.prepare");
    if (m_bounces && !m_turned) m_detected = m_contacts;
    m_turned = true;
    for (const ContactPlace& at : m_contacts.places) {
      const Manifold<D>& m = in.manifolds[at.manifold];
      if (shared && m_plan.contacts == ContactsOf::substep && isMadeNow(in, m)) continue;
      const auto [atA, atB] = displacements().pair(in.bodies, at.a, at.b);
      countMadeRows<D>(in.work, m_contacts.rowsOf(at));
      for (int k = 0; k < at.count; ++k) {
        const ContactPoint<D>& c = m.points[k];
        if (shared) {
          const auto& inverse = in.bodies.invInertia;
          const ContactArms<D> arms = sharedArms(c, m.normal, atA, atB, inverse[at.a], inverse[at.b]);
          m_contacts.setRows(at, k, in.bodies, m, arms.rA, arms.rB);
        } else {
          m_contacts.setRows(at, k, in.bodies, m, atA.q * c.localA, atB.q * c.localB);
        }
      }
    }
  }

  /// Measures contacts again after another method has changed the poses.
  void measure(const StepInput<D>& in) {
    m_contacts.loadPose(in.bodies, m_displacement);
    measureBlocks(m_contacts);
  }

  /// Removes the velocity that pushing has added. No velocity may change between solve() and this.
  void relax(const StepInput<D>& in, int iterations) {
    Profiler::Scope scope(in.profiler, "solver.relax");
    sweep(in, {}, iterations);
    m_contacts.storeMotion(in.bodies, in.bodies.motion);
  }

  /// Runs sub-step i: solve with a push, move, relax.
  void step(const StepInput<D>& in, int i, const ErrorFeedback& errors, int sweeps, int relaxing,
            bool separationsFollow = true) {
    begin(in, i);
    solve(in, errors, sweeps);
    move(in, separationsFollow);
    relax(in, relaxing);
    end();
  }

  /// Adds this sub-step's impulses to the loads of contacts and joints.
  void end() {
    m_contacts.addLoads();
    for (const std::int32_t j : m_joints.rowless) m_jointImpulse[j].substep.fill(0);
    for (const JointBlock<D>& block : m_joints.blocks) {
      JointImpulse& kept = m_jointImpulse[block.joint];
      kept.substep.fill(0);
      for (const JointRow<D>& row : m_joints.of(block)) {
        const auto i = row.number;
        kept.substep[i] = row.impulse;
        kept.step[i] += row.impulse;
      }
    }
  }

  /// Applies restitution, then stores the impulses. Contacts store those of the last sub-step, scaled to a whole step,
  /// for warm starting. A rolling ball, whose anchor turns up and away, carries load in the first sub-steps only.
  void finish(const StepInput<D>& in, BounceFriction how = BounceFriction::withFriction) {
    if (m_bounces) bounce(in, how);
    storeContacts(in, m_count);
    const auto store = [&](std::int32_t j) {
      JointRecord<D>& joint = in.joints[j];
      const JointImpulse& sum = m_jointImpulse[j];
      joint.impulse = sum.step;
      for (std::size_t i = 0; i < kJointRows; ++i) joint.memory[i] = m_count * sum.substep[i];
    };
    for (const JointBlock<D>& block : m_joints.blocks) store(block.joint);
    for (const std::int32_t j : m_joints.rowless) store(j);
  }

 private:
  struct JointImpulse {                        // by row
    IndexedArray<Real, kJointRows> substep{};  // of the last sub-step: warm starts the next one
    IndexedArray<Real, kJointRows> step{};     // of all sub-steps: the load of the joint
  };
  using Layout = BlockLayout<D>;

  // Contacts start with this multiple of their stored impulses.
  void prepareContacts(const StepInput<D>& in, Real warmStart) {
    m_order.assign(in.active.begin(), in.active.end()), m_colours.clear();
    if (m_plan.order == SweepOrder::coloured) in.graph.colour(in.active, m_order, m_colours);
    const int lanes = m_plan.lanes == SweepLanes::scalar ? 1 : contactLanes();
    m_contacts.arrange(in.bodies, in.manifolds, m_order, m_colours, lanes, in.model.friction);
    m_turned = false;
    countMadeRows<D>(in.work, m_contacts.rows());
    m_contacts.loadFixed(in.bodies, [&](std::int32_t body) { return m_start[body]; });
    m_contacts.loadPose(in.bodies);
    prepareBlocks(m_contacts, in.manifolds, warmStart);
    if (m_plan.armsAsMade) keepArms(in);
    m_bounces = in.model.restitution &&
                std::any_of(m_contacts.places.begin(), m_contacts.places.end(),
                            [&](const ContactPlace& at) { return in.manifolds[at.manifold].restitution > 0; });
    if (!m_bounces && m_plan.contacts == ContactsOf::step) return;  // only a bounce needs the velocities
    m_contacts.loadMotion(in.bodies.motion);
    velocityBlocks(m_contacts, Layout::kVelocity, in.model.rotation);
  }

  // Writes `scale` times the impulses, and the loads.
  void storeContacts(const StepInput<D>& in, Real scale) {
    m_contacts.forPoints([&](const ContactPlace& at, int k) {
      ContactPoint<D>& c = in.manifolds[at.manifold].points[k];
      for (int d = 0; d < D; ++d) c.impulse[d] = scale * m_contacts.of(at, k, Layout::kImpulse + d);
      c.load = m_contacts.of(at, k, Layout::kLoad);
    });
  }

  // Makes the contacts of the present poses. A point that was hit in this step rebounds from its velocity before that;
  // any other from its present velocity.
  void makeContacts(const StepInput<D>& in) {
    storeContacts(in, 1);
    m_contacts.forPoints([&](const ContactPlace& at, int k) {
      in.manifolds[at.manifold].points[k].memory[0] = m_contacts.of(at, k, Layout::kVelocity);
    });
    m_remade.keep(in.manifolds, in.active);
    in.detect.again();
    Profiler::Scope scope(in.profiler, "solver.prepare");
    m_remade.restore(in.manifolds, in.active, PointImpulse::ofSubstep);
    prepareContacts(in, 1);
    m_contacts.forPoints([&](const ContactPlace& at, int k) {
      const ContactPoint<D>& c = in.manifolds[at.manifold].points[k];
      if (!(c.load > 0)) return;
      m_contacts.of(at, k, Layout::kLoad) = m_contacts.of(at, k, Layout::kMaxImpulse) = c.load;
      m_contacts.of(at, k, Layout::kVelocity) = c.memory[0];
    });
    measure(in);
  }

  static bool isMadeNow(const StepInput<D>& in, const Manifold<D>& m) {
    const Pose<D> X_AB = poseBetween(in.bodies.pose[m.bodyA], in.bodies.pose[m.bodyB]);
    return X_AB.p == m.X_AB.p && X_AB.q.matrix() == m.X_AB.q.matrix();
  }

  // Arms of points that a cache has kept: each body's own, in world axes of the time when the points were made. The
  // rotation of A at that time is stored with each point, also of a point that a listener vetoes, since it may be
  // allowed later.
  void keepArms(const StepInput<D>& in) {
    for (Manifold<D>& m : in.manifolds) {
      if (!isMadeNow(in, m)) continue;
      const Ang<D> turn = turnOf(in.bodies.pose[m.bodyA].q);
      for (int k = 0; k < m.count; ++k) {
        std::copy(turn.begin(), turn.end(), m.points[k].memory.begin());
      }
    }
    for (const ContactPlace& at : m_contacts.places) {
      const Manifold<D>& m = in.manifolds[at.manifold];
      if (isMadeNow(in, m)) continue;
      countMadeRows<D>(in.work, m_contacts.rowsOf(at));
      for (int k = 0; k < m.count; ++k) {
        const ContactPoint<D>& c = m.points[k];
        Ang<D> turn;
        std::copy_n(c.memory.begin(), turn.size(), turn.begin());
        const Rot<D> q = integrateRotation(Rot<D>{}, turn);
        m_contacts.setRows(at, k, in.bodies, m, q * c.localA, q * (m.X_AB.q * c.localB));
      }
    }
  }

  void sweep(const StepInput<D>& in, const ErrorFeedback& errors, int iterations) {
    const BlockSweep law{.contact = errors.contact,
                         .contactFixed = errors.contactFixed,
                         .slop = errors.slop,
                         .maxSpeed = errors.maxSpeed,
                         .h = m_h,
                         .softGaps = errors.softGaps,
                         .rotation = in.model.rotation};
    for (int i = 0; i < iterations; ++i) {
      if (!m_joints.blocks.empty()) {
        m_contacts.storeMotion(in.bodies, in.bodies.motion);
        m_joints.sweep(in.bodies.motion, m_h, errors.joint);
        m_contacts.loadMotion(in.bodies.motion);
      }
      m_joints.count(in.work);
      sweepBlocks(m_contacts, law);
      countRows<D>(in.work, m_contacts.rows());
    }
  }

  // Uses the arms of the detection, as the measurement of the velocity before the step did.
  void bounce(const StepInput<D>& in, BounceFriction how) {
    const bool rotation = in.model.rotation;
    ContactBlocks<D>& detected = m_turned ? m_detected : m_contacts;
    for (const ContactPlace& at : m_contacts.places) {
      const Real e = in.manifolds[at.manifold].restitution;
      if (!(e > 0)) continue;
      Motion<D>&a = in.bodies.motion[at.a], &b = in.bodies.motion[at.b];
      const ManifoldRows<D> m = m_contacts.manifoldRows(at);
      for (int k = 0; k < at.count; ++k) {
        const Real before = m_contacts.of(at, k, Layout::kVelocity);
        if (!(before < -in.restitutionThreshold) || !(m_contacts.of(at, k, Layout::kMaxImpulse) > 0)) continue;
        PointRows<D> row = detected.pointRows(at, k);
        for (int d = 0; d < D; ++d) row.impulse[d] = m_contacts.of(at, k, Layout::kImpulse + d);
        const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
        const Real old = row.impulse[0];
        row.impulse[0] = std::max(old - row.normal.mass * (v + e * before), Real(0));
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, rotation);
        m_contacts.of(at, k, Layout::kLoad) += row.impulse[0] - old;
        countRows<D>(in.work, 1);
        if (m.friction > 0 && row.impulse[0] != old) {
          const bool slides = row.impulse[0] < old || how == BounceFriction::withFriction;
          if (row.impulse[0] < old) {
            solveFrictionAt(m, row, a, b, rotation);
          } else if (slides) {
            solveFrictionBeside(m, row, row.impulse[0] - old, a, b, rotation);
          }
          if (slides) countRows<D>(in.work, D - 1);
        }
        for (int d = 0; d < D; ++d) m_contacts.of(at, k, Layout::kImpulse + d) = row.impulse[d];
      }
    }
  }

  SubstepPlan m_plan;
  Real m_count = 1, m_h = 0;
  ContactBlocks<D> m_contacts, m_detected;  // m_detected: before arms were turned, if m_turned
  bool m_turned = false, m_bounces = false;
  FreeMotion<D> m_motion;
  std::vector<int> m_order, m_colours;  // of contacts, as VelocityInput has them
  JointSystem<D> m_joints;
  IndexedVector<Vec<D>> m_start, m_displacement;  // by body: position at the start of the step, displacement since, m
  RemadeContacts<D> m_remade;
  IndexedVector<JointImpulse> m_jointImpulse;  // by joint slot
  IndexedVector<Wrench<D>> m_wrenches;
};

}}}  // namespace lpc::LPC_PRECISION::solver
