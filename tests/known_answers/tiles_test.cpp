// SPDX-License-Identifier: Zlib
// Bodies that slide without friction over floors of flush parts: nothing slows them and nothing lifts them. Steps,
// walls and gaps between parts still act.
#include <gtest/gtest.h>

#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/surfaces.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace tiles_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr double kTile = 0.7, kFrom = -2.8, kTo = 9.8;  // m
constexpr Real kRound = sizeof(Real) == 8 ? Real(1e-12) : Real(0);

template <int D>
BodyDef<D> slippery(const Shape<D>& shape, const Vec<D>& place, BodyType type = BodyType::fixed) {
  BodyDef<D> def = body<D>(shape, place, type);
  def.shapes[0].friction = 0, def.canSleep = false;
  return def;
}

// A level surface from x0 to x1 m, 4 m wide in 3D, of two segments or four triangles.
template <int D>
Shape<D> levelPiece(double x0, double x1) {
  const double xs[] = {x1, (x0 + x1) / 2, x0};
  if constexpr (D == 2) {
    return Shape<2>::chain(std::vector<Vec<2>>{at<2>(xs[0], 0), at<2>(xs[1], 0), at<2>(xs[2], 0)}, false);
  } else {
    std::vector<Vec<3>> points;
    for (const double x : xs) points.push_back(at<3>(x, 0, -2)), points.push_back(at<3>(x, 0, 2));
    return Shape<3>::mesh(points, std::vector<std::array<int, 3>>{{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}});
  }
}

enum class Floor { boxes, bond, shapes, compound, surfaces, surfacesAndBoxes };
constexpr Floor kFloors[] = {Floor::boxes,    Floor::bond,     Floor::shapes,
                             Floor::compound, Floor::surfaces, Floor::surfacesAndBoxes};

// The tops are level up to rounding.
template <int D>
std::vector<BodyDef<D>> floorOf(Floor kind) {
  std::vector<BodyDef<D>> out;
  BodyDef<D> whole;
  whole.type = BodyType::fixed;
  std::vector<ShapePart<D>> parts;
  int i = 0;
  for (double x = kFrom; x < kTo - kTile / 2; x += kTile, ++i) {
    const double height = double(kRound) * (i % 3 - 1);
    if (kind == Floor::surfaces || (kind == Floor::surfacesAndBoxes && i % 2)) {
      out.push_back(slippery<D>(levelPiece<D>(x, x + kTile), at<D>(0, height)));
      continue;
    }
    const int rows = kind == Floor::bond && D == 3 ? 4 : 1;
    for (int k = 0; k < rows; ++k) {
      const double width = 4.0 / rows, thick = i % 2 ? 1 : 0.5, shift = k % 2 ? 0.4 * kTile : 0;
      const Vec<D> middle = at<D>(x + kTile / 2 - shift, height - thick / 2, width * (k + 0.5) - 2);
      const Shape<D> box = Shape<D>::box(at<D>(kTile / 2, thick / 2, width / 2));
      switch (kind) {
        case Floor::boxes:
        case Floor::bond:
        case Floor::surfacesAndBoxes:
          out.push_back(slippery<D>(box, middle));
          break;
        case Floor::shapes:
          whole.shapes.push_back({.shape = box, .X_BS = {middle, {}}, .friction = 0});
          break;
        case Floor::compound:
          parts.push_back({box, {middle, {}}});
          break;
        case Floor::surfaces:
          break;
      }
    }
  }
  if (!whole.shapes.empty()) out.push_back(whole);
  if (!parts.empty()) out.push_back(slippery<D>(Shape<D>::compound(parts), Vec<D>::Zero()));
  return out;
}

struct Slide {
  double lost = 0;    // the largest change of the velocity along the floor (m/s)
  double height = 0;  // the largest change of height (m)
  double turned = 0;  // the largest angular speed (rad/s)
};

