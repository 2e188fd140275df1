// SPDX-License-Identifier: Zlib
// Every registered contact generator, in both dimensions, against a brute-force distance. A property that a generator
// names in info().failures must fail for it.
#include <gtest/gtest.h>

#include <set>

#include "tests/check_property.h"
#include "tests/contact_properties.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/contact_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contacts_test {

// Runs a property on every competitor; `name` as in info().failures.
template <int D, class Property>
void onEveryGenerator(const std::string& name, const Property& property, int cases) {
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    bool mustFail = false;
    for (const FailureMode& f : r->info.failures) mustFail = mustFail || f.test == name;
    const auto generator = createStage<ContactGenerator<D>>({r->info.name, {}});
    const auto run = [&] { property(*generator); };
    const std::string title = name + " " + r->info.name + " " + std::to_string(D) + "D";
    if (mustFail) {
      expectFalsified(title + " must fail", run, cases);
    } else {
      check(title, run, cases);
    }
  }
}

// A batch gives each pair the same bits as a new generator gives that pair alone. So the answer depends neither on the
// order of the pairs, nor on earlier queries, nor on the size of the batch.
template <int D>
void pairsAreIndependent() {
  constexpr int kPairs = 1500;  // more than one block of a batch
  PlainDraw draw(7);
  std::vector<ShapeRecord<D>> shapes;
  std::vector<Pose<D>> pose;
  std::vector<ShapePair> pairs;
  for (int i = 0; i < kPairs; ++i) {
    const ContactScene<D> scene = drawScene<D>(draw);
    for (std::size_t k : {0u, 1u}) {
      shapes.push_back(scene.shapes[k]);
      shapes.back().body = static_cast<std::int32_t>(pose.size());
      pose.push_back(scene.pose[k]);
    }
    pairs.push_back({2 * i, 2 * i + 1});
  }
  PartPairs<D> partPairs;
  WorkDone none;
  const auto convexPairs = partPairs.of(pairs, shapes, pose, kContactMargin, none);
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    WorkDone work;
    std::vector<Manifold<D>> together, alone;
    const auto generator = createStage<ContactGenerator<D>>({r->info.name, {}});
    generator->generate({convexPairs, shapes, pose, kContactMargin, true}, together, work);
    for (const ConvexPair<D>& pair : convexPairs) {
      const auto fresh = createStage<ContactGenerator<D>>({r->info.name, {}});
      fresh->generate({{&pair, 1}, shapes, pose, kContactMargin, true}, alone, work);
    }
    std::sort(together.begin(), together.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
    ASSERT_EQ(together.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      ASSERT_EQ(together[i].key(), alone[i].key());
      ASSERT_EQ(together[i].normal, alone[i].normal);
      ASSERT_EQ(together[i].count, alone[i].count);
      for (int k = 0; k < alone[i].count; ++k) {
        const auto& p = together[i].points[static_cast<std::size_t>(k)];
        const auto& q = alone[i].points[static_cast<std::size_t>(k)];
        ASSERT_TRUE(p.localA == q.localA && p.localB == q.localB && p.separation == q.separation);
        ASSERT_EQ(p.feature, q.feature);
      }
    }
  }
}

// A body at NaN touches nothing, and nothing hangs.
template <int D>
void nowhereIsNoContact() {
  PlainDraw draw(8);
  for (int i = 0; i < 400; ++i) {
    ContactScene<D> scene = drawScene<D>(draw);
    const ShapePair pair{0, 1};
    PartPairs<D> partPairs;
    WorkDone work;
    const auto convexPairs = partPairs.of({&pair, 1}, scene.shapes, scene.pose, scene.margin, work);
    scene.pose[static_cast<std::size_t>(i % 2)].p[i % D] = std::numeric_limits<Real>::quiet_NaN();
    for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
      std::vector<Manifold<D>> fresh;
      createStage<ContactGenerator<D>>({r->info.name, {}})
          ->generate({convexPairs, scene.shapes, scene.pose, scene.margin, true}, fresh, work);
      for (const Manifold<D>& m : fresh) EXPECT_EQ(m.count, 0) << r->info.name << ", " << D << "D, scene " << i;
    }
  }
}

