// SPDX-License-Identifier: Zlib
// Where a camera projects points, without a window.
#include "experiments/sandbox/view_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/sandbox/look_at_all.h"
#include "framework/world/world.h"
#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/planted_bugs/view_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace view_camera_test { namespace {

constexpr Real kPixel = Real(1e-6);  // px: tolerance for rounding

Vec<2> drawPixel(Draw& draw, const ViewFrame& frame) {
  return {frame.left() + draw.real(0, frame.width()), frame.top() + draw.real(0, frame.height())};
}

// At any place and scale, moved in any way.
template <class Camera, int D>
Camera drawCamera(Draw& draw) {
  Camera camera;
  camera.resize(20 + draw.below(2000), 20 + draw.below(1000), draw.below(300), draw.below(300));
  const Real scale = draw.pick({Real(1), Real(1e-2), Real(1e2)});
  const Vec<D> lo = scale * draw.pick({Real(1), Real(100)}) * drawVector<D>(draw);
  camera.look(lo, lo + scale * drawHalf<D>(draw));
  if constexpr (D == 3) camera.orbit(draw.real(-500, 500), draw.real(-150, 150));
  return camera;
}

// A point under the pixel at the depth of the target.
Vec<2> under(const ViewCamera<2>& camera, const Vec<2>& pixel) { return camera.toWorld(pixel); }
Vec<3> under(const ViewCamera<3>& camera, const Vec<2>& pixel) {
  const auto ray = camera.ray(pixel);
  return ray.origin + camera.distance() / -ray.direction.dot(camera.towards()) * ray.direction;
}

template <int D>
Vec<2> pixelOfMatrix(const ViewCamera<D>& camera, const Vec<D>& p) {
  const ViewMatrix m = camera.matrix();
  std::array<Real, 4> clip{};
  for (std::size_t row = 0; row < 4; ++row) {
    clip[row] = m[12 + row];
    for (int k = 0; k < D; ++k) clip[row] += m[4 * static_cast<std::size_t>(k) + row] * (p - camera.origin())[k];
  }
  return {camera.left() + camera.width() * (1 + clip[0] / clip[3]) / 2,
          camera.top() + camera.height() * (1 - clip[1] / clip[3]) / 2};
}

template <class Camera, int D>
void seesAsItsMatrix() {
  RapidCheckDraw draw;
  const auto camera = drawCamera<Camera, D>(draw);
  const Vec<2> pixel = drawPixel(draw, camera);
  const Vec<D> p = under(camera, pixel);
  RC_ASSERT((camera.toPixel(p) - pixel).norm() <= kPixel * 100);
  RC_ASSERT((pixelOfMatrix<D>(camera, p) - camera.toPixel(p)).norm() <= Real(0.01));
}

template <class Camera, int D>
void keepsWhatIsUnderTheMouse() {
  RapidCheckDraw draw;
  auto camera = drawCamera<Camera, D>(draw);
  const Vec<2> pixel = drawPixel(draw, camera), moved = drawPixel(draw, camera);
  const Vec<D> p = under(camera, pixel);
  camera.pan(moved[0] - pixel[0], moved[1] - pixel[1]);
  RC_ASSERT((camera.toPixel(p) - moved).norm() <= kPixel * 100);
  const Real factor = draw.real(0.5, 2), before = camera.scaleAt(p);
  camera.zoom(factor, moved);
  RC_ASSERT((camera.toPixel(p) - moved).norm() <= kPixel * 100);
  RC_ASSERT(std::abs(camera.scaleAt(p) / before - factor) <= Real(1e-6));
}

template <int D>
void look() {
  RapidCheckDraw draw;
  auto camera = drawCamera<ViewCamera<D>, D>(draw);
  const Vec<D> lo = drawVector<D>(draw), hi = lo + drawHalf<D>(draw);
  camera.look(lo, hi);
  Vec<2> least = Vec<2>::Constant(1e9), most = -least;
  for (int corner = 0; corner < 1 << D; ++corner) {
    Vec<D> p;
    for (int k = 0; k < D; ++k) p[k] = (corner >> k & 1) ? hi[k] : lo[k];
    least = least.cwiseMin(camera.toPixel(p)), most = most.cwiseMax(camera.toPixel(p));
  }
  RC_ASSERT(least[0] >= camera.left() && least[1] >= camera.top());
  RC_ASSERT(most[0] <= camera.left() + camera.width() && most[1] <= camera.top() + camera.height());
  const Vec<2> share = (most - least).cwiseQuotient(Vec<2>(camera.width(), camera.height()));
  RC_ASSERT(share.maxCoeff() >= Real(D == 2 ? 0.9 : 0.5));
}

