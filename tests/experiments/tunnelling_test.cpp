// SPDX-License-Identifier: Zlib
// Bodies that pass through static bodies: on paths with an obvious answer, and in trials of LPC's worlds and of
// engines.
#include "experiments/trial/measure/tunnelling.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "experiments/runner/sweep_file.h"
#include "experiments/trial/trial.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace tunnelling_test { namespace {

using test::at;
using test::body;
using test::expectCaught;
using test::Outcome;
using test::Workspace;
using Path = std::vector<std::pair<double, double>>;

template <class F>
void inBoth(const F& f) {
  f.template operator()<2>();
  f.template operator()<3>();
}

template <int D>
Shape<D> boxOf(double x, double y) {
  Vec<D> half = Vec<D>::Constant(5);
  half[0] = static_cast<Real>(x), half[1] = static_cast<Real>(y);
  return Shape<D>::box(half);
}

// Without stepping, `mover` follows a path past a static body of thickness 2 `half` and height 10 at x = 0.
template <int D, class Counter = Tunnelling<D>>
int led(const Path& path, BodyDef<D> mover, double half, std::uint32_t maskOfWall = ~0u, bool jointed = false) {
  World<D> world;
  BodyDef<D> wall = body<D>(boxOf<D>(half, 5), at<D>(0, 0), BodyType::fixed);
  wall.shapes[0].mask = maskOfWall;
  const BodyHandle w = world.add(wall);
  mover.X_WB.p = at<D>(path[0].first, path[0].second);
  const BodyHandle h = world.add(mover);
  if (jointed) world.add(test::pivot<D>(w, h, mover.X_WB.p));
  Counter seen;
  for (std::size_t i = 1; i < path.size(); ++i) {
    seen.place(world);
    world.setPose(h, {at<D>(path[i].first, path[i].second), {}});
    seen.observe(world);
  }
  seen.finish(world);
  return seen.count();
}
template <int D>
BodyDef<D> ball() {
  return body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0));
}

const Path kShot = {{-4, 0}, {-2, 0}, {3, 0}, {5, 0}};
const Path kShotBack = {{-4, 0}, {3, 0}, {-4, 0}};
const Path kPressed = {{-1, 0}, {-0.5, 0}, {-0.15, 0}, {-0.05, 0}, {0, 0}, {0.05, 0}, {0.15, 0}, {0.3, 0}};
const Path kSunk = {{-1, 0}, {-0.15, 0}, {-0.05, 0}, {0.05, 0}, {-0.05, 0}, {-0.15, 0}, {-1, 0}};
const Path kBounced = {{-9, 0}, {-5, 0}, {-0.5, 0}, {-4, 0}};

TEST(Tunnelling, MeansLeavingOnTheFarSide) {
  inBoth([]<int D>() {
    EXPECT_EQ(led<D>(kShot, ball<D>(), 0.1), 1);
    EXPECT_EQ(led<D>(kShot, ball<D>(), 1e-6), 1);
    EXPECT_EQ(led<D>(kShotBack, ball<D>(), 0.1), 1) << "a body counts once";
    EXPECT_EQ(led<D>(kPressed, ball<D>(), 0.1), 1) << "slowly, too";
    EXPECT_EQ(led<D>(kPressed, ball<D>(), 1e-6), 1);
    EXPECT_EQ(led<D>(kSunk, ball<D>(), 0.1), 0) << "it was pushed back";
    EXPECT_EQ(led<D>(kBounced, ball<D>(), 0.1), 0);
  });
}

// Half a circle around the static body's end, three eighths of a radius away, in steps so long that their chords would
// cut through it.
TEST(Tunnelling, DoesNotIncludeGoingAround) {
  inBoth([]<int D>() {
    for (const int steps : {4, 7, 12, 40}) {
      Path around = {{-0.6, 4}};
      for (int i = 0; i <= steps; ++i) {
        const double angle = std::numbers::pi * i / steps;
        around.emplace_back(-0.6 * std::cos(angle), 5.1 + 0.6 * std::sin(angle));
      }
      around.emplace_back(0.6, 4);
      EXPECT_EQ(led<D>(around, ball<D>(), 0.05), 0) << steps << " steps";
    }
  });
}

TEST(Tunnelling, CountsOnlyBodiesThatCollide) {
  inBoth([]<int D>() {
    EXPECT_EQ(led<D>(kShot, ball<D>(), 0.1, 2), 0) << "the two do not collide";
    EXPECT_EQ(led<D>(kShot, ball<D>(), 0.1, ~0u, true), 0) << "nor do these";
    BodyDef<D> ring = body<D>(boxOf<D>(1, 0.2), at<D>(0, 0));
    ring.shapes[0].X_BS.p = at<D>(0, -7);
    ring.shapes.push_back(ring.shapes[0]);
    ring.shapes[1].X_BS.p = at<D>(0, 7);
    EXPECT_EQ(led<D>(kShot, ring, 0.1), 0) << "the wall stands in the hole";
  });
}

TEST(Tunnelling, AMovedBodyStartsAgain) {
  inBoth([]<int D>() {
    World<D> world;
    const BodyHandle wall = world.add(body<D>(boxOf<D>(0.1, 5), at<D>(0, 0), BodyType::fixed));
    const BodyHandle h = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-3, 0)));
    Tunnelling<D> seen;
    const auto step = [&](double scripted, double moved) {
      world.setPose(h, {at<D>(scripted, 0), {}});
      seen.place(world);
      world.setPose(h, {at<D>(moved, 0), {}});
      seen.observe(world);
    };
    step(-3, -2), step(2, 3);  // a script moves it through
    EXPECT_EQ(seen.count(), 0);
    world.setPose(wall, {at<D>(6, 0), {}});
    step(3, 5), step(5, 4);  // and moves the static body away
    EXPECT_EQ(seen.count(), 0);
    step(4, 8);
    EXPECT_EQ(seen.count(), 1);
    world.remove(h);
    const BodyHandle next = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-3, 0)));
    ASSERT_EQ(next.slot, h.slot);
    seen.place(world), world.setPose(next, {at<D>(9, 0), {}}), seen.observe(world);
    EXPECT_EQ(seen.count(), 2) << "another body in the same slot";
  });
}

