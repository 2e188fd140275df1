// SPDX-License-Identifier: Zlib
// Joints of any kind as a sequential resolver sees them. The equality rows of a joint are solved as one block, since
// they are strongly coupled. Its other rows are solved one by one before them: motors and springs first, then limits,
// so that the hardest constraints are solved last.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "algorithms/solver/rows/block_inverse.h"
#include "algorithms/solver/rows/body_displacements.h"
#include "framework/math/indexed.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Error feedback of a row: an update demands v = -rate x error, applies `massScale` of the needed impulse, and removes
/// `impulseScale` of the accumulated one.
struct Feedback {
  Real rate = 0;  // 1/s
  Real massScale = 1, impulseScale = 0;
};

template <int D>
struct JointRow : ConstraintRow<D> {
  Real mass;     // of a box row: impulse per change of its velocity, kg or kg m^2
  Real impulse;  // accumulated, on B
  std::int32_t number;
};

template <int D>
struct JointBlock {
  std::int32_t a, b, joint;  // a -1: the world
  Real invMassA, invMassB;
  Inertia<D> invIA, invIB;
  std::int32_t first, equalities, count;  // of its rows: the equality rows, then the others
  BlockInverse<D> mass;                   // of the equality rows
  bool warm;                              // whether it may be warm started
};

/// All joints of a solve, between movable bodies. Arrays keep their capacity from step to step.
template <int D>
class JointSystem {
 public:
  IndexedVector<JointBlock<D>> blocks;
  IndexedVector<JointRow<D>> rows;
  std::vector<std::int32_t> rowless;  // joints without present rows

  std::span<JointRow<D>> of(const JointBlock<D>& block) { return rows.part(block.first, block.count); }
  std::span<const JointRow<D>> of(const JointBlock<D>& block) const { return rows.part(block.first, block.count); }

