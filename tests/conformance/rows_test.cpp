// SPDX-License-Identifier: Zlib
// The sequential resolvers have specialised kernels for contacts. This file writes the same methods over rows, as
// joints have them, sharing nothing but the rows. The impulses must be equal up to rounding.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "framework/problem/contact_as_rows.h"
#include "tests/check_property.h"
#include "tests/conformance/impact_scene.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace rows_test {

constexpr Real kRounding = sizeof(Real) == 8 ? Real(1e-11) : Real(5e-4);  // of impulses, relative to the largest

template <int D>
struct NoCorrection final : PositionResolver<D> {
  Real bias(Real separation, Real dt) const override { return -separation / (8 * dt); }
};

/// One contact's rows and their accumulated impulses.
template <int D>
struct RowContact {
  int a, b;
  std::array<ConstraintRow<D>, D> row;  // normal, tangents
  std::array<Real, D> impulse{};
};

/// Velocities, and the effect of impulses on them.
template <int D>
struct RowProblem {
  Bodies<D> bodies;
  std::vector<RowContact<D>> contacts;
  std::vector<std::size_t> firstOf;  // contact of each manifold, and one past the last

  explicit RowProblem(const VelocityInput<D>& in) : bodies(in.bodies) {
    for (const int i : in.order) {
      const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(i)];
      std::vector<ConstraintRow<D>> rows;
      contactRows(in, m, rows);
      firstOf.push_back(contacts.size());
      for (std::size_t k = 0; k < rows.size(); k += D) {
        RowContact<D> c{m.bodyA, m.bodyB, {}, {}};
        std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(k), D, c.row.begin());
        contacts.push_back(c);
      }
    }
    firstOf.push_back(contacts.size());
  }

  Motion<D>& motion(int body) { return bodies.motion[static_cast<std::size_t>(body)]; }
  Real speed(const RowContact<D>& c, int i) {
    const Motion<D>&a = motion(c.a), &b = motion(c.b);
    return rowSpeed(c.row[static_cast<std::size_t>(i)], a.v, a.w, b.v, b.w);
  }
  /// Velocity of row i per impulse along row j.
  Real response(const RowContact<D>& c, int i, int j) const {
    const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
    const auto &r = c.row[static_cast<std::size_t>(i)], &s = c.row[static_cast<std::size_t>(j)];
    return (bodies.invMass[a] + bodies.invMass[b]) * r.d.dot(s.d) + r.armA.dot(bodies.invInertia[a] * s.armA) +
           r.armB.dot(bodies.invInertia[b] * s.armB);
  }
  void apply(const RowContact<D>& c, int i, Real impulse) {
    const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
    const auto& r = c.row[static_cast<std::size_t>(i)];
    motion(c.a).v -= bodies.invMass[a] * impulse * r.d, motion(c.b).v += bodies.invMass[b] * impulse * r.d;
    motion(c.a).w -= bodies.invInertia[a] * Ang<D>(impulse * r.armA);
    motion(c.b).w += bodies.invInertia[b] * Ang<D>(impulse * r.armB);
  }
  /// The least velocity along the normal, m/s.
  static Real target(const ConstraintRow<D>& normal, Real dt) {
    const NoCorrection<D> position;
    const Real least = normal.open() ? -normal.error / dt : position.bias(normal.error, dt);
    return std::max(least, normal.bounce);
  }
  /// Friction: stops sliding, or as far as the cone allows. First the exact solution; if it is outside, a gradient step
  /// and a projection onto the cone.
  void solveFriction(RowContact<D>& c) {
    if (c.row[1].absent()) return;
    RealMatrix<D - 1, D - 1> k;
    RealMatrix<D - 1, 1> v, old;
    for (int i = 0; i < D - 1; ++i) {
      v[i] = speed(c, i + 1), old[i] = c.impulse[static_cast<std::size_t>(i) + 1];
      for (int j = 0; j < D - 1; ++j) k(i, j) = response(c, i + 1, j + 1);
    }
    const Real limit = c.row[1].friction * c.impulse[0];
    RealMatrix<D - 1, 1> now = old - k.inverse() * v;
    if (now.norm() > limit) {
      const Real last = k(D - 2, D - 2), half = (k(0, 0) - last) / 2, aside = D == 3 ? k(0, D - 2) : Real(0);
      now = old - v / (last + half + std::sqrt(half * half + aside * aside));  // the largest eigenvalue
      if (now.norm() > limit) now *= limit / now.norm();
    }
    for (int i = 0; i < D - 1; ++i) {
      apply(c, i + 1, now[i] - old[i]);
      c.impulse[static_cast<std::size_t>(i) + 1] = now[i];
    }
  }
};

