// SPDX-License-Identifier: Zlib
#include "algorithms/cache/inherit.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Contact recycling: the points of two shapes are kept while the shapes have hardly moved relative to each other since
// the points were made. Anchors stay on the bodies; separations are updated. A leaning tower thus keeps the face that
// it stands on.
//
// The bound on the motion must hold for the whole face that the shapes share, also for corners without a point. The
// face lies in the smaller shape, so no place of it is farther from the first point than that shape is wide. The place
// may have moved by `distance`, but along the normal by no more than the contact margin: a place that was farther apart
// when the points were made has no point and would penetrate unseen. Round shapes are excluded: their points do not
// stay on them while they roll, and a ball accelerates if its point lags behind it.
template <int D>
class Recycling final : public ContactCache<D> {
 public:
  struct Params {
    Real distance = Real(0.05);
    Real angle = Real(0.2);
    void visit(ParamVisitor& v) {
      v.real("distance", distance, 0, 1000, "m", "largest motion of the contact area since its points were made");
      v.real("angle", angle, 0, 3, "rad", "largest relative rotation since the points were made");
    }
  };
  explicit Recycling(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "recycling",
            .summary = "flat shapes with little relative motion keep their points; others match as by_feature",
            .paper = "box2d",
            .complexity = "old and new manifolds; kept ones skip the contact generator",
            .failures = {{"a body that slides over a vertex or rolls over an edge",
                          "the contact gets a new feature id and starts cold", "Cache.CarriesWhereFeaturesChange"}}};
  }

  void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) override {
    regenerate.clear();
    std::size_t o = 0;
    for (const ShapePair& pair : in.pairs) {
      const auto ofPair = [&](const Manifold<D>& m) { return m.shapeA == pair.a && m.shapeB == pair.b; };
      if (o < in.old.size() && !ofPair(in.old[o])) {
        const std::tuple key(in.shapes[pair.a].body, pair.a, in.shapes[pair.b].body, pair.b);
        while (o < in.old.size() && in.old[o].shapeKey() < key) ++o;
      }
      const std::size_t first = o;
      while (o < in.old.size() && ofPair(in.old[o])) ++o;
      if (first == o || !stays(in, in.old.part(first, o - first))) regenerate.push_back(pair);
    }
  }

  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    cache::forKnown<D>(in.old, fresh, cache::inheritByFeature<D>);
  }

  void renew(const CacheInput<D>& in, std::span<Manifold<D>> pair) override {
    const Pose<D>&X_WA = in.pose[pair[0].bodyA], &X_WB = in.pose[pair[0].bodyB];
    for (Manifold<D>& m : pair) {
      const Vec<D> n = X_WA.q * m.normalA;
      const FrictionTurn<D> turn(m.normal, n);
      m.normal = n, m.begun = m.ignored = 0;
      for (int i = 0; i < m.count; ++i) {
        ContactPoint<D>& p = m.points[i];
        p.separation = separation(p, n, X_WA, X_WB);
        turn(p.impulse);
      }
    }
  }

 private:
  // Manifolds of one pair of shapes, all made in one step.
  bool stays(const CacheInput<D>& in, std::span<const Manifold<D>> old) const {
    const Manifold<D>& m = old[0];
    const Shape<D>&a = in.shapes[m.shapeA].shape, &b = in.shapes[m.shapeB].shape;
    if (!a.flat() || !b.flat()) return false;
    const Pose<D>&X_WA = in.pose[m.bodyA], &X_WB = in.pose[m.bodyB];
    const Pose<D> X_AB = poseBetween(X_WA, X_WB);
    const Ang<D> turn = turnOf(X_AB.q * m.X_AB.q.inverse());
    const Real angle = turn.norm();
    if (!(angle <= m_params.angle)) return false;
    const Vec<D>& p = m.points[0].localB;
    const Vec<D> moved = (X_AB.p - m.X_AB.p) + (X_AB.q * p - m.X_AB.q * p);
    const Real width = 2 * std::min(a.reach(), b.reach());
    if (!(moved.norm() + width * angle <= m_params.distance)) return false;
    const Real tilt = cross(turn, m.normalA).norm();
    if (!(std::abs(moved.dot(m.normalA)) + width * tilt <= in.margin)) return false;
    // Shapes that are farther apart have no contacts.
    for (const Manifold<D>& manifold : old) {
      const Vec<D> n = X_WA.q * manifold.normalA;
      for (int i = 0; i < manifold.count; ++i) {
        if (separation(manifold.points[i], n, X_WA, X_WB) <= in.margin) return true;
      }
    }
    return false;
  }

  // Computed as a generator would: far from the origin the sum of a position and an arm loses digits.
  static Real separation(const ContactPoint<D>& p, const Vec<D>& n, const Pose<D>& X_WA, const Pose<D>& X_WB) {
    return ((X_WB.p - X_WA.p) + X_WB.q * p.localB - X_WA.q * p.localA).dot(n);
  }

  Params m_params;
};

}  // namespace

LPC_REGISTER(ContactCache, Recycling, 2, 3);

}}  // namespace lpc::LPC_PRECISION
