// SPDX-License-Identifier: Zlib
// A cleared world holds nothing and behaves like a new one.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace clear_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
using Clear = std::function<void(World<D>&)>;
template <int D>
void clears(World<D>& world) {
  world.clear();
}

// Planted bugs: what a user could do without World::clear.
template <int D>
void removesEachBody(World<D>& world) {
  for (std::int32_t i = 0; i < world.bodies().size(); ++i) {
    if (world.bodies().used[static_cast<std::size_t>(i)]) world.remove(world.handle(i));
  }
}
template <int D>
void loadsAnEmptyWorld(World<D>& world) {
  std::istringstream empty(saved(World<D>(world.pipeline(), world.settings())));
  world.load(empty);
}

template <int D>
struct Blower final : ForceGenerator<D> {
  void apply(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    for (std::size_t i = 0; i < out.size(); ++i) out[i].force[0] += state.bodies.mass[i];
  }
};

// Everything that a world can hold, including free slots.
template <int D>
void fill(World<D>& world, int n, std::uint64_t seed) {
  addHeap(world, n, seed);
  addJointed(world, at<D>(30, 5));
  world.remove(world.handle(2));
  world.add(ForceDef<D>{.kind = dragKind(1e-3, 1e-4)});  // weak: the smallest body would fly apart
  world.applyForce(world.handle(1), at<D>(5, 5), at<D>(0, 0));
}

// Everything observable of a run as numbers, except free slots at the ends of the tables.
template <int D>
std::vector<Real> told(const World<D>& world) {
  std::vector<Real> out = {world.time(), world.lastDt(), static_cast<Real>(world.stepCount())};
  const auto put = [&](const auto& values) { out.insert(out.end(), values.begin(), values.end()); };
  const Bodies<D>& b = world.bodies();
  for (std::size_t i = 0; i < b.used.size(); ++i) {
    if (!b.used[i]) continue;
    const Vec<D> x = b.pose[i].q * Vec<D>::Unit(0), y = b.pose[i].q * Vec<D>::Unit(1);
    put(std::array{static_cast<Real>(i), static_cast<Real>(b.awake[i])});
    put(b.pose[i].p), put(x), put(y), put(b.motion[i].v), put(b.motion[i].w), put(b.sleep[i]), put(b.solver[i]);
  }
  for (const Manifold<D>& m : world.manifolds()) {
    put(std::array{static_cast<Real>(m.shapeA), static_cast<Real>(m.shapeB), static_cast<Real>(m.count)});
    for (const ContactPoint<D>& c : m.points) put(c.impulse), put(c.memory), out.push_back(c.separation);
  }
  for (const JointRecord<D>& j : world.joints()) put(j.impulse), out.push_back(static_cast<Real>(j.broken));
  return out;
}

// A second run, shorter or longer than the first, compared with that of a new world.
template <int D>
bool isAsNew(const std::string& pipeline, const Clear<D>& clear, int before, int after) {
  WorldSettings<D> settings;
  settings.gravity *= Real(0.7), settings.mixing.friction = MixRule::minimum;
  World<D> cleared(Pipeline::parse(pipeline), settings);
  cleared.add(std::make_shared<Blower<D>>());
  fill(cleared, before, 1);
  for (int i = 0; i < 40; ++i) cleared.step(kDt);
  clear(cleared);
  World<D> fresh(Pipeline::parse(pipeline), settings);
  for (World<D>* w : {&cleared, &fresh}) fill(*w, after, 2);
  for (int i = 0; i < 50; ++i) {
    cleared.step(kDt), fresh.step(kDt);
    if (told(cleared) != told(fresh)) return false;
  }
  return fresh.manifolds().size() > 0;
}
template <int D>
void asNew() {
  for (const std::string& pipeline : everyPipeline<D>()) {
    EXPECT_TRUE(isAsNew<D>(pipeline, clears<D>, 8, 4)) << pipeline;
  }
  EXPECT_TRUE(isAsNew<D>("", clears<D>, 3, 9));
  expectCaught("a world is cleared by removing each body", isAsNew<D>("", removesEachBody<D>, 8, 4));
}
TEST(ClearTest, AWorldIsAsNew2) { asNew<2>(); }
TEST(ClearTest, AWorldIsAsNew3) { asNew<3>(); }

