// SPDX-License-Identifier: Zlib
// Bodies on meshes and chains. Sliding bodies must not feel the inner edges, and resting bodies must rest as on the
// surface as a whole.
#include <gtest/gtest.h>

#include "framework/world/internal_edges.h"
#include "tests/expect_caught.h"
#include "tests/surfaces.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace surface_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
BodyDef<D> slippery(const Shape<D>& shape, const Vec<D>& place, BodyType type = BodyType::dynamic) {
  BodyDef<D> def = body<D>(shape, place, type);
  def.shapes[0].friction = 0, def.canSleep = false;
  return def;
}

template <int D>
World<D> worldWith(const std::string& contacts) {
  return World<D>(Pipeline::parse("contacts=" + contacts));
}

// Measured in f64: up to 1.6e-7 m/s for boxes, 4e-6 for query_clip's capsules and 3e-5 for sat_clip's. Ten sweeps turn
// sat_clip's capsules by 0.014 rad/s, 200 by 1e-5. Without the pass over inner edges all of them jump at 0.3 m/s or
// more.
constexpr double kSmooth = 1e-3;  // m/s
constexpr double kTurns = 0.05;   // rad/s

struct Slide {
  double upwards = 0;  // the largest vertical speed (m/s)
  double lost = 0;     // the largest change of the horizontal velocity (m/s)
  double turned = 0;   // the largest angular speed (rad/s)
  double way = 0;      // distance, m
  bool smooth() const { return upwards < kSmooth && lost < kSmooth && turned < kTurns && way > 9.9; }
};

// 10 m at 5 m/s, after a second of settling; in 3D at an angle to the axes.
template <int D>
Slide slide(const std::string& contacts, const std::vector<BodyDef<D>>& ground, const Shape<D>& mover, Real height) {
  World<D> world = worldWith<D>(contacts);
  for (const BodyDef<D>& def : ground) world.add(def);
  const BodyHandle body = world.add(slippery<D>(mover, at<D>(0, double(height), -1)));
  for (int i = 0; i < 60; ++i) world.step(kDt);
  const Vec<D> start = world.pose(body).p;
  Motion<D> motion;
  motion.v = D == 2 ? at<D>(5, 0) : at<D>(4.9, 0, 0.99498743710662);
  world.setMotion(body, motion);
  Slide out;
  for (int i = 0; i < 120; ++i) {
    world.step(kDt);
    const Motion<D> now = world.motion(body);
    Vec<D> change = now.v - motion.v;
    out.upwards = std::max(out.upwards, std::abs(double(change[1])));
    change[1] = 0;
    out.lost = std::max(out.lost, double(change.norm()));
    out.turned = std::max(out.turned, double(now.w.norm()));
  }
  Vec<D> way = world.pose(body).p - start;
  way[1] = 0;
  out.way = double(way.norm());
  return out;
}

template <int D, class F>
void forMovers(const F& f) {
  f("box", Shape<D>::box(Vec<D>::Constant(Real(0.3))), Real(0.3));
  f("ball", Shape<D>::sphere(Real(0.3)), Real(0.3));
  f("capsule", Shape<D>::capsule(Real(0.4), Real(0.25)), Real(0.25));
}

