// SPDX-License-Identifier: Zlib
// Contacts as a resolver sees them: one row per direction of impulse, prepared once per step in flat arrays.
//
// A positive impulse pushes B along the direction and A against it. Both act at one shared point, midway between the
// two anchors, so that angular momentum is kept to rounding even while shapes overlap.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Response K: (relative velocity at the two arms) = K (impulse). Symmetric; positive definite unless both bodies have
/// infinite mass.
template <int D>
Mat<D> pointResponse(const Vec<D>& rA, const Vec<D>& rB, Real invMassSum, const Inertia<D>& invIA,
                     const Inertia<D>& invIB) {
  Mat<D> k;
  for (int i = 0; i < D; ++i) {
    const Vec<D> d = Vec<D>::Unit(i);
    k.col(i) = invMassSum * d + cross((invIA * cross(rA, d)).eval(), rA) + cross((invIB * cross(rB, d)).eval(), rB);
  }
  return k;
}

/// Scale of the last step's impulses for warm starting. An impulse is a force times dt; if dt changes, the force is the
/// better guess. `in`: a VelocityInput or a StepInput.
template <class Input>
Real lastImpulseScale(const Input& in) {
  return in.lastDt > 0 ? in.dt / in.lastDt : Real(1);
}

/// Arms (m, world axes) after bodies have moved since the detection: each to its own body's anchor, and from there half
/// the separation along the normal. Where bodies slide past each other, the midpoint of the anchors lags behind both by
/// half the way, and a push there would turn them; so a depth would heal worse at speed. The two impulses form a torque
/// where the anchors have slid apart, so these arms are for displacements, not for velocities.
template <int D>
ContactArms<D> ownArms(const ContactPoint<D>& c, const Vec<D>& n, const Pose<D>& X_WA, const Pose<D>& X_WB) {
  ContactArms<D> arms(c, n, X_WA, X_WB);
  const Vec<D> half = (arms.separation / 2) * n;
  arms.rA = X_WA.q * c.localA + half, arms.rB = X_WB.q * c.localB - half;
  return arms;
}

/// Arms (m, world axes) after bodies have moved since the detection, to one point shared by both, so that an impulse
/// keeps angular momentum. Where the anchors have slid apart, the point is nearer to that of the body that turns more
/// easily; beside a body that does not turn it is the other's own.
template <int D>
ContactArms<D> sharedArms(const ContactPoint<D>& c, const Vec<D>& n, const Pose<D>& X_WA, const Pose<D>& X_WB,
                          const Inertia<D>& invIA, const Inertia<D>& invIB) {
  ContactArms<D> arms = ownArms(c, n, X_WA, X_WB);
  const Vec<D> gap = (X_WB.p - X_WA.p) + arms.rB - arms.rA;  // along the tangents
  const Real easeB = invIB.trace(), sum = invIA.trace() + easeB, share = sum > 0 ? easeB / sum : Real(0.5);
  arms.rA += share * gap, arms.rB -= (1 - share) * gap;
  return arms;
}

/// One direction d of impulse between two bodies.
template <int D>
struct Row {
  Ang<D> armA, armB;    // r x d: relative speed per angular velocity, m
  Ang<D> turnA, turnB;  // I^-1 (r x d): angular velocity per impulse, rad/s per N s
  Real mass;            // impulse per change of relative speed, kg; 0 if neither body can move
};

template <int D>
Row<D> makeRow(const Vec<D>& d, const Vec<D>& rA, const Vec<D>& rB, Real invMassSum, const Inertia<D>& invIA,
               const Inertia<D>& invIB) {
  Row<D> row;
  row.armA = cross(rA, d), row.armB = cross(rB, d);
  row.turnA = invIA * row.armA, row.turnB = invIB * row.armB;
  const Real k = invMassSum + row.armA.dot(row.turnA) + row.armB.dot(row.turnB);
  row.mass = k > 0 ? 1 / k : Real(0);
  return row;
}

/// Velocity of B relative to A along d, m/s.
template <int D>
Real rowVelocity(const Row<D>& row, const Vec<D>& d, const Motion<D>& a, const Motion<D>& b, bool rotation) {
  Real v = d.dot(b.v - a.v);
  if (rotation) v += row.armB.dot(b.w) - row.armA.dot(a.w);
  return v;
}

template <int D>
void applyRow(const Row<D>& row, const Vec<D>& d, Real invMassA, Real invMassB, Real impulse, Motion<D>& a,
              Motion<D>& b, bool rotation) {
  a.v -= (impulse * invMassA) * d;
  b.v += (impulse * invMassB) * d;
  if (!rotation) return;
  a.w -= impulse * row.turnA;
  b.w += impulse * row.turnB;
}