template <int D, template <int> class Bug, class Property>
void catches(const std::string& name, const Property& property, int cases) {
  Bug<D> bug;
  expectFalsified(
      name + " " + std::to_string(D) + "D", [&] { property(bug); }, cases);
}

TEST(Contacts, GeneratorsAreRegistered) {
  for (int d : {2, 3}) {
    std::vector<std::string> names;
    for (const Registered* r : Registry::instance().list(StageKind::contacts, d)) names.push_back(r->info.name);
    for (const char* expected : {"sat_clip", "query_clip", "deepest_point", "persistent_manifold"})
      EXPECT_NE(std::find(names.begin(), names.end(), expected), names.end());
    EXPECT_EQ(std::count(names.begin(), names.end(), "rounded_polygon"), d == 2 ? 1 : 0);
  }
}

TEST(Contacts, ManifoldsAreWellFormed) {
  onEveryGenerator<2>("Contacts.ManifoldsAreWellFormed", wellFormed<2>, 1000);
  onEveryGenerator<3>("Contacts.ManifoldsAreWellFormed", wellFormed<3>, 1000);
  catches<2, DuplicateFeatures>("duplicate feature ids", wellFormed<2>, 1000);
  catches<3, DuplicateFeatures>("duplicate feature ids", wellFormed<3>, 1000);
}

TEST(Contacts, WitnessesLieOnTheShapes) {
  onEveryGenerator<2>("Contacts.WitnessesLieOnTheShapes", witnessesOnShapes<2>, 1000);
  onEveryGenerator<3>("Contacts.WitnessesLieOnTheShapes", witnessesOnShapes<3>, 1000);
  catches<2, Unclipped>("incident face not clipped", witnessesOnShapes<2>, 1000);
  catches<3, Unclipped>("incident face not clipped", witnessesOnShapes<3>, 1000);
}

TEST(Contacts, DepthIsTrue) {
  onEveryGenerator<2>("Contacts.DepthIsTrue", depthIsTrue<2>, 1000);
  onEveryGenerator<3>("Contacts.DepthIsTrue", depthIsTrue<3>, 1000);
  catches<2, FlippedContactNormal>("flipped normal", depthIsTrue<2>, 1000);
  catches<3, FlippedContactNormal>("flipped normal", depthIsTrue<3>, 1000);
  catches<3, NoEdgeContacts>("no edge contacts", depthIsTrue<3>, 1000);
}

TEST(Contacts, SwappedBodiesGiveMirroredContacts) {
  onEveryGenerator<2>("Contacts.SwappedBodiesGiveMirroredContacts", swapMirrors<2>, 500);
  onEveryGenerator<3>("Contacts.SwappedBodiesGiveMirroredContacts", swapMirrors<3>, 500);
  catches<2, NormalOfFirstShapeKind>("normal by kind", swapMirrors<2>, 500);
  catches<3, NormalOfFirstShapeKind>("normal by kind", swapMirrors<3>, 500);
}

TEST(Contacts, RelabelledBoxesGiveTheSameContacts) {
  onEveryGenerator<2>("Contacts.RelabelledBoxesGiveTheSameContacts", relabelledBoxes<2>, 500);
  onEveryGenerator<3>("Contacts.RelabelledBoxesGiveTheSameContacts", relabelledBoxes<3>, 500);
  catches<2, ThinsAlongFirstAxis>("thins along B's first axis", relabelledBoxes<2>, 500);
  catches<3, ThinsAlongFirstAxis>("thins along B's first axis", relabelledBoxes<3>, 500);
}