// Loose parts are bodies that are dynamic, but cannot move: the passes leave their contacts alone.
template <int D>
std::vector<BodyDef<D>> levelGround(GroundOf of) {
  const Shape<D> ground = roughGround<D>(5, of, level);
  if (of == GroundOf::surface) return {slippery<D>(ground, Vec<D>::Zero(), BodyType::fixed)};
  std::vector<BodyDef<D>> out;
  for (const ShapePart<D>& part : ground.parts()) {
    BodyDef<D> def = slippery<D>(part.shape, Vec<D>::Zero());
    def.X_WB = part.X_SP, def.pinned = true, def.rotatable = false;
    def.mass = MassProperties<D>{.mass = 1};
    def.shapes[0].category = 2, def.shapes[0].mask = 1;
    out.push_back(def);
  }
  return out;
}
// With every generator. A generator that declares a single point on sliding faces cannot keep boxes and capsules from
// rocking, on any ground; but they must lose no speed.
template <int D>
void slidesWithoutABump() {
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    const auto& failures = r->info.failures;
    const bool onePoint = std::any_of(failures.begin(), failures.end(), [](const FailureMode& f) {
      return std::string_view(f.test) == "Contacts.FastFacesSpanThePatch";
    });
    forMovers<D>([&](const char* name, const Shape<D>& mover, Real height) {
      const Slide s = slide<D>(r->info.name, levelGround<D>(GroundOf::surface), mover, height);
      const bool mayRock = onePoint && mover.kind() != ShapeKind::sphere;
      EXPECT_TRUE(mayRock ? s.lost < kSmooth && s.way > 9.9 : s.smooth())
          << D << "D " << r->info.name << ", " << name << ": upwards " << s.upwards << " m/s, lost " << s.lost
          << " m/s, turned " << s.turned << " rad/s, " << s.way << " m";
    });
  }
}
TEST(Surface, SlidesWithoutABump2) { slidesWithoutABump<2>(); }
TEST(Surface, SlidesWithoutABump3) { slidesWithoutABump<3>(); }

// Planted bug: the same parts without the passes over inner edges and flush parts.
template <int D>
bool everyMoverIsSmooth(GroundOf of) {
  bool smooth = true;
  forMovers<D>([&](const char*, const Shape<D>& mover, Real height) {
    smooth = smooth && slide<D>("sat_clip", levelGround<D>(of), mover, height).smooth();
  });
  return smooth;
}
TEST(Surface, PartsWithoutThePassBump) {
  expectCaught("a chain without its pass over inner edges", everyMoverIsSmooth<2>(GroundOf::loosePart));
  expectCaught("a mesh without its pass over inner edges", everyMoverIsSmooth<3>(GroundOf::loosePart));
}

// Height of a ball's centre at rest on the surface of two slopes of 0.3 that meet at x = 6 m.
double heightOver(double x, double radius, bool ridge) {
  const double slope = 0.3, stretch = std::sqrt(1 + slope * slope), side = std::abs(x - 6);
  if (!ridge) return slope * side + radius * stretch;
  const double edge = radius * slope / stretch;  // beside the edge the ball touches a slope
  return side < edge ? std::sqrt(radius * radius - side * side) : -slope * side + radius * stretch;
}
double ridgeAt6(double x) { return -0.3 * std::abs(x - 6); }
double valleyAt6(double x) { return 0.3 * std::abs(x - 6); }

template <int D>
Shape<D> twoSlopes(bool ridge) {
  const auto height = [&](double x) { return ridge ? ridgeAt6(x) : valleyAt6(x); };
  if constexpr (D == 2) {
    const std::vector<Vec<2>> points = {at<2>(12, height(12)), at<2>(6, 0), at<2>(0, height(0))};
    return Shape<2>::chain(points, false);
  } else {
    std::vector<Vec<3>> points;
    for (const double x : {0.0, 6.0, 12.0}) {
      for (const double z : {-3.0, -0.7, 0.9, 3.0}) points.push_back(at<3>(x, height(x), z));
    }
    std::vector<std::array<int, 3>> triangles;
    for (const int a : {0, 1, 2, 4, 5, 6}) triangles.insert(triangles.end(), {{a, a + 1, a + 5}, {a, a + 5, a + 4}});
    return Shape<3>::mesh(points, triangles);
  }
}

template <int D>
void rollsOverARidge(const std::string& contacts) {
  World<D> world = worldWith<D>(contacts);
  world.add(body<D>(twoSlopes<D>(true), Vec<D>::Zero(), BodyType::fixed));
  const double radius = 0.5;
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(radius)), at<D>(5, heightOver(5, radius, true), 0.1));
  def.velocity = at<D>(3, 0.9);
  const BodyHandle ball = world.add(def);
  double least = 1, farthest = 0;
  while (world.pose(ball).p[0] < 6.6 && world.stepCount() < 120) {
    world.step(kDt);
    const double above = double(world.pose(ball).p[1]) - heightOver(double(world.pose(ball).p[0]), radius, true);
    least = std::min(least, above), farthest = std::max(farthest, above);
  }
  EXPECT_GT(world.pose(ball).p[0], 6.6) << contacts;
  EXPECT_GT(least, -2 * double(kLinearSlop)) << contacts;
  EXPECT_LT(farthest, double(kContactMargin)) << contacts;  // at 2.6 m/s it lifts off by no more
}

