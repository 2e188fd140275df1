// SPDX-License-Identifier: Zlib
// Every registered contact cache, in both dimensions: what it must carry over, and what it must not change.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "framework/world/past_pair.h"
#include "tests/check_property.h"
#include "tests/conformance/moment.h"
#include "tests/planted_bugs/cache_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace cache_test {

constexpr const char* kFriction = "Cache.CarriesFrictionAsAVector";
constexpr const char* kImpulses = "Cache.CarriesImpulses";
constexpr const char* kNewFeatures = "Cache.CarriesWhereFeaturesChange";
constexpr const char* kJump = "Cache.CarriesAcrossAJump";

template <int D>
ContactPoint<D> drawPoint(Draw& draw, std::uint64_t feature) {
  ContactPoint<D> p;
  p.localA = drawVector<D>(draw), p.localB = drawVector<D>(draw);
  p.separation = draw.signedUnit() / 100;
  p.feature = feature;
  for (Real& x : p.impulse) x = draw.signedUnit();
  p.impulse[0] = std::abs(p.impulse[0]);
  for (Real& x : p.memory) x = draw.signedUnit();
  return p;
}

// Pairs from a small set of shapes, so that the lists of two steps share some pairs and differ in others.
template <int D>
std::vector<Manifold<D>> drawManifolds(Draw& draw) {
  std::vector<Manifold<D>> out;
  for (int k = 0; k < 12; ++k) {
    if (draw.coin()) continue;
    Manifold<D> m;
    m.bodyA = k / 4, m.bodyB = 3 + k / 2, m.shapeA = k / 4, m.shapeB = 3 + k / 2;
    m.partA = k % 2, m.partB = k % 4;
    m.normal = drawDirection<D>(draw);
    m.begun = draw.coin();
    // In the upper half of the number, which 32 bits would lose.
    for (std::uint64_t feature = 1; feature <= 6 && m.count < kManifoldPoints<D>; ++feature) {
      if (draw.coin() || feature == 6)
        m.points[static_cast<std::size_t>(m.count++)] = drawPoint<D>(draw, feature * 7 << 32);
    }
    out.push_back(m);
  }
  return out;
}

// In the order in which generators return them.
template <int D>
void clearImpulses(std::vector<Manifold<D>>& manifolds) {
  for (Manifold<D>& m : manifolds) {
    for (ContactPoint<D>& p : m.points) p.impulse = {}, p.memory = {};
  }
}

template <int D>
struct Steps {
  std::vector<Manifold<D>> old, fresh;
};

// Caches that read shapes and poses have their own tests.
template <int D>
CacheInput<D> inputOf(const Steps<D>& s) {
  return {{}, s.old, {}, {}, 0};
}

template <int D>
std::ostream& operator<<(std::ostream& out, const Steps<D>& s) {
  return out << s.old.size() << " old and " << s.fresh.size() << " fresh manifolds";
}

template <int D>
const Manifold<D>* find(const std::vector<Manifold<D>>& list, const Manifold<D>& like) {
  for (const Manifold<D>& m : list) {
    if (m.key() == like.key()) return &m;
  }
  return nullptr;
}
template <int D>
const ContactPoint<D>* find(const Manifold<D>* m, std::uint64_t feature) {
  for (int i = 0; m && i < m->count; ++i) {
    if (m->points[static_cast<std::size_t>(i)].feature == feature) return &m->points[static_cast<std::size_t>(i)];
  }
  return nullptr;
}

// Two steps. Where both have a manifold, its normal moved a little, stayed, or crossed z = 0, where the tangent basis
// jumps. Where both have a feature, its anchors moved by a millimetre or anywhere.
template <int D>
Steps<D> drawSteps(bool anywhere = false) {
  return *Gen([anywhere](Draw& draw) {
    Steps<D> s{drawManifolds<D>(draw), drawManifolds<D>(draw)};
    for (Manifold<D>& m : s.fresh) {
      for (Manifold<D>& o : s.old) {
        if (o.key() != m.key()) continue;
        const int change = draw.below(3);
        if (change == 2) o.normal[D - 1] = D == 3 ? Real(1e-12) : o.normal[D - 1];
        if (o.normal.norm() < Real(0.5)) o.normal[0] = 1;
        o.normal.normalize();
        m.normal = o.normal;
        if (change == 1) m.normal = (m.normal + Real(1e-3) * drawVector<D>(draw)).normalized();
        if (change == 2 && D == 3) m.normal[2] = -m.normal[2];
        for (ContactPoint<D>& p : m.points) {
          const ContactPoint<D>* q = anywhere ? nullptr : find(&o, p.feature);
          if (!q) continue;
          p.localA = q->localA + Real(1e-3) * drawVector<D>(draw);
          p.localB = q->localB + Real(1e-3) * drawVector<D>(draw);
        }
      }
    }
    clearImpulses(s.fresh);
    return s;
  });
}

