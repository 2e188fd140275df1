// SPDX-License-Identifier: Zlib
#include "algorithms/cache/inherit.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// Factor (1) of the bounds. It covers rounding errors, and by how much an angle exceeds a short chord. Larger: more
/// pairs compute the angle itself, which costs time only. Smaller: a bound may be below the value.
constexpr Real kBoundGrowth = Real(1.02);
/// Longer chords may be shorter than the angle by more than kBoundGrowth (rad). Larger: a bound may be below the angle.
/// Smaller: more pairs compute the angle itself.
constexpr Real kShortChord = Real(0.25);

// Vectors side by side, by component. The compiler computes several lanes at once. A vector load of numbers that were
// just stored one by one would stall the processor.
template <int D, int N>
using PointLanes = IndexedArray<IndexedArray<Real, N>, D>;

template <int D>
PointLanes<D, 1> laneOf(const Vec<D>& v) {
  PointLanes<D, 1> out;
  for (int k = 0; k < D; ++k) out[k][0] = v[k];
  return out;
}

// Each function computes what the operator of space.h computes, to the last bit.
template <int N>
PointLanes<2, N> turnedLanes(const Rot<2>& q, const PointLanes<2, N>& v) {
  PointLanes<2, N> out;
  for (int i = 0; i < N; ++i) {
    out[0][i] = q.c * v[0][i] - q.s * v[1][i];
    out[1][i] = q.s * v[0][i] + q.c * v[1][i];
  }
  return out;
}
template <int N>
PointLanes<3, N> turnedLanes(const Rot<3>& q, const PointLanes<3, N>& v) {
  PointLanes<3, N> out;
  for (int i = 0; i < N; ++i) {
    const Real x = v[0][i], y = v[1][i], z = v[2][i];
    const Real tx = 2 * (q.y * z - q.z * y), ty = 2 * (q.z * x - q.x * z), tz = 2 * (q.x * y - q.y * x);
    out[0][i] = x + q.w * tx + (q.y * tz - q.z * ty);
    out[1][i] = y + q.w * ty + (q.z * tx - q.x * tz);
    out[2][i] = z + q.w * tz + (q.x * ty - q.y * tx);
  }
  return out;
}

template <int D>
PointLanes<D, 1> laneBetween(const Vec<D>& a, const Vec<D>& b) {
  PointLanes<D, 1> out;
  for (int k = 0; k < D; ++k) out[k][0] = a[k] - b[k];
  return out;
}