template <int D>
void liesInAValley(const std::string& contacts) {
  World<D> world = worldWith<D>(contacts);
  world.add(body<D>(twoSlopes<D>(false), Vec<D>::Zero(), BodyType::fixed));
  const double radius = 0.5;
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(radius)), at<D>(5.7, 1, 0.1)));
  for (int i = 0; i < 600; ++i) world.step(kDt);
  EXPECT_NEAR(world.pose(ball).p[0], 6, 0.03) << contacts;
  EXPECT_NEAR(world.pose(ball).p[1], heightOver(6, radius, false), 2 * double(kLinearSlop)) << contacts;
}

TEST(Surface, RidgeAndValley) {
  for (const char* contacts : {"sat_clip", "query_clip", "deepest_point"}) {
    rollsOverARidge<2>(contacts), rollsOverARidge<3>(contacts);
    liesInAValley<2>(contacts), liesInAValley<3>(contacts);
  }
}

// Counter-clockwise seen from outside, corners numbered by bits.
template <int D>
Shape<D> boxSurface(const Vec<D>& half) {
  if constexpr (D == 2) {
    const std::vector<Vec<2>> points = {at<2>(-half[0], -half[1]), at<2>(half[0], -half[1]), at<2>(half[0], half[1]),
                                        at<2>(-half[0], half[1])};
    return Shape<2>::chain(points, true);
  } else {
    std::vector<Vec<3>> points;
    for (int bits = 0; bits < 8; ++bits) {
      points.push_back(
          at<3>((bits & 1 ? 1 : -1) * half[0], (bits & 2 ? 1 : -1) * half[1], (bits & 4 ? 1 : -1) * half[2]));
    }
    const std::vector<std::array<int, 3>> triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                                       {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                       {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    return Shape<3>::mesh(points, triangles);
  }
}

template <int D>
Pose<D> restOn(const Shape<D>& ground, const Shape<D>& shape, const Vec<D>& from, const std::string& contacts) {
  World<D> world = worldWith<D>(contacts);
  world.add(body<D>(ground, Vec<D>::Zero(), BodyType::fixed));
  const BodyHandle dropped = world.add(body<D>(shape, from));
  for (int i = 0; i < 240; ++i) world.step(kDt);
  return world.pose(dropped);
}

template <int D>
void restsAsOnTheBox() {
  const Vec<D> half = at<D>(1, 0.5, 1);
  for (const char* contacts : {"sat_clip", "query_clip"}) {
    forMovers<D>([&](const char* name, const Shape<D>& mover, Real) {
      const Vec<D> from = at<D>(0.2, 1.2, 0.1);
      const Pose<D> mesh = restOn<D>(boxSurface<D>(half), mover, from, contacts);
      const Pose<D> box = restOn<D>(Shape<D>::box(half), mover, from, contacts);
      EXPECT_LT((mesh.p - box.p).norm(), 2e-3) << contacts << ' ' << name;
      EXPECT_LT((mesh.q * Vec<D>(Vec<D>::UnitY()) - box.q * Vec<D>(Vec<D>::UnitY())).norm(), 5e-3)
          << contacts << ' ' << name;
    });
  }
}
TEST(Surface, RestsAsOnTheBox2) { restsAsOnTheBox<2>(); }
TEST(Surface, RestsAsOnTheBox3) { restsAsOnTheBox<3>(); }

// A level net of squares, 0.3 m wide, of two triangles each: faces and lines of curved bodies lie on dozens of
// triangles.
Shape<3> finePlain() {
  constexpr int kSide = 20;
  std::vector<Vec<3>> points;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= kSide; ++i) {
    for (int k = 0; k <= kSide; ++k) points.push_back(at<3>(0.3 * (i - kSide / 2), 0, 0.3 * (k - kSide / 2)));
  }
  for (int i = 0; i < kSide; ++i) {
    for (int k = 0; k < kSide; ++k) {
      const int a = i * (kSide + 1) + k, b = a + kSide + 1;
      triangles.push_back({a, a + 1, b + 1}), triangles.push_back({a, b + 1, b});
    }
  }
  return Shape<3>::mesh(points, triangles);
}
TEST(Surface, CurvedBodiesRestOnAFineMesh) {
  const Real rod[2] = {Real(0.5), Real(0.25)}, cone[2] = {Real(0.25), Real(0.25)};
  const Rot<3> up = Rot<3>::vector(at<3>(0, 0, 1.5707963267948966)), skew = Rot<3>::vector(at<3>(0, 0.6, 0));
  const Shape<3> cylinder = Shape<3>::curved(ShapeKind::cylinder, rod);
  const std::tuple<const char*, Shape<3>, Rot<3>, double> bodies[] = {
      {"lying cylinder", cylinder, skew, 0.25},
      {"standing cylinder", cylinder, up, 0.5},
      {"standing cone", Shape<3>::curved(ShapeKind::cone, cone), up, 0.25}};
  for (const auto& [name, shape, turn, height] : bodies) {
    World<3> world = worldWith<3>("query_clip");
    world.add(body<3>(finePlain(), Vec<3>::Zero(), BodyType::fixed));
    BodyDef<3> def = body<3>(shape, at<3>(0.7, height, -0.9));
    def.X_WB.q = turn, def.canSleep = false;
    const BodyHandle handle = world.add(def);
    const Vec<3> axis = turn * at<3>(1, 0, 0);
    for (int i = 0; i < 300; ++i) world.step(kDt);
    const Pose<3> X = world.pose(handle);
    EXPECT_NEAR(X.p[1], height, 2e-3) << name;
    EXPECT_NEAR((X.q * at<3>(1, 0, 0)).dot(axis), 1, 1e-4) << name;
    EXPECT_LT(world.motion(handle).v.norm(), 1e-3) << name;
  }
}

// Boxes whose sides are above edges of a level net of 2 m squares: the sides are separating axes as good as the face
// below, and rounding decides. The normal that remains of a side's normal over level neighbours has no direction.
TEST(Surface, BoxesRestAboveEdges) {
  std::vector<Vec<3>> points;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < 9; ++i) {
    for (int k = 0; k < 9; ++k) points.push_back(at<3>(2 * i - 8, 0, 2 * k - 8));
  }
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 8; ++k) {
      const int a = 9 * i + k, b = a + 9;
      triangles.push_back({a, b + 1, b}), triangles.push_back({a, a + 1, b + 1});
    }
  }
  const Shape<3> net = Shape<3>::mesh(points, triangles);
  for (const char* contacts : {"sat_clip", "query_clip"}) {
    World<3> world = worldWith<3>(contacts);
    world.add(body<3>(net, Vec<3>::Zero(), BodyType::fixed));
    std::vector<BodyHandle> boxes;
    for (int i = 0; i < 7; ++i) {
      for (int k = 0; k < 7; ++k) {
        const Shape<3> box = Shape<3>::box(at<3>(0.3, 0.2, 0.25));
        boxes.push_back(world.add(body<3>(box, at<3>(2 * i - 5.7, 0.2, 2 * k - 6.25))));
      }
    }
    for (int i = 0; i < 10; ++i) world.step(kDt);
    for (const BodyHandle handle : boxes) EXPECT_LT(world.motion(handle).v.norm(), 1e-3) << contacts;
  }
}

