// SPDX-License-Identifier: Zlib
#include "algorithms/solver/contact_rows.h"
#include "algorithms/solver/extreme_first.h"
#include "framework/profiler.h"
#include "framework/tolerances.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// The deepest contact first: its depth is shared between moving and turning both bodies, by how easily each of the four
// gives way, and then measured again where bodies have moved.
template <int D>
class Nonlinear final : public PositionResolver<D> {
 public:
  struct Params {
    Real iterationFactor = 4;
    Real slop = kLinearSlop;
    Real angularLimit = Real(0.2);
    ExtremeSearch search = ExtremeSearch::tree;
    void visit(ParamVisitor& v) {
      v.real("iteration_factor", iterationFactor, 0, 10000, "1", "limit of moves, as a multiple of the contacts");
      v.real("slop", slop, 0, 1, "m", "depth that stays, so that resting contacts do not come and go");
      v.real("angular_limit", angularLimit, 0, 2, "rad", "largest turn in one move; the rest is made up by moving");
      v.choice("search", search, {"scan", "tree"}, "how the deepest contact is found; the result is the same");
    }
  };
  explicit Nonlinear(const Params& params) : m_params(params), m_depths(params.search) {}

  static Info info() {
    return {.name = "nonlinear",
            .summary = "moves and turns bodies out of the deepest contact first",
            .paper = "millington2007",
            .complexity = "iterations x (log contacts + neighbours); scan: iterations x contacts",
            .guarantee = Guarantee::approximate,
            .failures = {{"contacts elsewhere, that do not touch these", "share their limit of moves",
                          "Replay.DisjointScenesAreTwoWorlds"}}};
  }

  void correct(const PositionInput<D>& in) override {
    m_contacts.clear();
    for (int i : in.order) {
      const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(i)];
      for (int k = 0; k < m.count; ++k) {
        m_contacts.push_back({m.bodyA, m.bodyB, m.normal, m.points[static_cast<std::size_t>(k)].localA,
                              m.points[static_cast<std::size_t>(k)].localB, false});
      }
    }
    if (in.features.joints) {
      for (const PivotJoint<D>& j : in.joints) {
        if (j.bodyA >= 0) m_contacts.push_back({j.bodyA, j.bodyB, Vec<D>::Zero(), j.localA, j.localB, true});
      }
    }
    const std::size_t n = m_contacts.size();
    if (n == 0) return;
    const auto moves = [&](int body) {
      const auto i = static_cast<std::size_t>(body);
      return in.bodies.invMass[i] > 0 || in.bodies.invInertia[i].trace() > 0;
    };
    m_neighbours.build(
        in.bodies.pose.size(), n, [&](std::size_t k) { return std::pair(m_contacts[k].a, m_contacts[k].b); }, moves);
    m_depths.reset(n);
    for (std::size_t k = 0; k < n; ++k) {
      const Item& item = m_contacts[k];
      m_depths.set(k, moves(item.a) || moves(item.b) ? depth(in.bodies, item) : Real(0));
    }
    const auto limit = static_cast<long>(m_params.iterationFactor * static_cast<Real>(n));
    for (long i = 0; i < limit; ++i) {
      const std::size_t worst = m_depths.top();
      if (!(m_depths.value(worst) > 0)) break;
      const Item& item = m_contacts[worst];
      separate(in.bodies, item);
      for (int body : {item.a, item.b}) {
        for (std::uint32_t k : m_neighbours.of(body)) m_depths.set(k, depth(in.bodies, m_contacts[k]));
      }
      ++in.work[Count::rowUpdates];
    }
  }

 private:
  // A contact, or a pivot: then the normal is the direction in which its ends are apart now.
  struct Item {
    int a, b;
    Vec<D> normal, localA, localB;
    bool pivot;
  };
  struct Place {
    Vec<D> rA, rB, n;
    Real depth;  // beyond what may stay, m
  };

  Place place(const Bodies<D>& bodies, const Item& item) const {
    const auto a = static_cast<std::size_t>(item.a), b = static_cast<std::size_t>(item.b);
    Place x{bodies.pose[a].q * item.localA, bodies.pose[b].q * item.localB, item.normal, 0};
    const Vec<D> gap = (bodies.pose[b].p - bodies.pose[a].p) + x.rB - x.rA;
    if (item.pivot) {
      const Real distance = gap.norm();
      // A pivot is never exact: without a floor it would take all iterations for rounding errors.
      x.depth = distance > m_params.slop / 8 ? distance : Real(0);
      if (x.depth > 0) x.n = -gap / distance;
    } else {
      x.depth = -gap.dot(item.normal) - m_params.slop;
      x.rA += gap / 2, x.rB -= gap / 2;
    }
    return x;
  }
  Real depth(const Bodies<D>& bodies, const Item& item) const { return place(bodies, item).depth; }

  void separate(Bodies<D>& bodies, const Item& item) const {
    const auto a = static_cast<std::size_t>(item.a), b = static_cast<std::size_t>(item.b);
    const Place x = place(bodies, item);
    const Row<D> row =
        makeRow<D>(x.n, x.rA, x.rB, bodies.invMass[a] + bodies.invMass[b], bodies.invInertia[a], bodies.invInertia[b]);
    const Real amount = x.depth * row.mass;  // an impulse that would act for one second: kg m
    move(bodies, a, -amount, x.n, row.armA, row.turnA);
    move(bodies, b, amount, x.n, row.armB, row.turnB);
  }

  // A turn moves the contact along a circle, not along the normal, so it is limited, and what is missing of this body's
  // share is made up by moving it.
  void move(Bodies<D>& bodies, std::size_t i, Real amount, const Vec<D>& n, const Ang<D>& arm,
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
  std::vector<Item> m_contacts;
  Extreme m_depths;
  ContactsOfBodies m_neighbours;
};

}  // namespace

LPC_REGISTER(PositionResolver, Nonlinear, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
