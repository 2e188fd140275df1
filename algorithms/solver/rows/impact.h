// SPDX-License-Identifier: Zlib
// Laws of restitution beside Newton's, which is a target velocity of each contact (contact_rows.h) and needs none of
// this: Poisson's for all contacts at once, and blows that are handed on from pair to pair.
#pragma once

#include <limits>

#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/extreme_first.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

enum class ImpactLaw { newton, poisson, sequential };

/// Before a velocity resolver, which then is left with nothing that bounces. It acts on the velocities with which
/// bodies arrive, since weight is no blow, and on islands in which something is hit, each by itself.
///
/// One impact has two phases (Glocker and Pfeiffer 1995). Compression: inelastic, with friction. Restitution: each
/// contact gives back e times its impulse, and nothing may approach; friction starts anew, from the velocities of then
/// and within the cone of the new normal impulses. For given normal impulses friction takes out what energy it can, so
/// that the second phase gives back at most e^2 of what the first took, whereas Newton's law can add some when sliding
/// turns round in between.
template <int D>
class Impact {
 public:
  /// `limit`: of sweeps in each phase, and of blows per pair. What ends there is counted in WorkCount::impactLimits,
  /// and what still approaches then is left to the resolver, which stops it.
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
    // Impacts take no time: this step's forces are added again. At a contact that was hit they are held, as they are
    // by Newton's law, or each bounce would lose what gravity adds in a step.
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
    Real fastest = 0;  // m/s, that something is hit with
  };

  // Islands in which a contact is hit and one, perhaps another, has restitution; false: there is none.
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
    if (in.features.joints) m_joints.prepare(in.work, in.bodies, in.joints);
    m_blocks.assign(m_joints.blocks.begin(), m_joints.blocks.end());
    for (JointRow<D>& row : m_joints.rows) {
      if (row.law != RowLaw::rigid) row.lo = row.hi = 0;  // springs and motors do nothing in no time
    }
    return true;
  }

  // -1: of what no contact moves.
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
  // What changes less has come to its end, m/s.
  void lookAt(int island) { m_still = 64 * std::numeric_limits<Real>::epsilon() * m_islands[island].fastest; }
  // The pairs of one island after the other, whose joints then are those of m_joints.
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
    return rowVelocity<D>(row.normal, m.n, motion[m.a], motion[m.b], in.features.rotation);
  }
  // By a velocity v without this step's forces, within this step.
  bool isHit(const VelocityInput<D>& in, const PointRows<D>& row, Real gap, Real v) const {
    return v < -m_slow && gap + (v + row.kick) * in.dt <= 0;
  }
  // The least normal velocity of a contact in both phases: a gap may be closed, but what bounces stops where it is.
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

  // The pair whose approach is most wrong, then look again: a touching cradle lets out as many balls as come in. A pair
  // is hit at all of its points at once, or a box that falls flat would turn. Joints answer after the last blow.
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
  // How much too fast the points of a pair approach, m/s; 0: not so that they bounce.
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
    const bool rotation = in.features.rotation;
    applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0], a, b, rotation);
    if (!(m.friction > 0)) return;
    for (int d = 0; d < D - 1; ++d) {
      applyRow<D>(row.tangent[d], m.t.col(d), m.invMassA, m.invMassB, row.impulse[d + 1], a, b, rotation);
    }
  }

  // Sweeps until nothing changes. `hold`: only contacts that were hit, and no friction.
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
    const bool rotation = in.features.rotation;
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
      rubAt(m, row, a, b, rotation);
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
  IndexedVector<int> m_blows;  // that a pair has left
  Extreme m_errors{ExtremeSearch::tree};
  ContactsOfBodies m_neighbours;
};

}}}  // namespace lpc::LPC_PRECISION::solver