// The same pair of shapes and the same feature: the same normal impulse and the solver's memory.
template <int D>
void carriesFeatures(ContactCache<D>& cache, bool anywhere) {
  Steps<D> s = drawSteps<D>(anywhere);
  cache.carry(inputOf(s), s.fresh);
  for (const Manifold<D>& m : s.fresh) {
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& p = m.points[static_cast<std::size_t>(i)];
      const ContactPoint<D>* o = find(find(s.old, m), p.feature);
      if (!o) continue;
      RC_ASSERT(p.impulse[0] == o->impulse[0]);
      RC_ASSERT(p.memory == o->memory);
    }
  }
}

template <int D>
void carriesImpulses(ContactCache<D>& cache) {
  carriesFeatures<D>(cache, false);
}
template <int D>
void carriesAcrossAJump(ContactCache<D>& cache) {
  carriesFeatures<D>(cache, true);
}

// Friction stays the same vector in space, whatever the tangent basis of the new normal.
template <int D>
void carriesFriction(ContactCache<D>& cache) {
  Steps<D> s = drawSteps<D>();
  cache.carry(inputOf(s), s.fresh);
  const auto friction = [](const Vec<D>& n, const ContactPoint<D>& p) {
    Vec<D> f = Vec<D>::Zero();
    for (int k = 1; k < D; ++k) f += p.impulse[static_cast<std::size_t>(k)] * tangents(n).col(k - 1);
    return f;
  };
  for (const Manifold<D>& m : s.fresh) {
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& p = m.points[static_cast<std::size_t>(i)];
      const Manifold<D>* o = find(s.old, m);
      const ContactPoint<D>* q = find(o, p.feature);
      // A normal that turned by an angle drops the component that is now along it: second order in length, first order
      // along n.
      if (!q) continue;
      const Real turn = (m.normal - o->normal).norm();
      RC_ASSERT((friction(m.normal, p) - friction(o->normal, *q)).norm() <= 4 * turn + 100 * kEps);
    }
  }
}

// Geometry, flags and materials are the new ones. Points without an old point start cold. The number of manifolds
// stays.
template <int D>
void leavesTheRestAlone(ContactCache<D>& cache) {
  Steps<D> s = drawSteps<D>();
  const auto made = s.fresh;
  cache.carry(inputOf(s), s.fresh);
  RC_ASSERT(s.fresh.size() == made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    const Manifold<D>&m = s.fresh[i], &was = made[i];
    RC_ASSERT(m.key() == was.key());
    RC_ASSERT(m.count == was.count && m.normal == was.normal && m.begun == was.begun && m.ignored == was.ignored);
    for (int k = 0; k < m.count; ++k) {
      const auto &p = m.points[static_cast<std::size_t>(k)], &q = was.points[static_cast<std::size_t>(k)];
      RC_ASSERT(p.localA == q.localA && p.localB == q.localB && p.separation == q.separation);
      RC_ASSERT(p.feature == q.feature);
      if (!find(s.old, m)) {
        for (Real x : p.impulse) RC_ASSERT(x == 0);
      }
    }
  }
}

// A point in the same place keeps its impulse although its feature number changed.
template <int D>
void carriesWhereFeaturesChange(ContactCache<D>& cache) {
  Steps<D> s = drawSteps<D>();
  s.fresh = s.old;
  clearImpulses(s.fresh);
  for (Manifold<D>& m : s.fresh) {
    for (ContactPoint<D>& p : m.points) p.feature += 1000;
  }
  cache.carry(inputOf(s), s.fresh);
  for (const Manifold<D>& m : s.fresh) {
    const Manifold<D>* o = find(s.old, m);
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
      RC_ASSERT(m.points[i].impulse[0] == o->points[i].impulse[0]);
    }
  }
}

