// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/extreme_first.h"
#include "algorithms/solver/rows/joint_rows.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

enum class ImpulseOrder { worstFirst, given };

// Solves the contact with the largest velocity error first, and repeats; or contacts in the given order. One contact is
// solved with friction as a block, and finally: its impulse is not accumulated and cannot be taken back.
template <int D>
class Millington final : public VelocityResolver<D> {
 public:
  struct Params {
    Real iterationFactor = 4;
    Real epsilon = Real(0.01);
    ExtremeSearch search = ExtremeSearch::tree;
    ImpulseOrder order = ImpulseOrder::worstFirst;
    void visit(ParamVisitor& v) {
      v.real("iteration_factor", iterationFactor, 0, 10000, "1",
             "largest number of impulses, as a multiple of the contacts", ParamRole::effort);
      v.real("epsilon", epsilon, 0, 10, "m/s", "velocity errors below this are accepted", ParamRole::tolerance);
      v.choice("search", search, {"scan", "tree"}, "how the worst contact is found; the result is the same");
      v.choice("order", order, {"worst_first", "given"},
               "worst_first, or passes in the given order, up to the same limit");
    }
  };
  explicit Millington(const Params& params) : m_params(params), m_errors(params.search) {}

  static AlgorithmInfo info() {
    return {
        .name = "millington",
        .summary = "solves the contact with the largest velocity error first, until none is left or a limit is reached",
        .paper = "millington2007",
        .complexity = "iterations x (log contacts + neighbours); scan: iterations x contacts",
        .guarantee = Guarantee::approximate,
        .failures =
            {{"a box on a slope below the critical angle, in space",
              "it creeps: friction is bounded by this step's normal impulses, without warm starting",
              "Slope.HoldsOrSaysThatItDoesNot"},
             {"several coupled contacts", "excess impulses are never undone: towers jitter", "Accumulation.TakesBack"},
             {"a heavy body on a light one", "the limit of impulses is reached long before the weight is carried",
              "Impulse.CarriesHeavyOnLight"},
             {"a stack at rest", "it trembles and drifts", "Rest.Stays"},
             {"order=given: the same contacts in another order",
              "early impulses are never undone, so the result depends on the order", "Impulse.OrderDoesNotMatter"},
             {"order=worst_first: unconnected contacts elsewhere", "they share one limit of impulses",
              "Replay.DisjointScenesAreTwoWorlds"},
             {"a box that slides on four points", "it rotates and slides up to 13 % too fast",
              "Slope.SlidesOrSaysThatItDoesNot"},
             {"a 2D box that slides on two points", "it slides a different distance",
              "Extrusion.AgreesOrSaysThatItDoesNot"},
             {"a plate that slides and spins on its corners", "some corners carry nothing, others twice their share",
              "Corners.ShareAPlateThatSlides"}},
        .friction = FrictionLaw::coulomb};
  }

  void solve(const VelocityInput<D>& in) override {
    Profiler::Scope scope(in.profiler, "solver.iterate");
    collect(in);
    solveJoints(in);
    if (!m_points.empty()) solveContacts(in);
    m_joints.store(in.joints);
    for (const Point& p : m_points) p.contact->impulse = p.impulse;
  }

 private:
  struct Point {
    int a, b;
    Vec<D> rA, rB;
    const Manifold<D>* manifold;
    ContactPoint<D>* contact;
    Real kick = 0;  // part of the normal velocity that this step's forces have just made, m/s
    IndexedArray<Real, D> impulse{};
  };

  void solveContacts(const VelocityInput<D>& in) {
    const auto limit = static_cast<long>(m_params.iterationFactor * static_cast<Real>(m_points.size()));
    if (m_params.order == ImpulseOrder::worstFirst) {
      solveWorstFirst(in, limit);
    } else {
      solveInTurn(in, limit);
    }
    solveJoints(in);
  }

  void solveWorstFirst(const VelocityInput<D>& in, long limit) {
    const std::size_t n = m_points.size();
    m_errors.reset(n);
    for (std::size_t k = 0; k < n; ++k) m_errors.set(k, error(in, m_points[k]));
    for (long i = 0; i < limit; ++i) {
      const std::size_t k = m_errors.top();
      if (!(m_errors.value(k) > m_params.epsilon)) break;
      resolve(in, m_points[k]);
      for (int body : {m_points[k].a, m_points[k].b}) {
        for (std::uint32_t other : m_neighbours.of(body)) m_errors.set(other, error(in, m_points[other]));
      }
      countRows<D>(in.work, in.model.friction ? D : 1);
    }
  }

  // The limit counts visits. Ends when a whole sweep finds no error.
  void solveInTurn(const VelocityInput<D>& in, long limit) {
    const auto n = static_cast<long>(m_points.size());
    long quiet = 0;
    for (long i = 0; i < limit && quiet < n; ++i, ++quiet) {
      Point& p = m_points[i % n];
      if (!(error(in, p) > m_params.epsilon)) continue;
      resolve(in, p);
      quiet = -1;
      countRows<D>(in.work, in.model.friction ? D : 1);
    }
  }