// 5 m at 5 m/s. The whole world is turned by `turn`.
template <int D>
Slide slide(const std::string& pipeline, const std::vector<BodyDef<D>>& floor, const Shape<D>& mover, double height,
            const Rot<D>& turn) {
  World<D> world(Pipeline::parse(pipeline));
  const Pose<D> X{turn * at<D>(3, -2, 1), turn};
  world.setGravity(turn * at<D>(0, -9.81));
  for (BodyDef<D> def : floor) {
    def.X_WB = X * def.X_WB;
    world.add(def);
  }
  BodyDef<D> def = slippery<D>(mover, at<D>(0, height, 0.013), BodyType::dynamic);
  def.X_WB = X * def.X_WB;
  const Vec<D> up = turn * at<D>(0, 1), start = def.velocity = turn * at<D>(4.9, 0, 0.8);
  const BodyHandle handle = world.add(def);
  Slide out;
  for (int i = 0; i < 60; ++i) {
    world.step(kDt);
    const Motion<D> now = world.motion(handle);
    const Vec<D> change = now.v - start;
    out.lost = std::max(out.lost, double((change - change.dot(up) * up).norm()));
    out.height = std::max(out.height, std::abs(double((world.pose(handle).p - def.X_WB.p).dot(up))));
    out.turned = std::max(out.turned, double(now.w.norm()));
  }
  return out;
}

template <int D>
Rot<D> someTurn() {
  if constexpr (D == 2) return Rot<2>::angle(Real(0.7));
  if constexpr (D == 3) return Rot<3>::vector(at<3>(0.5, -0.4, 0.9));
}

template <int D, class F>
void forMovers(const F& f) {
  f("box", Shape<D>::box(at<D>(0.4, 0.3, 0.35)), 0.3);
  f("rounded box", Shape<D>::box(at<D>(0.3, 0.2, 0.25), Real(0.1)), 0.3);
  f("ball", Shape<D>::sphere(Real(0.3)), 0.3);
  f("capsule", Shape<D>::capsule(Real(0.4), Real(0.25)), 0.25);
  std::vector<Vec<D>> corners;
  for (const double x : {-0.5, 0.3, 0.6}) {
    for (const double z : {-0.3, 0.3}) {
      if (D == 3 || z > 0) corners.push_back(at<D>(x, 0, z)), corners.push_back(at<D>(0.5 * x, 0.4, z));
    }
  }
  const MassProperties<D> mass = massProperties(Shape<D>::polytope(corners), Real(1));
  for (Vec<D>& c : corners) c -= mass.center;
  f("hull", Shape<D>::polytope(corners), double(mass.center[1]));
}

template <int D>
void nothingSlowsWithEveryGenerator() {
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    if (!competes(*r)) continue;
    // A single point cannot keep faces from rocking, on any ground.
    const auto& failures = r->info.failures;
    const bool onePoint = std::any_of(failures.begin(), failures.end(), [](const FailureMode& f) {
      return std::string_view(f.test) == "Contacts.FastFacesSpanThePatch";
    });
    forMovers<D>([&](const char* name, const Shape<D>& mover, double height) {
      if (onePoint && mover.kind() != ShapeKind::sphere) return;
      for (const Floor kind : kFloors) {
        const Rot<D> turn = int(kind) % 2 ? someTurn<D>() : Rot<D>{};
        const Slide s = slide<D>("contacts=" + r->info.name, floorOf<D>(kind), mover, height, turn);
        EXPECT_TRUE(s.lost < 1e-3 && s.height < 2 * double(kLinearSlop) && s.turned < 0.05)
            << D << "D " << r->info.name << ", " << name << ", floor " << int(kind) << ": lost " << s.lost
            << " m/s, height " << s.height << " m, turned " << s.turned << " rad/s";
      }
    });
  }
}
TEST(Tiles, NothingSlowsWithEveryGenerator2) { nothingSlowsWithEveryGenerator<2>(); }
TEST(Tiles, NothingSlowsWithEveryGenerator3) { nothingSlowsWithEveryGenerator<3>(); }

