// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "algorithms/solver/rows/body_displacements.h"
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "algorithms/solver/step/free_motion.h"
#include "algorithms/solver/step/gyroscopic.h"
#include "algorithms/solver/step/remade_contacts.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Extended position based dynamics: sub-steps of one iteration. Bodies move freely, constraints move them back, and the
// resulting displacement is their velocity. Nothing is accumulated from sub-step to sub-step. A second pass over
// velocities adds sliding friction and restitution, and removes velocity that only corrected overlap.
//
// A correction is stored as the change of velocity that makes it in this sub-step, so a velocity is never the
// difference of two positions, which would have no digits far from the origin. Joint rows belong to the predicted poses
// and are linear from there. Contact rows have the arms of the start of the sub-step: at the predicted poses the anchor
// of a rolling ball has turned with it, and the floor's push at that arm would turn the ball.
template <int D>
class Xpbd final : public Solver<D> {
 public:
  struct Params {
    int substeps = 8;
    Real contactCompliance = 0, jointCompliance = 0, slop = Real(0.0005);
    // Half in f32: the rounding of a position divided by h would become speed and impulse.
    Real jointShare = 0;
    bool gyroscopic = false;
    ContactsOf contacts = ContactsOf::step;
    void visit(ParamVisitor& v) {
      v.integer("substeps", substeps, 1, 10000, "sub-steps per step, one iteration each", ParamRole::effort);
      v.real("contact_compliance", contactCompliance, 0, 1, "m/N", "compliance of contacts; 0: rigid");
      v.real("joint_compliance", jointCompliance, 0, 1, "m/N",
             "compliance of joints; rad/(N m) for their angular rows");
      v.real("joint_share", jointShare, 0, 1, "1",
             "fraction of a joint's error corrected per sub-step; 0: 1 (published), 0.5 in f32 because of rounding");
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected, so that resting contacts persist");
      v.flag("gyroscopic", gyroscopic,
             "implicit gyroscopic term, in 3D; published: an explicit one, which gains energy");
      visitContactsOf(v, contacts, "or again for each sub-step (published)");
    }
  };
  explicit Xpbd(const Params& params) : m_params(params) {
    if (m_params.jointShare == 0) m_params.jointShare = sizeof(Real) == 8 ? Real(1) : Real(0.5);
  }

  static AlgorithmInfo info() {
    return {
        .name = "xpbd",
        .summary = "extended position based dynamics: sub-steps of one iteration on positions, then velocities",
        .paper = "mueller2020",
        .complexity = "substeps x 2 x contacts + substeps x joints",
        .guarantee = Guarantee::approximate,
        .failures =
            {kNoGyroscopicTerm,
             {"a body that rocks or rolls on a curved one",
              "its swing grows: contact points stay those of the step's start; contacts=substep follows",
              "KnownAnswer.rocking_plank"},
             {"boxes deep inside each other",
              "they are thrown apart: depth becomes velocity in one sub-step, and one pass does not remove it",
              "Overlap.ComesApartOrSaysThatItDoesNot"},
             {"a penetration that is corrected by rotation", "the bodies separate: the correction becomes velocity",
              "PositionError.EndsInTouch"},
             {"a joint error that is corrected", "its bodies keep the correction speed", "JointStep.PullsLeaveNoSpeed"},
             {"a box on a slope below the critical angle",
              "it creeps: friction only holds the position of the sub-step's start, without warm starting",
              "Slope.HoldsOrSaysThatItDoesNot"},
             {"cubes on each other", "they tremble and creep, because each sub-step is one pass without warm starting",
              "Rest.StackStays"},
             {"a cone with friction at its limit, with shorter and shorter steps",
              "its error shrinks slower than the step, because each sub-step is one pass without warm starting",
              "JointMotion.Converges"},
             {"brakes in series that hold a weight", "they slip: no impulse is kept, and nothing pulls back",
              "JointMotion.Rests"},
             {"bodies in contact that rotate together",
              "their angular momentum changes: lever arms of joints are a sub-step ahead of those of contacts",
              "Solver.TurningKeepsAngularMomentum"},
             {"bodies that separate within the step",
              "no later sub-step undoes a push of an earlier one, so the result depends on the order of contacts",
              "Solver.OrderDoesNotMatter"},
             {"a ball that rolls",
              "it gains speed: its anchor rotates with it within a step, and the floor's force there drives it on",
              "Rolling.StopsOrSaysThatItDoesNot"},
             {"a heavy body that falls on a light one",
              "it is thrown up: a later sub-step corrects the penetration of an earlier one, which becomes velocity",
              "Solver.HeavyIsNotThrownUp"},
             {"a heavy body that falls on a light one", "it slows down faster than Gauss-Seidel predicts",
              "Solver.ConvergesAsPredicted"}},
        .friction = FrictionLaw::coulomb};
  }

