// SPDX-License-Identifier: Zlib
// Contacts in SIMD lanes, with each instruction set of this processor, give the same bits as one contact at a time in
// the same order, and so do bodies that turn in lanes. Most contacts must lie in full blocks; otherwise the test would
// prove nothing about lanes.
#include "algorithms/solver/lanes/contact_lanes.h"

#include <gtest/gtest.h>

#include <cstring>

#include "algorithms/solver/lanes/rotation_lanes.h"
#include "tests/draw.h"
#include "tests/each_target.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_lanes_test {

using namespace solver;

// Rows of boxes on the ground and on each other, without friction in one world of four; a heap with a pendulum; jointed
// bodies; a kinematic plate, a pinned bar, a body that cannot rotate, and a plate that touches more bodies than there
// are colours.
template <int D>
void build(World<D>& world, std::uint64_t seed) {
  Random random(seed);
  const Real friction = random.below(4) == 0 ? Real(0) : Real(0.6);
  const auto add = [&](BodyDef<D> def) {
    for (ShapeDef<D>& shape : def.shapes) {
      shape.friction = friction;
      if (random.below(4) == 0) shape.restitution = Real(0.5);
    }
    return world.add(def);
  };
  addHeap<D>(world, 15, seed, at<D>(60, 0));
  addJointed<D>(world, at<D>(-60, 3));
  Vec<D> plate = Vec<D>::Constant(2);
  plate[0] = 30, plate[1] = Real(0.5);
  add(body<D>(Shape<D>::box(plate), at<D>(0, -0.5), BodyType::fixed));
  BodyDef<D> moving = body<D>(Shape<D>::box(plate), at<D>(0, -20.5), BodyType::kinematic);
  moving.velocity[0] = Real(0.3);
  add(moving);
  for (int i = 0; i < 20; ++i) {
    for (int row = 0; row < 3; ++row) {
      const double x = 1.2 * i - 12 + random.uniform(0, 0.1);
      BodyDef<D> box = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(x, 0.5 + row));
      if (random.below(8) == 0) box.rotatable = false;
      if (random.below(16) == 0) box.pinned = true;
      box.velocity[0] = static_cast<Real>(random.uniform(-1, 1));
      add(box);
    }
    add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(1.2 * i - 12, -19.5)));
  }
  Vec<D> wide = Vec<D>::Constant(1);
  wide[0] = 50, wide[1] = Real(0.2);
  add(body<D>(Shape<D>::box(wide), at<D>(0, -40)));
  for (int i = 0; i < 80; ++i) {
    add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.3))), at<D>(i - 40, -39.5 - random.uniform(0, 0.01))));
  }
}

// The bits of all poses, velocities, impulses and loads after some steps.
template <int D>
std::vector<Real> run(const std::string& solver, std::uint64_t seed, PhysicsModel model = {}) {
  Pipeline pipeline;
  pipeline[StageKind::solver] = Spec::parse(solver);
  WorldSettings<D> settings;
  settings.model = model;
  World<D> world(pipeline, settings);
  build(world, seed);
  for (int i = 0; i < 12; ++i) world.step(Real(1) / 60);
  std::vector<Real> out;
  const auto keep = [&](const auto& numbers) {
    for (std::size_t k = 0; k < sizeof numbers / sizeof(Real); ++k)
      out.push_back(reinterpret_cast<const Real*>(&numbers)[k]);
  };
  for (int i = 0; i < world.bodies().size(); ++i) keep(world.bodies().pose[i]), keep(world.bodies().motion[i]);
  for (const Manifold<D>& m : world.manifolds()) {
    for (int k = 0; k < m.count; ++k) keep(m.points[k].impulse), out.push_back(m.points[k].load);
  }
  return out;
}