TEST(Contacts, FaceContactsSpanThePatch) {
  onEveryGenerator<2>("Contacts.FaceContactsSpanThePatch", facesSpanPatch<2>, 500);
  onEveryGenerator<3>("Contacts.FaceContactsSpanThePatch", facesSpanPatch<3>, 500);
  catches<2, OnlyOnePoint>("one point for a face", facesSpanPatch<2>, 500);
  catches<3, OnlyOnePoint>("one point for a face", facesSpanPatch<3>, 500);
}

TEST(Contacts, FeaturesAreSteady) {
  onEveryGenerator<2>("Contacts.FeaturesAreSteady", featuresAreSteady<2>, 500);
  onEveryGenerator<3>("Contacts.FeaturesAreSteady", featuresAreSteady<3>, 500);
  catches<2, FeaturesFromPosition>("feature ids from positions", featuresAreSteady<2>, 500);
  catches<3, FeaturesFromPosition>("feature ids from positions", featuresAreSteady<3>, 500);
  catches<2, FeaturesByMillimetre>("features by the millimetre", featuresAreSteady<2>, 500);
  catches<3, FeaturesByMillimetre>("features by the millimetre", featuresAreSteady<3>, 500);
  catches<2, FeaturesFromDepth>("feature ids from the deepest point", featuresAreSteady<2>, 500);
  catches<3, FeaturesFromDepth>("feature ids from the deepest point", featuresAreSteady<3>, 500);
}

TEST(Contacts, ParallelEdgesTouchInTwoPoints) {
  onEveryGenerator<3>("Contacts.ParallelEdgesTouchInTwoPoints", parallelEdges, 200);
  catches<3, OnlyOnePoint>("one point for an edge", parallelEdges, 200);
}

// Two long capsules with nearly intersecting axes. The difference between the axes is rounding and has no direction. A
// normal tilted by a millionth makes the depth wrong by a millionth of the capsules' length.
TEST(Contacts, CrossingAxesGiveTheDirectionAcrossBoth) {
  constexpr Real kGap = sizeof(Real) == 8 ? Real(1e-9) : Real(1e-4);
  PlainDraw draw(3);
  for (int i = 0; i < 200; ++i) {
    const Real turned = draw.real(0.5, 2.6);
    const Shape<3> a = Shape<3>::capsule(100, 1), b = Shape<3>::capsule(80, 1);
    const Pose<3> X_AB{{draw.real(-50, 50), 0, kGap * draw.real(0.01, 1)}, Rot<3>::vector({0, 0, turned})};
    const Pose<3> X_WA{{0, 0, 0}, drawRotation<3>(draw)};
    const ContactScene<3> scene(a, b, X_WA, X_WA * X_AB, 0);
    for (const char* name : {"sat_clip", "query_clip", "deepest_point"}) {
      const auto fresh = scene.run(*createStage<ContactGenerator<3>>({name, {}}));
      ASSERT_EQ(fresh.size(), 1u) << name;
      const Vec<3> n = X_WA.q.inverse() * fresh[0].normal;
      EXPECT_LE(std::hypot(n[0], n[1]), sizeof(Real) == 8 ? Real(1e-12) : Real(1e-5)) << name << ", " << X_AB;
    }
  }
}

// Two long capsules with axes nearly on one line: a normal tilted along that line makes the depth wrong by the
// capsules' length.
TEST(Contacts, AxesOnOneLineGiveADirectionAcrossIt) {
  constexpr Real kGap = sizeof(Real) == 8 ? Real(1e-9) : Real(1e-1);
  PlainDraw draw(4);
  for (int i = 0; i < 200; ++i) {
    const Shape<3> a = Shape<3>::capsule(100, 1), b = Shape<3>::capsule(80, 1);
    const Real gap = kGap * draw.real(0.01, 1), shift = draw.real(-50, 50);
    const Pose<3> X_WA{{0, 0, 0}, drawRotation<3>(draw)};
    const ContactScene<3> scene(a, b, X_WA, X_WA * Pose<3>{{shift, gap, 0}, {}}, 0);
    for (const char* name : {"sat_clip", "query_clip", "deepest_point"}) {
      const auto fresh = scene.run(*createStage<ContactGenerator<3>>({name, {}}));
      ASSERT_EQ(fresh.size(), 1u) << name;
      const Vec<3> n = X_WA.q.inverse() * fresh[0].normal;
      EXPECT_LE(std::abs(n[0]), sizeof(Real) == 8 ? Real(1e-12) : Real(1e-5)) << name << ", gap " << gap;
    }
  }
}

