// SPDX-License-Identifier: Zlib
#include "algorithms/solver/lanes/contact_lanes.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "algorithms/solver/rows/normal_block.h"
#include "algorithms/solver/rows/sequential_impulse.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

enum class Sweep { forward, symmetric };
enum class Friction { cone, pyramid, box };

// Sequential impulses: projected Gauss-Seidel on velocities. The accumulated impulse is clamped, never the increment,
// so that a later sweep can reduce what an earlier one applied; and it warm starts the next step.
template <int D>
class Catto final : public VelocityResolver<D> {
 public:
  struct Params {
    int iterations = 10;
    bool warmStart = true;
    Real warmFactor = 1;
    Real relaxation = 1;
    Sweep sweep = Sweep::forward;
    bool block = false;
    Friction friction = Friction::cone;
    SweepLanes lanes = SweepLanes::automatic;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "passes over all joints and contacts", ParamRole::effort);
      v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
      v.real("warm_factor", warmFactor, 0, 1, "1", "fraction of the last step's impulses used for warm starting");
      v.real("relaxation", relaxation, Real(0.05), Real(1.95), "1", "over-relaxation of normal impulses (SOR)");
      v.choice("sweep", sweep, {"forward", "symmetric"}, "direction of the passes: always forward, or alternating");
      v.flag("block", block, "solve the normal impulses of a manifold as one block");
      v.choice(
          "friction", friction, {"cone", "pyramid", "box"},
          "bound of friction: vector within mu n, each tangent within mu n, or each tangent with n of the last step");
      visitSweepLanes(v, lanes, "; only with the other choices at their defaults");
    }
  };
  explicit Catto(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    std::vector<FailureMode> failures = {
        {"a heavy body on a light one; a tall stack",
         "linear convergence: each pass reduces the error by the factor r/(1+r) for a mass ratio r",
         "Impulse.CarriesHeavyOnLight"}};
    if (D == 3) {
      const std::string pyramid = "friction=pyramid: a body that slides at an angle to the tangents";
      for (const char* test : {"Impulse.StaysInTheCone", "Impulse.PushesOnly", "Solver.StaysInTheCone"}) {
        failures.push_back({pyramid, "friction reaches sqrt(2) mu n", test});
      }
      for (const char* test : {"Impulse.TurnsWithTheFrame", "Symmetry.MovesWithTheFrame"}) {
        failures.push_back({pyramid, "the result changes when the scene is rotated", test});
      }
      failures.push_back({"friction=box: a body that slides at an angle to the tangents",
                          "the result changes when the scene is rotated", "Symmetry.MovesWithTheFrame"});
      for (const char* choice : {"pyramid", "box"}) {
        failures.push_back({"friction=" + std::string(choice) + ": prisms that slide in their plane",
                            "the tangents lie at an angle to that plane: friction reaches sqrt(2) mu n",
                            "Extrusion.AgreesOrSaysThatItDoesNot"});
      }
    }
    return {
        .name = "catto",
        .summary = "sequential impulses: projected Gauss-Seidel with accumulated, clamped and warm-started impulses",
        .paper = "catto2006",
        .complexity = "iterations x (contacts + joints)",
        .guarantee = Guarantee::approximate,
        .failures = failures,
        .friction = FrictionLaw::coulomb,
        .otherFriction = {{"friction", "pyramid", FrictionLaw::pyramid}, {"friction", "box", FrictionLaw::lagged}}};
  }

  void solve(const VelocityInput<D>& in) override {
    if (m_params.sweep == Sweep::forward && !m_params.block && m_params.friction == Friction::cone) {
      return solveInBlocks(in);
    }
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      m_contacts.prepare(in);
      m_joints.clear();
      if (in.model.joints) m_joints.prepare(in.work, in.bodies, in.joints);
      if (m_params.block) prepareNormalBlocks(in.work);
      if (m_params.friction == Friction::box) prepareLimits(in);
      if (m_params.warmStart) warmStart(in);
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    const Feedback feedback{.rate = in.position.jointBias(in.dt)};
    for (int i = 0; i < m_params.iterations; ++i) {
      m_joints.sweep(in.bodies.motion, in.dt, feedback);
      const bool back = m_params.sweep == Sweep::symmetric && i % 2 == 1;
      const std::size_t n = m_contacts.manifolds.size();
      for (std::size_t k = 0; k < n; ++k) {
        solveManifold(back ? n - 1 - k : k, in, back);
      }
    }
    std::uint64_t rows = 0;
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      rows += m.rows();
    }
    countRows<D>(in.work, rows * static_cast<std::uint64_t>(m_params.iterations));
    m_joints.count(in.work, static_cast<std::uint64_t>(m_params.iterations));
    m_contacts.store(in.manifolds);
    m_joints.store(in.joints);
  }

 private:
  using Layout = BlockLayout<D>;

  // The default choices, in lanes where `order` has colours.
  void solveInBlocks(const VelocityInput<D>& in) {
    const bool rotation = in.model.rotation;
    auto& motion = in.bodies.motion;
    {
      Profiler::Scope scope(in.profiler, "solver.prepare");
      const int lanes = m_params.lanes == SweepLanes::scalar ? 1 : contactLanes();
      m_inLanes.arrange(in.bodies, in.manifolds, in.order, in.colours, lanes, in.model.friction);
      m_inLanes.loadFixed(in.bodies, [&](std::int32_t body) { return in.bodies.pose[body].p; });
      m_inLanes.loadPose(in.bodies);
      prepareBlocks(m_inLanes, in.manifolds, m_params.warmStart ? m_params.warmFactor * lastImpulseScale(in) : Real(0));
      countMadeRows<D>(in.work, m_inLanes.rows());
      setTargets(in);
      m_joints.clear();
      if (in.model.joints) m_joints.prepare(in.work, in.bodies, in.joints);
      if (m_params.warmStart) {
        applyBlocks(m_inLanes, rotation);
        m_inLanes.storeMotion(in.bodies, motion);
        warmStartJoints(in);
        m_inLanes.loadMotion(motion);
      }
    }
    Profiler::Scope scope(in.profiler, "solver.iterate");
    const Feedback relaxed{.rate = 0, .massScale = m_params.relaxation};
    const BlockSweep law{.contact = relaxed, .contactFixed = relaxed, .targets = true, .rotation = rotation};
    const Feedback feedback{.rate = in.position.jointBias(in.dt)};
    for (int i = 0; i < m_params.iterations; ++i) {
      if (!m_joints.blocks.empty()) {
        m_inLanes.storeMotion(in.bodies, motion);
        m_joints.sweep(motion, in.dt, feedback);
        m_inLanes.loadMotion(motion);
      }
      sweepBlocks(m_inLanes, law);
    }
    m_inLanes.storeMotion(in.bodies, motion);
    const auto iterations = static_cast<std::uint64_t>(m_params.iterations);
    countRows<D>(in.work, m_inLanes.rows() * iterations);
    m_joints.count(in.work, iterations);
    m_inLanes.forPoints([&](const ContactPlace& at, int k) {
      ContactPoint<D>& c = in.manifolds[at.manifold].points[k];
      for (int d = 0; d < D; ++d) c.impulse[d] = m_inLanes.of(at, k, Layout::kImpulse + d);
      c.load = c.impulse[0];
    });
    m_joints.store(in.joints);
  }

  // Restitution uses the velocities before any impulse. Afterwards the blocks hold the present velocities.
  void setTargets(const VelocityInput<D>& in) {
    constexpr int kArrival = Layout::kVelocity, kNow = Layout::kMaxImpulse;  // neither is needed otherwise
    if (!in.arrival.empty()) {
      m_inLanes.loadMotion(in.arrival);
      velocityBlocks(m_inLanes, kArrival, in.model.rotation);
    }
    m_inLanes.loadMotion(in.bodies.motion);
    velocityBlocks(m_inLanes, kNow, in.model.rotation);
    m_inLanes.forPoints([&](const ContactPlace& at, int k) {
      const Manifold<D>& m = in.manifolds[at.manifold];
      const Real v = m_inLanes.of(at, k, kNow), arrival = in.arrival.empty() ? v : m_inLanes.of(at, k, kArrival);
      m_inLanes.of(at, k, Layout::kGoal) =
          contactTarget<D>(m.points[k].separation, v, arrival, in.model.restitution ? m.restitution : Real(0),
                           in.restitutionThreshold, in.dt, in.position);
    });
  }

  void warmStart(const VelocityInput<D>& in) {
    warmStartContacts(in, m_params.warmFactor * lastImpulseScale(in), m_contacts);
    warmStartJoints(in);
  }
  void warmStartJoints(const VelocityInput<D>& in) {
    const Real factor = m_params.warmFactor * lastImpulseScale(in);
    m_joints.warmStart(in.dt,
                       [&](std::int32_t joint, std::int32_t row) { return factor * in.joints[joint].impulse[row]; });
    m_joints.applyAccumulated(in.bodies.motion);
  }

  void prepareNormalBlocks(WorkDone& work) {
    m_blocks.resize(m_contacts.manifolds.size());
    m_isBlock.assign(m_contacts.manifolds.size(), 0);
    for (std::size_t k = 0; k < m_blocks.size(); ++k) {
      const ManifoldRows<D>& m = m_contacts.manifolds[k];
      if (m.count > 1) m_isBlock[k] = m_blocks[k].set(m, m_contacts.points.data() + m.first, work);
    }
  }

  // Friction limits of the box law from the normal impulses of the last step, so that they do not change during the
  // solve.
  void prepareLimits(const VelocityInput<D>& in) {
    m_limits.resize(m_contacts.points.size());
    for (const ManifoldRows<D>& m : m_contacts.manifolds) {
      const Manifold<D>& old = in.manifolds[m.manifold];
      for (int i = 0; i < m.count; ++i) {
        const Real normal = lastImpulseScale(in) * old.points[i].impulse[0];
        m_limits[m.first + i] = m.friction * std::max(normal, Real(0));
      }
    }
  }

  void solveManifold(std::size_t k, const VelocityInput<D>& in, bool back) {
    Bodies<D>& bodies = in.bodies;
    const bool rotation = in.model.rotation;
    const ManifoldRows<D>& m = m_contacts.manifolds[k];
    // Local copies: the compiler keeps them in registers over all rows of the manifold.
    Motion<D> a = bodies.motion[m.a], b = bodies.motion[m.b];
    PointRows<D>* const points = m_contacts.points.data() + m.first;
    const auto place = [&](int i) { return back ? m.count - 1 - i : i; };
    if (m_params.block && m_isBlock[k]) {
      pushTogether(m_blocks[k], m, points, a, b, in);
    } else {
      for (int i = 0; i < m.count; ++i) solveNormalAt(m, points[place(i)], m_params.relaxation, a, b, rotation);
    }
    // Friction last, with the updated normal impulse: Coulomb's law holds exactly at the end of the sweep.
    for (int i = 0; i < m.count && m.friction > 0; ++i) {
      PointRows<D>& row = points[place(i)];
      switch (m_params.friction) {
        case Friction::cone:
          solveFrictionAt(m, row, a, b, rotation);
          break;
        case Friction::pyramid:
          solveBoxFrictionAt(m, row, m.friction * row.impulse[0], a, b, rotation);
          break;
        case Friction::box:
          solveBoxFrictionAt(m, row, m_limits[m.first + place(i)], a, b, rotation);
          break;
      }
    }
    bodies.motion[m.a] = a;
    bodies.motion[m.b] = b;
  }

  void pushTogether(const NormalBlock<D>& block, const ManifoldRows<D>& m, PointRows<D>* points, Motion<D>& a,
                    Motion<D>& b, const VelocityInput<D>& in) const {
    const bool rotation = in.model.rotation;
    typename NormalBlock<D>::Impulses old{}, v{};
    for (int i = 0; i < m.count; ++i) {
      old[i] = points[i].impulse[0];
      v[i] = rowVelocity<D>(points[i].normal, m.n, a, b, rotation) - points[i].target;
    }
    const auto wanted = block.solve(old, v, in.work);
    for (int i = 0; i < m.count; ++i) {
      points[i].impulse[0] = std::max(old[i] + m_params.relaxation * (wanted[i] - old[i]), Real(0));
      applyRow<D>(points[i].normal, m.n, m.invMassA, m.invMassB, points[i].impulse[0] - old[i], a, b, rotation);
    }
  }

  Params m_params;
  ContactRows<D> m_contacts;  // used unless solveInBlocks() applies
  ContactBlocks<D> m_inLanes;
  JointSystem<D> m_joints;
  std::vector<NormalBlock<D>> m_blocks;  // by manifold
  std::vector<std::uint8_t> m_isBlock;
  IndexedVector<Real> m_limits;  // of friction=box, by point, N s
};

}  // namespace

LPC_REGISTER(VelocityResolver, Catto, 2, 3);

}}  // namespace lpc::LPC_PRECISION
