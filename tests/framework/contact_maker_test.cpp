// SPDX-License-Identifier: Zlib
#include "framework/world/contact_maker.h"

#include "framework/world/joint_table.h"
#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_maker_test { namespace {

template <class T>
struct ContactMakerTest : testing::Test {};
TYPED_TEST_SUITE(ContactMakerTest, BothDimensions);

// One point per pair, in reverse order. Counts the queries of each pair in its memory.
template <int D>
struct OnePoint final : ContactGenerator<D> {
  std::vector<Real> margins;  // of the pairs, in order
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  bool remembers() const override { return true; }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone&) override {
    for (std::size_t i = in.pairs.size(); i-- > 0;) {
      fresh.push_back(startManifold(in, in.pairs[i]));
      fresh.back().count = 1, fresh.back().normal[1] = 1;
      margins.push_back(in.margin);
      if (!in.memory.empty()) in.memory[i].bytes[0] = std::byte(std::to_integer<int>(in.memory[i].bytes[0]) + 1);
    }
  }
};

// Generates every contact again, or keeps every old one.
template <int D>
struct Keeper final : ContactCache<D> {
  bool keeps = false;
  void select(const CacheInput<D>& in, std::vector<ShapePair>& regenerate) override {
    regenerate.clear();
    if (!keeps) regenerate.assign(in.pairs.begin(), in.pairs.end());
  }
  void carry(const CacheInput<D>&, std::span<Manifold<D>>) override {}
};

template <int D>
struct Maker : Inhabitants<D> {
  ContactMaker<D> maker;
  OnePoint<D> generator;
  Keeper<D> cache;
  NonCollidingPairs nonColliding;
  std::vector<SpeculativePair> speculative;

  void run() {
    this->table.sync(false);
    maker.findPairs(this->table, nonColliding, this->profiler.frame().work);
    maker.sortPairs(this->table.shapes, speculative);
    generator.margins.clear();
    maker.make({cache, generator, this->table, this->settings, speculative, this->profiler});
    this->table.boxes.markAllStale();
  }
  std::vector<std::pair<int, int>> touching() const {
    std::vector<std::pair<int, int>> out;
    for (const Manifold<D>& m : maker.manifolds) out.emplace_back(m.bodyA, m.bodyB);
    return out;
  }
};
using Bodies2 = std::vector<std::pair<int, int>>;

TYPED_TEST(ContactMakerTest, PairsMayCollideAndAreSortedByBodies) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  m.ball(at<D>(0, 0));                                    // body 0
  for (int i = 1; i < 4; ++i) m.ball(at<D>(1.5 * i, 0));  // bodies 1 to 3, each touches the next
  m.ball(at<D>(-1.5, 0), BodyType::fixed), m.ball(at<D>(-3, 0), BodyType::fixed);
  m.run();
  EXPECT_EQ(m.touching(), (Bodies2{{0, 1}, {0, 4}, {1, 2}, {2, 3}}));
  EXPECT_EQ(m.maker.pairs().size(), 4u);
  for (const Manifold<D>& c : m.maker.manifolds) {
    EXPECT_EQ(m.table.shapes[static_cast<std::size_t>(c.shapeA)].body, c.bodyA);
    EXPECT_NEAR(
        (c.X_AB.p - (m.table.bodies.pose[std::size_t(c.bodyB)].p - m.table.bodies.pose[std::size_t(c.bodyA)].p)).norm(),
        0, 1e-6);
    EXPECT_EQ(c.normalA, c.normal);
  }
  JointTable<D> joints;
  joints.add(pivot<D>(m.handle(1), m.handle(2), at<D>(2, 0)), m.table);
  m.nonColliding.read(std::span<const JointRecord<D>>(joints.records));
  m.run();
  EXPECT_EQ(m.touching(), (Bodies2{{0, 1}, {0, 4}, {2, 3}}));
}

TYPED_TEST(ContactMakerTest, OrderIsByBodiesNotByShapeSlots) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(0, 0));
  def.shapes.push_back({.shape = Shape<D>::sphere(1), .X_BS = {at<D>(0, 50), {}}});
  m.add(def);             // body 0: shapes 0 and 1
  m.ball(at<D>(1.5, 0));  // body 1: shape 2
  m.table.remove(0);
  m.ball(at<D>(30, 0));  // body 0: shape 0
  m.ball(at<D>(3, 0));   // body 2: shape 1, after body 1
  m.run();
  ASSERT_EQ(m.touching(), (Bodies2{{1, 2}}));
  EXPECT_EQ(m.maker.pairs()[0], (ShapePair{2, 1}));
}

TYPED_TEST(ContactMakerTest, PairsAheadHaveTheirOwnMarginAndComeOnce) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  m.ball(at<D>(0, 0)), m.ball(at<D>(1.5, 0)), m.ball(at<D>(20, 0));
  m.speculative = {{{0, 1}, Real(7)}, {{0, 2}, Real(8)}};
  m.run();
  EXPECT_EQ(m.touching(), (Bodies2{{0, 1}, {0, 2}}));
  EXPECT_EQ(m.generator.margins, (std::vector<Real>{7, 8}));
  m.speculative.clear();
  m.run();
  EXPECT_EQ(m.touching(), (Bodies2{{0, 1}}));
  EXPECT_EQ(m.generator.margins, std::vector<Real>{m.settings.margin});
}