// Catto 2006: all normals of a manifold, then its friction.
template <int D>
void accumulated(RowProblem<D>& p, const VelocityInput<D>& in, int iterations) {
  for (int n = 0; n < iterations; ++n) {
    for (std::size_t m = 0; m + 1 < p.firstOf.size(); ++m) {
      for (std::size_t k = p.firstOf[m]; k < p.firstOf[m + 1]; ++k) {
        RowContact<D>& c = p.contacts[k];
        const Real old = c.impulse[0];
        c.impulse[0] = std::max(Real(0), old + (p.target(c.row[0], in.dt) - p.speed(c, 0)) / p.response(c, 0, 0));
        p.apply(c, 0, c.impulse[0] - old);
      }
      for (std::size_t k = p.firstOf[m]; k < p.firstOf[m + 1]; ++k) p.solveFriction(p.contacts[k]);
    }
  }
}

// The two methods that do not accumulate decide restitution with the current velocity.
template <int D>
Real wantedNow(RowProblem<D>& p, const VelocityInput<D>& in, std::size_t k) {
  ConstraintRow<D> normal = p.contacts[k].row[0];
  const Real v = p.speed(p.contacts[k], 0);
  const auto m = static_cast<std::size_t>(std::upper_bound(p.firstOf.begin(), p.firstOf.end(), k) - p.firstOf.begin());
  const Real e = in.manifolds[m - 1].restitution;
  const bool hit = e > 0 && v < -in.restitutionThreshold && normal.error + v * in.dt <= 0;
  normal.bounce = hit ? -e * v : -ConstraintRow<D>::kNoLimit;
  return p.target(normal, in.dt) - v;
}

// 2009: each contact once, then friction of the impulse just applied.
template <int D>
void pushedOnce(RowProblem<D>& p, const VelocityInput<D>& in, int) {
  for (std::size_t k = 0; k < p.contacts.size(); ++k) {
    RowContact<D>& c = p.contacts[k];
    const Real impulse = wantedNow(p, in, k) / p.response(c, 0, 0);
    if (!(impulse > 0)) continue;
    c.impulse[0] = impulse;
    p.apply(c, 0, impulse);
    p.solveFriction(c);
  }
}

// Millington 2007: the worst contact first, normal and tangents as one block; if it slides, on the edge of the cone.
template <int D>
void worstFirst(RowProblem<D>& p, const VelocityInput<D>& in, int factor) {
  for (std::size_t turn = 0; turn < static_cast<std::size_t>(factor) * p.contacts.size(); ++turn) {
    std::size_t worst = 0;
    for (std::size_t k = 1; k < p.contacts.size(); ++k) {
      if (wantedNow(p, in, k) > wantedNow(p, in, worst)) worst = k;
    }
    RowContact<D>& c = p.contacts[worst];
    const Real wanted = wantedNow(p, in, worst);
    if (!(wanted > Real(0.01))) return;
    Mat<D> k;
    Vec<D> change;
    for (int i = 0; i < D; ++i) {
      change[i] = i == 0 ? wanted : -p.speed(c, i);
      for (int j = 0; j < D; ++j) k(i, j) = p.response(c, i, j);
    }
    const Real mu = c.row[1].friction;
    Vec<D> impulse = Vec<D>::Unit(0) * (wanted / k(0, 0));
    if (mu > 0) {
      const Vec<D> sticking = k.inverse() * change;
      const Real sliding = sticking.template tail<D - 1>().norm();
      if (sticking[0] > 0 && sliding <= mu * sticking[0]) {
        impulse = sticking;
      } else {
        Vec<D> along = Vec<D>::Unit(0);
        along.template tail<D - 1>() = sticking.template tail<D - 1>() * (mu / sliding);
        impulse = along * (wanted / k.row(0).dot(along));
      }
    }
    for (int i = 0; i < D; ++i) p.apply(c, i, impulse[i]), c.impulse[static_cast<std::size_t>(i)] += impulse[i];
  }
}