template <int D>
Slide boxOnBoxes(const std::string& pipeline) {
  return slide<D>(pipeline, floorOf<D>(Floor::boxes), Shape<D>::box(at<D>(0.4, 0.3, 0.35)), 0.3, {});
}
template <int D>
void nothingSlowsInEveryPipeline() {
  std::vector<std::string> pipelines;
  for (const Registered* r : Registry::instance().list(StageKind::solver, D)) {
    if (competes(*r)) pipelines.push_back("solver=" + r->info.name);
  }
  for (const Registered* r : Registry::instance().list(StageKind::cache, D)) {
    if (competes(*r)) pipelines.push_back("cache=" + r->info.name);
  }
  for (const char* continuous : {"cast", "ray", "speculative"}) {
    pipelines.push_back("continuous=" + std::string(continuous));
  }
  for (const std::string& pipeline : pipelines) {
    const Slide s = boxOnBoxes<D>(pipeline);
    EXPECT_TRUE(s.lost < 1e-3 && s.height < 2 * double(kLinearSlop))
        << D << "D " << pipeline << ": lost " << s.lost << " m/s, height " << s.height << " m";
  }
}
TEST(Tiles, NothingSlowsInEveryPipeline2) { nothingSlowsInEveryPipeline<2>(); }
TEST(Tiles, NothingSlowsInEveryPipeline3) { nothingSlowsInEveryPipeline<3>(); }

// avbd solves a body as if the rows that were active at its last velocity acted. Where many rows become active
// together, their summed penalty exceeds m / dt^2, and their impulses alternate between none and too much. A second
// solve sees which rows are active. Returns the largest change of height (m), 1 if the body does not get far. `first`:
// number of tiles to the left of the origin.
template <int D>
double liftBySmallTiles(const std::string& solver, double tile, int first) {
  World<D> world(Pipeline::parse("solver=" + solver));
  for (int i = 0; i < 5 / tile; ++i) {
    world.add(slippery<D>(Shape<D>::box(at<D>(tile / 2, 0.5, 2)), at<D>(tile * (i - first), -0.5)));
  }
  BodyDef<D> def = slippery<D>(Shape<D>::box(Vec<D>::Constant(Real(0.4))), at<D>(0, 0.405), BodyType::dynamic);
  def.velocity = at<D>(2, 0);
  const BodyHandle handle = world.add(def);
  double lift = 0;
  for (int i = 0; i < 100; ++i) {
    world.step(kDt);
    if (i > 10) lift = std::max(lift, std::abs(double(world.pose(handle).p[1]) - 0.4));
  }
  return world.pose(handle).p[0] > 3 ? lift : 1;  // also where it is not a number
}
template <int D>
double liftBySmallTiles(const std::string& solver) {
  return std::max({liftBySmallTiles<D>(solver, 0.1, 2), liftBySmallTiles<D>(solver, 0.1, 10),
                   liftBySmallTiles<D>(solver, 0.05, 2)});
}
template <int D>
void manyContactsLiftNothing() {
  constexpr double kMost = 2e-3;
  EXPECT_LT(liftBySmallTiles<D>("avbd{tries=1}"), kMost);
  for (const Registered* r : Registry::instance().list(StageKind::solver, D)) {
    if (!competes(*r)) continue;
    const auto& failures = r->info.failures;
    const bool declared = std::any_of(failures.begin(), failures.end(), [](const FailureMode& f) {
      return std::string_view(f.test) == "Tiles.ManyContactsAtOnceLiftNothing";
    });
    const double lift = liftBySmallTiles<D>(r->info.name);
    EXPECT_EQ(lift > kMost, declared) << r->info.name << " in " << D << "D: " << lift << " m";
  }
}
TEST(Tiles, ManyContactsAtOnceLiftNothing) { manyContactsLiftNothing<2>(), manyContactsLiftNothing<3>(); }