  void clear() { blocks.clear(), rows.clear(), rowless.clear(), m_world = {}, m_coupled = 0; }
  /// `compliance` is added to the response of each rigid row per impulse, 1/kg or 1/(kg m^2). `displacements`, unless
  /// empty, replaces the positions of bodies for joints between two bodies.
  void prepare(WorkDone& work, const Bodies<D>& bodies, IndexedSpan<const JointRecord<D>> joints, Real compliance = 0,
               const BodyDisplacements<D>& displacements = {}) {
    clear();
    m_compliance = compliance, m_displacements = displacements;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (joints[j].active()) add(bodies, joints[j], static_cast<std::int32_t>(j));
    }
    countMadeRows<D>(work, rows.size());
    for (const JointBlock<D>& block : blocks) {  // the response of the equality rows, then its inverse
      const auto n = static_cast<std::uint64_t>(block.equalities);
      work[WorkCount::multiplyAdds] += n * (n + 1) / 2 * (D + D * (D - 1)) + n * n * n;
      m_coupled += n * n - n;
    }
  }
  /// Counts sweeps over all rows. Equality rows are multiplied by a matrix; other rows have one mass.
  void count(WorkDone& work, std::uint64_t sweeps = 1) const {
    countRows<D>(work, sweeps * rows.size());
    work[WorkCount::multiplyAdds] += sweeps * m_coupled;
  }

  /// `start(joint, row number)` is the initial impulse. applyAccumulated() applies it.
  template <class Start>
  void warmStart(Real h, const Start& start) {
    for (JointBlock<D>& block : blocks) {
      if (!block.warm) continue;
      for (JointRow<D>& row : of(block)) {
        const Real impulse = start(block.joint, row.number);
        row.impulse = row.block == RowBlock::equality ? impulse : std::clamp(impulse, row.lo * h, row.hi * h);
      }
    }
  }
  void applyAccumulated(IndexedVector<Motion<D>>& motion) {
    for (JointBlock<D>& block : blocks) {
      IndexedArray<Real, kJointRows> impulse;
      const IndexedSpan<const JointRow<D>> all = of(block);
      for (std::size_t i = 0; i < all.size(); ++i) impulse[i] = all[i].impulse;
      apply(block, all, impulse.data(), at(motion, block.a), at(motion, block.b));
    }
  }

  /// Updates every row once, over h seconds. A limit that is not reached may be reached within h, whatever `rigid`
  /// says; springs and motors follow their own laws. count() counts this work.
  void sweep(IndexedVector<Motion<D>>& motion, Real h, const Feedback& rigid) {
    for (JointBlock<D>& block : blocks) sweepBlock(block, at(motion, block.a), at(motion, block.b), h, rigid);
  }
  /// The same for one joint, between bodies with these velocities.
  void sweepBlock(JointBlock<D>& block, Motion<D>& a, Motion<D>& b, Real h, const Feedback& rigid) {
    const std::span<JointRow<D>> boxes = of(block).subspan(static_cast<std::size_t>(block.equalities));
    for (JointRow<D>& row : boxes) {  // motors and springs first: a limit must hold against them
      if (row.law != RowLaw::rigid) sweepBox(block, row, h, rigid, a, b);
    }
    for (JointRow<D>& row : boxes) {
      if (row.law == RowLaw::rigid) sweepBox(block, row, h, rigid, a, b);
    }
    if (block.equalities > 0) sweepEqualities(block, rigid, a, b);
  }
  /// The same in displacements instead of velocities: removes these shares of the errors of equalities and limits.
  /// Springs and motors have no error.
  void sweepErrors(IndexedVector<Motion<D>>& moves, Real share, Real stopShare) {
    for (JointBlock<D>& block : blocks) {
      Motion<D>&a = at(moves, block.a), &b = at(moves, block.b);
      for (JointRow<D>& row : of(block).subspan(static_cast<std::size_t>(block.equalities))) {
        if (row.law == RowLaw::rigid) sweepBox(block, row, 1, {stopShare, 1, 0}, a, b);
      }
      if (block.equalities > 0) sweepEqualities(block, {share, 1, 0}, a, b);
    }
  }

  /// Writes the accumulated impulses. A joint between sleeping bodies keeps its old ones; an absent row has none.
  void store(IndexedSpan<JointRecord<D>> joints) const {
    for (const std::int32_t j : rowless) joints[j].impulse.fill(0);
    for (const JointBlock<D>& block : blocks) {
      auto& impulse = joints[block.joint].impulse;
      impulse.fill(0);
      for (const JointRow<D>& row : of(block)) impulse[row.number] = row.impulse;
    }
  }

 private:
  Motion<D>& at(IndexedVector<Motion<D>>& motion, std::int32_t body) { return body < 0 ? m_world : motion[body]; }

  static Real response(const JointBlock<D>& block, const JointRow<D>& r, const JointRow<D>& s) {
    return (block.invMassA + block.invMassB) * r.d.dot(s.d) + r.armA.dot(block.invIA * s.armA) +
           r.armB.dot(block.invIB * s.armB);
  }

  void add(const Bodies<D>& bodies, const JointRecord<D>& joint, std::int32_t number) {
    JointBlock<D> block;
    block.a = joint.bodyA, block.b = joint.bodyB, block.joint = number;
    const auto a = joint.bodyA, b = joint.bodyB;
    block.invMassA = joint.bodyA < 0 ? Real(0) : bodies.invMass[a], block.invMassB = bodies.invMass[b];
    block.invIA = joint.bodyA < 0 ? Inertia<D>(Inertia<D>::Zero()) : bodies.invInertia[a];
    block.invIB = bodies.invInertia[b];
    block.warm = block.invMassA + block.invMassB > 0;
    block.first = static_cast<std::int32_t>(rows.size()), block.equalities = 0;
    if (m_displacements.empty() || joint.bodyA < 0) {
      jointRows(joint, bodies, m_rows);
    } else {
      const auto [X_WA, X_WB] = m_displacements.pair(bodies, a, b);
      m_rows.count = 0;
      joint.kind->rows(joint, X_WA, X_WB, m_rows);
    }
    Real trace = 0;
    for (int i = 0; i < m_rows.count; ++i) {
      const ConstraintRow<D>& from = m_rows.row[i];
      if (from.absent()) continue;
      rows.push_back({from, 0, 0, i});
      const Real k = response(block, rows.back(), rows.back());
      rows.back().mass = k > 0 ? 1 / (from.law == RowLaw::rigid ? k + m_compliance : k) : Real(0);
      trace += k;
      LPC_ASSERT(from.block == RowBlock::box ||
                 block.equalities + block.first + 1 == static_cast<std::int32_t>(rows.size()));
      block.equalities += from.block == RowBlock::equality;
    }
    LPC_ASSERT(block.equalities <= BlockInverse<D>::kRows);
    block.count = static_cast<std::int32_t>(rows.size()) - block.first;
    if (block.count == 0) rowless.push_back(number);
    if (!(trace > 0)) {  // between immovable bodies
      rows.resize(static_cast<std::size_t>(block.first));
      return;
    }
    const IndexedSpan<const JointRow<D>> all = of(block);
    block.mass.set(
        block.equalities,
        [&](int i, int j) {
          const Real k = response(block, all[i], all[j]);
          return i == j ? k + m_compliance : k;
        },
        block.warm);
    blocks.push_back(block);
  }

  void sweepBox(const JointBlock<D>& block, JointRow<D>& row, Real h, const Feedback& rigid, Motion<D>& a,
                Motion<D>& b) {
    Real wanted = 0, massScale = 1, impulseScale = 0;
    switch (row.law) {
      case RowLaw::rigid:
        if (row.open()) {
          wanted = -row.error / h;
        } else {
          wanted = -rigid.rate * row.error, massScale = rigid.massScale, impulseScale = rigid.impulseScale;
        }
        break;
      case RowLaw::spring: {
        // Implicit, so stable at any stiffness: k and c act on the row's future position and velocity. Catto 2011.
        const Real c = row.damping + h * row.stiffness, share = h * c / (h * c + row.mass);
        if (c > 0) wanted = -row.error * row.stiffness / c;
        massScale = share, impulseScale = 1 - share;
        break;
      }
      case RowLaw::motor:
        wanted = row.speed;
        break;
    }
    const Real v = rowSpeed<D>(row, a.v, a.w, b.v, b.w);
    const Real old = row.impulse;
    row.impulse = std::clamp(old + massScale * row.mass * (wanted - v) - impulseScale * old, row.lo * h, row.hi * h);
    const Real impulse = row.impulse - old;
    apply(block, std::span<const JointRow<D>>(&row, 1), &impulse, a, b);
  }

  void sweepEqualities(const JointBlock<D>& block, const Feedback& rigid, Motion<D>& a, Motion<D>& b) {
    const auto n = static_cast<std::size_t>(block.equalities);
    const IndexedSpan<JointRow<D>> all = of(block).first(n);
    IndexedArray<Real, BlockInverse<D>::kRows> v, impulse;
    for (std::size_t i = 0; i < n; ++i) {
      v[i] = rowSpeed<D>(all[i], a.v, a.w, b.v, b.w) + rigid.rate * all[i].error;
    }
    block.mass.multiply(block.equalities, -rigid.massScale, v.data(), impulse.data());
    for (std::size_t i = 0; i < n; ++i) {
      impulse[i] -= rigid.impulseScale * all[i].impulse;
      all[i].impulse += impulse[i];
    }
    apply(block, std::span<const JointRow<D>>(all), impulse.data(), a, b);
  }

  static void apply(const JointBlock<D>& block, IndexedSpan<const JointRow<D>> rows, const Real* impulse, Motion<D>& a,
                    Motion<D>& b) {
    Vec<D> linear = Vec<D>::Zero();
    Ang<D> angularA = Ang<D>::Zero(), angularB = Ang<D>::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      linear += impulse[i] * rows[i].d;
      angularA += impulse[i] * rows[i].armA;
      angularB += impulse[i] * rows[i].armB;
    }
    a.v -= block.invMassA * linear;
    b.v += block.invMassB * linear;
    a.w -= block.invIA * angularA;
    b.w += block.invIB * angularB;
  }

  JointRows<D> m_rows;
  Real m_compliance = 0;
  BodyDisplacements<D> m_displacements;
  std::uint64_t m_coupled = 0;  // multiply-adds of a sweep beyond those of its rows
  Motion<D> m_world;  // at rest, since its inverse mass is 0; an infinite impulse changes it, for one solve only
};

}}}  // namespace lpc::LPC_PRECISION::solver
