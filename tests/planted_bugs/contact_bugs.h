// SPDX-License-Identifier: Zlib
// Planted bugs of contact generators. The properties must catch them.
#pragma once

#include "algorithms/contacts/sat/sat_collide3.h"
#include "oracles/referee/posed_core.h"
#include "tests/contact_scene.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

using namespace contacts;

/// sat_clip, followed by `spoil` on each manifold.
template <int D>
class SpoiledContacts : public ContactGenerator<D> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_right->generate(in, fresh, work);
    for (Manifold<D>& m : fresh) spoil(in, m);
  }
  virtual void spoil(const ContactInput<D>& in, Manifold<D>& m) = 0;

 private:
  std::unique_ptr<ContactGenerator<D>> m_right = createStage<ContactGenerator<D>>({"sat_clip", {}});
};

template <int D>
struct FlippedContactNormal final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override { m.normal = -m.normal; }
};

/// The normal points from the lower kind of shape to the higher, not from A to B.
template <int D>
struct NormalOfFirstShapeKind final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>& in, Manifold<D>& m) override {
    if (in.shapes[0].shape.kind() > in.shapes[1].shape.kind()) m.normal = -m.normal;
  }
};

/// Thins the patch along B's own x axis: the remaining point depends on the names of the box's axes.
template <int D>
struct ThinsAlongFirstAxis final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>& in, Manifold<D>& m) override {
    const Vec<D> x = in.shapes[1].X_CS.q * Vec<D>(Vec<D>::Unit(0));
    const auto last = std::max_element(m.points.begin(), m.points.begin() + m.count,
                                       [&](const auto& p, const auto& q) { return p.localB.dot(x) < q.localB.dot(x); });
    m.points[0] = *last, m.count = 1;
  }
};

template <int D>
struct DuplicateFeatures final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override {
    if (m.count > 1) m.points[1].feature = m.points[0].feature;
  }
};

/// Drops the last of several points.
template <int D>
struct PointNowhere final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override {
    if (m.count > 1) m.points[static_cast<std::size_t>(m.count - 1)].localA[0] = std::numeric_limits<Real>::quiet_NaN();
  }
};
template <int D>
struct DepthIsNoNumber final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override {
    if (m.count > 1)
      m.points[static_cast<std::size_t>(m.count - 1)].separation = std::numeric_limits<Real>::quiet_NaN();
  }
};

template <int D>
struct OnlyOnePoint final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override { m.count = 1; }
};

/// Feature numbers depend on the position of the point, not on the features that touch.
template <int D>
struct FeaturesFromPosition final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override {
    for (int i = 0; i < m.count; ++i) {
      auto& p = m.points[static_cast<std::size_t>(i)];
      p.feature = static_cast<std::uint32_t>(static_cast<std::int64_t>(p.localB[0] * Real(1e6))) * 8u +
                  static_cast<std::uint32_t>(i);
    }
  }
};

/// The feature number is the millimetre cell of the point: few small motions change it.
template <int D>
struct FeaturesByMillimetre final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override {
    for (int i = 0; i < m.count; ++i) {
      auto& p = m.points[static_cast<std::size_t>(i)];
      const auto cell = static_cast<std::int64_t>(std::floor(1000 * p.localB.sum() + Real(0.3)));
      p.feature = static_cast<std::uint64_t>(8 * i) << 32 | static_cast<std::uint32_t>(cell);
    }
  }
};

/// Feature numbers depend on which point is the deepest: on faces that lie flat, rounding decides.
template <int D>
struct FeaturesFromDepth final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>&, Manifold<D>& m) override {
    std::uint64_t deepest = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(m.count); ++i) {
      if (m.points[i].separation < m.points[deepest].separation) deepest = i;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) m.points[i].feature = 8 * deepest + i;
  }
};

/// All vertices of B near the plane of A's face, not clipped to the face.
template <int D>
struct Unclipped final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>& in, Manifold<D>& m) override {
    const Pose<D>&X_WA = in.pose[0], &X_WB = in.pose[1];
    const ShapeView<D>& b = in.shapes[1].shape.view();
    const Real plane = m.normal.dot(X_WA * m.points[0].localA);
    m.count = 0;
    std::vector<Vec<D>> vertices;
    coreVertices(b, vertices);
    for (const Vec<D>& v : vertices) {
      const Vec<D> local = in.shapes[1].X_CS * v;
      const Vec<D> p = X_WB * local - b.radius * m.normal;
      const Real s = m.normal.dot(p) - plane;
      if (s > in.margin || m.count == kManifoldPoints<D>) continue;
      auto& c = m.points[static_cast<std::size_t>(m.count++)];
      c.localA = X_WA.inverse() * Vec<D>(p - s * m.normal), c.localB = X_WB.inverse() * p, c.separation = s;
    }
  }
};

/// The normal is the direction between the two nearest vertices, the 2009 report's second kind of axis, even if an edge
/// is nearer or the vertices coincide.
struct PointsFromOneToTheOther final : SpoiledContacts<2> {
  void spoil(const ContactInput<2>& in, Manifold<2>& m) override {
    std::vector<Vec<2>> a, b;
    coreVertices(in.shapes[0].shape.view(), a), coreVertices(in.shapes[1].shape.view(), b);
    Vec<2> way = Vec<2>::Constant(std::numeric_limits<Real>::max());
    const Pose<2> X_WA = in.pose[0] * in.shapes[0].X_CS, X_WB = in.pose[1] * in.shapes[1].X_CS;
    for (const Vec<2>& p : a) {
      for (const Vec<2>& q : b) {
        const Vec<2> here = X_WB * q - X_WA * p;
        if (here.lpNorm<1>() < way.lpNorm<1>()) way = here;
      }
    }
    m.normal = way / way.norm();
  }
};

