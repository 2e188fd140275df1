// SPDX-License-Identifier: Zlib
#include "algorithms/solver/rows/contact_rows.h"
#include "algorithms/solver/rows/extreme_first.h"
#include "framework/math/tolerances.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Corrects the deepest contact first. Its depth is shared between translation and rotation of both bodies in proportion
// to their inverse inertia along the row; depths are then measured again where bodies have moved.
template <int D>
class Nonlinear final : public PositionResolver<D> {
 public:
  struct Params {
    Real iterationFactor = 4;
    Real slop = 0;
    // The penetration epsilon of the book's code. A correction deepens neighbouring contacts by less than this, so a
    // tolerance of zero uses up all permitted iterations.
    Real tolerance = Real(0.01);
    Real angularLimit = Real(0.2);
    ExtremeSearch search = ExtremeSearch::tree;
    void visit(ParamVisitor& v) {
      v.real("iteration_factor", iterationFactor, 0, 10000, "1",
             "largest number of moves, as a multiple of the contacts", ParamRole::effort);
      v.real("slop", slop, 0, 1, "m", "penetration left uncorrected; published: 0");
      v.real("tolerance", tolerance, 0, 1, "m", "a contact is accepted if it is deeper than the slop by at most this",
             ParamRole::tolerance);
      v.real("angular_limit", angularLimit, 0, 2, "rad", "largest rotation in one move; translation corrects the rest");
      v.choice("search", search, {"scan", "tree"}, "how the deepest contact is found; the result is the same");
    }
  };
  explicit Nonlinear(const Params& params) : m_params(params), m_depths(params.search) {}

  static AlgorithmInfo info() {
    return {.name = "nonlinear",
            .summary = "moves and rotates bodies out of the deepest contact first",
            .paper = "millington2007",
            .complexity = "iterations x (log contacts + neighbours); scan: iterations x contacts",
            .guarantee = Guarantee::approximate,
            .failures = {{"bodies that overlap by more than `tolerance`",
                          "they end slightly separated, because a rotation moves points along arcs; slop=0.005 keeps "
                          "them in contact",
                          "PositionError.EndsInTouch"},
                         {"tolerance=0: unconnected contacts elsewhere", "they share one limit of moves",
                          "Replay.DisjointScenesAreTwoWorlds"},
                         {"bodies that pass each other", "position correction changes their angular momentum",
                          "PositionError.KeepsAngularMomentum"}}};
  }

  void correct(const PositionInput<D>& in) override {
    m_joints = in.joints;
    m_contacts.clear();
    for (int i : in.order) {
      const Manifold<D>& m = in.manifolds[i];
      for (int k = 0; k < m.count; ++k) {
        m_contacts.push_back({m.bodyA, m.bodyB, m.normal, m.points[k].localA, m.points[k].localB, -1, false});
      }
    }
    if (in.model.joints) {
      for (std::size_t j = 0; j < in.joints.size(); ++j) {
        if (in.joints[j].active()) addJoint(in, static_cast<std::int32_t>(j));
      }
    }
    const std::size_t n = m_contacts.size();
    if (n == 0) return;
    const auto moves = [&](int body) {
      return body >= 0 && (in.bodies.invMass[body] > 0 || in.bodies.invInertia[body].trace() > 0);
    };
    m_neighbours.build(
        in.bodies.pose.size(), n, [&](std::size_t k) { return std::pair(m_contacts[k].a, m_contacts[k].b); }, moves);
    m_depths.reset(n);
    for (std::size_t k = 0; k < n; ++k) {
      const Item& item = m_contacts[k];
      m_depths.set(k, moves(item.a) || moves(item.b) ? depth(in.bodies, item) : Real(0));
    }
    countMadeRows<D>(in.work, n);
    const auto limit = static_cast<long>(m_params.iterationFactor * static_cast<Real>(n));
    for (long i = 0; i < limit; ++i) {
      const std::size_t worst = m_depths.top();
      if (!(m_depths.value(worst) > 0)) break;
      const Item& item = m_contacts[worst];
      separate(in.bodies, item);
      std::uint64_t places = 1;
      for (int body : {item.a, item.b}) {
        if (body < 0) continue;
        for (std::uint32_t k : m_neighbours.of(body)) m_depths.set(k, depth(in.bodies, m_contacts[k])), ++places;
      }
      countRows<D>(in.work, 1);
      countMadeRows<D>(in.work, places);
    }
  }

 private:
  // A contact, or the errors of a joint in metres or in radians. A radian counts as much as a metre when the deepest is
  // sought.
  struct Item {
    int a, b;  // a -1: the world
    Vec<D> normal, localA, localB;
    std::int32_t joint;  // -1: a contact
    bool angular;
  };
  // The row along which an item violates its constraint most.
  struct Place {
    Vec<D> n;
    Ang<D> armA, armB;
    Real depth;  // beyond the allowed error, m or rad
  };