  void collect(const VelocityInput<D>& in) {
    m_points.clear();
    for (int i : in.order) {
      Manifold<D>& m = in.manifolds[i];
      for (int k = 0; k < m.count; ++k) {
        ContactPoint<D>& c = m.points[k];
        const ContactArms<D> arms(c, m.normal, in.bodies.pose[m.bodyA], in.bodies.pose[m.bodyB]);
        m_points.push_back({m.bodyA, m.bodyB, arms.rA, arms.rB, &m, &c});
        Point& p = m_points.back();
        if (!in.arrival.empty()) p.kick = (velocity(in.bodies.motion, p) - velocity(in.arrival, p)).dot(m.normal);
      }
    }
    const auto moves = [&](int body) { return in.bodies.invMass[body] > 0 || in.bodies.invInertia[body].trace() > 0; };
    m_neighbours.build(
        in.bodies.pose.size(), m_points.size(), [&](std::size_t k) { return std::pair(m_points[k].a, m_points[k].b); },
        moves);
    m_joints.clear();
    if (in.model.joints) m_joints.prepare(in.work, in.bodies, in.joints);
  }

  // Joints have no place in the order by error: they are solved as often as an average contact, before and after the
  // contacts.
  void solveJoints(const VelocityInput<D>& in) {
    const Feedback feedback{.rate = in.position.jointBias(in.dt)};
    for (int i = 0; i < static_cast<int>(m_params.iterationFactor) + 1 && !m_joints.rows.empty(); ++i) {
      m_joints.sweep(in.bodies.motion, in.dt, feedback);
      m_joints.count(in.work);
    }
  }

  static Vec<D> velocity(IndexedSpan<const Motion<D>> motion, const Point& p) {
    const Motion<D>& a = motion[p.a];
    const Motion<D>& b = motion[p.b];
    return b.v + cross(b.w, p.rB) - a.v - cross(a.w, p.rA);
  }

  // The change of normal velocity that the contact demands, m/s.
  static Real error(const VelocityInput<D>& in, const Point& p) {
    const Real v = velocity(in.bodies.motion, p).dot(p.manifold->normal);
    const Real e = in.model.restitution ? p.manifold->restitution : Real(0);
    return contactTarget<D>(p.contact->separation, v, v - p.kick, e, in.restitutionThreshold, in.dt, in.position) - v;
  }

  // The impulse that gives the wanted normal velocity and stops sliding. If friction is too weak for that: the impulse
  // on the edge of the cone against the direction of the sticking impulse.
  void resolve(const VelocityInput<D>& in, Point& p) const {
    const auto a = p.a, b = p.b;
    Bodies<D>& bodies = in.bodies;
    const Vec<D>& n = p.manifold->normal;
    const Mat<D> k =
        pointResponse<D>(p.rA, p.rB, bodies.invMass[a] + bodies.invMass[b], bodies.invInertia[a], bodies.invInertia[b]);
    const Vec<D> kn = k * n;
    const Real normalResponse = n.dot(kn);
    if (!(normalResponse > 0)) return;
    const Vec<D> v = velocity(in.bodies.motion, p);
    const Real wanted = error(in, p);
    Vec<D> impulse = (wanted / normalResponse) * n;
    const Real mu = in.model.friction ? p.manifold->friction : Real(0);
    const Real determinant = k.determinant();
    if (mu > 0 && determinant > 0) {
      const Vec<D> sticking = k.inverse() * (wanted * n - (v - v.dot(n) * n));
      const Real normal = sticking.dot(n);
      const Vec<D> tangential = sticking - normal * n;
      const Real size = tangential.norm();
      if (normal > 0 && size <= mu * normal) {
        impulse = sticking;
      } else if (size > 0) {
        const Vec<D> direction = n + (mu / size) * tangential;
        const Real response = n.dot(k * direction);
        if (response > 0) impulse = (wanted / response) * direction;
      }
    }
    bodies.motion[a].v -= bodies.invMass[a] * impulse;
    bodies.motion[b].v += bodies.invMass[b] * impulse;
    bodies.motion[a].w -= bodies.invInertia[a] * cross(p.rA, impulse);
    bodies.motion[b].w += bodies.invInertia[b] * cross(p.rB, impulse);
    const auto t = tangents(n);
    p.impulse[0] += impulse.dot(n);
    for (int d = 0; d < D - 1; ++d) p.impulse[d + 1] += impulse.dot(t.col(d));
  }

  Params m_params;
  IndexedVector<Point> m_points;
  Extreme m_errors;
  ContactsOfBodies m_neighbours;
  JointSystem<D> m_joints;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Millington, 2, 3);

}}  // namespace lpc::LPC_PRECISION
