// SPDX-License-Identifier: Zlib
// Laws of restitution other than Newton's: Poisson's for all contacts at once, and impacts that propagate from pair to
// pair. Newton's is a target velocity of each contact (contact_rows.h) and does not use this file.
#pragma once

#include <limits>

#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/extreme_first.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

enum class ImpactLaw { newton, poisson, sequential };

/// Runs before a velocity resolver, which then sees no restitution. It acts on the velocities of arrival, since weight
/// is not an impact, and on each island with an impact separately.
///
/// An impact has two phases (Glocker and Pfeiffer 1995). Compression: inelastic, with friction. Restitution: each
/// contact returns e times its impulse, and no contact may approach; friction starts anew, from the velocities of that
/// time and within the cone of the new normal impulses. For given normal impulses friction removes as much energy as it
/// can. The second phase therefore returns at most e^2 of what the first absorbed, whereas Newton's law can add energy
/// when sliding reverses in between.
template <int D>
class Impact {
 public:
  /// `limit`: sweeps in each phase, and impacts per pair. Exceeding it is counted in WorkCount::impactLimits, and the
  /// resolver stops whatever still approaches.
  void strike(ImpactLaw law, const VelocityInput<D>& in, const ContactGraph<D>& graph, int limit) {
    m_limit = limit, m_slow = in.restitutionThreshold;
    if (!prepare(in, graph)) return;
    auto& motion = in.bodies.motion;
    m_free.assign(motion.begin(), motion.end());
    each(motion, [&](Motion<D>& body, std::size_t i) { body = in.arrival[i]; });
    if (law == ImpactLaw::sequential) {
      handOn(in);
    } else {
      forIslands([&](std::span<const ManifoldRows<D>> which) { strikeAtOnce(in, which); });
    }
    for (const ManifoldRows<D>& m : m_rows.manifolds) {
      for (PointRows<D>& row : pointsOf(m)) row.target = velocity(in, m, row), row.impulse.fill(0);
    }
    // Impacts take no time: this step's forces are added again. A contact that was hit resists them, as under Newton's
    // law; otherwise each bounce would lose what gravity adds in a step.
    each(motion, [&](Motion<D>& body, std::size_t i) {
      body.v += m_free[i].v - in.arrival[i].v;
      body.w += m_free[i].w - in.arrival[i].w;
    });
    forIslands([&](std::span<const ManifoldRows<D>> which) { m_joints.blocks.clear(), settle(in, which, true); });
  }

 private:
  struct State {
    bool hit;
    Real least;  // impulse that restitution owes, N s
  };
  struct Island {
    bool bounces = false;
    Real fastest = 0;  // fastest impact, m/s
  };