bool sameBits(const std::vector<Real>& a, const std::vector<Real>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

const char* const kSolvers[] = {"soft_step",
                                "soft_step{arms=as_made}",
                                "soft_step{contacts=substep}",
                                "tgs",
                                "tgs_ngs",
                                "tgs_ngs{arms=detection}",
                                "split_solver{velocity=catto",
                                "split_solver{velocity=catto{relaxation=1.3}"};

// Adds `order=coloured` and the choice of lanes to a solver's text.
std::string withLanes(std::string solver, const char* lanes) {
  const std::string choice = std::string("lanes=") + lanes;
  if (const std::size_t at = solver.find("catto"); at != std::string::npos) {
    const bool has = solver.back() == '}';
    if (has) solver.pop_back();
    return solver + (has ? "," : "{") + choice + "},order=coloured}";
  }
  const bool has = solver.back() == '}';
  if (has) solver.pop_back();
  return solver + (has ? "," : "{") + "order=coloured," + choice + "}";
}

template <int D>
void expectBitsOfOneLane() {
  PhysicsModel plain;
  plain.rotation = plain.friction = false;
  for (const char* solver : kSolvers) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const PhysicsModel model = seed == 2 ? plain : PhysicsModel{};
      const std::vector<Real> one = run<D>(withLanes(solver, "scalar"), seed, model);
      forEachTarget([&](std::int64_t target) {
        EXPECT_TRUE(sameBits(run<D>(withLanes(solver, "auto"), seed, model), one))
            << solver << " by " << hwy::TargetName(target) << ", world " << seed << ", " << D << "D";
      });
    }
  }
}

TEST(ContactLanes, HaveTheBitsOfOneLane) { expectBitsOfOneLane<2>(), expectBitsOfOneLane<3>(); }

template <int D>
struct Problem {
  Bodies<D> bodies;
  std::vector<Manifold<D>> manifolds;
  std::vector<int> active, order, colours;
  WorkDone work;

  Problem() {
    World<D> world(Pipeline{}, {});
    build(world, 1);
    for (int i = 0; i < 3; ++i) world.step(Real(1) / 60);
    bodies = world.bodies();
    manifolds.assign(world.manifolds().begin(), world.manifolds().end());
    for (std::size_t i = 0; i < manifolds.size(); ++i) active.push_back(static_cast<int>(i));
    ContactGraph<D> graph;
    graph.reset(bodies, manifolds, {}, work);
    graph.colour(active, order, colours);
  }

  /// Velocities after three sweeps.
  std::vector<Real> swept(int lanes, ContactBlocks<D>& blocks) {
    blocks.arrange(bodies, manifolds, order, colours, lanes, true);
    blocks.loadFixed(bodies, [&](std::int32_t i) { return bodies.pose[i].p; });
    blocks.loadPose(bodies), blocks.loadMotion(bodies.motion);
    prepareBlocks(blocks, manifolds, 0);
    for (int i = 0; i < 3; ++i) sweepBlocks(blocks, {.h = Real(1) / 60});
    IndexedVector<Motion<D>> motion = bodies.motion;
    blocks.storeMotion(bodies, motion);
    std::vector<Real> out;
    for (const Motion<D>& m : motion) {
      out.insert(out.end(), m.v.begin(), m.v.end()), out.insert(out.end(), m.w.begin(), m.w.end());
    }
    return out;
  }
};

template <int D>
void expectFullBlocks() {
  Problem<D> p;
  ContactBlocks<D> blocks, one;
  const int lanes = contactLanes();
  EXPECT_TRUE(sameBits(p.swept(lanes, blocks), p.swept(1, one)));
  EXPECT_EQ(one.blocks.size(), p.active.size());
  std::size_t wide = 0, alone = 0;
  for (const ContactPlace& at : blocks.places) ++(at.lanes > 1 ? wide : alone);
  EXPECT_EQ(wide + alone, p.active.size());
  if (lanes == 1) return;  // a processor without lanes
  EXPECT_GT(blocks.places.size(), 0.6 * lanes * static_cast<double>(blocks.blocks.size() - alone));
  // The plate with 80 boxes has more contacts than there are colours: the others are alone.
  EXPECT_GE(p.colours.size(), static_cast<std::size_t>(ContactGraph<D>::kGreedyColours) + 10);
  EXPECT_GE(alone, std::size_t{10});
  EXPECT_GT(wide, p.active.size() * 2 / 5);  // each of these many colours may leave one contact over
  p.order = p.active, p.colours = {0, static_cast<int>(p.active.size())};
  expectCaught("contacts of one colour that share bodies", sameBits(p.swept(lanes, blocks), p.swept(1, one)));
}