// Catto 2024 over rows with constant directions. Each sub-step starts with the impulses of the previous one, treats
// overlap as a damped spring, moves the bodies, and removes the spring's velocity. Restitution comes at the end.
template <int D>
void softly(RowProblem<D>& p, const VelocityInput<D>& in, int substeps) {
  constexpr Real kHertz = 30, kDampingRatio = 10, kPushSpeed = 3;  // the defaults of soft_step
  const Real h = in.dt / static_cast<Real>(substeps);
  std::vector<const ContactPoint<D>*> anchors;
  for (const int i : in.order) {
    const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(i)];
    for (int k = 0; k < m.count; ++k) anchors.push_back(&m.points[static_cast<std::size_t>(k)]);
  }
  std::vector<Real> arrival, largest(p.contacts.size(), 0);
  for (const RowContact<D>& c : p.contacts) arrival.push_back(p.speed(c, 0));
  const auto pose = [&](int body) -> Pose<D>& { return p.bodies.pose[static_cast<std::size_t>(body)]; };
  const auto massOf = [&](int body) { return p.bodies.invMass[static_cast<std::size_t>(body)]; };

  const auto push = [&](std::size_t k, bool springs) {
    RowContact<D>& c = p.contacts[k];
    const Real s = (pose(c.b) * anchors[k]->localB - pose(c.a) * anchors[k]->localA).dot(c.row[0].d);
    const Real response = p.response(c, 0, 0), old = c.impulse[0];
    Real v = p.speed(c, 0) + (s > 0 ? s / h : Real(0)), softness = 0;
    if (springs && !(s > 0)) {
      const Real hertz = std::min(kHertz, Real(0.25) / h) * (massOf(c.a) > 0 && massOf(c.b) > 0 ? Real(1) : Real(2));
      // Stiffness and damping of an oscillator with the row's own mass, implicit over the sub-step.
      const Real omega = Real(6.283185307179586) * hertz;
      const Real stiffness = omega * omega / response, damping = 2 * kDampingRatio * omega / response;
      v += std::max(s * stiffness / (damping + h * stiffness), -kPushSpeed);
      softness = 1 / (h * damping + h * h * stiffness);
    }
    c.impulse[0] = std::max(Real(0), old - (v + softness * old) / (response + softness));
    largest[k] = std::max(largest[k], c.impulse[0]);
    p.apply(c, 0, c.impulse[0] - old);
  };
  const auto sweep = [&](bool springs) {
    for (std::size_t m = 0; m + 1 < p.firstOf.size(); ++m) {
      for (std::size_t k = p.firstOf[m]; k < p.firstOf[m + 1]; ++k) push(k, springs);
      for (std::size_t k = p.firstOf[m]; k < p.firstOf[m + 1]; ++k) p.solveFriction(p.contacts[k]);
    }
  };
  for (int n = 0; n < substeps; ++n) {
    for (const RowContact<D>& c : p.contacts) {
      for (int i = 0; i < D; ++i) p.apply(c, i, c.impulse[static_cast<std::size_t>(i)]);
    }
    sweep(true);
    for (int i = 0; i < p.bodies.size(); ++i) {
      pose(i).p += h * p.motion(i).v, pose(i).q = integrateRotation(pose(i).q, Ang<D>(h * p.motion(i).w));
    }
    sweep(false);
  }
  for (std::size_t k = 0; k < p.contacts.size(); ++k) {
    RowContact<D>& c = p.contacts[k];
    const auto m = std::upper_bound(p.firstOf.begin(), p.firstOf.end(), k) - p.firstOf.begin() - 1;
    const Real e = in.manifolds[static_cast<std::size_t>(in.order[static_cast<std::size_t>(m)])].restitution;
    const Real old = c.impulse[0];
    if (e > 0 && arrival[k] < -in.restitutionThreshold && largest[k] > 0) {
      c.impulse[0] = std::max(Real(0), old - (p.speed(c, 0) + e * arrival[k]) / p.response(c, 0, 0));
      p.apply(c, 0, c.impulse[0] - old);
      if (c.impulse[0] < old) p.solveFriction(c);
    }
  }
  for (RowContact<D>& c : p.contacts) {  // scaled to a whole step
    for (Real& impulse : c.impulse) impulse *= static_cast<Real>(substeps);
  }
}