  // Finds islands in which a contact is hit and a contact, perhaps another one, has restitution. Returns false if there
  // are none.
  bool prepare(const VelocityInput<D>& in, const ContactGraph<D>& graph) {
    const auto bounces = [&](int i) { return in.manifolds[i].restitution > 0; };
    if (std::none_of(in.order.begin(), in.order.end(), bounces)) return false;
    m_rows.prepare(in);
    m_states.assign(m_rows.points.size(), {});
    m_islandOf = graph.islands();
    m_islands.assign(m_islandOf.size(), {});
    for (const ManifoldRows<D>& m : m_rows.manifolds) {
      const int number = islandOf(m.a, m.b);
      if (number < 0) continue;
      Island& island = m_islands[number];
      island.bounces = island.bounces || bounces(m.manifold);
      const IndexedSpan<PointRows<D>> points = pointsOf(m);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Real arrival = velocity(in, m, points[k]) - points[k].kick;
        if (isHit(in, points[k], gap(in, m, k), arrival)) island.fastest = std::max(island.fastest, -arrival);
      }
    }
    std::erase_if(m_rows.manifolds, [&](const ManifoldRows<D>& m) { return !isStruck(islandOf(m.a, m.b)); });
    std::sort(m_rows.manifolds.begin(), m_rows.manifolds.end(), [&](const auto& m, const auto& n) {
      return std::pair(islandOf(m.a, m.b), m.first) < std::pair(islandOf(n.a, n.b), n.first);
    });
    if (m_rows.manifolds.empty()) return false;
    m_joints.clear();
    if (in.model.joints) m_joints.prepare(in.work, in.bodies, in.joints);
    m_blocks.assign(m_joints.blocks.begin(), m_joints.blocks.end());
    for (JointRow<D>& row : m_joints.rows) {
      if (row.law != RowLaw::rigid) row.lo = row.hi = 0;  // springs and motors do nothing in zero time
    }
    return true;
  }

  // -1 for bodies that no contact moves.
  int islandOf(int a, int b) const {
    const int of = a < 0 ? -1 : m_islandOf[a];
    return of >= 0 ? of : m_islandOf[b];
  }
  bool isStruck(int island) const { return island >= 0 && m_islands[island].bounces && m_islands[island].fastest > 0; }
  template <class Visit>
  void each(std::vector<Motion<D>>& motion, const Visit& visit) const {
    for (std::size_t i = 0; i < motion.size(); ++i) {
      if (isStruck(m_islandOf[i])) visit(motion[i], i);
    }
  }
  // Smaller changes (m/s) end the iteration.
  void lookAt(int island) { m_still = 64 * std::numeric_limits<Real>::epsilon() * m_islands[island].fastest; }
  // Visits the pairs of one island after the other; m_joints then holds the island's joints.
  template <class Visit>
  void forIslands(const Visit& visit) {
    const std::span<const ManifoldRows<D>> all = m_rows.manifolds;
    for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
      const int island = islandOf(all[first].a, all[first].b);
      while (last < all.size() && islandOf(all[last].a, all[last].b) == island) ++last;
      m_joints.blocks.clear();
      for (const JointBlock<D>& block : m_blocks) {
        if (islandOf(block.a, block.b) == island) m_joints.blocks.push_back(block);
      }
      lookAt(island);
      visit(all.subspan(first, last - first));
    }
  }
  std::span<PointRows<D>> pointsOf(const ManifoldRows<D>& m) { return m_rows.points.part(m.first, m.count); }
  State& stateOf(const ManifoldRows<D>& m, std::size_t k) { return m_states[static_cast<std::size_t>(m.first) + k]; }
  static Real gap(const VelocityInput<D>& in, const ManifoldRows<D>& m, std::size_t k) {
    return in.manifolds[m.manifold].points[k].separation;
  }
  static Real velocity(const VelocityInput<D>& in, const ManifoldRows<D>& m, const PointRows<D>& row) {
    const auto& motion = in.bodies.motion;
    return rowVelocity<D>(row.normal, m.n, motion[m.a], motion[m.b], in.model.rotation);
  }
  // Whether the contact is hit within this step at a velocity v without this step's forces.
  bool isHit(const VelocityInput<D>& in, const PointRows<D>& row, Real gap, Real v) const {
    return v < -m_slow && gap + (v + row.kick) * in.dt <= 0;
  }
  // The smallest normal velocity of a contact in both phases: a gap may close, but a bouncing contact stops at once.
  Real floorOf(const VelocityInput<D>& in, const ManifoldRows<D>& m, std::size_t k, Real v) {
    const Real open = gap(in, m, k);
    const bool bounces = in.manifolds[m.manifold].restitution > 0;
    if (!(open > 0) || (bounces && isHit(in, pointsOf(m)[k], open, v))) return 0;
    return -open / in.dt;
  }

  void strikeAtOnce(const VelocityInput<D>& in, std::span<const ManifoldRows<D>> which) {
    for (const ManifoldRows<D>& m : which) {
      const IndexedSpan<PointRows<D>> points = pointsOf(m);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Real v = velocity(in, m, points[k]);
        points[k].target = floorOf(in, m, k, v), points[k].impulse.fill(0);
        State& state = stateOf(m, k);
        state.hit = state.hit || isHit(in, points[k], gap(in, m, k), v), state.least = 0;
      }
    }
    settle(in, which, false);
    for (const ManifoldRows<D>& m : which) {
      const Real e = in.manifolds[m.manifold].restitution;
      const IndexedSpan<PointRows<D>> points = pointsOf(m);
      for (std::size_t k = 0; k < points.size(); ++k) {
        for (Real& impulse : points[k].impulse) impulse *= e;
        stateOf(m, k).least = points[k].impulse[0];
        apply(in, m, points[k]);
      }
    }
    for (const JointBlock<D>& block : m_joints.blocks) {
      for (JointRow<D>& row : m_joints.of(block)) row.impulse = 0;
    }
    settle(in, which, false);
  }

  // Solves the pair with the largest approach error, and repeats: a touching cradle then releases as many balls as hit
  // it. All points of a pair are hit at once; otherwise a box that falls flat would turn. Joints respond after the last
  // impact.
  void handOn(const VelocityInput<D>& in) {
    const std::vector<ManifoldRows<D>>& pairs = m_rows.manifolds;
    m_joints.blocks.clear();
    m_neighbours.build(
        in.bodies.pose.size(), pairs.size(), [&](std::size_t i) { return std::pair(pairs[i].a, pairs[i].b); },
        [&](int body) { return m_islandOf[body] >= 0; });
    m_blows.assign(pairs.size(), m_limit);
    m_errors.reset(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) m_errors.set(i, error(in, i));
    for (;;) {
      const std::size_t i = m_errors.top();
      if (!(m_errors.value(i) > 0)) return;
      lookAt(islandOf(pairs[i].a, pairs[i].b));
      strikeAtOnce(in, std::span(&pairs[i], 1));
      if (--m_blows[i] == 0) ++in.work[WorkCount::impactLimits];
      for (const int body : {pairs[i].a, pairs[i].b}) {
        for (const std::uint32_t other : m_neighbours.of(body)) m_errors.set(other, error(in, other));
      }
    }
  }
  // By how much (m/s) the points of a pair approach too fast; 0: not fast enough to bounce.
  Real error(const VelocityInput<D>& in, std::size_t pair) {
    const ManifoldRows<D>& m = m_rows.manifolds[pair];
    Real worst = 0;
    lookAt(islandOf(m.a, m.b));
    for (std::size_t k = 0; k < pointsOf(m).size() && m_blows[pair] > 0; ++k) {
      const Real v = velocity(in, m, pointsOf(m)[k]), wrong = floorOf(in, m, k, v) - v;
      if (wrong > std::max(m_slow, m_still) && pointsOf(m)[k].normal.mass > 0) worst = std::max(worst, wrong);
    }
    return worst;
  }

  void apply(const VelocityInput<D>& in, const ManifoldRows<D>& m, const PointRows<D>& row) const {
    Motion<D>& a = in.bodies.motion[m.a];
    Motion<D>& b = in.bodies.motion[m.b];
    const bool rotation = in.model.rotation;
    applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0], a, b, rotation);
    if (!(m.friction > 0)) return;
    for (int d = 0; d < D - 1; ++d) {
      applyRow<D>(row.tangent[d], m.t.col(d), m.invMassA, m.invMassB, row.impulse[d + 1], a, b, rotation);
    }
  }

  // Sweeps until nothing changes. `hold`: only contacts that were hit, without friction.
  void settle(const VelocityInput<D>& in, std::span<const ManifoldRows<D>> which, bool hold) {
    for (int i = 0; i < m_limit; ++i) {
      m_joints.sweep(in.bodies.motion, in.dt, {});
      m_joints.count(in.work);
      Real change = 0;
      for (const ManifoldRows<D>& m : which) change = std::max(change, sweep(in, m, hold));
      if (!(change > m_still)) return;
    }
    ++in.work[WorkCount::impactLimits];
  }
  // Returns the largest change of a velocity at a contact, m/s.
  Real sweep(const VelocityInput<D>& in, const ManifoldRows<D>& m, bool hold) {
    Motion<D>& a = in.bodies.motion[m.a];
    Motion<D>& b = in.bodies.motion[m.b];
    const IndexedSpan<PointRows<D>> points = pointsOf(m);
    const bool rotation = in.model.rotation;
    Real change = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      PointRows<D>& row = points[k];
      const State& state = stateOf(m, k);
      if (!(row.normal.mass > 0) || (hold && !state.hit)) continue;
      const IndexedArray<Real, D> old = row.impulse;
      const Real wanted = old[0] + row.normal.mass * (row.target - rowVelocity<D>(row.normal, m.n, a, b, rotation));
      row.impulse[0] = std::max(wanted, hold ? Real(0) : state.least);
      applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old[0], a, b, rotation);
      change = std::max(change, std::abs(row.impulse[0] - old[0]) / row.normal.mass);
      countRows<D>(in.work, 1);
      if (hold || !(m.friction > 0)) continue;
      solveFrictionAt(m, row, a, b, rotation);
      for (std::size_t d = 1; d < D; ++d) {
        const Real mass = row.tangent[d - 1].mass;
        if (mass > 0) change = std::max(change, std::abs(row.impulse[d] - old[d]) / mass);
      }
      countRows<D>(in.work, D - 1);
    }
    return change;
  }

  int m_limit = 0;
  Real m_slow = 0, m_still = 0;  // m/s
  ContactRows<D> m_rows;
  JointSystem<D> m_joints;
  std::vector<JointBlock<D>> m_blocks;  // of all islands
  IndexedVector<State> m_states;        // by point
  std::vector<Motion<D>> m_free;
  IndexedSpan<const std::int32_t> m_islandOf;  // by body
  IndexedVector<Island> m_islands;
  IndexedVector<int> m_blows;  // remaining impacts of a pair
  Extreme m_errors{ExtremeSearch::tree};
  ContactsOfBodies m_neighbours;
};

}}}  // namespace lpc::LPC_PRECISION::solver
