// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <bit>
#include <memory>

#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/impact.h"
#include "algorithms/solver/step/free_motion.h"
#include "framework/math/random.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

enum class Order { stored, reverse, random, bottomUp, coloured, worstFirst };
enum class Loop { solveMove, resolveThenForceMove };

// Forces, velocities and positions by three separate methods, one after the other.
template <int D>
class SplitSolver final : public Solver<D> {
 public:
  struct Params {
    Spec velocity{"catto", {}}, position{"split_impulse", {}}, integrator{"semi_implicit_euler", {}};
    Order order = Order::stored;
    Loop loop = Loop::solveMove;
    ImpactLaw impact = ImpactLaw::newton;
    int impactLimit = 500;
    int seed = 1;
    void visit(ParamVisitor& v) {
      v.stage("velocity", velocity, StageKind::velocity, "velocity resolver");
      v.stage("position", position, StageKind::position,
              "position resolver, which corrects penetration and joint errors");
      v.stage("integrator", integrator, StageKind::integrator, "integrator of the free motion under forces");
      v.choice("order", order, {"stored", "reverse", "random", "bottom_up", "coloured", "worst_first"},
               "order of the contacts in a pass; to alternate its direction use catto{sweep=symmetric}");
      v.choice("loop", loop, {"solve_move", "resolve_then_force_move"},
               "contacts are solved with this step's forces, or before them as in 2009");
      v.choice(
          "impact", impact, {"newton", "poisson", "sequential"},
          "law of restitution: Newton's on velocities, Poisson's on impulses, or sequential impacts from pair to pair");
      v.integer("impact_limit", impactLimit, 1, 100000,
                "largest number of passes of Poisson's phases, and of sequential impacts per pair");
      v.integer("seed", seed, 0, 1000000000, "seed of order=random");
    }
  };
  explicit SplitSolver(const Params& params)
      : m_params(params),
        m_velocity(createStage<VelocityResolver<D>>(params.velocity)),
        m_position(createStage<PositionResolver<D>>(params.position)),
        m_integrator(createStage<Integrator<D>>(params.integrator)) {}

  static AlgorithmInfo info() {
    return {.name = "split_solver",
            .summary = "combines an integrator, a velocity resolver and a position resolver",
            .paper = "lpc2009",
            .complexity = "that of its parts",
            .guarantee = Guarantee::approximate,
            .failures = {{"impact=newton, and restitution differs between contacts or sliding reverses during the "
                          "impact (Kane's rod)",
                          "the impact adds energy; the other laws do not", "Impact.AddsNoEnergy"},
                         {"loop=resolve_then_force_move: a box on a slope below the critical angle",
                          "it slides by g dt^2 sin(angle) a step: the force moves it before contacts are solved",
                          "Slope.HoldsOrSaysThatItDoesNot"}},
            .friction = FrictionLaw::ofItsParts};
  }

  void step(const StepInput<D>& in) override {
    haltUnmoving(in.bodies, in.model.rotation);
    arrange(in);
    m_arrival.assign(in.bodies.motion.begin(), in.bodies.motion.end());
    m_drift.resize(in.bodies.pose.size());
    if (m_params.loop == Loop::solveMove) {
      integrate(in);
      m_free.assign(in.bodies.motion.begin(), in.bodies.motion.end());
      solveVelocities(in);
      for (std::size_t i = 0; i < m_drift.size(); ++i) {
        m_drift[i].v += in.bodies.motion[i].v - m_free[i].v;
        m_drift[i].w += in.bodies.motion[i].w - m_free[i].w;
      }
      move(in);
      correct(in);
    } else {
      solveVelocities(in);
      correct(in);
      integrate(in);
      move(in);
    }
  }

 private:
  void arrange(const StepInput<D>& in) {
    m_colours.clear();
    if (m_params.order == Order::coloured) return in.graph.colour(in.active, m_order, m_colours);
    m_order.assign(in.active.begin(), in.active.end());
    if (m_params.order == Order::reverse) std::reverse(m_order.begin(), m_order.end());
    if (m_params.order == Order::random) {
      // Seeded by the time: each step has another order, yet a loaded world continues with the order that it would have
      // had.
      Random random(static_cast<std::uint64_t>(m_params.seed) ^ std::bit_cast<std::uint64_t>(double(in.time)));
      for (std::size_t i = m_order.size(); i > 1; --i) std::swap(m_order[i - 1], m_order[random.below(i)]);
    }
    if (m_params.order == Order::bottomUp) sortBottomUp(in);
  }