// Another feature in another place is another point.
template <int D>
void forgetsWhatIsFar(ContactCache<D>& cache) {
  Steps<D> s = drawSteps<D>();
  s.fresh = s.old;
  clearImpulses(s.fresh);
  for (Manifold<D>& m : s.fresh) {
    for (ContactPoint<D>& p : m.points) {
      p.feature += 1000, p.localA[0] += 10, p.localB[0] += 10;
    }
  }
  cache.carry(inputOf(s), s.fresh);
  for (const Manifold<D>& m : s.fresh) {
    for (const ContactPoint<D>& p : m.points) {
      for (Real x : p.impulse) RC_ASSERT(x == 0);
    }
  }
}

// One old point and several new ones near it: the sum of the impulses does not grow.
template <int D>
void givesAnImpulseOnce(ContactCache<D>& cache) {
  Steps<D> s = drawSteps<D>();
  for (Manifold<D>& m : s.old) m.count = 1;
  s.fresh = s.old;
  clearImpulses(s.fresh);
  for (Manifold<D>& m : s.fresh) {
    for (; m.count < kManifoldPoints<D>; ++m.count) {
      ContactPoint<D>& p = m.points[static_cast<std::size_t>(m.count)];
      p = m.points[0];
      p.feature += static_cast<std::uint64_t>(m.count), p.localA[0] += Real(1e-4) * static_cast<Real>(m.count);
    }
  }
  cache.carry(inputOf(s), s.fresh);
  for (std::size_t i = 0; i < s.old.size(); ++i) {
    Real sum = 0;
    for (int k = 0; k < s.fresh[i].count; ++k) sum += s.fresh[i].points[static_cast<std::size_t>(k)].impulse[0];
    RC_ASSERT(sum <= s.old[i].points[0].impulse[0]);
  }
}

template <int D>
Real deepest(const Manifold<D>& m) {
  Real s = m.points[0].separation;
  for (int i = 1; i < m.count; ++i) s = std::min(s, m.points[static_cast<std::size_t>(i)].separation);
  return s;
}

// `renew` brings the pairs that `select` leaves out to their present state. Checked: no touching pair
// is lost, normals and separations are of these poses, and every corner deep inside has a point.
template <int D>
void isOfThisMoment(ContactCache<D>& cache) {
  Moment<D> s = drawMoment<D>();
  std::vector<ShapePair> regenerate;
  cache.select(s.input(), regenerate);
  std::vector<Manifold<D>> now = s.made(regenerate, s.after);
  cache.carry(s.input(), now);
  std::vector<Manifold<D>> old = s.old;
  for (std::span<Manifold<D>> rest = old; !rest.empty();) {
    const std::span<Manifold<D>> pair = firstPair(rest);
    rest = rest.subspan(pair.size());
    const ShapePair shapes{pair[0].shapeA, pair[0].shapeB};
    if (std::find(regenerate.begin(), regenerate.end(), shapes) != regenerate.end()) continue;
    cache.renew(s.input(), pair);
    now.insert(now.end(), pair.begin(), pair.end());
  }
  for (const Manifold<D>& m : now) {
    const bool kept =
        std::find(regenerate.begin(), regenerate.end(), ShapePair{m.shapeA, m.shapeB}) == regenerate.end();
    const Manifold<D>* was = kept ? find(s.old, m) : nullptr;
    RC_ASSERT(!kept || was);
    RC_ASSERT(std::abs(m.normal.norm() - 1) <= 20 * kEps);
    const Pose<D>&X_WA = s.after[static_cast<std::size_t>(m.bodyA)], &X_WB = s.after[static_cast<std::size_t>(m.bodyB)];
    RC_ASSERT((X_WA.q * m.normalA - m.normal).norm() <= 20 * kEps);
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
      RC_ASSERT(std::abs(m.points[i].separation - separationNow(m, m.points[i], X_WA, X_WB)) <= 100 * kEps);
      if (kept) RC_ASSERT(m.points[i].impulse[0] == was->points[i].impulse[0]);
    }
  }
  for (const Manifold<D>& m : s.made(s.pairs, s.after)) {
    if (!(deepest(m) < 0)) continue;
    const Manifold<D>* seen = find(now, m);
    if (!seen) RC_ASSERT(deepest(m) > -kContactMargin / 4);
    if (seen) RC_ASSERT(deepest(*seen) - deepest(m) < kContactMargin / 4);
  }
}

