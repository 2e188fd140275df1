// SPDX-License-Identifier: Zlib
// Every registered contact generator, in both dimensions, against a brute-force distance. A property that a generator
// names in info().failures must fail for it.
#include <gtest/gtest.h>

#include <set>

#include "tests/check_property.h"
#include "tests/contact_properties.h"
#include "tests/planted_bugs/contact_bugs.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

// Runs a property on every competitor; `name` as it stands in info().failures.
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

// Many pairs in one call give bit for bit what each gives alone, asked of a generator that is asked for the first time.
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
  ChildPairs<D> childPairs;
  WorkDone none;
  const auto children = childPairs.of(pairs, shapes, pose, kContactMargin, none);
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    WorkDone work;
    std::vector<Manifold<D>> together, alone;
    const auto generator = createStage<ContactGenerator<D>>({r->info.name, {}});
    generator->generate({children, shapes, pose, kContactMargin, true}, together, work);
    for (const ConvexPair<D>& pair : children) {
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
    for (const char* expected : {"sat_clip", "query_clip", "deepest_point"})
      EXPECT_NE(std::find(names.begin(), names.end(), expected), names.end());
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
  catches<2, FlippedNormal>("flipped normal", depthIsTrue<2>, 1000);
  catches<3, FlippedNormal>("flipped normal", depthIsTrue<3>, 1000);
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

// Two logs whose axes all but meet: what rounding leaves of the way between the axes has no direction any more, and a
// normal that leans by a millionth is short of the depth by a millionth of the logs' length.
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

// Two logs whose axes all but lie on one line: what leans along that line is short of the depth by the logs' length.
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

TEST(Contacts, DeepBodiesGoBackWhereTheyCameFrom) {
  onEveryGenerator<2>("Contacts.DeepBodiesGoBackWhereTheyCameFrom", deepBodiesGoBack<2>, 20);
  onEveryGenerator<3>("Contacts.DeepBodiesGoBackWhereTheyCameFrom", deepBodiesGoBack<3>, 20);
}

TEST(Contacts, DeclaredFailuresAreTested) {
  const std::set<std::string> known = {"Contacts.FaceContactsSpanThePatch", "Contacts.ParallelEdgesTouchInTwoPoints",
                                       "Contacts.DeepBodiesGoBackWhereTheyCameFrom"};
  for (int d : {2, 3}) {
    for (const Registered* r : Registry::instance().list(StageKind::contacts, d)) {
      for (const FailureMode& f : r->info.failures)
        EXPECT_TRUE(known.contains(f.test)) << r->info.name << ": " << f.test;
    }
  }
}

// The answer must not depend on the order of the pairs, on what was asked before, or on how many are asked at once.
TEST(Contacts, PairsAreIndependent) {
  pairsAreIndependent<2>();
  pairsAreIndependent<3>();
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