/// The smallest normal velocity (m/s) that a contact may have after the step.
///
/// In every resolver a gap may close but not more, -separation / dt; otherwise shapes within the contact margin would
/// stop in the air. A contact that the present velocity reaches within this step bounces instead, with its velocity of
/// arrival, if that is fast enough. With e = 1 the next step then mirrors the step that led here, and a ball returns to
/// its height for ever; the velocity after this step's gravity would raise it.
template <int D>
Real contactTarget(Real separation, Real velocity, Real arrival, Real restitution, Real threshold, Real dt,
                   const PositionResolver<D>& position) {
  Real target = separation > 0 ? -separation / dt : position.bias(separation, dt);
  const bool hit = arrival < -threshold && separation + velocity * dt <= 0;
  if (hit && restitution > 0) target = std::max(target, -restitution * arrival);
  return target;
}

/// The change of normal velocity (m/s) that a contact point demands at the present velocities; negative: none.
template <int D>
Real velocityError(const VelocityInput<D>& in, const Manifold<D>& m, const ContactPoint<D>& c) {
  const auto a = m.bodyA, b = m.bodyB;
  const ContactArms<D> arms(c, m.normal, in.bodies.pose[a], in.bodies.pose[b]);
  const auto along = [&](const Motion<D>& x, const Motion<D>& y) {
    return (y.v + cross(y.w, arms.rB) - x.v - cross(x.w, arms.rA)).dot(m.normal);
  };
  const Real v = along(in.bodies.motion[a], in.bodies.motion[b]);
  const Real arrival = in.arrival.empty() ? v : along(in.arrival[a], in.arrival[b]);
  const Real e = in.model.restitution ? m.restitution : Real(0);
  return contactTarget<D>(c.separation, v, arrival, e, in.restitutionThreshold, in.dt, in.position) - v;
}

template <int D>
struct PointRows {
  Row<D> normal;
  IndexedArray<Row<D>, D - 1> tangent;
  RealMatrix<D - 1, D - 1> stick;  // inverse response of the tangents: impulse that stops sliding, kg
  Real slide;                      // 1 / the largest eigenvalue of that response, kg
  Real target;                     // smallest normal velocity, m/s
  Real kick;                       // part of the normal velocity that this step's forces have just made, m/s
  IndexedArray<Real, D> impulse;   // accumulated in this step: along n, then along the tangents
};

template <int D>
struct ManifoldRows {
  int a, b;          // bodies
  int first, count;  // of the manifold's points
  int manifold;
  Real invMassA, invMassB;
  Real friction;
  Vec<D> n;
  RealMatrix<D, D - 1> t;

  std::uint64_t rows() const { return static_cast<std::uint64_t>(count) * (friction > 0 ? D : 1); }
};

inline void prepareFriction(PointRows<2>& row) { row.stick[0] = row.slide = row.tangent[0].mass; }
inline void prepareFriction(PointRows<3>& row) {
  const Row<3>&s = row.tangent[0], &t = row.tangent[1];
  row.stick.setZero(), row.slide = 0;
  if (!(s.mass > 0 && t.mass > 0)) return;
  const Real ss = 1 / s.mass, tt = 1 / t.mass, st = s.armA.dot(t.turnA) + s.armB.dot(t.turnB);
  const Real mean = (ss + tt) / 2, half = (ss - tt) / 2;
  row.slide = 1 / (mean + std::sqrt(half * half + st * st));
  const Real determinant = ss * tt - st * st;
  // Pinned bodies: the point may have only one direction in which it can move.
  if (determinant > mean * mean * Real(1e-6)) {
    row.stick << tt, -st, -st, ss;
    row.stick /= determinant;
  } else {
    row.stick.diagonal().setConstant(row.slide);
  }
}

/// All contacts of a velocity solve. Arrays keep their capacity from step to step.
template <int D>
struct ContactRows {
  IndexedVector<ManifoldRows<D>> manifolds;
  IndexedVector<PointRows<D>> points;