  void step(const StepInput<D>& in) override {
    const bool rotation = in.model.rotation;
    const Real h = in.dt / static_cast<Real>(m_params.substeps);
    auto& pose = in.bodies.pose;
    auto& motion = in.bodies.motion;
    haltUnmoving(in.bodies, rotation);
    m_contacts.points.clear();
    m_jointImpulse.assign(in.joints.size(), {});
    m_joints.clear();
    m_start.resize(pose.size());
    for (std::size_t k = 0; k < pose.size(); ++k) m_start[k] = pose[k].p;
    m_displacement.assign(pose.size(), Vec<D>::Zero());
    for (int i = 0; i < m_params.substeps; ++i) {
      {
        Profiler::Scope scope(in.profiler, "solver.integrate");
        m_arrival.assign(motion.begin(), motion.end());
        kick<D>({h, in.time + static_cast<Real>(i) * h, in.bodies, in.forces, in.model, in.work}, m_wrenches);
        if (m_params.gyroscopic && rotation) gyroscopicStep(in.bodies, h, 1);
      }
      {
        Profiler::Scope scope(in.profiler, "solver.prepare");
        const bool again = i > 0 && m_params.contacts == ContactsOf::substep;
        if (again) makeContacts(in);
        prepareContacts(in, h);
        if (i == 0) m_total.assign(m_contacts.points.size(), {});
        if (again) inheritTotals(in);
        if (i == 0 || again) findPairs();
        m_from.assign(pose.begin(), pose.end());
        if (in.model.joints) {
          move(in, h);  // to the predicted poses
          prepareJoints(in, h);
        }
      }
      {
        Profiler::Scope scope(in.profiler, "solver.iterate");
        m_joints.sweep(motion, h, {.rate = m_params.jointShare / h});
        m_joints.count(in.work);
        m_work.assign(m_pair.size(), 0);
        for (std::size_t w = 0; w < m_pair.size(); ++w) push(m_contacts.manifolds[w], in, h, m_work[m_pair[w]]);
      }
      {
        Profiler::Scope scope(in.profiler, "solver.move");
        for (std::size_t k = 0; k < pose.size(); ++k) pose[k].q = m_from[k].q;
        move(in, h);
        for (std::size_t k = 0; k < pose.size(); ++k) m_displacement[k] += h * motion[k].v;
      }
      Profiler::Scope scope(in.profiler, "solver.velocities");
      for (int k = 0; k < kSettle; ++k) {
        for (std::size_t w = 0; w < m_pair.size(); ++w)
          settle(m_contacts.manifolds[w], in, m_work[m_pair[w]], k + 1 == kSettle);
      }
      accumulate();
    }
    store(in);
  }

 private:
  static constexpr int kSettle = 2;   // friction that is removed changes the normal velocity
  static constexpr int kBounce = 16;  // visits: depth over h may be a hundred times the speed of a bounce

  // Positions are the start of the step plus one displacement; thirty small displacements would be rounded thirty
  // times.
  void move(const StepInput<D>& in, Real h) {
    m_ahead.assign(m_displacement.begin(), m_displacement.end());
    m_motion.move(in.bodies, in.bodies.motion, h, in.model.rotation);
    for (std::size_t k = 0; k < in.bodies.pose.size(); ++k) {
      if (!travels(in.bodies, k)) continue;
      m_ahead[k] += h * in.bodies.motion[k].v;
      in.bodies.pose[k].p = m_start[k] + m_ahead[k];
    }
  }