  void sortBottomUp(const StepInput<D>& in) {
    m_key.resize(in.manifolds.size());
    for (int i : m_order) {
      const Manifold<D>& m = in.manifolds[i];
      m_key[i] = (in.bodies.pose[m.bodyA] * m.points[0].localA)[1];
      for (int p = 1; p < m.count; ++p) {
        const Vec<D>& local = m.points[p].localA;
        m_key[i] = std::min(m_key[i], (in.bodies.pose[m.bodyA] * local)[1]);
      }
    }
    sortByKey();
  }

  // Sorts contacts once per step by the correction that a resolver is about to make: the largest change of normal
  // velocity that a point of the contact demands (contactTarget), including this step's forces, before any impulse.
  void sortWorstFirst(const VelocityInput<D>& in) {
    m_key.resize(in.manifolds.size());
    for (int i : m_order) {
      const Manifold<D>& m = in.manifolds[i];
      Real worst = velocityError<D>(in, m, m.points[0]);
      for (int p = 1; p < m.count; ++p) {
        worst = std::max(worst, velocityError<D>(in, m, m.points[p]));
      }
      m_key[i] = -worst;
    }
    sortByKey();
  }

  void sortByKey() {
    for (int i : m_order) {
      Real& key = m_key[i];
      if (!(key == key)) key = 0;  // NaN cannot be ordered
    }
    std::sort(m_order.begin(), m_order.end(), [&](int a, int b) {
      const Real x = m_key[a], y = m_key[b];
      return x < y || (!(y < x) && a < b);
    });
  }

  void integrate(const StepInput<D>& in) {
    Profiler::Scope scope(in.profiler, "solver.integrate");
    m_integrator->integrate({in.dt, in.time, in.bodies, in.forces, in.model, in.work}, m_drift);
  }
  void solveVelocities(const StepInput<D>& in) {
    Profiler::Scope scope(in.profiler, "solver.velocity");
    PhysicsModel model = in.model;
    const VelocityInput<D> problem{
        in.dt,   in.lastDt,   in.bodies, in.manifolds, m_order, in.joints, *m_position, model, in.restitutionThreshold,
        in.work, in.profiler, m_arrival, m_colours};
    if (model.restitution && m_params.impact != ImpactLaw::newton) {
      m_impact.strike(m_params.impact, problem, in.graph, m_params.impactLimit);
      model.restitution = false;
    }
    if (m_params.order == Order::worstFirst) sortWorstFirst(problem);
    if (in.watcher) in.watcher->see(problem);
    m_velocity->solve(problem);
    for (const int i : m_order) {
      for (ContactPoint<D>& c : in.manifolds[i].points) c.load = c.impulse[0];
    }
  }
  void move(const StepInput<D>& in) {
    Profiler::Scope scope(in.profiler, "solver.move");
    m_motion.move(in.bodies, m_drift, in.dt, in.model.rotation);
  }
  void correct(const StepInput<D>& in) {
    Profiler::Scope scope(in.profiler, "solver.position");
    m_position->correct(
        {in.dt, in.bodies, in.manifolds, m_order, in.joints, in.model, in.work, in.profiler, m_colours});
  }

  Params m_params;
  std::unique_ptr<VelocityResolver<D>> m_velocity;
  std::unique_ptr<PositionResolver<D>> m_position;
  std::unique_ptr<Integrator<D>> m_integrator;
  std::vector<int> m_order, m_colours;
  IndexedVector<Real> m_key;  // by manifold: the sort key, m or m/s
  std::vector<Motion<D>> m_drift, m_free, m_arrival;
  Impact<D> m_impact;
  FreeMotion<D> m_motion;
};

}  // namespace

LPC_REGISTER(Solver, SplitSolver, 2, 3);

}}  // namespace lpc::LPC_PRECISION