  /// Call before any impulse is applied: restitution uses the present velocities. `moved`: bodies have moved since the
  /// detection, so that anchors may have slid apart.
  void prepare(const VelocityInput<D>& in, bool moved = false) {
    std::size_t count = 0;
    for (int i : in.order) count += static_cast<std::size_t>(in.manifolds[i].count);
    manifolds.resize(in.order.size());
    points.resize(count);
    const Bodies<D>& bodies = in.bodies;
    const bool rotation = in.model.rotation;
    std::size_t p = 0;
    for (std::size_t k = 0; k < in.order.size(); ++k) {
      const Manifold<D>& m = in.manifolds[in.order[k]];
      ManifoldRows<D>& rows = manifolds[k];
      const auto a = m.bodyA, b = m.bodyB;
      rows.a = m.bodyA, rows.b = m.bodyB, rows.manifold = in.order[k];
      rows.first = static_cast<int>(p), rows.count = m.count;
      rows.invMassA = bodies.invMass[a], rows.invMassB = bodies.invMass[b];
      rows.friction = in.model.friction ? m.friction : Real(0);
      rows.n = m.normal, rows.t = tangents(m.normal);
      const Real invMassSum = rows.invMassA + rows.invMassB;
      for (int i = 0; i < m.count; ++i, ++p) {
        const ContactPoint<D>& c = m.points[i];
        PointRows<D>& row = points[p];
        const Pose<D>&X_WA = bodies.pose[a], &X_WB = bodies.pose[b];
        const ContactArms<D> arms =
            moved ? sharedArms(c, m.normal, X_WA, X_WB, bodies.invInertia[a], bodies.invInertia[b])
                  : ContactArms<D>(c, m.normal, X_WA, X_WB);
        const auto make = [&](const Vec<D>& d) {
          return makeRow<D>(d, arms.rA, arms.rB, invMassSum, bodies.invInertia[a], bodies.invInertia[b]);
        };
        row.normal = make(m.normal);
        if (rows.friction > 0) {
          for (int d = 0; d < D - 1; ++d) row.tangent[d] = make(rows.t.col(d));
          prepareFriction(row);
        }
        const Real v = rowVelocity(row.normal, m.normal, bodies.motion[a], bodies.motion[b], rotation);
        const Real arrival =
            in.arrival.empty() ? v : rowVelocity(row.normal, m.normal, in.arrival[a], in.arrival[b], rotation);
        row.kick = v - arrival;
        row.target = contactTarget<D>(c.separation, v, arrival, in.model.restitution ? m.restitution : Real(0),
                                      in.restitutionThreshold, in.dt, in.position);
        row.impulse.fill(0);
      }
      countMadeRows<D>(in.work, rows.rows());
    }
  }

  /// Writes the impulses of this step into the manifolds as their loads.
  void store(IndexedSpan<Manifold<D>> out) const {
    for (const ManifoldRows<D>& rows : manifolds) {
      Manifold<D>& m = out[rows.manifold];
      for (int i = 0; i < rows.count; ++i) {
        ContactPoint<D>& c = m.points[i];
        c.impulse = points[rows.first + i].impulse;
        c.load = c.impulse[0];
      }
    }
  }
};

/// Returns the tangential impulse nearest to `impulse` that Coulomb's law allows, |impulse| <= limit: an interval in
/// 2D, a disc in 3D, which unlike a pyramid has no preferred direction.
template <int D>
RealMatrix<D - 1, 1> clampFriction(const RealMatrix<D - 1, 1>& impulse, Real limit) {
  if constexpr (D == 2) {
    return RealMatrix<1, 1>(std::clamp(impulse[0], -limit, limit));
  } else {
    const Real squared = impulse.squaredNorm();
    if (squared <= limit * limit) return impulse;
    return impulse * (limit / std::sqrt(squared));
  }
}

/// Updates a point's accumulated friction once, for its present normal impulse.
///
/// First tries the impulse that stops sliding. If Coulomb's law does not allow it, takes a step down the gradient of
/// the kinetic energy and projects onto the disc: no energy is added, friction ends against the sliding velocity, and
/// the result depends on the contact alone, not on the choice of tangents. (Clamping two separately solved tangents
/// does neither.)
template <int D>
void solveFrictionAt(const ManifoldRows<D>& m, PointRows<D>& row, Motion<D>& a, Motion<D>& b, bool rotation) {
  RealMatrix<D - 1, 1> v, old;
  for (int d = 0; d < D - 1; ++d) {
    v[d] = rowVelocity<D>(row.tangent[d], m.t.col(d), a, b, rotation);
    old[d] = row.impulse[d + 1];
  }
  const Real limit = m.friction * row.impulse[0];
  RealMatrix<D - 1, 1> impulse = old - row.stick * v;
  if (impulse.squaredNorm() > limit * limit) {
    const RealMatrix<D - 1, 1> down = old - row.slide * v;
    impulse = clampFriction<D>(down, limit);
  }
  for (int d = 0; d < D - 1; ++d) {
    applyRow<D>(row.tangent[d], m.t.col(d), m.invMassA, m.invMassB, impulse[d] - old[d], a, b, rotation);
    row.impulse[d + 1] = impulse[d];
  }
}

/// Friction that an additional normal impulse `normal` allows besides the accumulated friction.
template <int D>
void solveFrictionBeside(const ManifoldRows<D>& m, PointRows<D>& row, Real normal, Motion<D>& a, Motion<D>& b,
                         bool rotation) {
  PointRows<D> alone = row;
  alone.impulse = {normal};
  solveFrictionAt(m, alone, a, b, rotation);
  for (std::size_t d = 1; d < D; ++d) row.impulse[d] += alone.impulse[d];
}

}}}  // namespace lpc::LPC_PRECISION::solver