constexpr int kRuns = 200;  // cases of each property, and of each planted bug

template <int D, class Property>
void onEveryCache(const std::string& name, const Property& property) {
  for (const Registered* r : Registry::instance().list(StageKind::cache, D)) {
    bool mustFail = false;
    for (const FailureMode& f : r->info.failures) mustFail = mustFail || f.test == name;
    const auto cache = createStage<ContactCache<D>>({r->info.name, {}});
    const std::string title = name + " " + r->info.name + " " + std::to_string(D) + "D";
    const auto run = [&] { property(*cache); };
    if (mustFail) {
      expectFalsified(title + " must fail", run, kRuns);
    } else {
      check(title, run, kRuns);
    }
  }
}

template <template <int> class Bug, int D, class Property>
void catches(const std::string& name, const Property& property) {
  Bug<D> bug;
  expectFalsified(
      name + " " + std::to_string(D) + "D", [&] { property(bug); }, kRuns);
}

TEST(Cache, CarriesImpulses) {
  onEveryCache<2>(kImpulses, carriesImpulses<2>);
  onEveryCache<3>(kImpulses, carriesImpulses<3>);
  catches<MatchesByPlace, 2>("matched by place in the list", carriesImpulses<2>);
  catches<MatchesByPlace, 3>("matched by place in the list", carriesImpulses<3>);
  catches<MatchesByShape, 2>("matched by shapes, children forgotten", carriesImpulses<2>);
  catches<MatchesByShape, 3>("matched by shapes, children forgotten", carriesImpulses<3>);
}

TEST(Cache, CarriesFrictionAsAVector) {
  onEveryCache<2>(kFriction, carriesFriction<2>);
  onEveryCache<3>(kFriction, carriesFriction<3>);
  catches<FrictionAsNumbers, 3>("friction as two numbers", carriesFriction<3>);
}

TEST(Cache, KeepsFreshGeometry) {
  onEveryCache<2>("Cache.KeepsFreshGeometry", leavesTheRestAlone<2>);
  onEveryCache<3>("Cache.KeepsFreshGeometry", leavesTheRestAlone<3>);
  catches<StaleManifold, 2>("stale manifold", leavesTheRestAlone<2>);
  catches<StaleManifold, 3>("stale manifold", leavesTheRestAlone<3>);
}

TEST(Cache, CarriesWhereFeaturesChange) {
  onEveryCache<2>(kNewFeatures, carriesWhereFeaturesChange<2>);
  onEveryCache<3>(kNewFeatures, carriesWhereFeaturesChange<3>);
}

TEST(Cache, CarriesAcrossAJump) {
  onEveryCache<2>(kJump, carriesAcrossAJump<2>);
  onEveryCache<3>(kJump, carriesAcrossAJump<3>);
}

TEST(Cache, ForgetsWhatIsFar) {
  onEveryCache<2>("Cache.ForgetsWhatIsFar", forgetsWhatIsFar<2>);
  onEveryCache<3>("Cache.ForgetsWhatIsFar", forgetsWhatIsFar<3>);
  catches<MatchesByPlace, 2>("matched by place in the list", forgetsWhatIsFar<2>);
  catches<MatchesByPlace, 3>("matched by place in the list", forgetsWhatIsFar<3>);
}

TEST(Cache, GivesAnImpulseOnce) {
  onEveryCache<2>("Cache.GivesAnImpulseOnce", givesAnImpulseOnce<2>);
  onEveryCache<3>("Cache.GivesAnImpulseOnce", givesAnImpulseOnce<3>);
  catches<GivesToAllAround, 2>("given to all around", givesAnImpulseOnce<2>);
  catches<GivesToAllAround, 3>("given to all around", givesAnImpulseOnce<3>);
}