// Random normals on a level strip with acute corners. A triangle's own normal is always allowed, so the nearest allowed
// one is at least as near.
TEST(Surface, CorrectedNormalsAreTheNearest) {
  const std::vector<Vec<3>> points = {at<3>(0, 0, 0), at<3>(0, 0, 0.4), at<3>(2, 0, 0.4), at<3>(2, 0, 0)};
  const std::vector<std::array<int, 3>> halves = {{0, 1, 2}, {0, 2, 3}};
  World<3> world;
  world.add(body<3>(Shape<3>::mesh(points, halves), Vec<3>::Zero(), BodyType::fixed));
  world.add(body<3>(Shape<3>::box(at<3>(0.3, 0.2, 0.25)), Vec<3>::Zero()));
  Random random(39);
  for (int i = 0; i < 2000; ++i) {
    const double lean = std::pow(10, random.uniform(-4, 2));
    const Vec<3> n = at<3>(lean * random.uniform(-1, 1), 1, lean * random.uniform(-1, 1)).normalized();
    std::vector<Manifold<3>> corrected(1);
    Manifold<3>& m = corrected[0];
    m.bodyA = m.shapeA = 0, m.bodyB = m.shapeB = 1, m.partA = i % 2, m.count = 1, m.normal = n;
    m.points[0].localB = at<3>(1, 0, 0.2);
    correctSurfaceContacts<3>(world.shapes(), world.bodies().pose, 1, 0, corrected);
    if (corrected.empty()) continue;
    ASSERT_GE(m.normal.dot(n), n[1] - 8 * std::numeric_limits<Real>::epsilon())
        << n.transpose() << " becomes " << m.normal.transpose();
  }
}