TEST(Tiles, NothingSlowsACylinder) {
  const Real sizes[] = {Real(0.4), Real(0.3)};
  for (const Floor kind : kFloors) {
    const Slide s =
        slide<3>("contacts=query_clip", floorOf<3>(kind), Shape<3>::curved(ShapeKind::cylinder, sizes), 0.3, {});
    EXPECT_TRUE(s.lost < 1e-3 && s.height < 2 * double(kLinearSlop))
        << int(kind) << ": lost " << s.lost << " m/s, height " << s.height << " m";
  }
}

// Planted bug: tiles that are dynamic bodies, but cannot move. The pass leaves their contacts alone.
template <int D>
bool slidesOverLooseTiles() {
  std::vector<BodyDef<D>> tiles = floorOf<D>(Floor::boxes);
  for (BodyDef<D>& tile : tiles) {
    tile.type = BodyType::dynamic, tile.pinned = true, tile.rotatable = false;
    tile.shapes[0].category = 2, tile.shapes[0].mask = 1;
  }
  const Slide s = slide<D>("", tiles, Shape<D>::box(at<D>(0.4, 0.3, 0.35)), 0.3, {});
  return s.lost < 1e-3;
}
TEST(Tiles, UncorrectedContactsStopTheBox) {
  expectCaught("2D tiles without the pass over flush parts", slidesOverLooseTiles<2>());
  expectCaught("3D tiles without the pass over flush parts", slidesOverLooseTiles<3>());
}

// How far a mover gets that slides at 2 m/s towards a tile at x = 1.4 m whose top is `step` m above the floor.
template <int D>
double wayAgainst(const Shape<D>& mover, double height, double step) {
  World<D> world;
  for (BodyDef<D> def : floorOf<D>(Floor::boxes)) {
    if (def.X_WB.p[0] > 1.4) def.X_WB.p[1] += Real(step);
    world.add(def);
  }
  BodyDef<D> def = slippery<D>(mover, at<D>(0, height), BodyType::dynamic);
  def.velocity = at<D>(2, 0);
  const BodyHandle handle = world.add(def);
  double way = 0;
  for (int i = 0; i < 90; ++i) world.step(kDt), way = std::max(way, double(world.pose(handle).p[0]));
  return way;
}
template <int D>
void stepsStop() {
  const Shape<D> box = Shape<D>::box(Vec<D>::Constant(Real(0.3)));
  for (const double step : {0.005, 0.02, 0.1, 0.4}) {  // at low steps the box tips
    EXPECT_LT(wayAgainst<D>(box, 0.3, step), 1.3) << step;
  }
  EXPECT_LT(wayAgainst<D>(Shape<D>::sphere(Real(0.3)), 0.3, 0.2), 1.4 - 0.25);
  // Far below the slop, and a step down.
  for (const double step : {1e-4, -1e-4, -0.1}) EXPECT_GT(wayAgainst<D>(box, 0.3, step), 2.7) << step;
}
TEST(Tiles, StepsStop2) { stepsStop<2>(); }
TEST(Tiles, StepsStop3) { stepsStop<3>(); }

// Into a gap that is wider than the box by 1 cm, along its walls.
template <int D>
void fallsIntoAGap() {
  World<D> world;
  for (const double side : {-1.0, 1.0}) {
    world.add(slippery<D>(Shape<D>::box(at<D>(1, 0.5, 2)), at<D>(side * 1.305, -0.5)));
  }
  const BodyHandle handle =
      world.add(slippery<D>(Shape<D>::box(Vec<D>::Constant(Real(0.3))), at<D>(0, 0.31), BodyType::dynamic));
  for (int i = 0; i < 30; ++i) world.step(kDt);
  EXPECT_LT(world.pose(handle).p[1], -0.5);
  EXPECT_NEAR(world.pose(handle).p[0], 0, 0.006);
}
TEST(Tiles, BoxesFallIntoGaps) {
  fallsIntoAGap<2>();
  fallsIntoAGap<3>();
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::tiles_test