TEST(Cache, CarriedContactsAreCurrent) {
  onEveryCache<2>("Cache.CarriedContactsAreCurrent", isOfThisMoment<2>);
  onEveryCache<3>("Cache.CarriedContactsAreCurrent", isOfThisMoment<3>);
  catches<StaleSeparations, 2>("separations of before", isOfThisMoment<2>);
  catches<StaleSeparations, 3>("separations of before", isOfThisMoment<3>);
  catches<StaleNormals, 2>("normals of before", isOfThisMoment<2>);
  catches<StaleNormals, 3>("normals of before", isOfThisMoment<3>);
}

// Hardly moved flat shapes are kept. Shapes that moved by a hand's width, and round shapes, are regenerated.
TEST(Cache, RecyclingKeepsShapesThatHardlyMoved) {
  const auto recycling = createStage<ContactCache<2>>({"recycling", {}});
  std::vector<ShapePair> regenerate;
  Moment<2> s;
  s.shapes.resize(3);
  s.shapes[0].shape = Shape<2>::box({2, 2}), s.shapes[0].body = 0;
  s.shapes[1].shape = Shape<2>::box({Real(0.5), Real(0.5)}), s.shapes[1].body = 1;
  s.shapes[2].shape = Shape<2>::sphere(Real(0.5)), s.shapes[2].body = 2;
  s.before = {Pose<2>{}, {{-1, Real(2.5)}, {}}, {{1, Real(2.5)}, {}}};
  s.old = s.made(s.pairs, s.before);
  ASSERT_EQ(s.old.size(), 2u);
  s.after = s.before;
  recycling->select(s.input(), regenerate);
  EXPECT_EQ(regenerate, (std::vector<ShapePair>{{0, 2}})) << "the ball rolls";
  s.after[1].p[0] += Real(0.04);
  recycling->select(s.input(), regenerate);
  EXPECT_EQ(regenerate, (std::vector<ShapePair>{{0, 2}}));
  s.after[1].p[0] += Real(0.04);
  recycling->select(s.input(), regenerate);
  EXPECT_EQ(regenerate, s.pairs);
  s.after[1] = {{-1, Real(2.53)}, {}};
  recycling->select(s.input(), regenerate);
  EXPECT_EQ(regenerate, s.pairs) << "beyond the margin there are no contacts";
  // A box on its left edge. Its right corner starts 25 mm up and without a point, then is 10 mm deep.
  s.shapes[1].shape = Shape<2>::box({Real(0.25), Real(0.25)}), s.pairs = {{0, 1}};
  const auto tilted = [](double t) { return Pose<2>{{-1, Real(2.25 + 0.25 * t)}, Rot<2>::angle(t)}; };
  s.before[1] = tilted(0.05), s.after[1] = tilted(-0.02);
  s.after[1].p[0] += Real(0.25 * 0.07);  // the edge stays in place
  s.old = s.made(s.pairs, s.before);
  ASSERT_EQ(s.old.at(0).count, 1);
  recycling->select(s.input(), regenerate);
  EXPECT_EQ(regenerate, s.pairs);
  SeesPointsAlone<2> wrong;
  wrong.select(s.input(), regenerate);
  EXPECT_TRUE(regenerate.empty()) << "the planted bug";
}

TEST(Cache, DeclaredFailuresAreTested) {
  const std::set<std::string> known = {kFriction, kImpulses, kNewFeatures, kJump};
  for (int d : {2, 3}) {
    for (const Registered* r : Registry::instance().list(StageKind::cache, d)) {
      for (const FailureMode& f : r->info.failures) EXPECT_TRUE(known.contains(f.test)) << f.test;
    }
  }
}

TEST(Cache, SelectsEveryPairUnlessItBringsItBack) {
  const std::vector<ShapePair> pairs = {{0, 1}, {0, 2}, {3, 4}};
  for (const Registered* r : Registry::instance().list(StageKind::cache, 2)) {
    const auto cache = createStage<ContactCache<2>>({r->info.name, {}});
    std::vector<ShapePair> regenerate = {{9, 9}};
    cache->select({pairs, {}, {}, {}, 0}, regenerate);
    EXPECT_EQ(regenerate, pairs) << r->info.name << ": nothing old, so nothing can be left out";
  }
}

}  // namespace cache_test
}}}  // namespace lpc::LPC_PRECISION::test