TYPED_TEST(ContactMakerTest, CachedContactsAreNotGeneratedAndHaveTheirShapesMaterial) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  m.ball(at<D>(0, 0)), m.ball(at<D>(1.5, 0));
  m.run();
  ASSERT_EQ(m.generator.margins.size(), 1u);
  m.maker.manifolds[0].friction = 9;  // as by a listener
  m.maker.manifolds[0].points[0].impulse[0] = 3;
  m.cache.keeps = true;
  m.run();
  EXPECT_TRUE(m.generator.margins.empty());
  ASSERT_EQ(m.maker.manifolds.size(), 1u);
  EXPECT_EQ(m.maker.manifolds[0].points[0].impulse[0], 3);
  EXPECT_NEAR(m.maker.manifolds[0].friction, m.table.shapes[0].friction, 1e-6);
  EXPECT_EQ(m.maker.before().size(), 1u);
  m.settings.model.cache = false;  // regenerates all, carries nothing over
  m.run();
  EXPECT_EQ(m.maker.manifolds[0].points[0].impulse[0], 0);
}

TYPED_TEST(ContactMakerTest, RecordsLastAsLongAsTheirPairs) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  m.ball(at<D>(0, 0)), m.ball(at<D>(1.5, 0)), m.ball(at<D>(3, 0));
  const auto asked = [&] {
    std::vector<int> out;
    for (const PairRecord& r : m.maker.records) out.push_back(std::to_integer<int>(r.memory.bytes[0]));
    return out;
  };
  m.run(), m.run();
  EXPECT_EQ(asked(), (std::vector<int>{2, 2}));
  m.cache.keeps = true;  // no query, all stays
  m.run();
  EXPECT_EQ(asked(), (std::vector<int>{2, 2}));
  m.cache.keeps = false;
  m.table.bodies.pose[2].p = at<D>(30, 0);
  m.run();
  EXPECT_EQ(asked(), std::vector<int>{3});
  m.table.bodies.pose[2].p = at<D>(3, 0);
  m.run();
  EXPECT_EQ(asked(), (std::vector<int>{4, 1}));
  m.settings.model.cache = false;
  m.run();
  EXPECT_TRUE(asked().empty());
}

// Contacts and records of sleeping pairs are skipped; those of others are updated.
TYPED_TEST(ContactMakerTest, ContactsOfSleepersStay) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  m.ball(at<D>(0, 0)), m.ball(at<D>(1.5, 0)), m.ball(at<D>(30, 0)), m.ball(at<D>(31.5, 0));
  m.run();
  for (Manifold<D>& c : m.maker.manifolds) c.points[0].impulse[0] = 3;
  m.table.bodies.awake[0] = m.table.bodies.awake[1] = 0;
  m.run();
  EXPECT_EQ(m.touching(), (Bodies2{{0, 1}, {2, 3}}));
  EXPECT_EQ(m.maker.manifolds[0].points[0].impulse[0], 3);
  EXPECT_EQ(m.maker.manifolds[1].points[0].impulse[0], 0);
  EXPECT_EQ(m.maker.records.size(), 2u);
  m.maker.manifolds[1].ignored = 1;
  EXPECT_TRUE(m.maker.collectActive(m.table.bodies).empty());
  m.maker.manifolds[1].ignored = 0;
  EXPECT_EQ(m.maker.collectActive(m.table.bodies), std::vector<int>{1});
  m.table.bodies.awake[2] = m.table.bodies.awake[3] = 0;
  m.run();
  EXPECT_EQ(m.maker.manifolds.size(), 2u);
  EXPECT_TRUE(m.maker.before().empty());
}

TYPED_TEST(ContactMakerTest, ContactsOfARemovedShapeEndOncePerPair) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  std::vector<ShapePart<D>> parts = {{Shape<D>::sphere(1), {at<D>(0, 0), {}}},
                                     {Shape<D>::sphere(1), {at<D>(0, 0.5), {}}}};
  m.add(body<D>(Shape<D>::compound(parts), at<D>(0, 0)));
  m.ball(at<D>(1.5, 0)), m.ball(at<D>(3, 0));
  m.run();
  ASSERT_EQ(m.touching(), (Bodies2{{0, 1}, {0, 1}, {1, 2}}));
  std::vector<int> told;
  m.maker.end([](const auto& p) { return p.bodyA == 0 ? 0 : -1; },
              [&](const Manifold<D>&, std::int32_t slot) { told.push_back(slot); });
  EXPECT_EQ(told, std::vector<int>{0});
  EXPECT_EQ(m.touching(), (Bodies2{{1, 2}}));
  EXPECT_EQ(m.maker.records.size(), 1u);
}

TYPED_TEST(ContactMakerTest, AnchorsStayWhenACentreOfMassMoves) {
  constexpr int D = TypeParam::D;
  Maker<D> m;
  m.ball(at<D>(0, 0)), m.ball(at<D>(1.5, 0)), m.ball(at<D>(3, 0));
  m.run();
  auto& b = m.table.bodies;
  const auto anchor = [&](const Manifold<D>& c, bool a) {
    return Vec<D>(a ? b.pose[std::size_t(c.bodyA)] * c.points[0].localA
                    : b.pose[std::size_t(c.bodyB)] * c.points[0].localB);
  };
  const Manifold<D>&first = m.maker.manifolds[0], &second = m.maker.manifolds[1];
  const Vec<D> asB = anchor(first, false), asA = anchor(second, true), by = at<D>(0.25, -0.5);
  const Pose<D> X_1 = first.X_AB, X_2 = second.X_AB;
  b.pose[1].p += by;
  m.maker.moveCenter(1, by, m.table.visits);
  EXPECT_NEAR((anchor(first, false) - asB).norm(), 0, 1e-6);
  EXPECT_NEAR((anchor(second, true) - asA).norm(), 0, 1e-6);
  EXPECT_NEAR((first.X_AB.p - X_1.p - by).norm(), 0, 1e-6);
  EXPECT_NEAR((second.X_AB.p - X_2.p + by).norm(), 0, 1e-6);
}

}}}}}  // namespace lpc::LPC_PRECISION::test::contact_maker_test