  // Corrects a velocity that closes more than the gap, or that leaves depth.
  void prepareContacts(const StepInput<D>& in, Real h) {
    const NoBias none;
    m_contacts.prepare({h, h, in.bodies, in.manifolds, in.active, in.joints, none, in.model, in.restitutionThreshold,
                        in.work, in.profiler, m_arrival},
                       true);
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Manifold<D>& of = in.manifolds[m.manifold];
      const auto [atA, atB] = BodyDisplacements<D>{m_start, m_displacement}.pair(in.bodies, m.a, m.b);
      for (int k = 0; k < m.count; ++k) {
        const ContactArms<D> arms(of.points[k], m.n, atA, atB);
        const Real kept = std::clamp(-arms.separation, Real(0), m_params.slop);
        m_contacts.points[m.first + k].target = -(arms.separation + kept) / h;
      }
    }
  }
  // Numbers the pairs of bodies by their first manifold. Manifolds are sorted by body A, its shape, and body B:
  // those of two bodies need not be adjacent.
  void findPairs() {
    const auto& manifolds = m_contacts.manifolds;
    const auto key = [&](std::size_t k) { return std::tuple(manifolds[k].a, manifolds[k].b, k); };
    m_byPair.resize(manifolds.size()), m_pair.resize(manifolds.size());
    std::iota(m_byPair.begin(), m_byPair.end(), std::size_t(0));
    std::sort(m_byPair.begin(), m_byPair.end(), [&](std::size_t k, std::size_t l) { return key(k) < key(l); });
    std::size_t first = 0;
    for (const std::size_t k : m_byPair) {
      if (manifolds[k].a != manifolds[first].a || manifolds[k].b != manifolds[first].b || k == m_byPair[0]) first = k;
      m_pair[k] = first;
    }
  }
  // Joint errors at the predicted poses, less the predicted motion along each row: the errors from which the velocity
  // of this sub-step starts.
  void prepareJoints(const StepInput<D>& in, Real h) {
    const auto& motion = in.bodies.motion;
    m_joints.prepare(in.work, in.bodies, in.joints, m_params.jointCompliance / (h * h), {m_start, m_ahead});
    for (const JointBlock<D>& block : m_joints.blocks) {
      const Motion<D> a = block.a < 0 ? Motion<D>{} : motion[block.a];
      const Motion<D>& b = motion[block.b];
      for (JointRow<D>& row : m_joints.of(block)) row.error -= h * rowSpeed<D>(row, a.v, a.w, b.v, b.w);
    }
  }

  // Corrects positions. Friction acts only where it can hold the point in place; sliding is left to the velocity pass.
  void push(const ManifoldRows<D>& m, const StepInput<D>& in, Real h, Real& work) {
    const bool rotation = in.model.rotation;
    Motion<D>& a = in.bodies.motion[m.a];
    Motion<D>& b = in.bodies.motion[m.b];
    for (int k = 0; k < m.count; ++k) {
      PointRows<D>& row = m_contacts.points[m.first + k];
      const Real give = 1 / (1 + m_params.contactCompliance / (h * h) * row.normal.mass);
      const Real v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
      row.impulse[0] = std::max(give * row.normal.mass * (row.target - v), Real(0));
      work += workOf(row.normal, row.impulse[0], v);
      applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0], a, b, rotation);
    }
    if (!(m.friction > 0)) return;
    for (int k = 0; k < m.count; ++k) {
      PointRows<D>& row = m_contacts.points[m.first + k];
      const RealMatrix<D - 1, 1> v = slip(m, row, a, b, rotation);
      const RealMatrix<D - 1, 1> impulse = -(row.stick * v);
      if (!(impulse.norm() <= m.friction * row.impulse[0])) continue;
      for (int d = 0; d < D - 1; ++d) {
        row.impulse[d + 1] = impulse[d];
        applyRow<D>(row.tangent[d], m.t.col(d), m.invMassA, m.invMassB, impulse[d], a, b, rotation);
      }
      work += impulse.dot(v + slip(m, row, a, b, rotation)) / 2;
    }
    countRows<D>(in.work, m.rows());
  }

  // The kinetic energy (J) that an impulse along a row gives to bodies with relative velocity v.
  static Real workOf(const Row<D>& row, Real impulse, Real v) {
    return impulse == 0 ? Real(0) : impulse * (v + impulse / (2 * row.mass));
  }
  static RealMatrix<D - 1, 1> slip(const ManifoldRows<D>& m, const PointRows<D>& row, const Motion<D>& a,
                                   const Motion<D>& b, bool rotation) {
    RealMatrix<D - 1, 1> v;
    for (int d = 0; d < D - 1; ++d) v[d] = rowVelocity<D>(row.tangent[d], m.t.col(d), a, b, rotation);
    return v;
  }

  // Corrects velocities: a point that was pushed stops or bounces, whatever the reason for the push. It may be pulled
  // by no more than it was pushed. A pair that bounces is visited until little is left of the speed that only corrected
  // depth. The last visit limits a bounce so that it leaves no `work`: the energy (J) that this pair gained in this
  // sub-step. A push that is pulled back has still moved the bodies against their forces (`kick`).
  void settle(const ManifoldRows<D>& m, const StepInput<D>& in, Real& work, bool last) {
    const bool rotation = in.model.rotation;
    const auto a = m.a, b = m.b;
    const Real e = in.model.restitution ? in.manifolds[m.manifold].restitution : Real(0);
    auto& motion = in.bodies.motion;
    bool bounces = false;
    for (int i = 0; i == 0 || (bounces && i < kBounce); ++i) {
      const bool ends = last && i + 1 == kBounce;
      for (int k = 0; k < m.count; ++k) {
        PointRows<D>& row = m_contacts.points[m.first + k];
        const Real old = row.impulse[0];
        if (!(old > 0)) continue;
        const Real arrival = rowVelocity<D>(row.normal, m.n, m_arrival[a], m_arrival[b], rotation);
        const Real v = rowVelocity<D>(row.normal, m.n, motion[a], motion[b], rotation);
        Real target = 0;
        if (e > 0 && std::abs(arrival) > in.restitutionThreshold) bounces = true;  // or leaves after a bounce
        if (e > 0 && arrival < -in.restitutionThreshold) {
          target = -e * arrival;
          const Real u = v + row.kick, free = u * u - 2 * work / row.normal.mass;
          const Real most = std::sqrt(std::max(free, Real(0))) - row.kick;  // speed at which `work` is 0
          if (ends) target = std::min(target, std::max(most, Real(0)));
        }
        row.impulse[0] = std::max(old + row.normal.mass * (target - v), Real(0));
        work += workOf(row.normal, row.impulse[0] - old, v + row.kick);
        applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, motion[a], motion[b], rotation);
        countRows<D>(in.work, 1);
      }
      if (!(m.friction > 0)) continue;
      for (int k = 0; k < m.count; ++k) {
        work += slide(m, m_contacts.points[m.first + k], motion[a], motion[b], rotation);
      }
      countRows<D>(in.work, static_cast<std::uint64_t>(m.count) * (D - 1));
    }
  }

  // Sliding friction at one point. Returns its work, J.
  static Real slide(const ManifoldRows<D>& m, PointRows<D>& row, Motion<D>& a, Motion<D>& b, bool rotation) {
    const RealMatrix<D - 1, 1> before = slip(m, row, a, b, rotation);
    RealMatrix<D - 1, 1> change;
    for (int d = 0; d < D - 1; ++d) change[d] = -row.impulse[d + 1];
    solveFrictionAt(m, row, a, b, rotation);
    for (int d = 0; d < D - 1; ++d) change[d] += row.impulse[d + 1];
    return change.dot(before + slip(m, row, a, b, rotation)) / 2;
  }

  // Impulses are those of a whole step, as in every other solver.
  void accumulate() {
    for (std::size_t k = 0; k < m_total.size(); ++k) {
      for (std::size_t d = 0; d < D; ++d) m_total[k][d] += m_contacts.points[k].impulse[d];
    }
    for (const JointBlock<D>& block : m_joints.blocks) {
      auto& sum = m_jointImpulse[block.joint];
      for (const JointRow<D>& row : m_joints.of(block)) sum[row.number] += row.impulse;
    }
  }
  void storeContacts(const StepInput<D>& in) {
    for (std::size_t k = 0; k < m_total.size(); ++k) m_contacts.points[k].impulse = m_total[k];
    m_contacts.store(in.manifolds);
  }
  void makeContacts(const StepInput<D>& in) {
    storeContacts(in);
    m_remade.keep(in.manifolds, in.active);
    in.detect.again();
    m_remade.restore(in.manifolds, in.active, PointImpulse::sum);
  }
  void inheritTotals(const StepInput<D>& in) {
    m_total.resize(m_contacts.points.size());
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      for (int k = 0; k < m.count; ++k) m_total[m.first + k] = in.manifolds[m.manifold].points[k].impulse;
    }
  }
  void store(const StepInput<D>& in) {
    storeContacts(in);
    const auto keep = [&](std::int32_t j) { in.joints[j].impulse = m_jointImpulse[j]; };
    for (const JointBlock<D>& block : m_joints.blocks) keep(block.joint);
    for (const std::int32_t j : m_joints.rowless) keep(j);
  }

  struct NoBias final : PositionResolver<D> {};

  Params m_params;
  FreeMotion<D> m_motion;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
  IndexedVector<Pose<D>> m_from;  // before this sub-step's motion
  IndexedVector<Vec<D>> m_start, m_displacement,
      m_ahead;                 // position at the start of the step, displacement since, the same with this sub-step, m
  IndexedVector<Real> m_work;  // of each two bodies in this sub-step, J
  IndexedVector<std::size_t> m_pair;  // by manifold: where its work is in m_work
  std::vector<std::size_t> m_byPair;  // manifolds, sorted by their bodies
  RemadeContacts<D> m_remade;
  IndexedVector<Motion<D>> m_arrival;  // before this sub-step's forces
  IndexedVector<IndexedArray<Real, D>> m_total;
  IndexedVector<IndexedArray<Real, kJointRows>> m_jointImpulse;  // by slot
  IndexedVector<Wrench<D>> m_wrenches;
};

}  // namespace

LPC_REGISTER(Solver, Xpbd, 2, 3);

}}  // namespace lpc::LPC_PRECISION