// Where vertices coincide or lie on one line, no edge gives a direction.
bool hasTrueNormal(ContactGenerator<2>& generator, const ContactScene<2>& scene) {
  const auto fresh = scene.run(generator);
  if (fresh.size() != 1u || !(std::abs(fresh[0].normal.norm() - 1) <= kUnitTolerance)) return false;
  const Real truth = scene.trueDistance(), tolerance = 2 * scene.tolerance();
  return std::abs(deepest(fresh[0]) - truth) <= tolerance &&
         worldSeparation(scene, fresh[0].normal) >= truth - tolerance;
}
TEST(Contacts, VerticesThatCoincideHaveADirection) {
  const Shape<2> ball = Shape<2>::sphere(Real(0.5)), log = Shape<2>::capsule(1, Real(0.25)),
                 box = Shape<2>::box({1, Real(0.5)}, Real(0.125)), plain = Shape<2>::box({1, Real(0.5)});
  const auto at = [](Real x, Real y, double angle = 0) { return Pose<2>{{x, y}, Rot<2>::angle(angle)}; };
  const std::vector<ContactScene<2>> scenes = {
      {ball, ball, at(3, 1), at(3, 1), 0},             // one centre
      {ball, log, at(3, 1), at(4, 1), 0},              // a centre on a capsule's vertex
      {log, log, at(0, 0), at(Real(2.25), 0), 0},      // two segments on one line, apart
      {log, log, at(0, 0), at(2, 0), 0},               // two segments that meet in a vertex
      {log, log, at(0, 0), at(1, 0), 0},               // two segments that overlap
      {ball, log, at(0, 0), at(Real(1.6), 0), 0},      // a centre beyond a capsule's end
      {box, box, at(0, 0), at(2, 1), 0},               // rounded: corner on corner of the cores
      {plain, plain, at(0, 0), at(2, 1), Real(0.01)},  // the same, not rounded
      {log, box, at(-2, Real(0.5)), at(0, 0), 0},      // a capsule's vertex on a box's vertex
      {ball, plain, at(0, Real(0.875)), at(0, 0), 0},  // above the middle of a floor
      {log, log, at(0, 0), at(0, Real(0.75), 1.5707963267948966), Real(0.01)}};  // crossed, overlapping
  PointsFromOneToTheOther bug;
  int caught = 0;
  for (const Registered* r : Registry::instance().list(StageKind::contacts, 2)) {
    const auto generator = createStage<ContactGenerator<2>>({r->info.name, {}});
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      EXPECT_TRUE(hasTrueNormal(*generator, scenes[i])) << r->info.name << ", scene " << i;
      EXPECT_TRUE(hasTrueNormal(*generator, scenes[i].swapped())) << r->info.name << ", scene " << i << " swapped";
    }
  }
  for (const auto& scene : scenes) caught += !hasTrueNormal(bug, scene);
  expectCaught("the normal is the way between the nearest vertices", caught == 0);
}

// Depths within the bias are alike, once: a face that replaces a deeper axis is not compared with another face first.
TEST(Contacts, DeepBoxesAreWithinTheBias) {
  PlainDraw draw(6);
  for (int i = 0; i < 400; ++i) {
    const auto size = [&] { return Vec<3>(draw.real(1, 2), draw.real(1, 2), draw.real(1, 2)); };
    const Shape<3> a = Shape<3>::box(size()), b = Shape<3>::box(size());
    const Pose<3> X_AB{{draw.real(-1, 1), draw.real(-1, 1), draw.real(-1, 1)}, drawRotation<3>(draw)};
    const ContactScene<3> scene(a, b, {}, X_AB, 0);
    for (const char* bias : {"0.001", "0.005"}) {  // m
      const auto fresh =
          scene.run(*createStage<ContactGenerator<3>>(Spec::parse(std::string("sat_clip{bias=") + bias + "}")));
      ASSERT_EQ(fresh.size(), 1u);
      EXPECT_GE(worldSeparation(scene, fresh[0].normal), scene.trueDistance() - std::stod(bias) - scene.rounding())
          << bias << ", " << X_AB;
    }
  }
}