TEST(ContactLanes, FillTheirBlocks) { expectFullBlocks<2>(), expectFullBlocks<3>(); }

// A listener gives friction to every pair.
template <int D>
struct Roughener final : ContactListener<D> {
  void mix(const World<D>&, const Manifold<D>&, PairMaterial& material) override { material.friction = Real(0.9); }
};

// Without friction in the model, nothing slows bodies that bounce, whatever a listener says. Blocks keep the numbers of
// earlier steps in memory that a frictionless manifold does not use.
template <int D>
void expectNoFriction(const std::string& solver) {
  const auto speeds = [&](bool rough) {
    Pipeline pipeline;
    pipeline[StageKind::solver] = Spec::parse(solver);
    WorldSettings<D> settings;
    settings.model.friction = false;
    World<D> world(pipeline, settings);
    Roughener<D> listener;
    if (rough) world.addListener(&listener);
    for (int i = 0; i < 12; ++i) {
      const Shape<D> shape = i % 2 ? Shape<D>::sphere(Real(0.5)) : Shape<D>::box(Vec<D>::Constant(Real(0.5)));
      BodyDef<D> def = body<D>(shape, at<D>(2 * i - 12, 0.6 + 0.2 * i));
      def.velocity[0] = 1, def.shapes[0].restitution = Real(0.5);
      world.add(def);
    }
    addGround(world);  // last: so the first body of each pair moves
    std::vector<Real> out;
    for (int i = 0; i < 100; ++i) {  // the number of contacts changes, and with it the place of each number
      world.step(Real(1) / 60);
      for (int k = 0; k < world.bodies().size(); ++k) out.push_back(world.bodies().motion[k].v[0]);
    }
    return out;
  };
  EXPECT_TRUE(sameBits(speeds(true), speeds(false))) << solver << ' ' << D << 'D';
}

TEST(ContactLanes, UseNoFrictionOfAnotherStep) {
  for (const char* solver : {"soft_step", "soft_step{order=coloured}", "tgs", "tgs_ngs", "pgs_soft"}) {
    expectNoFriction<2>(solver), expectNoFriction<3>(solver);
  }
}

template <int D>
void expectTurnsOfOneBody() {
  Random random(3);
  std::vector<Pose<D>> start(203);
  std::vector<Motion<D>> motion(start.size());
  std::vector<std::int32_t> bodies;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double speeds[] = {0, 1e-200, 1e-9, 0.1, 3, 40, 1e6};
    Ang<D> turn;
    for (Real& x : turn) x = static_cast<Real>(random.uniform(-3, 3));
    start[i].q = integrateRotation(Rot<D>{}, turn);
    const double speed = speeds[i % 50 == 0 ? 5 + random.below(2) : random.below(5)];
    for (Real& x : motion[i].w) x = static_cast<Real>(random.uniform(-speed, speed));
    if (i % 7 != 3) bodies.push_back(static_cast<std::int32_t>(i));
  }
  std::vector<Pose<D>> wanted = start;
  const Real dt = Real(1) / 60;
  for (const std::int32_t slot : bodies) {
    const auto i = static_cast<std::size_t>(slot);
    if (motion[i].w.squaredNorm() > 0) wanted[i].q = integrateRotation(start[i].q, Ang<D>(dt * motion[i].w));
  }
  const auto differences = [&](Real time) {
    std::vector<Pose<D>> pose = start;
    turnBodies(pose, motion, bodies, time);
    int out = 0;
    for (std::size_t i = 0; i < pose.size(); ++i) out += std::memcmp(&pose[i], &wanted[i], sizeof pose[i]) != 0;
    return out;
  };
  forEachTarget(
      [&](std::int64_t target) { EXPECT_EQ(differences(dt), 0) << hwy::TargetName(target) << ", " << D << 'D'; });
  expectCaught("a time that is one rounding longer", differences(dt * (1 + 2 * kEps)) == 0);
}

TEST(RotationLanes, HaveTheBitsOfOneBody) { expectTurnsOfOneBody<2>(), expectTurnsOfOneBody<3>(); }

}}}}  // namespace lpc::LPC_PRECISION::test::contact_lanes_test