/// sat_clip that also keeps, or only keeps, the first point of the last step, each with one mistake.
template <int D>
class SpoiledKeeping : public SpoiledContacts<D> {
 public:
  void spoil(const ContactInput<D>& in, Manifold<D>& m) override {
    for (const Manifold<D>& old : in.old) {
      if (old.key() != m.key()) continue;
      ContactPoint<D> kept = old.points[0];
      const Real before = kept.separation;
      const Pose<D>&X_WA = in.pose[0], &X_WB = in.pose[1];
      kept.separation = separationNow(m, kept, X_WA, X_WB);
      const Vec<D> gap = X_WB * kept.localB - X_WA * kept.localA;
      keep(in, m, kept, before, Vec<D>(gap - kept.separation * m.normal));
    }
  }
  /// `slid`: displacement of the anchors across the normal.
  virtual void keep(const ContactInput<D>& in, Manifold<D>& m, ContactPoint<D>& kept, Real before,
                    const Vec<D>& slid) = 0;

 protected:
  static constexpr Real kBreaking = kContactMargin;  // the default of correct generators that keep points
  static void append(Manifold<D>& m, ContactPoint<D> kept) {
    const int last = std::min(m.count, kManifoldPoints<D> - 1);
    kept.feature = m.points[static_cast<std::size_t>(last - 1)].feature + 1;
    m.points[static_cast<std::size_t>(last)] = kept, m.count = last + 1;
  }
};
template <int D>
struct KeepsOldDepths final : SpoiledKeeping<D> {
  void keep(const ContactInput<D>&, Manifold<D>& m, ContactPoint<D>& kept, Real before, const Vec<D>&) override {
    kept.separation = before;
    this->append(m, kept);
  }
};
/// Keeps points however far the bodies have separated.
template <int D>
struct KeepsTheParted final : SpoiledKeeping<D> {
  void keep(const ContactInput<D>&, Manifold<D>& m, ContactPoint<D>& kept, Real, const Vec<D>& slid) override {
    if (slid.norm() <= this->kBreaking) this->append(m, kept);
  }
};
template <int D>
struct KeepsTheSlidden final : SpoiledKeeping<D> {
  void keep(const ContactInput<D>& in, Manifold<D>& m, ContactPoint<D>& kept, Real, const Vec<D>&) override {
    if (kept.separation <= in.margin) this->append(m, kept);
  }
};
/// Keeps the old point alone and drops the new ones.
template <int D>
struct KeepsTheOldAlone final : SpoiledKeeping<D> {
  void keep(const ContactInput<D>& in, Manifold<D>& m, ContactPoint<D>& kept, Real, const Vec<D>& slid) override {
    if (kept.separation <= in.margin && slid.norm() <= this->kBreaking) m.points[0] = kept, m.count = 1;
  }
};
/// Corrects the displacement on B, even beyond the end of B.
template <int D>
struct PutsAnchorsTogether final : SpoiledKeeping<D> {
  void keep(const ContactInput<D>& in, Manifold<D>& m, ContactPoint<D>& kept, Real, const Vec<D>& slid) override {
    kept.localB -= in.pose[1].q.inverse() * slid;
    if (kept.separation <= in.margin) this->append(m, kept);
  }
};

/// Feature numbers that did not occur in the last step.
template <int D>
struct NumbersAnew final : SpoiledContacts<D> {
  void spoil(const ContactInput<D>& in, Manifold<D>& m) override {
    for (const Manifold<D>& old : in.old) {
      const std::uint64_t last = old.points[static_cast<std::size_t>(old.count - 1)].feature;
      for (int i = 0; i < m.count; ++i) {
        m.points[static_cast<std::size_t>(i)].feature = last + 1 + static_cast<std::uint64_t>(i);
      }
    }
  }
};

/// Face axes only: the 2009 engine's mistake in 3D.
template <int D>
class NoEdgeContacts final : public ContactGenerator<D> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone&) override {
    for (const ConvexPair<D>& pair : in.pairs) {
      const PlacedPair<3> placed = placePair(in, pair, kLinearSlop / 10);
      const Core3 c1 = makeCore3(placed.view1(), nullptr, m_scratch.first);
      const Core3 c2 = makeCore3(placed.view2(), &placed.X_12, m_scratch.second);
      const FaceAxis3 f1 = bestFace(c1, c2, placed.limit), f2 = bestFace(c2, c1, placed.limit);
      if (std::max(f1.separation, f2.separation) > placed.limit || f2.face < 0) continue;
      const bool first = f1.separation >= f2.separation;
      const Vec<3> n = first ? c1.n[f1.face] : Vec<3>(-c2.n[f2.face]);
      clipAgainst(c1, c2, first, first ? f1.face : f2.face, n, std::max(f1.separation, f2.separation), placed,
                  m_scratch);
      addPatch(in, placed, n, patchPoints(m_scratch, placed.tolerance, Reduction::spread), fresh);
    }
  }

 private:
  Scratch3 m_scratch;
};

}}}  // namespace lpc::LPC_PRECISION::test