// "The running time is O(E + V)" (2009 report, 9.1.4): when bodies touch, few edges are measured against the other
// body's support point. The planted bug measures each.
TEST(Contacts, RoundedPolygonsMeasureFewEdges) {
  constexpr int kCorners = 256;
  PlainDraw draw(5);
  const auto round = [&] {
    std::vector<Vec<2>> points;
    const Real x = draw.real(0.5, 1), y = draw.real(0.5, 1);
    for (int i = 0; i < kCorners; ++i) {
      const Rot<2> turn = Rot<2>::angle(6.283185307179586 * i / kCorners);
      points.emplace_back(x * turn.c, y * turn.s);
    }
    return Shape<2>::polytope(points);
  };
  const auto axes = [](const char* name, const ContactScene<2>& scene) {
    const ShapePair pair{0, 1};
    PartPairs<2> partPairs;
    WorkDone work;
    std::vector<Manifold<2>> fresh;
    const auto convexPairs = partPairs.of({&pair, 1}, scene.shapes, scene.pose, scene.margin, work);
    createStage<ContactGenerator<2>>({name, {}})
        ->generate({convexPairs, scene.shapes, scene.pose, scene.margin}, fresh, work);
    return fresh.empty() || deepest(fresh[0]) < Real(-0.1) ? std::uint64_t(0) : work[WorkCount::axisTests];
  };
  std::uint64_t most = 0, all = 0;
  for (int i = 0; i < 300; ++i) {
    const ContactScene<2> scene(round(), round(), drawPose<2>(draw, 1), drawPose<2>(draw, 1), kContactMargin);
    most = std::max(most, axes("rounded_polygon", scene)), all = std::max(all, axes("sat_clip", scene));
  }
  const auto few = [](std::uint64_t count) { return count > 0 && count <= kCorners / 8; };
  EXPECT_TRUE(few(most)) << most << " of " << all;
  expectCaught("every edge is measured", few(all));
}

TEST(Contacts, DeepBodiesGoBackWhereTheyCameFrom) {
  onEveryGenerator<2>("Contacts.DeepBodiesGoBackWhereTheyCameFrom", deepBodiesGoBack<2>, 20);
  onEveryGenerator<3>("Contacts.DeepBodiesGoBackWhereTheyCameFrom", deepBodiesGoBack<3>, 20);
}

TEST(Contacts, DeclaredFailuresAreTested) {
  const std::set<std::string> known = {"Contacts.FaceContactsSpanThePatch", "Contacts.ParallelEdgesTouchInTwoPoints",
                                       "Contacts.DeepBodiesGoBackWhereTheyCameFrom",
                                       "Contacts.RockingFacesSpanThePatch", "Contacts.FastFacesSpanThePatch"};
  for (int d : {2, 3}) {
    for (const Registered* r : Registry::instance().list(StageKind::contacts, d)) {
      for (const FailureMode& f : r->info.failures)
        EXPECT_TRUE(known.contains(f.test)) << r->info.name << ": " << f.test;
    }
  }
}

TEST(Contacts, BodiesAtNanHaveNoContacts) {
  nowhereIsNoContact<2>();
  nowhereIsNoContact<3>();
}

TEST(Contacts, PairsAreIndependent) {
  pairsAreIndependent<2>();
  pairsAreIndependent<3>();
}

}  // namespace contacts_test
}}}  // namespace lpc::LPC_PRECISION::test
