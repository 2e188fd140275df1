// SPDX-License-Identifier: Zlib
// Solvers that make contacts again within a step (contacts=substep): what a step has done to a contact stays known,
// also where no cache keeps contacts and where features change.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <sstream>

#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace remade_contacts_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr const char* kSolvers[] = {"soft_step", "tgs", "tgs_ngs", "xpbd"};

// Calls f(pipeline, settings) for caches that remember contacts from step to step, and without. A pipeline lacks the
// solver's parameters.
template <class Settings, class F>
void forMemories(const F& f) {
  for (const std::string solver : kSolvers) {
    for (const std::string cache : {"by_feature", "by_distance", "recycling", "none"}) {
      for (const bool keeps : {true, false}) {
        if (!keeps && cache != "by_feature") continue;
        Settings settings;
        settings.model.cache = keeps, settings.model.sleeping = false;
        const std::string rest = " cache=" + cache;
        SCOPED_TRACE(solver + rest + (keeps ? "" : ", model without a cache"));
        f("solver=" + solver + "{contacts=substep}" + rest, "solver=" + solver + rest, settings);
      }
    }
  }
}

// A body falls on a floor from 0.8 m above it. Returns the greatest height of its centre after the bounce, m.
template <int D>
double rebound(const std::string& pipeline, const WorldSettings<D>& settings, const Shape<D>& shape) {
  World<D> world(Pipeline::parse(pipeline), settings);
  BodyDef<D> floor = body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed);
  BodyDef<D> def = body<D>(shape, at<D>(0, 1.3));
  floor.shapes[0].restitution = def.shapes[0].restitution = Real(0.9);
  world.add(floor);
  const BodyHandle h = world.add(def);
  double highest = 0;
  bool rises = false;
  for (int i = 0; i < 60; ++i) {
    world.step(kDt);
    rises = rises || world.motion(h).v[1] > Real(0.5);
    if (rises) highest = std::max(highest, double(world.pose(h).p[1]));
  }
  return highest;
}

// The height after a bounce does not depend on how often contacts are made.
template <int D>
void bounces() {
  forMemories<WorldSettings<D>>(
      [](const std::string& often, const std::string& once, const WorldSettings<D>& settings) {
        for (const Shape<D>& shape : {Shape<D>::sphere(Real(0.5)), Shape<D>::box(Vec<D>::Constant(Real(0.5)))}) {
          const double expected = rebound<D>(once, settings, shape);
          EXPECT_GT(expected, 0.8);
          EXPECT_NEAR(rebound<D>(often, settings, shape), expected, 0.05) << shapeKindName(shape.kind());
        }
      });
}
TEST(RemadeContacts, BounceAsThoseOfAStep2) { bounces<2>(); }
TEST(RemadeContacts, BounceAsThoseOfAStep3) { bounces<3>(); }

// A polygon of 24 corners rolls, in 3D a prism: its contacts change their features within a step. In each step its
// loads change its momentum.
template <int D>
void accounts() {
  forMemories<WorldSettings<D>>([](const std::string& often, const std::string&, const WorldSettings<D>& settings) {
    World<D> world(Pipeline::parse(often), settings);
    world.add(body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed));
    std::vector<Vec<D>> corners;
    for (int i = 0; i < 24; ++i) {
      const double a = i * 6.283185307179586 / 24;
      for (const double z : {-0.2, 0.2}) {
        if (D == 3 || z > 0) corners.push_back(at<D>(0.5 * std::cos(a), 0.5 * std::sin(a), z));
      }
    }
    BodyDef<D> def = body<D>(Shape<D>::polytope(corners), at<D>(0, 0.5));
    def.velocity = at<D>(3, 0), def.angularVelocity[kAngDim<D> - 1] = -6;
    const BodyHandle wheel = world.add(def);
    const double mass = double(world.mass(wheel)), g = -double(settings.gravity[1]);
    std::set<std::uint64_t> features;
    for (int i = 0; i < 40; ++i) {
      const double before = double(world.motion(wheel).v[1]);
      world.step(kDt);
      double load = 0;
      for (const Manifold<D>& m : world.manifolds()) {
        for (int k = 0; k < m.count; ++k) load += double(m.points[k].load), features.insert(m.points[k].feature);
      }
      const double change = mass * (double(world.motion(wheel).v[1]) - before + g * double(kDt));
      EXPECT_NEAR(load, change, 1e-6 * mass) << "step " << i;
    }
    EXPECT_GT(features.size(), 10u);
  });
}
TEST(RemadeContacts, LoadsAreTheMomentum2) { accounts<2>(); }
TEST(RemadeContacts, LoadsAreTheMomentum3) { accounts<3>(); }

/// Lets dynamic bodies sleep, and records how fast supports go away.
template <int D>
class Recorder final : public SleepPolicy<D> {
 public:
  explicit Recorder(std::vector<double>& speeds) : m_speeds(speeds) {}
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>>) override {
    for (const SleepEvent& e : in.events) {
      if (e.kind == SleepEvent::separationGrown) m_speeds.push_back(e.speed);
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (in.bodies.type[i] == BodyType::dynamic) awake[i] = 0;
    }
  }

 private:
  std::vector<double>& m_speeds;
};

// The speed of a support that goes away, which wakes sleepers, does not depend on how often contacts are made.
template <int D>
void separates() {
  for (const std::string solver : {"soft_step{contacts=substep}", "xpbd{contacts=substep}", "soft_step"}) {
    std::vector<double> speeds;
    StageSet<D> stages{Pipeline::parse("solver=" + solver)};
    stages.set(std::make_unique<Recorder<D>>(speeds), "recorder");
    World<D> world(std::move(stages));
    world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5)));
    BodyDef<D> floor = body<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(0, -1), BodyType::kinematic);
    floor.velocity = at<D>(0, -0.125);
    world.add(floor);
    for (int i = 0; i < 2; ++i) world.step(kDt);
    std::ostringstream out;
    world.save(out);
    speeds.clear();
    world.step(kDt);
    ASSERT_EQ(speeds.size(), 1u) << solver;
    EXPECT_NEAR(speeds[0], 0.125, 1e-3) << solver;
    std::istringstream in(out.str());  // also after a save
    world.load(in);
    world.step(kDt);
    ASSERT_EQ(speeds.size(), 2u) << solver;
    EXPECT_EQ(speeds[1], speeds[0]) << solver;
  }
}
TEST(RemadeContacts, TellHowFastSupportsLeave) { separates<2>(), separates<3>(); }

}}}}}  // namespace lpc::LPC_PRECISION::test::remade_contacts_test
