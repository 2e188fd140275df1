// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "algorithms/solver/contact_rows.h"
#include "algorithms/solver/free_motion.h"
#include "algorithms/solver/joint_rows.h"
#include "framework/profiler.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

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

// Sub-steps with one detection: the separations follow from the anchors. Each sub-step solves soft contacts, moves, and
// then solves again without the springs, which takes out the velocity that the springs put in. Restitution comes last.
template <int D>
class SoftStep final : public Solver<D> {
 public:
  struct Params {
    int substeps = 4;
    Real hertz = 30, dampingRatio = 10, pushSpeed = 3, jointDampingRatio = 2;
    int relax = 1;
    bool warmStart = true;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step");
      v.real("hertz", hertz, 0, 100000, "1/s", "stiffness of contacts; limited to a quarter of the sub-step rate");
      v.real("damping_ratio", dampingRatio, 0, 1000, "1", "of contacts; large: they do not bounce");
      v.real("push_speed", pushSpeed, 0, 1000, "m/s", "limit of the speed at which overlap is undone");
      v.real("joint_damping_ratio", jointDampingRatio, 0, 1000, "1", "of joints, which are twice as stiff as contacts");
      v.integer("relax", relax, 0, 100, "sweeps without springs after each move");
      v.flag("warm_start", warmStart, "start from the impulses of the last step");
    }
  };
  explicit SoftStep(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "soft_step",
            .summary = "sub-steps with soft contacts, relaxed after each move, restitution at the end",
            .paper = "catto2024",
            .complexity = "substeps x (1 + relax) x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {{"a body on a very heavy one",
                          "sinks in deeper than on a fixed one, whose springs are stiffer", "Symmetry.HeavyIsFixed"},
                         {"a motor of a million times the torque that its body needs, at a stop",
                          "drives through the stop, which is a spring", "Joint.StopHoldsAgainstItsMotor"},
                         {"a hinge that is beyond its stop", "leaves it with a speed that nothing has given it",
                          "JointStep.LeavesNoSpeed"},
                         {"a stop that is hit, or a weld that is bent, in ever shorter steps",
                          "gives way by what falls slower than the step: relaxing takes out what its spring has put in",
                          "JointMotion.Converges"}},
            .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    const bool rotation = in.features.rotation;
    const auto substeps = static_cast<Real>(m_params.substeps);
    const Real h = in.dt / substeps;
    const Real hertz = std::min(m_params.hertz, Real(0.25) / h);
    m_soft = Softness(hertz, m_params.dampingRatio, h);
    m_softFixed = Softness(2 * hertz, m_params.dampingRatio, h);
    m_softJoint = Softness(2 * hertz, m_params.jointDampingRatio, h);
    haltUnmoving(in.bodies, rotation);
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      prepare(in, (in.lastDt > 0 ? in.dt / in.lastDt : Real(1)) / substeps);
    }
    for (int i = 0; i < m_params.substeps; ++i) {
      {
        Profiler::Scope scope(in.profiler, "solver.integrate");
        kick<D>({h, in.time + static_cast<Real>(i) * h, in.bodies, in.forces, in.features, in.work}, m_wrenches);
        if (in.features.joints) prepareJoints(in, h);
      }
      {
        Profiler::Scope scope(in.profiler, "solver.iterate");
        applyAccumulated(in);
        sweep(in, h, true);
      }
      {
        Profiler::Scope scope(in.profiler, "solver.move");
        for (std::size_t k = 0; k < in.bodies.pose.size(); ++k) {
          if (travels(in.bodies, k)) moveBody(in.bodies.pose[k], in.bodies.motion[k], h, rotation);
        }
      }
      Profiler::Scope scope(in.profiler, "solver.relax");
      for (int k = 0; k < m_params.relax; ++k) sweep(in, h, false);
      keepJoints();
    }
    if (in.features.restitution) bounce(in);
    // Impulses are those of a whole step, as in every other solver.
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      for (int k = 0; k < m.count; ++k) {
        for (Real& x : m_contacts.points[static_cast<std::size_t>(m.first + k)].impulse) x *= substeps;
      }
    }
    m_contacts.store(in.manifolds);
    const auto store = [&](std::int32_t j) {
      JointRecord<D>& joint = in.joints[static_cast<std::size_t>(j)];
      const JointImpulse& sum = m_jointImpulse[static_cast<std::size_t>(j)];
      joint.impulse = sum.step;
      for (std::size_t i = 0; i < kJointRows; ++i) joint.memory[i] = substeps * sum.substep[i];
    };
    for (const JointBlock<D>& block : m_joints.blocks) store(block.joint);
    for (const std::int32_t j : m_joints.rowless) store(j);
  }

 private:
  struct State {
    Vec<D> localA, localB;
    Real velocity;    // along the normal before the step, m/s
    Real maxImpulse;  // of all sub-steps: did it hit at all?
  };
  struct JointImpulse {                      // by row
    std::array<Real, kJointRows> substep{};  // of the last sub-step: what the next one starts from
    std::array<Real, kJointRows> step{};     // of all of them: what the joint bore
  };
  // The springs are in this solver; what ContactRows asks for is overwritten in the sweeps.
  struct NoBias final : PositionResolver<D> {};

  void prepare(const StepInput<D>& in, Real scale) {
    const NoBias none;
    m_contacts.prepare({in.dt, in.lastDt, in.bodies, in.manifolds, in.active, in.joints, none, in.features,
                        in.restitutionThreshold, in.work, in.profiler});
    m_states.resize(m_contacts.points.size());
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Manifold<D>& from = in.manifolds[static_cast<std::size_t>(m.manifold)];
      const Motion<D>& a = in.bodies.motion[static_cast<std::size_t>(m.a)];
      const Motion<D>& b = in.bodies.motion[static_cast<std::size_t>(m.b)];
      for (int k = 0; k < m.count; ++k) {
        const ContactPoint<D>& c = from.points[static_cast<std::size_t>(k)];
        PointRows<D>& row = m_contacts.points[static_cast<std::size_t>(m.first + k)];
        m_states[static_cast<std::size_t>(m.first + k)] = {
            c.localA, c.localB, rowVelocity<D>(row.normal, m.n, a, b, in.features.rotation), 0};
        if (!m_params.warmStart) continue;
        row.impulse[0] = std::max(scale * c.impulse[0], Real(0));
        for (std::size_t d = 1; d < D && m.friction > 0; ++d) row.impulse[d] = scale * c.impulse[d];
      }
    }
    m_jointImpulse.resize(in.joints.size());
    for (std::size_t j = 0; j < in.joints.size(); ++j) {
      m_jointImpulse[j] = {};
      for (std::size_t i = 0; i < kJointRows && m_params.warmStart; ++i) {
        m_jointImpulse[j].substep[i] = scale * in.joints[j].memory[i];
      }
    }
    m_joints.clear();
  }

  void prepareJoints(const StepInput<D>& in, Real h) {
    m_joints.prepare(in.bodies, in.joints);
    m_joints.warmStart(h, [&](std::int32_t joint, std::int32_t row) {
      return m_jointImpulse[static_cast<std::size_t>(joint)].substep[static_cast<std::size_t>(row)];
    });
  }

  void keepJoints() {
    for (const std::int32_t j : m_joints.rowless) m_jointImpulse[static_cast<std::size_t>(j)].substep.fill(0);
    for (const JointBlock<D>& block : m_joints.blocks) {
      JointImpulse& kept = m_jointImpulse[static_cast<std::size_t>(block.joint)];
      kept.substep.fill(0);
      for (const JointRow<D>& row : m_joints.of(block)) {
        const auto i = static_cast<std::size_t>(row.number);
        kept.substep[i] = row.impulse;
        kept.step[i] += row.impulse;
      }
    }
  }

  void applyAccumulated(const StepInput<D>& in) {
    auto& motion = in.bodies.motion;
    m_joints.applyAccumulated(motion);
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      Motion<D>&a = motion[static_cast<std::size_t>(m.a)], &b = motion[static_cast<std::size_t>(m.b)];
      for (int k = 0; k < m.count; ++k) {
        const PointRows<D>& row = m_contacts.points[static_cast<std::size_t>(m.first + k)];
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0], a, b, in.features.rotation);
        for (int d = 0; d < D - 1 && m.friction > 0; ++d) {
          applyRow<D>(row.tangent[static_cast<std::size_t>(d)], m.t.col(d), m.invMassA, m.invMassB,
                      row.impulse[static_cast<std::size_t>(d) + 1], a, b, in.features.rotation);
        }
      }
    }
  }

  void sweep(const StepInput<D>& in, Real h, bool springs) {
    auto& motion = in.bodies.motion;
    const bool rotation = in.features.rotation;
    in.work[WorkCount::rowUpdates] += m_joints.sweep(motion, h, springs ? m_softJoint : Softness());
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      Motion<D> a = motion[static_cast<std::size_t>(m.a)], b = motion[static_cast<std::size_t>(m.b)];
      const Pose<D>& X_WA = in.bodies.pose[static_cast<std::size_t>(m.a)];
      const Pose<D>& X_WB = in.bodies.pose[static_cast<std::size_t>(m.b)];
      // Nothing gives way on one side, so the other may be stiffer.
      const Softness& spring = m.invMassA > 0 && m.invMassB > 0 ? m_soft : m_softFixed;
      for (int k = 0; k < m.count; ++k) {
        PointRows<D>& row = m_contacts.points[static_cast<std::size_t>(m.first + k)];
        State& state = m_states[static_cast<std::size_t>(m.first + k)];
        const Real s = ((X_WB.p - X_WA.p) + X_WB.q * state.localB - X_WA.q * state.localA).dot(m.n);
        Real bias = 0, massScale = 1, impulseScale = 0;
        if (s > 0) {
          bias = s / h;
        } else if (springs) {
          bias = std::max(spring.rate * s, -m_params.pushSpeed);
          massScale = spring.massScale, impulseScale = spring.impulseScale;
        }
        const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
        const Real old = row.impulse[0];
        const Real wanted = old - massScale * row.normal.mass * (v + bias) - impulseScale * old;
        row.impulse[0] = std::max(wanted, Real(0));
        state.maxImpulse = std::max(state.maxImpulse, row.impulse[0]);
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, rotation);
      }
      if (m.friction > 0) {
        for (int k = 0; k < m.count; ++k) {
          rubAt(m, m_contacts.points[static_cast<std::size_t>(m.first + k)], a, b, rotation);
        }
      }
      in.work[WorkCount::rowUpdates] += static_cast<std::uint64_t>(m.count) * (m.friction > 0 ? D : 1);
      motion[static_cast<std::size_t>(m.a)] = a, motion[static_cast<std::size_t>(m.b)] = b;
    }
  }

  void bounce(const StepInput<D>& in) {
    const bool rotation = in.features.rotation;
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Real e = in.manifolds[static_cast<std::size_t>(m.manifold)].restitution;
      if (!(e > 0)) continue;
      Motion<D>& a = in.bodies.motion[static_cast<std::size_t>(m.a)];
      Motion<D>& b = in.bodies.motion[static_cast<std::size_t>(m.b)];
      for (int k = 0; k < m.count; ++k) {
        PointRows<D>& row = m_contacts.points[static_cast<std::size_t>(m.first + k)];
        const State& state = m_states[static_cast<std::size_t>(m.first + k)];
        if (!(state.velocity < -in.restitutionThreshold) || !(state.maxImpulse > 0)) continue;
        const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
        const Real old = row.impulse[0];
        row.impulse[0] = std::max(old - row.normal.mass * (v + e * state.velocity), Real(0));
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, rotation);
        ++in.work[WorkCount::rowUpdates];
      }
    }
  }

  Params m_params;
  Softness m_soft, m_softFixed, m_softJoint;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
  std::vector<State> m_states;
  std::vector<JointImpulse> m_jointImpulse;  // by joint slot
  std::vector<Wrench<D>> m_wrenches;
};

}  // namespace

LPC_REGISTER(Solver, SoftStep, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