TEST(ViewCamera, AgreesWithItsMatrix) {
  check("2D", [] { seesAsItsMatrix<ViewCamera<2>, 2>(); });
  check("3D", [] { seesAsItsMatrix<ViewCamera<3>, 3>(); });
  expectFalsified("y not flipped, 2D", [] { seesAsItsMatrix<UpIsDown<2>, 2>(); });
  expectFalsified("y not flipped, 3D", [] { seesAsItsMatrix<UpIsDown<3>, 3>(); });
  expectFalsified("the corner of a view forgotten, 2D", [] { seesAsItsMatrix<ForgetsItsCorner<2>, 2>(); });
  expectFalsified("the corner of a view forgotten, 3D", [] { seesAsItsMatrix<ForgetsItsCorner<3>, 3>(); });
}

TEST(ViewCamera, KeepsWhatIsUnderTheMouse) {
  check("2D", [] { keepsWhatIsUnderTheMouse<ViewCamera<2>, 2>(); });
  check("3D", [] { keepsWhatIsUnderTheMouse<ViewCamera<3>, 3>(); });
  expectFalsified("pans the other way, 2D", [] { keepsWhatIsUnderTheMouse<PansTheOtherWay<2>, 2>(); });
  expectFalsified("pans the other way, 3D", [] { keepsWhatIsUnderTheMouse<PansTheOtherWay<3>, 3>(); });
  expectFalsified("zooms about the middle, 2D", [] { keepsWhatIsUnderTheMouse<ZoomsAboutTheMiddle<2>, 2>(); });
  expectFalsified("zooms about the middle, 3D", [] { keepsWhatIsUnderTheMouse<ZoomsAboutTheMiddle<3>, 3>(); });
}

TEST(ViewCamera, ShowsAWholeBox) {
  check("2D", look<2>);
  check("3D", look<3>);
}

// Points in front of the target move with the mouse.
template <class Camera>
void orbits() {
  RapidCheckDraw draw;
  auto camera = drawCamera<Camera, 3>(draw);
  const Vec<3> target = camera.origin(), front = target + camera.distance() / 2 * camera.towards();
  const Real distance = camera.distance(), dx = draw.real(-40, 40), dy = draw.real(-5, 5);
  camera.orbit(dx, dy);
  RC_ASSERT((camera.toPixel(target) - camera.center()).norm() <= kPixel);
  RC_ASSERT(std::abs((camera.eye() - target).norm() / distance - 1) <= Real(1e-9));
  const Vec<2> moved = camera.toPixel(front) - camera.center();
  RC_ASSERT(moved[0] * dx >= 0);
  if (std::abs(dy) > std::abs(dx)) RC_ASSERT(moved[1] * dy >= 0);
}
TEST(ViewCamera, Orbits) {
  check("orbit", orbits<ViewCamera<3>>);
  expectFalsified("up and down exchanged", orbits<OrbitsTheOtherWay>);
}

TEST(ViewCamera, RaysGoThroughWhatTheyShow) {
  check("ray", [] {
    RapidCheckDraw draw;
    const auto camera = drawCamera<ViewCamera<3>, 3>(draw);
    const Vec<2> pixel = drawPixel(draw, camera);
    const auto [origin, direction] = camera.ray(pixel);
    RC_ASSERT(std::abs(direction.norm() - 1) <= Real(1e-12));
    const Real t = draw.real(0.1, 10) * camera.distance();
    RC_ASSERT((camera.toPixel(origin + t * direction) - pixel).norm() <= kPixel * 100);
    RC_ASSERT(std::isnan(camera.toPixel(origin - t * direction)[0]));
  });
}

// The view contains the floor on which bodies fall, unless it is far below.
template <int D>
void looksAtTheFloor() {
  const auto lowest = [](Real height) {
    World<D> world(Pipeline::parse("solver=split_solver"));
    BodyDef<D> floor = BodyDef<D>::fixed({.shape = Shape<D>::box(Vec<D>::Constant(50))});
    floor.X_WB.p[1] = -50;
    world.add(floor);
    BodyDef<D> ball;
    ball.X_WB.p[1] = height;
    ball.shapes = {{.shape = Shape<D>::sphere(1)}};
    world.add(ball);
    ViewCamera<D> camera;
    camera.resize(800, 600);
    lookAtAll(camera, world);
    return camera.toPixel(Vec<D>::Zero())[1];
  };
  EXPECT_GT(lowest(2), 300);
  EXPECT_LT(lowest(2), 600);
  EXPECT_GT(lowest(2.9), 400);
  EXPECT_LT(lowest(2.9), 600);
  EXPECT_GT(lowest(30), 600);
}
TEST(ViewCamera, ShowsTheFloorBelowFallingBodies) {
  looksAtTheFloor<2>();
  looksAtTheFloor<3>();
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::view_camera_test