// Rays straight down onto the edges and corners that two parts share.
TEST(Surface, RaysMeetSharedBorders) {
  std::vector<Vec<2>> points;
  for (int i = 100; i >= 0; --i) points.push_back(at<2>(0.1 * i, 0));
  World<2> chain;
  chain.add(body<2>(Shape<2>::chain(points, false), Vec<2>::Zero(), BodyType::fixed));
  const std::vector<Vec<3>> corners = {at<3>(0, 0, 0), at<3>(0, 0, 1), at<3>(1, 0, 1), at<3>(1, 0, 0)};
  const std::vector<std::array<int, 3>> halves = {{0, 1, 2}, {0, 2, 3}};
  World<3> square;
  square.add(body<3>(Shape<3>::mesh(corners, halves), Vec<3>::Zero(), BodyType::fixed));
  for (int i = 1; i < 100; ++i) {
    EXPECT_TRUE(chain.rayFirst(at<2>(0.1 * i, 1), at<2>(0, -1), 2)) << i;
    EXPECT_TRUE(square.rayFirst(at<3>(0.01 * i, 1, 0.01 * i), at<3>(0, -1, 0), 2)) << i;
  }
}

// A closed surface pushes balls outwards on both sides: every normal points from the box to the ball, and the balls
// stay outside.
template <int D>
void pushesOutwards() {
  World<D> world = worldWith<D>("sat_clip");
  world.add(slippery<D>(boxSurface<D>(at<D>(1, 1, 1)), Vec<D>::Zero(), BodyType::fixed));
  std::vector<BodyHandle> balls;
  for (const double side : {-1.0, 1.0}) {
    BodyDef<D> def = slippery<D>(Shape<D>::sphere(Real(0.25)), at<D>(side * 1.5, 0.1, 0.2));
    def.velocity = at<D>(-side, 0);
    balls.push_back(world.add(def));
  }
  for (int i = 0; i < 20; ++i) {
    world.step(kDt);
    for (const Manifold<D>& m : world.manifolds()) {
      const Vec<D> away = world.bodies().pose[std::size_t(m.bodyB)].p - world.bodies().pose[std::size_t(m.bodyA)].p;
      EXPECT_GT(away.dot(m.normal), 0);
    }
  }
  for (const BodyHandle ball : balls) EXPECT_GT(std::abs(world.pose(ball).p[0]), 1.25 - 2 * kLinearSlop);
}
TEST(Surface, PushesOutwards) {
  pushesOutwards<2>();
  pushesOutwards<3>();
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::surface_test