template <int D>
using Method = void (*)(RowProblem<D>&, const VelocityInput<D>&, int);

// The planted bug: a cone one per cent too wide.
template <int D, Method<D> right>
void wideCone(RowProblem<D>& p, const VelocityInput<D>& in, int iterations) {
  for (RowContact<D>& c : p.contacts) c.row[1].friction *= Real(1.01);
  right(p, in, iterations);
}

void solve(VelocityResolver<2>& r, ImpactScene<2>&, const VelocityInput<2>& in) { r.solve(in); }
void solve(VelocityResolver<3>& r, ImpactScene<3>&, const VelocityInput<3>& in) { r.solve(in); }
void solve(Solver<2>& r, ImpactScene<2>& s, const VelocityInput<2>&) { s.step(r); }
void solve(Solver<3>& r, ImpactScene<3>& s, const VelocityInput<3>&) { s.step(r); }

template <int D, class Stage>
void equalToRows(Stage& resolver, Method<D> method, int iterations, Draw& draw) {
  const NoCorrection<D> position;
  const Real restitution = draw.pick({Real(0), Real(0.5)});
  auto s = drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .restitution = restitution, .gap = Real(0.05)});
  const VelocityInput<D> in{s.dt,      s.lastDt, s.bodies, s.manifolds,           s.active,
                            s.joints,  position, s.model,  kRestitutionThreshold, s.work,
                            s.profiler};
  RowProblem<D> rows(in);
  method(rows, in, iterations);
  solve(resolver, s, in);
  Real largest = 1, error = 0;
  std::size_t k = 0;
  for (const Manifold<D>& m : s.manifolds) {
    for (int i = 0; i < m.count; ++i, ++k) {
      for (std::size_t d = 0; d < D; ++d) {
        const Real impulse = m.points[static_cast<std::size_t>(i)].impulse[d];
        largest = std::max(largest, std::abs(impulse));
        error = std::max(error, std::abs(impulse - rows.contacts[k].impulse[d]));
      }
    }
  }
  for (int i = 0; i < s.bodies.size(); ++i) {
    error = std::max(error, (s.motion(i).v - rows.motion(i).v).norm());
    error = std::max(error, (s.motion(i).w - rows.motion(i).w).norm());
    error = std::max(error, (s.pose(i).p - rows.bodies.pose[static_cast<std::size_t>(i)].p).norm());
  }
  if (!(error <= kRounding * largest)) RC_LOG() << "error " << error << '\n' << s;
  RC_ASSERT(error <= kRounding * largest);
}

template <int D>
void everyKernel() {
  const std::string dimension = " " + std::to_string(D) + "D";
  const auto equal = [](auto resolver, Method<D> method, int iterations) {
    return [resolver = std::shared_ptr(std::move(resolver)), method, iterations] {
      RapidCheckDraw draw;
      equalToRows<D>(*resolver, method, iterations, draw);
    };
  };
  const auto velocity = [](const std::string& spec) { return createStage<VelocityResolver<D>>(Spec::parse(spec)); };
  const auto soft = [] { return createStage<Solver<D>>(Spec::parse("soft_step{substeps=3}")); };
  check("rows of catto" + dimension, equal(velocity("catto{iterations=7}"), accumulated<D>, 7), 200);
  check("rows of naive" + dimension, equal(velocity("naive"), pushedOnce<D>, 1), 200);
  check("rows of millington" + dimension, equal(velocity("millington"), worstFirst<D>, 4), 200);
  check("rows of soft_step" + dimension, equal(soft(), softly<D>, 3), 200);
  expectFalsified("rows with a wide cone" + dimension,
                  equal(velocity("catto{iterations=7}"), wideCone<D, accumulated<D>>, 7), 200);
  expectFalsified("sub-steps with a wide cone" + dimension, equal(soft(), wideCone<D, softly<D>>, 3), 200);
}
TEST(Rows, ContactKernelsEqualRows2) { everyKernel<2>(); }
TEST(Rows, ContactKernelsEqualRows3) { everyKernel<3>(); }

}  // namespace rows_test
}}}  // namespace lpc::LPC_PRECISION::test