template <int D>
struct Ends final : ContactListener<D> {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  int begun = 0;
  bool begin(const World<D>&, const Manifold<D>&) override { return ++begun, true; }
  void end(const World<D>& world, const Manifold<D>& m) override {
    EXPECT_TRUE(world.valid(world.handle(m.bodyA)) && world.valid(world.handle(m.bodyB)));
    pairs.emplace_back(m.bodyA, m.bodyB);
  }
};

// Clearing reports the same ends as removing each body in slot order. The world's listener stays registered; the body's
// does not.
template <int D>
bool tellsEnds(const Clear<D>& clear) {
  World<D> cleared, emptied;
  Ends<D> of[2], ofBody;
  for (World<D>* w : {&cleared, &emptied}) fill(*w, 8, 3);
  cleared.addListener(&of[0]), emptied.addListener(&of[1]), cleared.addListener(cleared.handle(0), &ofBody);
  for (int i = 0; i < 60; ++i) cleared.step(kDt), emptied.step(kDt);
  for (Ends<D>& e : of) e.pairs.clear();
  clear(cleared), removesEachBody(emptied);
  const int heard = ofBody.begun;
  const bool same = of[0].pairs == of[1].pairs && !of[0].pairs.empty() && ofBody.pairs.size() > 0;
  fill(cleared, 8, 3);
  const int begun = of[0].begun;
  for (int i = 0; i < 60; ++i) cleared.step(kDt);
  return same && ofBody.begun == heard && of[0].begun > begun;
}
template <int D>
void ends() {
  EXPECT_TRUE(tellsEnds<D>(clears<D>));
  expectCaught("a world is cleared and no end is told", tellsEnds<D>(loadsAnEmptyWorld<D>));
}
TEST(ClearTest, ClearingReportsTheSameEndsAsRemoving) { ends<2>(), ends<3>(); }

template <int D>
bool handlesAreNobodys(const Clear<D>& clear) {
  World<D> world;
  std::vector<BodyHandle> bodies;
  JointHandle joint;
  ForceHandle force;
  const auto add = [&] {
    for (int i = 0; i < 5; ++i) bodies.push_back(world.add(body<D>(Shape<D>::sphere(1), at<D>(3 * i, 0))));
    joint = world.add(pivot<D>(bodies.end()[-1], bodies.end()[-2], at<D>(0, 0)));
    force = world.add(ForceDef<D>{.kind = dragKind(1, 1), .bodyB = bodies.back()});
  };
  const auto isRefused = [&](const auto& f) {
    try {
      f();
      return false;
    } catch (const UserError&) {
      return true;
    }
  };
  add();
  const JointHandle oldJoint = joint;
  const ForceHandle oldForce = force;
  world.step(kDt);
  clear(world);
  bool none =
      world.bodyCount() == 0 && world.manifolds().empty() && world.overlap({at<D>(-9, -9), at<D>(99, 9)}).empty();
  add();
  for (std::size_t i = 0; i < 5; ++i) none = none && !world.valid(bodies[i]) && world.valid(bodies[5 + i]);
  return none && isRefused([&] { world.remove(oldJoint); }) && isRefused([&] { world.remove(oldForce); });
}
template <int D>
void handles() {
  EXPECT_TRUE(handlesAreNobodys<D>(clears<D>));
  expectCaught("a world is cleared and old handles are of new bodies", handlesAreNobodys<D>(loadsAnEmptyWorld<D>));
}
TEST(ClearTest, OldHandlesStayInvalid) { handles<2>(), handles<3>(); }

template <int D>
std::uint64_t visitsOfClearing(int n, const Clear<D>& clear) {
  World<D> world;
  for (const BodyHandle& h : addRow(world, n)) {
    world.add(pivot<D>(BodyHandle{}, h, world.pose(h).p));
    world.add(ForceDef<D>{.kind = dragKind(1, 1), .bodyB = h});
  }
  world.step(kDt);
  clear(world);
  world.step(kDt);
  return world.profiler().frame().work[WorkCount::eventVisits];
}
// Visits each body, shape, joint, force and contact once.
template <int D>
bool isLinear(const Clear<D>& clear) {
  for (const int n : {20, 200}) {
    if (visitsOfClearing<D>(n, clear) > static_cast<std::uint64_t>(6 * (n + 1))) return false;
  }
  return true;
}
template <int D>
void costs() {
  EXPECT_TRUE(isLinear<D>(clears<D>));
  expectCaught("a world is cleared body by body", isLinear<D>(removesEachBody<D>));
}
TEST(ClearTest, CostIsLinear) { costs<2>(), costs<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::clear_test
