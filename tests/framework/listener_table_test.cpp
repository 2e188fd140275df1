// SPDX-License-Identifier: Zlib
#include "framework/world/listener_table.h"

#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace listener_table_test { namespace {

template <class T>
struct ListenerTableTest : testing::Test {};
TYPED_TEST_SUITE(ListenerTableTest, BothDimensions);

template <int D>
struct Listener final : ContactListener<D> {
  std::string heard;
  bool vetoes = false;
  PairMaterial came, to{Real(0.1), Real(0.2)};
  void mix(const World<D>&, const Manifold<D>&, PairMaterial& m) override { came = m, m = to; }
  bool begin(const World<D>&, const Manifold<D>& m) override { return notify('b', m), !vetoes; }
  bool persist(const World<D>&, const Manifold<D>& m) override { return notify('p', m), !vetoes; }
  void end(const World<D>&, const Manifold<D>& m) override { notify('e', m); }
  void notify(char what, const Manifold<D>& m) {
    heard += what + std::to_string(m.bodyA) + std::to_string(m.bodyB) + ' ';
  }
  std::string told() { return std::exchange(heard, ""); }
};

template <int D>
struct Room : Inhabitants<D> {
  World<D> token;  // an empty world to pass to listeners
  ListenerTable<D> listeners;
  std::vector<Manifold<D>> now, before;

  Room() {
    for (int i = 0; i < 3; ++i) this->ball(at<D>(1.5 * i, 0));
    this->table.sync(false);
  }
  void touch(std::int32_t a, std::int32_t b, std::int32_t part = 0, Real separation = 0) {
    Manifold<D>& m = now.emplace_back();
    m.bodyA = m.shapeA = a, m.bodyB = m.shapeB = b, m.partB = part;
    m.count = 1, m.friction = 9, m.normal[0] = 1, m.points[0].separation = separation;
  }
  void notify(bool again = false, Real lastDt = Real(0.5)) {
    std::vector<PastPair> pairs;
    for (std::span<const Manifold<D>> rest = before; !rest.empty(); rest = rest.subspan(firstPair(rest).size())) {
      pairs.emplace_back(firstPair(rest));
    }
    listeners.notify(token, this->table, {now, pairs, before, lastDt, again});
  }
  void next() { before = std::exchange(now, {}), this->table.events.clear(); }
};

TYPED_TEST(ListenerTableTest, EachListenerReceivesAContactOnce) {
  constexpr int D = TypeParam::D;
  Room<D> r;
  Listener<D> all, first, last, both;
  r.listeners.add(&all), r.listeners.add(&all);
  r.listeners.add(0, &first), r.listeners.add(0, &all);
  r.listeners.add(2, &last);
  r.listeners.add(0, &both), r.listeners.add(1, &both);
  EXPECT_NE(refusalOf([&] { r.listeners.add(nullptr); }), "");
  EXPECT_TRUE(r.listeners.isOf(0, &both));
  EXPECT_FALSE(r.listeners.isOf(0, &last) || r.listeners.isOf(7, &last) || r.listeners.isOf(-1, &last));
  r.touch(0, 1), r.touch(1, 2);
  r.notify();
  EXPECT_EQ(all.told(), "b01 b12 ");
  EXPECT_EQ(first.told(), "b01 ");
  EXPECT_EQ(last.told(), "b12 ");
  EXPECT_EQ(both.told(), "b01 b12 ");
  r.listeners.remove(&all), r.listeners.forget(0);
  r.next(), r.touch(0, 1), r.notify();
  EXPECT_EQ(all.told(), "");
  EXPECT_EQ(first.told(), "");
  EXPECT_EQ(both.told(), "p01 e12 ");
  r.listeners.forgetBodies();
  EXPECT_FALSE(r.listeners.isOf(1, &both));
}

TYPED_TEST(ListenerTableTest, PairsBeginPersistAndEndWithAllTheirParts) {
  constexpr int D = TypeParam::D;
  Room<D> r;
  Listener<D> l;
  r.listeners.add(&l);
  l.vetoes = true;
  r.touch(0, 1, 0), r.touch(0, 1, 1), r.touch(1, 2);
  r.notify();
  EXPECT_EQ(l.told(), "b01 b12 ");
  EXPECT_EQ(l.came.friction, 9);
  for (const Manifold<D>& m : r.now) {
    EXPECT_TRUE(m.begun && m.ignored);
    EXPECT_EQ(m.friction, l.to.friction);
    EXPECT_EQ(m.restitution, l.to.restitution);
  }
  l.vetoes = false;
  r.next(), r.touch(0, 1, 0), r.touch(0, 1, 1), r.touch(0, 2);
  r.notify();
  EXPECT_EQ(l.told(), "p01 b02 e12 ");
  EXPECT_FALSE(r.now[0].begun || r.now[1].begun || r.now[0].ignored || r.now[1].ignored);
  EXPECT_TRUE(r.now[2].begun);
  l.to.friction = -1;
  EXPECT_NE(refusalOf([&] { r.notify(); }), "");
}

// Contacts that are generated again within a step, or again for sleeping bodies: listeners are not called again.
TYPED_TEST(ListenerTableTest, AnswersStayWithinAStepAndForSleepers) {
  constexpr int D = TypeParam::D;
  for (const bool again : {false, true}) {
    Room<D> r;
    Listener<D> l;
    l.vetoes = true;
    r.listeners.add(&l);
    r.touch(0, 1);
    r.notify();
    l.told();
    if (!again) r.table.bodies.awake[0] = r.table.bodies.awake[1] = 0;
    r.next(), r.touch(0, 1), r.touch(1, 2);
    r.notify(again);
    EXPECT_EQ(l.told(), "b12 ");
    EXPECT_TRUE(r.now[0].ignored);
    EXPECT_EQ(r.now[0].friction, l.to.friction);
    r.table.bodies.awake.assign(3, 0), r.table.boxes.markAllStale(), r.table.sync(false);
    r.next(), r.touch(0, 1);
    r.notify();  // no events for sleeping shapes
    EXPECT_EQ(l.told(), "e12 ");
    EXPECT_FALSE(r.now[0].ignored);
  }
}

TYPED_TEST(ListenerTableTest, SleepersGetEvents) {
  constexpr int D = TypeParam::D;
  Room<D> r;
  r.table.bodies.awake[1] = 0;
  r.table.bodies.motion[0].v[0] = 3;
  const auto events = [&] {
    std::vector<std::pair<int, double>> out;
    for (const SleepEvent& e : r.table.events) {
      EXPECT_EQ(e.body, 1);
      out.emplace_back(e.kind, e.speed);
    }
    return out;
  };
  using Told = std::vector<std::pair<int, double>>;
  r.touch(0, 1);
  r.notify();
  EXPECT_EQ(events(), (Told{{SleepEvent::contactBegun, 3}}));
  r.next(), r.touch(0, 1, 0, Real(0.25)), r.notify();
  EXPECT_EQ(events(), (Told{{SleepEvent::separationGrown, 0.5}}));
  r.next(), r.touch(0, 1, 0, Real(0.25)), r.notify();
  EXPECT_EQ(events(), Told{});
  Listener<D> l;
  l.vetoes = true;
  r.listeners.add(&l);
  r.next(), r.touch(0, 1, 0, Real(0.25)), r.notify();
  EXPECT_EQ(events(), (Told{{SleepEvent::contactLost, 0}}));
  r.next(), r.notify();
  EXPECT_EQ(events(), (Told{{SleepEvent::contactLost, 0}}));
}

}}}}}  // namespace lpc::LPC_PRECISION::test::listener_table_test
