// SPDX-License-Identifier: Zlib
#include "oracles/corpus/drawn_problem.h"

#include <cmath>
#include <iterator>

#include "framework/math/random.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class ProblemFamily { heap, frictionless, massRatio, hyperstatic, sliding, jointed };
constexpr const char* kProblemFamilies[] = {"heap", "frictionless", "mass_ratio", "hyperstatic", "sliding", "jointed"};

template <int D>
class ProblemDrawer {
 public:
  ProblemDrawer(std::uint64_t seed, int number) : m_random(seed * 1000003 + static_cast<std::uint64_t>(number)) {
    m_random = Random(m_random.next());
    m_family = static_cast<ProblemFamily>(m_random.below(std::size(kProblemFamilies)));
  }

  DrawnProblem<D> draw() {
    m_problem.dt = m_problem.lastDt = Real(1) / 60;
    m_problem.gravity = Vec<D>::Unit(1) * Real(-9.81);
    m_problem.model.restitution = false;
    m_problem.position.rate = Real(0.2) / m_problem.dt;
    m_problem.addBody(BodyType::fixed, true, Vec<D>::Zero(), 0, Inertia<D>::Zero(), {});
    const auto bodies = static_cast<std::int32_t>(1 + m_random.below(6));
    for (std::int32_t i = 1; i <= bodies; ++i) addBody(i);
    for (std::int32_t i = 1; i <= bodies; ++i) {
      if (m_family == ProblemFamily::jointed) {
        if (i > 1) hang(i);
        if (i == 1 || m_random.below(2) == 0) touch(0, i);
        continue;
      }
      touch(below(i), i);
      if (m_random.below(2) == 0) touch(below(i), i);
    }
    return {kProblemFamilies[static_cast<std::size_t>(m_family)], std::move(m_problem)};
  }

 private:
  Real within(double lo, double hi) { return static_cast<Real>(m_random.uniform(lo, hi)); }
  Vec<D> anywhere(double size) {
    Vec<D> out;
    for (int k = 0; k < D; ++k) out[k] = within(-size, size);
    return out;
  }
  const Vec<D>& placeOf(std::int32_t i) const { return m_problem.bodies.pose[static_cast<std::size_t>(i)].p; }
  std::int32_t below(std::int32_t i) {
    return static_cast<std::int32_t>(m_random.below(static_cast<std::uint64_t>(i)));
  }

  void addBody(std::int32_t i) {
    const double decades = m_family == ProblemFamily::massRatio ? 3 : 0.5;
    const double mass = std::pow(10, m_random.uniform(-decades, decades));
    Inertia<D> inverse = Inertia<D>::Zero();
    for (int k = 0; k < kAngDim<D>; ++k) inverse(k, k) = static_cast<Real>(1 / (mass * m_random.uniform(0.05, 0.4)));
    Motion<D> motion;
    motion.v = anywhere(0.1) + m_problem.gravity * m_problem.dt;
    if (m_family == ProblemFamily::sliding) motion.v[0] += within(-5, 5);
    for (int k = 0; k < kAngDim<D>; ++k) motion.w[k] = within(-0.2, 0.2);
    const Vec<D> at = anywhere(0.3) + Vec<D>::Unit(1) * static_cast<Real>(i);
    m_problem.addBody(BodyType::dynamic, true, at, static_cast<Real>(1 / mass), inverse, motion);
  }

  // Normals point up: all contacts separate when each body rises faster than the earlier ones.
  void touch(std::int32_t a, std::int32_t b) {
    Manifold<D>& m = m_problem.manifolds.emplace_back();
    m.bodyA = a, m.bodyB = b;
    m.normal = (Vec<D>::Unit(1) + anywhere(0.3)).normalized();
    m.friction = m_family == ProblemFamily::frictionless ? Real(0) : within(0.1, 1);
    m.count = m_family == ProblemFamily::hyperstatic ? kManifoldPoints<D> : 1;
    const Vec<D> middle = placeOf(b) - Vec<D>::Unit(1) / 2 + anywhere(0.2);
    const RealMatrix<D, D - 1> t = tangents(m.normal);
    const Real separation = m_random.below(4) == 0 ? within(0, 1e-3) : within(-5e-3, 0);
    for (int k = 0; k < m.count; ++k) {
      ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      Vec<D> point = middle;
      for (int d = 0; m.count > 1 && d < D - 1; ++d) point += t.col(d) * ((k >> d) % 2 == 0 ? Real(0.3) : Real(-0.3));
      c.localA = point - placeOf(a), c.localB = point - placeOf(b), c.separation = separation;
    }
    if (separation <= 0) m_problem.position.add(separation, -separation);
    m_problem.order.push_back(static_cast<int>(m_problem.order.size()));
  }

  void hang(std::int32_t i) {
    const Vec<D> pin = (placeOf(i) + placeOf(i - 1)) / 2 + anywhere(0.2);
    JointRows<D> rows;
    for (int k = 0; k < D; ++k) {
      const Vec<D> axis = Vec<D>::Unit(k);
      ConstraintRow<D>& row = rows.turn(cross(Vec<D>(pin - placeOf(i)), axis), within(-1e-3, 1e-3));
      row.d = axis, row.armA = cross(Vec<D>(pin - placeOf(i - 1)), axis), row.angular = false;
    }
    m_problem.addJoint(i - 1, i, rows, {});
  }

  Random m_random;
  ProblemFamily m_family = ProblemFamily::heap;
  FrozenProblem<D> m_problem;
};

}  // namespace

template <int D>
DrawnProblem<D> drawProblem(std::uint64_t seed, int number) {
  return ProblemDrawer<D>(seed, number).draw();
}
template DrawnProblem<2> drawProblem(std::uint64_t, int);
template DrawnProblem<3> drawProblem(std::uint64_t, int);

}}  // namespace lpc::LPC_PRECISION
