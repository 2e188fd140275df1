// SPDX-License-Identifier: Zlib
// User data of bodies and shapes: kept wherever they go, and never read.
#include <gtest/gtest.h>

#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace user_data_test { namespace {

constexpr std::uint64_t kLarge = ~0ull - 4;  // more than a double can hold

template <int D>
BodyDef<D> marked(double x, double y, std::uint64_t data) {
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(x, y));
  def.userData = data;
  def.shapes[0].userData = data + 1;
  def.shapes.push_back({.shape = Shape<D>::sphere(Real(0.1)), .userData = data + 2});
  return def;
}

// By slot: bodies, then shapes.
template <int D>
std::vector<std::uint64_t> dataOf(const World<D>& world) {
  std::vector<std::uint64_t> out = world.bodies().userData;
  for (const ShapeRecord<D>& s : world.shapes()) out.push_back(s.userData);
  return out;
}
using Data = std::vector<std::uint64_t>;

template <int D>
void livesAsItsBodyDoes() {
  World<D> world;
  const BodyHandle a = world.add(marked<D>(0, 3, 10)), b = world.add(marked<D>(5, 3, kLarge - 2));
  EXPECT_EQ(dataOf(world), (Data{10, kLarge - 2, 11, 12, kLarge - 1, kLarge}));
  const std::uint64_t hash = world.hash();
  world.setUserData(a, 20);
  EXPECT_EQ(world.userData(a), 20u);
  EXPECT_EQ(world.hash(), hash) << "it is no state of the simulation";

  std::stringstream bytes;
  world.save(bytes);
  World<D> loaded;
  loaded.load(bytes);
  EXPECT_EQ(dataOf(loaded), (Data{20, kLarge - 2, 11, 12, kLarge - 1, kLarge}));
  EXPECT_EQ(loaded.userData(b), kLarge - 2);

  world.remove(a);
  EXPECT_EQ(dataOf(world), (Data{0, kLarge - 2, 0, 0, kLarge - 1, kLarge}));
  EXPECT_THROW(world.userData(a), UserError);
  EXPECT_THROW(world.setUserData(a, 1), UserError);
  BodyDef<D> plain = body<D>(Shape<D>::sphere(1), at<D>(0, 9));
  EXPECT_EQ(world.userData(world.add(plain)), 0u) << "a slot that is used again remembers nothing";
}
TEST(UserData, LivesAsLongAsItsBody) { livesAsItsBodyDoes<2>(), livesAsItsBodyDoes<3>(); }

// Every contact event gives access to the data of both bodies, also of a body that is being removed.
template <int D>
class Names final : public ContactListener<D> {
 public:
  std::string text;
  bool begin(const World<D>& world, const Manifold<D>& m) override { return note('b', world, m); }
  bool persist(const World<D>& world, const Manifold<D>& m) override { return note('p', world, m); }
  void end(const World<D>& world, const Manifold<D>& last) override { note('e', world, last); }

 private:
  bool note(char event, const World<D>& world, const Manifold<D>& m) {
    text += event;
    for (const std::int32_t body : {m.bodyA, m.bodyB}) {
      text += ' ' + std::to_string(world.bodies().userData[static_cast<std::size_t>(body)]);
    }
    for (const std::int32_t shape : {m.shapeA, m.shapeB}) {
      text += ' ' + std::to_string(world.shapes()[static_cast<std::size_t>(shape)].userData);
    }
    text += ';';
    return true;
  }
};
template <int D>
void eventsLeadToIt() {
  World<D> world(Pipeline{}, {.gravity = Vec<D>::Zero()});
  const BodyHandle a = world.add(marked<D>(0, 0, 10));
  const BodyHandle b = world.add(marked<D>(0.99, 0, 20));
  Names<D> names;
  world.addListener(&names);
  world.step(0);
  EXPECT_EQ(names.text, "") << "no time, no step";
  world.step(Real(1) / 60);
  EXPECT_EQ(names.text, "b 10 20 11 21;");
  world.setUserData(b, 30);
  world.step(Real(1) / 60);
  EXPECT_EQ(names.text, "b 10 20 11 21;p 10 30 11 21;");
  names.text.clear();
  world.remove(a);
  EXPECT_EQ(names.text, "e 10 30 11 21;");
  EXPECT_FALSE(world.valid(a));
}
TEST(UserData, ContactEventsGiveAccessToIt) { eventsLeadToIt<2>(), eventsLeadToIt<3>(); }

// A step with user data equals a step without it, bit by bit.
template <int D>
void changesNothing() {
  World<D> plain, marked;
  addHeap(plain, 6, 3), addHeap(marked, 6, 3);
  for (int i = 0; i < 9; ++i) marked.setUserData(marked.handle(i), kLarge);
  for (int i = 0; i < 30; ++i) plain.step(Real(1) / 60), marked.step(Real(1) / 60);
  EXPECT_EQ(plain.hash(), marked.hash());
}
TEST(UserData, ChangesNothing) { changesNothing<2>(), changesNothing<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::user_data_test