  void addJoint(const PositionInput<D>& in, std::int32_t number) {
    const JointRecord<D>& joint = in.joints[number];
    jointRows(joint, in.bodies, m_rows);
    bool rigid[2] = {};  // whether it can violate constraints in metres, in radians
    for (const ConstraintRow<D>& row : m_rows.all()) {
      if (row.law == RowLaw::rigid && !row.absent()) rigid[row.angular] = true;
    }
    for (const bool angular : {false, true}) {
      if (!rigid[angular]) continue;
      const Vec<D> zero = Vec<D>::Zero();
      m_contacts.push_back({joint.bodyA, joint.bodyB, zero, zero, zero, number, angular});
    }
  }

  Place place(const Bodies<D>& bodies, const Item& item) {
    if (item.joint >= 0) return jointPlace(bodies, item);
    const auto a = item.a, b = item.b;
    Vec<D> rA = bodies.pose[a].q * item.localA, rB = bodies.pose[b].q * item.localB;
    const Vec<D> gap = (bodies.pose[b].p - bodies.pose[a].p) + rB - rA;
    const Real separation = gap.dot(item.normal);
    rA += (separation / 2) * item.normal, rB -= (separation / 2) * item.normal;  // as in ownArms()
    const Real depth = -separation - m_params.slop;
    return {item.normal, cross(rA, item.normal), cross(rB, item.normal), depth > m_params.tolerance ? depth : Real(0)};
  }
  Place jointPlace(const Bodies<D>& bodies, const Item& item) {
    jointRows(m_joints[item.joint], bodies, m_rows);
    Vec<D> gap = Vec<D>::Zero();
    Ang<D> turn = Ang<D>::Zero();
    for (const ConstraintRow<D>& row : m_rows.all()) {
      if (!row.binds()) continue;
      if (row.angular) {
        turn += row.error * row.armB;
      } else {
        gap += row.error * row.d;
      }
    }
    Real size = item.angular ? turn.norm() : gap.norm();
    if (item.angular && !turns(bodies, item)) size = 0;  // no rotation can correct it; it would use up all iterations
    Place x{Vec<D>::Zero(), Ang<D>::Zero(), Ang<D>::Zero(), 0};
    // A joint is never exact: without a floor, rounding errors would use up all iterations.
    if (!(size > std::max(m_params.slop, kLinearSlop) / 8)) return x;
    x.depth = size;
    for (const ConstraintRow<D>& row : m_rows.all()) {
      if (!row.binds() || row.angular != item.angular) continue;
      const Real share = -row.error / size;
      x.n += share * row.d, x.armA += share * row.armA, x.armB += share * row.armB;
    }
    return x;
  }
  static bool turns(const Bodies<D>& bodies, const Item& item) {
    const auto turns = [&](int body) { return body >= 0 && bodies.invInertia[body].trace() > 0; };
    return turns(item.a) || turns(item.b);
  }
  Real depth(const Bodies<D>& bodies, const Item& item) { return place(bodies, item).depth; }

  void separate(Bodies<D>& bodies, const Item& item) {
    const auto a = item.a, b = item.b;
    const Place x = place(bodies, item);
    const Real invMassA = item.a < 0 ? Real(0) : bodies.invMass[a];
    const Ang<D> turnA = item.a < 0 ? Ang<D>(Ang<D>::Zero()) : Ang<D>(bodies.invInertia[a] * x.armA);
    const Ang<D> turnB = bodies.invInertia[b] * x.armB;
    const Real k = (item.angular ? Real(0) : invMassA + bodies.invMass[b]) + x.armA.dot(turnA) + x.armB.dot(turnB);
    const Real amount = k > 0 ? x.depth * (1 / k) : Real(0);  // an impulse that would act for one second: kg m
    if (item.a >= 0) move(bodies, a, -amount, x.n, x.armA, turnA);
    move(bodies, b, amount, x.n, x.armB, turnB);
  }

  // A rotation moves the contact along a circle instead of along the normal, so it is limited; translation makes up the
  // rest of this body's share.
  void move(Bodies<D>& bodies, std::int32_t i, Real amount, const Vec<D>& n, const Ang<D>& arm,
            const Ang<D>& turnPerAmount) const {
    Ang<D> turn = amount * turnPerAmount;
    Vec<D> shift = (amount * bodies.invMass[i]) * n;
    const Real angle = turn.norm();
    if (angle > m_params.angularLimit) {
      const Real kept = m_params.angularLimit / angle;
      if (bodies.invMass[i] > 0) shift += (amount * (1 - kept) * arm.dot(turnPerAmount)) * n;
      turn *= kept;
    }
    bodies.pose[i].p += shift;
    if (angle > 0) bodies.pose[i].q = integrateRotation(bodies.pose[i].q, turn);
  }

  Params m_params;
  IndexedSpan<const JointRecord<D>> m_joints;  // of this call
  JointRows<D> m_rows;
  std::vector<Item> m_contacts;
  Extreme m_depths;
  ContactsOfBodies m_neighbours;
};

}  // namespace

LPC_REGISTER(PositionResolver, Nonlinear, 2, 3);

}}  // namespace lpc::LPC_PRECISION