// About the angle between two rotations while it is small (rad).
Real chordOf(const Rot<2>& a, const Rot<2>& b) { return std::abs(a.c - b.c) + std::abs(a.s - b.s); }
Real chordOf(const Rot<3>& a, const Rot<3>& b) {
  return 2 * (std::abs(a.w - b.w) + std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z));
}

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
    regenerate.clear(), m_present.clear(), m_next = 0;
    std::size_t o = 0;
    for (const ShapePair& pair : in.pairs) {
      const auto ofPair = [&](const Manifold<D>& m) { return m.shapeA == pair.a && m.shapeB == pair.b; };
      if (o < in.old.size() && !ofPair(in.old[o])) {
        const std::tuple key(in.shapes[pair.a].body, pair.a, in.shapes[pair.b].body, pair.b);
        while (o < in.old.size() && in.old[o].shapeKey() < key) ++o;
      }
      const std::size_t first = o;
      while (o < in.old.size() && ofPair(in.old[o])) ++o;
      const std::span<const Manifold<D>> old = in.old.part(first, o - first);
      if (old.empty() || !hardlyMoved(in, old[0]) || !touches(in, old)) regenerate.push_back(pair);
    }
  }

  void carry(const CacheInput<D>& in, std::span<Manifold<D>> fresh) override {
    cache::forKnown<D>(in.old, fresh, cache::inheritByFeature<D>);
  }

  void renew(const CacheInput<D>&, std::span<Manifold<D>> pair) override {
    for (Manifold<D>& m : pair) {
      const Present& now = m_present[m_next++];
      LPC_ASSERT(now.shapeA == m.shapeA && now.shapeB == m.shapeB);
      const FrictionTurn<D> turn(m.normal, now.normal);
      m.normal = now.normal, m.begun = m.ignored = 0;
      for (int i = 0; i < m.count; ++i) {
        m.points[i].separation = now.separation[i];
        turn(m.points[i].impulse);
      }
    }
  }

 private:
  static constexpr int kPoints = kManifoldPoints<D>;
  // A kept manifold at the present poses.
  struct Present {
    std::int32_t shapeA, shapeB;
    Vec<D> normal;
    IndexedArray<Real, kPoints> separation;
  };

  // `m`: the first manifold of a pair of shapes. All manifolds of a pair were made in one step.
  bool hardlyMoved(const CacheInput<D>& in, const Manifold<D>& m) const {
    const Shape<D>&a = in.shapes[m.shapeA].shape, &b = in.shapes[m.shapeB].shape;
    if (!a.flat() || !b.flat()) return false;
    const Pose<D>&X_WA = in.pose[m.bodyA], &X_WB = in.pose[m.bodyB];
    const Rot<D> back = X_WA.q.inverse(), R_AB = back * X_WB.q;
    const PointLanes<D, 1> p_AB = turnedLanes(back, laneBetween<D>(X_WB.p, X_WA.p));
    const Real width = 2 * std::min(a.reach(), b.reach());
    // Most pairs rest. Bounds without square roots are enough for them. A point of B moves at most as far as B's
    // origin, plus the angle times its distance from that origin. The angle is at most the chord, with `kBoundGrowth`,
    // while the chord is short.
    Real way = 0, rise = 0, arm = 0;
    for (int k = 0; k < D; ++k) {
      const Real d = p_AB[k][0] - m.X_AB.p[k], p = m.points[0].localB[k];
      way += std::abs(d), rise += d * m.normalA[k], arm += std::abs(p);
    }
    const Real chord = chordOf(R_AB, m.X_AB.q), angle = kBoundGrowth * chord;
    const Real byAngle = angle * (arm + width);
    if (chord <= kShortChord && angle <= m_params.angle && kBoundGrowth * (way + byAngle) <= m_params.distance &&
        kBoundGrowth * (std::abs(rise) + byAngle) <= in.margin) {
      return true;
    }
    Pose<D> X_AB{Vec<D>::Zero(), R_AB};
    for (int k = 0; k < D; ++k) X_AB.p[k] = p_AB[k][0];
    return movedWithinLimits(in, m, X_AB, width);
  }

  bool movedWithinLimits(const CacheInput<D>& in, const Manifold<D>& m, const Pose<D>& X_AB, Real width) const {
    const Ang<D> turn = turnOf(X_AB.q * m.X_AB.q.inverse());
    const Real angle = turn.norm();
    if (!(angle <= m_params.angle)) return false;
    const Vec<D>& p = m.points[0].localB;
    const Vec<D> moved = (X_AB.p - m.X_AB.p) + (X_AB.q * p - m.X_AB.q * p);
    if (!(moved.norm() + width * angle <= m_params.distance)) return false;
    const Real tilt = cross(turn, m.normalA).norm();
    return std::abs(moved.dot(m.normalA)) + width * tilt <= in.margin;
  }

  // Appends the manifolds to m_present. Shapes that are farther apart have no contacts: then appends nothing.
  bool touches(const CacheInput<D>& in, std::span<const Manifold<D>> old) {
    const std::size_t before = m_present.size();
    bool touches = false;
    for (const Manifold<D>& m : old) {
      const Pose<D>&X_WA = in.pose[m.bodyA], &X_WB = in.pose[m.bodyB];
      const PointLanes<D, 1> n = turnedLanes(X_WA.q, laneOf<D>(m.normalA));
      PointLanes<D, kPoints> a, b;
      for (int i = 0; i < kPoints; ++i) {
        for (int k = 0; k < D; ++k) a[k][i] = m.points[i].localA[k], b[k][i] = m.points[i].localB[k];
      }
      a = turnedLanes(X_WA.q, a), b = turnedLanes(X_WB.q, b);
      // Computed as a generator would: far from the origin the sum of a position and an arm loses digits.
      for (int k = 0; k < D; ++k) {
        const Real centers = X_WB.p[k] - X_WA.p[k];
        for (int i = 0; i < kPoints; ++i) a[k][i] = ((centers + b[k][i]) - a[k][i]) * n[k][0];
      }
      Present& now = m_present.emplace_back();
      now.shapeA = m.shapeA, now.shapeB = m.shapeB;
      for (int k = 0; k < D; ++k) now.normal[k] = n[k][0];
      for (int i = 0; i < kPoints; ++i) {
        if constexpr (D == 2) {
          now.separation[i] = a[0][i] + a[1][i];
        } else {
          now.separation[i] = sumOfThree(a[0][i], a[1][i], a[2][i]);
        }
      }
      for (int i = 0; i < m.count; ++i) touches = touches || now.separation[i] <= in.margin;
    }
    if (!touches) m_present.resize(before);
    return touches;
  }

  Params m_params;
  IndexedVector<Present> m_present;  // of all kept manifolds, from select() to renew()
  std::size_t m_next = 0;
};

}  // namespace

LPC_REGISTER(ContactCache, Recycling, 2, 3);

}}  // namespace lpc::LPC_PRECISION