// Planted bugs: the result of a ray along each step alone.
template <int D, bool kEnds>
struct RayPerStep {
  void place(const World<D>& world) { before = world.bodies().pose[1].p; }
  void observe(const World<D>& world) {
    const Vec<D> now = world.bodies().pose[1].p;
    const bool enters =
        before != now && !world
                              .rayAll(before, Vec<D>(now - before), 1,
                                      QueryFilter<D>{.accepts = [](BodyHandle h, auto&) { return h.slot == 0; }})
                              .empty();
    const auto inside = [&](const Vec<D>& p) { return std::ranges::count(world.at(p), world.handle(0)) > 0; };
    hits += kEnds ? enters && !inside(before) && !inside(now) : enters;
  }
  void finish(const World<D>&) {}
  int count() const { return std::min(hits, 1); }
  Vec<D> before;
  int hits = 0;
};

TEST(Tunnelling, ARayPerStepIsNotEnough) {
  inBoth([]<int D>() {
    const std::string in = D == 2 ? " in 2D" : " in 3D";
    const int shot = led<D, RayPerStep<D, true>>(kShot, ball<D>(), 0.1);
    EXPECT_EQ(shot, 1);
    const int pressed = led<D, RayPerStep<D, true>>(kPressed, ball<D>(), 0.1);
    expectCaught("who goes through in two steps has not tunnelled" + in, pressed == 1);
    const int sunk = led<D, RayPerStep<D, false>>(kSunk, ball<D>(), 0.1);
    expectCaught("who is pushed back has tunnelled" + in, sunk == 0);
  });
}

// --- in trials ------------------------------------------------------------------------------------------------------

std::string scene(const std::string& bodies) {
  return R"(
name = "tunnelling"
summary = "a ball and a wall, or a box on it"
dimensions = [2, 3]
needs = ["cache", "restitution", "rotation"]
gravity = [0, -10, 0]
dt = 0.01
steps = 100
[[body]]
type = "fixed"
position = [0, -0.5, 0]
shapes = [{ kind = "box", half = [9, 0.5, 9], restitution = 1, friction = 0.5 }]
)" + bodies;
}
const std::string kWall =
    "[[body]]\ntype = \"fixed\"\nposition = [5, 5, 0]\n"
    "shapes = [{ kind = \"box\", half = [0.1, 5, 5], restitution = 1 }]\n";
std::string ballOf(int speed, int height = 5) {
  return "[[body]]\nposition = [0, " + std::to_string(height) + ", 0]\nvelocity = [" + std::to_string(speed) +
         ", 0, 0]\nshapes = [{ kind = \"circle\", radius = 0.25, restitution = 1 }]\n";
}

TrialResult run(const std::string& bodies, int dimension) {
  Workspace w;
  Planner planner;
  WorldCell cell;
  cell.dimension = dimension;
  const PlannedTrial t = planner.world(w.write("scene.toml", scene(bodies)), cell);
  return runTrial(t.request);
}

TEST(Tunnelling, IsCountedInTrials) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    const auto shot = run(kWall + ballOf(400), dimension).metrics;
    EXPECT_EQ(shot.at("tunnelled"), 1);
    expectCaught("where a body ends tells what it went through in " + std::to_string(dimension) + "D",
                 shot.at("fell_through") == 1);
    const auto bounced = run(kWall + ballOf(10), dimension);
    EXPECT_EQ(bounced.metrics.at("tunnelled"), 0);
    EXPECT_LT(bounced.series.at("drift").back(), 6) << "it came back";
    const auto rests =
        run("[[body]]\nposition = [0, 0.5, 0]\nshapes = [{ kind = \"box\", half = [0.5, 0.5, 0.5] }]\n", dimension)
            .metrics;
    EXPECT_EQ(rests.at("tunnelled"), 0);
    EXPECT_EQ(run(kWall + ballOf(400) + ballOf(390, 7) + ballOf(0, 9), dimension).metrics.at("tunnelled"), 2);
  }
}

// Bullet applies no continuous collision unless told to, and the adapter asks Box2D for steps without it.
TEST(Tunnelling, IsMeasuredAlikeForEngines) {
  const Workspace w;
  const std::string file = w.write("scene.toml", scene(kWall + ballOf(400)));
  const auto tunnelled = [&](const std::string& arguments) {
    const Outcome out = w.lpc("run --json " + file + " " + arguments);
    const std::size_t begin = out.text.find('{');
    EXPECT_NE(begin, std::string::npos) << out.text;
    return nlohmann::json::parse(out.text.substr(std::min(begin, out.text.size())))
        .at("metrics")
        .at("tunnelled")
        .dump();
  };
  EXPECT_EQ(tunnelled("--dimension 3"), "1.0");
  if (std::filesystem::exists(LPC_BINARY_DIR "/bin/lpc-engine-worker-f64")) {
    EXPECT_EQ(tunnelled("--dimension 3 --pipeline engine=bullet"), "1.0");
  }
  if (test::kSingle) {
    EXPECT_EQ(tunnelled("--dimension 2 --precision f32 --pipeline engine=box2d"), "1.0");
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::tunnelling_test
