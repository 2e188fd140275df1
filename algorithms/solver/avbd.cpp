// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <limits>

#include "algorithms/solver/island/ldl_solve.h"
#include "algorithms/solver/rows/avbd_joint.h"
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/step/free_motion.h"
#include "algorithms/solver/step/gyroscopic.h"
#include "framework/math/tolerances.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Augmented vertex block descent. Each body in turn minimises its own inertial energy and the energy of all its
// constraints while the other bodies are fixed: one small linear system. A constraint is a spring that stiffens while
// violated, plus a force that takes over its load (augmented Lagrangian). Both are kept from step to step.
//
// All quantities are velocities u, with which a body moves through the step, and impulses. A spring k becomes h^2 k, a
// mass, stored as a multiple of the row's effective mass, so that results do not depend on the masses of the scene. A
// joint has one multiple for its metres and one for its radians, a point one for both tangents (more depend on axes).
//
// Contacts are linearised at the start of the step and joints at the end of the last iteration, as in the authors'
// demo. The arms of the two then belong to different poses, so bodies that press on each other while they turn on
// joints lose angular momentum: `lpc run turning_cluster --pipeline solver=avbd` loses 68 % of it, with rows=start 5 %.
template <int D>
class Avbd final : public Solver<D> {
 public:
  enum class Rows { jointsAtEnd, start };
  struct Params {
    int iterations = 10, tries = 0;
    Rows rows = Rows::jointsAtEnd;
    Real ramp = 30, alpha = Real(0.99), gamma = Real(0.99);
    Real minPenalty = 10, maxPenalty = Real(1e5), slop = Real(0.0005);
    bool postStabilize = true, gyroscopic = false;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 1, 100000, "passes over all bodies", ParamRole::effort);
      v.integer("tries", tries, 0, 100,
                "extra solves of a body while its rows switch between limit and spring; published: 0");
      v.choice("rows", rows, {"joints_at_end", "start"},
               "poses for the linearisation of joints: last iteration (published) or start of the step");
      v.real("ramp", ramp, 0, Real(1e9), "1/m", "growth of a penalty per pass and violation (rad counts as m)");
      v.real("alpha", alpha, 0, 1, "1", "post_stabilize=false only: fraction of an error kept per step");
      v.real("gamma", gamma, 0, 1, "1", "fraction of a penalty kept for the next step");
      v.real("min_penalty", minPenalty, Real(1e-6), Real(1e6), "1", "smallest penalty, in row masses over dt^2");
      v.real("max_penalty", maxPenalty, Real(1e-6), Real(1e9), "1", "largest penalty, in the same unit");
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
      v.flag("post_stabilize", postStabilize, "a last pass corrects old errors without adding velocity");
      v.flag("gyroscopic", gyroscopic, "implicit gyroscopic term, in 3D; published: false");
    }
  };
  explicit Avbd(const Params& params) : m_params(params) {
    if (params.minPenalty > params.maxPenalty) {
      throw UserError("'avbd' has min_penalty above max_penalty; valid: min_penalty <= max_penalty");
    }
  }

  static AlgorithmInfo info() {
    return {
        .name = "avbd",
        .summary = "augmented vertex block descent: body by body, with growing penalties and warm-started forces",
        .paper = "giles2025",
        .complexity = "iterations x (bodies + contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures =
            {kNoGyroscopicTerm,
             {"a pulled rope round a post", "it sticks where it should slip; tries=5 slips", "KnownAnswer.capstan"},
             {"bodies that collide", "solved in turn, they get different forces", "Solver.KeepsLinearMomentum"},
             {"bodies that collide off-centre", "the torques on the two differ", "Solver.KeepsAngularMomentum"},
             {"bodies in contact that rotate together",
              "angular momentum is lost: contact rows use start poses, joint rows end poses; rows=start loses less",
              "Solver.TurningKeepsAngularMomentum"},
             {"a motor with a million times the needed torque, at a joint limit",
              "it drives through the limit: a single solve guesses which rows are at a limit; tries=3 holds",
              "Joint.StopHoldsAgainstItsMotor"},
             {"a box in space that lands on an edge",
              "it leaves the plane: a single solve guesses which rows are at a limit; tries=3 stays",
              "Extrusion.AgreesOrSaysThatItDoesNot"},
             {"a pendulum on a joint", "it loses three times as much energy as catto", "Order.PendulumKeepsItsEnergy"},
             {"a heavy body on a light one", "it is thrown up slightly", "Solver.HeavyIsNotThrownUp"},
             {"a heavy body that falls on a light one", "it slows down faster than Gauss-Seidel predicts",
              "Solver.ConvergesAsPredicted"},
             {"a body that touches many parts at once", "their penalties throw it up by centimetres; tries=1 does not",
              "Tiles.ManyContactsAtOnceLiftNothing"},
             {"bodies that collide, with more iterations", "multipliers overshoot", "Solver.MoreIsNoWorse"}},
        .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    m_rotation = in.model.rotation, m_h = in.dt;
    auto& motion = in.bodies.motion;
    haltUnmoving(in.bodies, m_rotation);
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      prepareContacts(in);
      prepareJoints(in);
    }
    {
      Profiler::Scope scope(in.profiler, "solver.integrate");
      guess(in);
    }
    {
      Profiler::Scope scope(in.profiler, "solver.iterate");
      m_alpha = m_params.postStabilize ? Real(1) : m_params.alpha;
      linearize(in);
      for (int i = 0; i < m_params.iterations; ++i) {
        sweep(in);
        raise(in);
      }
    }
    {
      Profiler::Scope scope(in.profiler, "solver.stabilize");
      m_velocity.assign(motion.begin(), motion.end());
      if (m_params.postStabilize) {
        m_alpha = 0;
        sweep(in);
      }
      move(in);
      motion.assign(m_velocity.begin(), m_velocity.end());
    }
    if (in.model.restitution) bounce(in);
    learn(in);
    store(in);
  }

 private:
  static constexpr int kSize = D + kAngDim<D>;
  using Column = RealMatrix<kSize, 1>;
  using Block = RealMatrix<kSize, kSize>;
  enum Kept : std::size_t { angularPenalty = kJointRows - 2, linearPenalty = kJointRows - 1 };

  struct Point {
    Real separation;       // at the start of the step, less the allowed error, m
    Real arrival;          // normal velocity before the step, m/s
    Real reachA, reachB;   // from the centres of mass, m
    Real normal, tangent;  // penalties
  };
  using Joint = AvbdJoint<D>;

  Real kept(Real penalty) const {
    return std::clamp(m_params.gamma * penalty, m_params.minPenalty, m_params.maxPenalty);
  }
  // The previous step's force is kept when dt changes, not its impulse.
  Real warmStartScale(const StepInput<D>& in) const {
    const Real scale = lastImpulseScale(in);
    return m_params.postStabilize ? scale : m_params.alpha * m_params.gamma * scale;
  }

  void prepareContacts(const StepInput<D>& in) {
    const NoBias none;
    m_contacts.prepare({in.dt, in.lastDt, in.bodies, in.manifolds, in.active, in.joints, none, in.model,
                        in.restitutionThreshold, in.work, in.profiler});
    m_points.resize(m_contacts.points.size());
    m_at.assign(in.manifolds.size(), -1);
    const Real warm = warmStartScale(in);
    for (std::size_t i = 0; i < m_contacts.manifolds.size(); ++i) {
      const ManifoldRows<D>& m = m_contacts.manifolds[i];
      m_at[m.manifold] = static_cast<int>(i);
      const auto a = m.a, b = m.b;
      for (int k = 0; k < m.count; ++k) {
        const auto at = m.first + k;
        const ContactPoint<D>& c = in.manifolds[m.manifold].points[k];
        PointRows<D>& row = m_contacts.points[at];
        const ContactArms<D> arms(c, m.n, in.bodies.pose[a], in.bodies.pose[b]);
        m_points[at] = {arms.separation + std::clamp(-arms.separation, Real(0), m_params.slop),
                        rowVelocity<D>(row.normal, m.n, in.bodies.motion[a], in.bodies.motion[b], m_rotation),
                        arms.rA.norm(),
                        arms.rB.norm(),
                        kept(c.memory[0]),
                        kept(c.memory[1])};
        row.impulse[0] = std::max(warm * c.impulse[0], Real(0));
        for (std::size_t d = 1; d < D && m.friction > 0; ++d) row.impulse[d] = warm * c.impulse[d];
      }
    }
  }

  void prepareJoints(const StepInput<D>& in) {
    m_joints.clear();
    m_jointAt.assign(in.joints.size(), -1);
    if (!in.model.joints) return;
    const Real warm = warmStartScale(in);
    for (std::size_t j = 0; j < in.joints.size(); ++j) {
      const JointRecord<D>& record = in.joints[j];
      if (!record.active() || !(moves(in, record.bodyA) || moves(in, record.bodyB))) continue;
      m_jointAt[j] = static_cast<int>(m_joints.size());
      Joint& joint = m_joints.emplace_back();
      joint.begin(static_cast<std::int32_t>(j), record, in.bodies, warm);
      joint.linear = kept(record.memory[linearPenalty]), joint.angular = kept(record.memory[angularPenalty]);
    }
  }
  bool moves(const StepInput<D>& in, std::int32_t body) const {
    return body >= 0 && (in.bodies.invMass[body] > 0 || turns(in, body));
  }
  bool turns(const StepInput<D>& in, AnyIndex auto i) const {
    return m_rotation && in.bodies.invInertia[i].trace() > 0;
  }

  // Positions without constraints, and the initial guess: along the same line as far as the body moved in the last
  // step, so that a resting body starts at rest.
  void guess(const StepInput<D>& in) {
    auto& motion = in.bodies.motion;
    m_start.assign(motion.begin(), motion.end());
    m_from.assign(in.bodies.pose.begin(), in.bodies.pose.end());
    kick<D>({in.dt, in.time, in.bodies, in.forces, in.model, in.work}, m_wrenches);
    if (m_params.gyroscopic && m_rotation) gyroscopicStep(in.bodies, m_h, 1);
    m_free.assign(motion.begin(), motion.end());
    m_inertia.resize(motion.size());
    for (std::size_t i = 0; i < motion.size(); ++i) {
      if (!in.bodies.active(static_cast<int>(i))) continue;
      if (turns(in, i)) m_inertia[i] = in.bodies.invInertia[i].inverse();
      motion[i].v -= in.bodies.solver[i][0] * (motion[i].v - m_start[i].v);
    }
  }
  // Stores, for the next step, how much of the motion that its forces demanded a body did not make in this one.
  void learn(const StepInput<D>& in) const {
    for (std::size_t i = 0; i < m_free.size(); ++i) {
      if (!in.bodies.active(static_cast<int>(i))) continue;
      const Vec<D> asked = m_free[i].v - m_start[i].v, done = in.bodies.motion[i].v - m_start[i].v;
      const Real size = asked.squaredNorm();
      in.bodies.solver[i][0] = size > 0 ? 1 - std::clamp(done.dot(asked) / size, Real(0), Real(1)) : Real(0);
    }
  }

  void move(const StepInput<D>& in) {
    for (std::size_t k = 0; k < m_from.size(); ++k) {
      if (travels(in.bodies, k)) in.bodies.pose[k] = m_from[k];
    }
    m_motion.move(in.bodies, in.bodies.motion, m_h, m_rotation);
  }

  // Linearises the joints at the present poses; their errors then belong to u = 0.
  void linearize(const StepInput<D>& in) {
    if (m_joints.empty()) return;
    const bool moved = m_params.rows == Rows::jointsAtEnd;
    if (moved) move(in);
    for (Joint& joint : m_joints) {
      jointRows(in.joints[joint.joint], in.bodies, joint.rows);
      joint.setMasses(in.bodies);
      countMadeRows<D>(in.work, static_cast<std::uint64_t>(joint.rows.count));
      for (int i = 0; moved && i < joint.rows.count; ++i) {
        ConstraintRow<D>& row = joint.rows.row[i];
        if (!row.absent()) row.error -= m_h * joint.speed(in.bodies, row);
      }
    }
    for (std::size_t k = 0; k < m_from.size() && moved; ++k) in.bodies.pose[k] = m_from[k];
  }

  // Impulse that a row demands at the present velocities, and its contribution to the mass matrices of its bodies.
  struct Ask {
    Real impulse, stiffness;
    Real violation;  // m or rad; 0 where the impulse is at a limit
  };
  Ask askNormal(const ManifoldRows<D>& m, int at, const Motion<D>& a, const Motion<D>& b) const {
    const PointRows<D>& row = m_contacts.points[at];
    const Real s = m_points[at].separation;
    const Real error = (s > 0 ? s : (1 - m_alpha) * s) + m_h * rowVelocity<D>(row.normal, m.n, a, b, m_rotation);
    const Real stiffness = m_points[at].normal * row.normal.mass;
    const Real impulse = row.impulse[0] - stiffness / m_h * error;
    return limited({impulse, stiffness, std::abs(error)}, 0, std::numeric_limits<Real>::infinity());
  }
  static Ask limited(const Ask& ask, Real lo, Real hi) {
    if (ask.impulse < lo) return {lo, 0, 0};
    if (ask.impulse > hi) return {hi, 0, 0};
    return ask;
  }
  struct FrictionStep {
    RealMatrix<D - 1, 1> impulse;
    Real stiffness, violation;
  };
  // For a sliding point, uses the stiffness of the line from zero force to the limit: its own stiffness would hold it
  // back.
  FrictionStep askFriction(const ManifoldRows<D>& m, int at, Real limit, const Motion<D>& a, const Motion<D>& b) const {
    const PointRows<D>& row = m_contacts.points[at];
    RealMatrix<D - 1, 1> v, wanted;
    FrictionStep friction;
    friction.stiffness = m_points[at].tangent * row.slide;
    for (int d = 0; d < D - 1; ++d) {
      v[d] = rowVelocity<D>(row.tangent[d], m.t.col(d), a, b, m_rotation);
      wanted[d] = row.impulse[d + 1] - friction.stiffness * v[d];
    }
    friction.impulse = clampFriction<D>(wanted, limit);
    const Real asked = wanted.norm();
    friction.violation = asked <= limit ? m_h * v.norm() : Real(0);
    if (asked > limit) friction.stiffness *= limit / asked;
    return friction;
  }
  Ask askJoint(const StepInput<D>& in, const Joint& joint, int i) const {
    const ConstraintRow<D>& row = joint.rows.row[i];
    const Real v = joint.speed(in.bodies, row), lo = row.lo * m_h, hi = row.hi * m_h;
    Real stiffness = (row.angular ? joint.angular : joint.linear) * joint.mass[i], impulse = 0, error = 0;
    switch (row.law) {
      case RowLaw::rigid:
        error = row.error + m_h * v - m_alpha * joint.start[i];
        impulse = joint.impulse[i] - stiffness / m_h * error;
        break;
      case RowLaw::spring:
        stiffness = m_h * (m_h * row.stiffness + row.damping);
        impulse = -m_h * row.stiffness * row.error - stiffness * v;
        break;
      case RowLaw::motor:
        impulse = joint.impulse[i] - stiffness * (v - row.speed);
        break;
    }
    return limited({impulse, stiffness, std::abs(error)}, lo, hi);
  }

  void sweep(const StepInput<D>& in) {
    for (std::size_t i = 0; i < m_from.size(); ++i) {
      if (!in.bodies.active(static_cast<int>(i)) || !moves(in, static_cast<std::int32_t>(i))) continue;
      // A single solve assumes which rows are at a limit. Solves repeat until the rows at a limit are those that were
      // assumed.
      std::uint64_t before = 0, limits = descend(in, i, 0, 1);
      for (int k = 0; k < m_params.tries && before != limits; ++k) {
        before = limits, limits = descend(in, i, limits, k == 0 ? Real(1) : Real(0.5));
      }
    }
  }

  // A row adds its outer product to the matrix of one body; a solve is a factorisation and two substitutions.
  static constexpr std::uint64_t kSolveMultiplyAdds = kSize * kSize * kSize / 6 + kSize * kSize;
  static void countBodyRows(const StepInput<D>& in, std::uint64_t n) {
    countRows<D>(in.work, n);
    in.work[WorkCount::multiplyAdds] += n * kSize * kSize;
  }

  // Returns the rows that were within their limits; does nothing if they are those of `last`.
  std::uint64_t descend(const StepInput<D>& in, std::size_t i, std::uint64_t last, Real share) {
    const auto body = static_cast<std::int32_t>(i);
    auto& motion = in.bodies.motion;
    const bool shifts = in.bodies.invMass[i] > 0, rotates = turns(in, i);
    Block a = Block::Identity();
    Column g = Column::Zero();
    if (shifts) {
      const Real mass = 1 / in.bodies.invMass[i];
      a.template topLeftCorner<D, D>().diagonal().setConstant(mass);
      g.template head<D>() = mass * Vec<D>(m_free[i].v - motion[i].v);
    }
    if (rotates) {
      a.template bottomRightCorner<kAngDim<D>, kAngDim<D>>() = m_inertia[i];
      g.template tail<kAngDim<D>>() = m_inertia[i] * Ang<D>(m_free[i].w - motion[i].w);
    }
    std::uint64_t within = 1;
    Real bends = 0;  // resistance of a loaded lever to turning, which no single row contains; a bound, so it only damps
    const auto add = [&](const Vec<D>& d, const Ang<D>& arm, Real impulse, Real stiffness) {
      Column j = Column::Zero();
      if (shifts) j.template head<D>() = d;
      if (rotates) j.template tail<kAngDim<D>>() = arm;
      g += impulse * j;
      within = 3 * within + (stiffness > 0);
      if (stiffness > 0) a += (stiffness * j) * j.transpose();
    };
    for (const std::int32_t number : in.graph.manifoldsOf(body)) {
      const int at = m_at[number];
      if (at < 0) continue;
      const ManifoldRows<D>& m = m_contacts.manifolds[at];
      const bool isB = m.b == body;
      const Real side = isB ? Real(1) : Real(-1);
      const Motion<D>&ma = motion[m.a], &mb = motion[m.b];
      for (int k = 0; k < m.count; ++k) {
        const auto p = m.first + k;
        const PointRows<D>& row = m_contacts.points[p];
        const Ask push = askNormal(m, p, ma, mb);
        add(m.n, isB ? row.normal.armB : row.normal.armA, side * push.impulse, push.stiffness);
        bends += push.impulse * (isB ? m_points[p].reachB : m_points[p].reachA);
        if (!(m.friction > 0 && row.impulse[0] > 0)) continue;
        const FrictionStep friction = askFriction(m, p, m.friction * row.impulse[0], ma, mb);
        for (int d = 0; d < D - 1; ++d) {
          const Row<D>& tangent = row.tangent[d];
          add(m.t.col(d), isB ? tangent.armB : tangent.armA, side * friction.impulse[d], friction.stiffness);
        }
      }
      countBodyRows(in, m.rows());
    }
    for (const std::int32_t number : in.graph.jointsOf(body)) {
      const int at = m_jointAt[number];
      if (at < 0) continue;
      const Joint& joint = m_joints[at];
      const bool isB = joint.b == body;
      Real load = 0;
      for (int k = 0; k < joint.rows.count; ++k) {
        const ConstraintRow<D>& row = joint.rows.row[k];
        if (row.absent()) continue;
        const Ask ask = askJoint(in, joint, k);
        add(row.d, isB ? row.armB : row.armA, isB ? ask.impulse : -ask.impulse, ask.stiffness);
        if (!row.angular) load += ask.impulse * ask.impulse;
        if (row.bend > 0) joint.addBend(row, m_h * std::abs(ask.impulse), isB, shifts, rotates, a);
      }
      bends += std::sqrt(load) * (isB ? joint.reachB : joint.reachA);
      countBodyRows(in, static_cast<std::uint64_t>(joint.rows.count));
    }
    if (rotates) a.template bottomRightCorner<kAngDim<D>, kAngDim<D>>().diagonal().array() += m_h * bends;
    if (within == last) return last;
    in.work[WorkCount::multiplyAdds] += kSolveMultiplyAdds;
    const Column change = share * ldlSolve<kSize>(a, g);
    motion[i].v += change.template head<D>();
    motion[i].w += change.template tail<kAngDim<D>>();
    return within;
  }

  // Adds the penalty forces to the constraint forces, and raises penalties where that was not enough.
  void raise(const StepInput<D>& in) {
    const auto& motion = in.bodies.motion;
    const auto grown = [&](Real penalty, Real violation) {
      return std::min(penalty + m_params.ramp * violation, m_params.maxPenalty);
    };
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Motion<D>&a = motion[m.a], &b = motion[m.b];
      for (int k = 0; k < m.count; ++k) {
        const auto p = m.first + k;
        PointRows<D>& row = m_contacts.points[p];
        const Ask push = askNormal(m, p, a, b);
        row.impulse[0] = push.impulse;
        if (m.friction > 0) {
          const FrictionStep friction = askFriction(m, p, m.friction * push.impulse, a, b);
          for (int d = 0; d < D - 1; ++d) row.impulse[d + 1] = friction.impulse[d];
          m_points[p].tangent = grown(m_points[p].tangent, friction.violation);
        }
        m_points[p].normal = grown(m_points[p].normal, push.violation);
      }
    }
    if (m_joints.empty()) return;
    if (m_params.rows == Rows::jointsAtEnd) linearize(in);
    for (Joint& joint : m_joints) {
      Real linear = 0, angular = 0;
      for (int i = 0; i < joint.rows.count; ++i) {
        if (joint.rows.row[i].absent()) continue;
        const Ask ask = askJoint(in, joint, i);
        joint.impulse[i] = ask.impulse;
        (joint.rows.row[i].angular ? angular : linear) += ask.violation * ask.violation;
      }
      joint.linear = grown(joint.linear, std::sqrt(linear));
      joint.angular = grown(joint.angular, std::sqrt(angular));
    }
  }

  // The method has no restitution: impulses at the end of the step make pairs bounce, and friction acts with these
  // impulses.
  void bounce(const StepInput<D>& in) {
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Real e = in.manifolds[m.manifold].restitution;
      if (!(e > 0)) continue;
      Motion<D>& a = in.bodies.motion[m.a];
      Motion<D>& b = in.bodies.motion[m.b];
      for (int k = 0; k < m.count; ++k) {
        const auto p = m.first + k;
        PointRows<D>& row = m_contacts.points[p];
        if (!(m_points[p].arrival < -in.restitutionThreshold) || !(row.impulse[0] > 0)) continue;
        const Real v = rowVelocity<D>(row.normal, m.n, a, b, m_rotation), old = row.impulse[0];
        row.impulse[0] = std::max(old - row.normal.mass * (v + e * m_points[p].arrival), old);
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, m_rotation);
        countRows<D>(in.work, 1);
        if (!(m.friction > 0) || !(row.impulse[0] > old)) continue;
        solveFrictionBeside(m, row, row.impulse[0] - old, a, b, m_rotation);
        countRows<D>(in.work, D - 1);
      }
    }
  }

  void store(const StepInput<D>& in) {
    m_contacts.store(in.manifolds);
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      for (int k = 0; k < m.count; ++k) {
        const Point& p = m_points[m.first + k];
        auto& memory = in.manifolds[m.manifold].points[k].memory;
        memory[0] = p.normal, memory[1] = p.tangent;
      }
    }
    for (const Joint& joint : m_joints) {
      JointRecord<D>& record = in.joints[joint.joint];
      record.impulse = joint.impulse;
      record.memory[linearPenalty] = joint.linear, record.memory[angularPenalty] = joint.angular;
    }
  }

  struct NoBias final : PositionResolver<D> {};

  Params m_params;
  FreeMotion<D> m_motion;
  bool m_rotation = true;
  Real m_h = 0, m_alpha = 0;
  ContactRows<D> m_contacts;
  IndexedVector<Point> m_points;
  IndexedVector<Joint> m_joints;
  IndexedVector<int> m_at, m_jointAt;  // by manifold, by slot of a joint: index into the arrays above, or -1
  IndexedVector<Pose<D>> m_from;       // at the start of the step
  IndexedVector<Motion<D>> m_start, m_free,
      m_velocity;  // without constraints; velocity that remains after the last sweep
  IndexedVector<Inertia<D>> m_inertia;
  IndexedVector<Wrench<D>> m_wrenches;
};

}  // namespace

LPC_REGISTER(Solver, Avbd, 2, 3);

}}  // namespace lpc::LPC_PRECISION
