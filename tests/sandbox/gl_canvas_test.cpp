// SPDX-License-Identifier: Zlib
// The window shows every shape where the camera projects it, and nowhere else.
#include "experiments/sandbox/gl_canvas.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/planted_bugs/view_bugs.h"
#include "tests/sandbox/shown.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace gl_canvas_test { namespace {

constexpr DrawColour kRed{220, 0, 0}, kBlue{0, 0, 220};
constexpr Look kRedBody{kRed, kRed}, kBlueBody{kBlue, kBlue};

class Canvas : public testing::Test {
 protected:
  Canvas() { m_window.limitFrames(0); }
  template <int D>
  Window::Picture shown(const ViewCamera<D>& camera, auto draw) {
    GlCanvas<D> canvas;
    return test::shown<D>(m_window, canvas, camera, draw);
  }
  template <int D>
  ViewCamera<D> camera() const {
    ViewCamera<D> camera;
    camera.resize(m_window.width(), m_window.height());
    camera.look(Vec<D>::Constant(-4), Vec<D>::Constant(4));
    return camera;
  }
  Window m_window{"test", 320, 240};
};

// Distance of a pixel's centre from p, and the pixel's size at p (m).
struct Gap {
  Real distance, pixel;
};
Gap gap(const ViewCamera<2>& camera, int x, int y, const Vec<2>& p) {
  return {(camera.toWorld({x + Real(0.5), y + Real(0.5)}) - p).norm(), 1 / camera.scaleAt(p)};
}
Gap gap(const ViewCamera<3>& camera, int x, int y, const Vec<3>& p) {
  const auto ray = camera.ray({x + Real(0.5), y + Real(0.5)});
  return {(p - ray.origin).cross(ray.direction).norm(), 1 / camera.scaleAt(p)};
}

// The ball covers the pixels with view rays that hit it. Its corners lie up to a fifth of a pixel inside; its edge is a
// line.
template <int D, class Twin = void>
void ballIsThere(Window& window) {
  RapidCheckDraw draw;
  ViewCamera<D> camera;
  camera.resize(window.width(), window.height());
  const Real far = draw.pick({Real(0), Real(1e5)});  // where floats have steps of a centimetre
  const Vec<D> middle = far * drawVector<D>(draw);
  camera.look(middle - Vec<D>::Constant(4), middle + Vec<D>::Constant(4));
  if constexpr (D == 3) camera.orbit(draw.real(-300, 300), draw.real(-100, 100));
  const Vec<D> p = middle + 3 * drawVector<D>(draw);
  const Real radius = draw.real(0.3, 1.2);
  GlCanvas<D> canvas;
  const auto picture = shown<D>(window, canvas, camera, [&](DebugDraw<D>& right) {
    Pose<D> X;
    X.p = p, X.q = drawRotation<D>(draw);
    const Shape<D> ball = Shape<D>::sphere(radius);
    if constexpr (std::is_void_v<Twin>) {
      right.shape(ball.view(), X, kRedBody);
    } else {
      Twin(right).shape(ball.view(), X, kRedBody);
    }
  });
  int red = 0, paper = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto [distance, pixel] = gap(camera, x, y, p);
      if (distance < radius - Real(1.5) * pixel) {
        RC_ASSERT(isRed(picture.at(x, y)));
        ++red;
      } else if (distance > radius + Real(2) * pixel) {
        RC_ASSERT(isPaper(picture.at(x, y)));
        ++paper;
      }
    }
  }
  RC_ASSERT(paper > 0);
  const Vec<2> at = camera.toPixel(p);
  if (at[0] > 0 && at[1] > 0 && at[0] < picture.width && at[1] < picture.height) RC_ASSERT(red > 0);
}

template <int D>
void balls(Window& window) {
  check(
      "a ball is where the world has it", [&] { ballIsThere<D>(window); }, 30);
  expectFalsified(
      "upside down", [&] { ballIsThere<D, DrawsUpsideDown<D>>(window); }, 30);
  expectFalsified(
      "at the origin", [&] { ballIsThere<D, ForgetsWhereShapesAre<D>>(window); }, 30);
  expectFalsified(
      "a tenth too large", [&] { ballIsThere<D, DrawsALittleLarger<D>>(window); }, 30);
  expectFalsified(
      "edges alone", [&] { ballIsThere<D, DrawsEdgesAlone<D>>(window); }, 30);
}
TEST_F(Canvas, BallsAreWhereTheWorldHasThem2) { balls<2>(m_window); }
TEST_F(Canvas, BallsAreWhereTheWorldHasThem3) { balls<3>(m_window); }

template <int D>
Pose<D> at(const Vec<D>& p) {
  Pose<D> X;
  X.p = p;
  return X;
}

TEST_F(Canvas, LinesAndPointsAreWhereTheWorldHasThem) {
  const auto camera = this->camera<2>();
  const Vec<2> a(-3, -2), b(2, 1), p(3, -3);
  const auto picture = shown<2>(camera, [&](DebugDraw<2>& draw) {
    draw.line(a, b, kRed);
    draw.point(p, 9, kBlue);
  });
  int seen[3] = {};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const Vec<2> pixel(x + Real(0.5), y + Real(0.5)), from = camera.toPixel(a), to = camera.toPixel(b);
      const Real along = (pixel - from).dot(to - from) / (to - from).squaredNorm(),
                 share = std::clamp<Real>(along, 0, 1);
      const Real off = (pixel - (from + share * (to - from))).norm(), away = (pixel - camera.toPixel(p)).norm();
      const bool red = off < Real(0.3) && std::abs(along - Real(0.5)) < Real(0.49), blue = away < Real(3.5);
      const bool paper = off > Real(1.5) && away > Real(5.5);
      if (red || blue || paper) {
        EXPECT_EQ(picture.at(x, y), red ? kRed : blue ? kBlue : kPaper) << x << ' ' << y;
        ++seen[red ? 0 : blue ? 1 : 2];
      }
    }
  }
  EXPECT_GT(seen[0], 20);
  EXPECT_GT(seen[1], 20);
}

TEST_F(Canvas, NearerShapesCoverFartherOnes) {
  const auto camera = this->camera<3>();
  const Shape<3> small = Shape<3>::box({Real(0.5), Real(0.5), Real(0.5)}), large = Shape<3>::box({2, 2, 2});
  const Pose<3> behind = at<3>(-4 * camera.towards()), before = at<3>({0, 0, 0});
  const auto alone = shown<3>(camera, [&](DebugDraw<3>& draw) { draw.shape(small.view(), behind, kBlueBody); });
  EXPECT_GT(count(alone, isBlue), 100);
  for (const bool first : {false, true}) {
    const auto picture = shown<3>(camera, [&](DebugDraw<3>& draw) {
      if (first) draw.shape(small.view(), behind, kBlueBody);
      draw.shape(large.view(), before, kRedBody);
      if (!first) draw.shape(small.view(), behind, kBlueBody);
    });
    EXPECT_EQ(count(picture, isBlue), 0) << first;
    EXPECT_GT(count(picture, isRed), 1000) << first;
  }
  // But contact points, lines and bodies behind a transparent body are faintly visible.
  const auto faint = shown<3>(camera, [&](DebugDraw<3>& draw) {
    draw.shape(large.view(), before, kRedBody);
    draw.point(behind.p, 9, {0, 255, 0});
  });
  EXPECT_GT(faint.at(160, 120).green, 50);
  EXPECT_GT(faint.at(160, 120).red, 50);
  Look glass = kRedBody;
  glass.fill.alpha = 100;
  const auto through = shown<3>(camera, [&](DebugDraw<3>& draw) {
    draw.shape(large.view(), before, glass);
    draw.shape(small.view(), behind, kBlueBody);
  });
  EXPECT_GT(through.at(160, 120).blue, 50);
  EXPECT_GT(through.at(160, 120).red, 50);
}

// Bodies inside a closed static shape are visible, and so is an empty inside. A static body behind everything is
// opaque.
TEST_F(Canvas, StaticBodiesAreTransparentWhileTheyHideABody) {
  const auto camera = this->camera<3>();
  const Shape<3> wall = Shape<3>::sphere(2), ball = Shape<3>::sphere(Real(0.5));
  Look fixed = kRedBody;
  fixed.moves = false;
  Pose<3> before, behind;
  before.p = 4 * camera.towards(), behind.p = -4 * camera.towards();
  const auto picture = [&](const Pose<3>& X, bool somebody) {
    const auto seen = shown<3>(camera, [&](DebugDraw<3>& draw) {
      draw.shape(wall.view(), X, fixed);
      if (somebody) draw.shape(ball.view(), {}, kBlueBody);
    });
    return seen.at(160, 117);  // beside the outline
  };
  EXPECT_GT(picture(before, true).blue, 100);
  EXPECT_GT(picture(before, false).green, 150);  // background
  EXPECT_TRUE(isBlue(picture(behind, true)));
  const DrawColour solid = picture(behind, false);
  EXPECT_GT(solid.red, 100);
  EXPECT_EQ(solid.green, 0);
}

TEST_F(Canvas, DynamicBodiesAreDrawnOverStaticOnes) {
  const Shape<2> shape = Shape<2>::box({2, 2});
  Look fixed = kBlueBody;
  fixed.moves = false;
  for (const bool first : {false, true}) {
    const auto picture = shown<2>(camera<2>(), [&](DebugDraw<2>& draw) {
      if (first) draw.shape(shape.view(), {}, fixed);
      draw.shape(shape.view(), {}, kRedBody);
      if (!first) draw.shape(shape.view(), {}, fixed);
    });
    EXPECT_EQ(count(picture, isBlue), 0) << first;
    EXPECT_GT(count(picture, isRed), 1000) << first;
  }
}

// Edges as well: a later body hides the edges of earlier ones.
TEST_F(Canvas, LaterBodiesHideEdgesOfEarlierOnes) {
  const auto picture = shown<2>(camera<2>(), [&](DebugDraw<2>& draw) {
    draw.shape(Shape<2>::box({1, 1}).view(), {}, {kRed, kBlue});
    draw.shape(Shape<2>::box({2, 2}).view(), {}, kRedBody);
  });
  EXPECT_EQ(count(picture, isBlue), 0);
}

TEST_F(Canvas, APlaneHasNoEnd) {
  for (const Real far : {Real(0), Real(1e4)}) {
    auto plane = camera<2>();
    plane.look({far - 4, -4}, {far + 4, 4});
    const auto picture =
        shown<2>(plane, [&](DebugDraw<2>& draw) { draw.shape(Shape<2>::plane().view(), {}, kRedBody); });
    for (int y = 0; y < picture.height; ++y) {
      if (std::abs(y + Real(0.5) - 120) < Real(1.5)) continue;
      for (int x = 0; x < picture.width; ++x) EXPECT_EQ(picture.at(x, y), y < 120 ? kPaper : kRed) << x << ' ' << y;
    }
  }
  auto space = camera<3>();
  space.orbit(0, -20);
  const auto picture = shown<3>(space, [&](DebugDraw<3>& draw) {
    draw.shape(Shape<3>::plane().view(), at<3>({0, -1, 0}), kRedBody);
  });
  int seen[2] = {0, 0};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto ray = space.ray({x + Real(0.5), y + Real(0.5)});
      if (std::abs(ray.direction[1]) < Real(0.01)) continue;
      const bool floor = ray.direction[1] < 0;
      EXPECT_TRUE((floor ? isRed : isPaper)(picture.at(x, y))) << x << ' ' << y;
      ++seen[floor];
    }
  }
  EXPECT_GT(seen[0], 1000);
  EXPECT_GT(seen[1], 1000);
}

template <int D>
void outlines(Window& window, const ViewCamera<D>& camera) {
  GlCanvas<D> canvas;
  Look look = kRedBody;
  look.outline = true;
  const Shape<D> box = Shape<D>::box(Vec<D>::Constant(2));
  const auto picture = shown<D>(window, canvas, camera, [&](DebugDraw<D>& draw) { draw.shape(box.view(), {}, look); });
  EXPECT_GT(count(picture, isRed), 200);
  EXPECT_EQ(count(picture, isRed) + count(picture, isPaper), 320 * 240);
  EXPECT_LT(count(picture, isRed), 2500);
  const Vec<D> corner = Vec<D>::Constant(-2);
  for (int k = 0; k < D; ++k) {
    const Vec<2> middle = camera.toPixel(corner + 2 * Vec<D>::Unit(k));
    int near = 0;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) near += isRed(picture.at(int(middle[0]) + x, int(middle[1]) + y));
    }
    EXPECT_GE(near, 2) << k;
  }
}
TEST_F(Canvas, AnOutlineLeavesTheMiddleFree) {
  outlines<2>(m_window, camera<2>());
  outlines<3>(m_window, camera<3>());
}

TEST_F(Canvas, WordsBeginAtTheirPoint) {
  const auto camera = this->camera<2>();
  const Vec<2> p(-1, 1), pixel = camera.toPixel(p);
  const auto picture = shown<2>(camera, [&](DebugDraw<2>& draw) { draw.text(p, "HHHH", {0, 0, 0}); });
  Vec<2> least(1e9, 1e9), most = -least;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (picture.at(x, y).red > 60) continue;
      least = least.cwiseMin(Vec<2>(x, y)), most = most.cwiseMax(Vec<2>(x, y));
    }
  }
  EXPECT_LE((least - pixel).cwiseAbs()[0], 2);
  EXPECT_LE(std::abs(most[1] - pixel[1]), 2);
  EXPECT_GT(most[0] - least[0], 20);
  EXPECT_LT(most[1] - least[1], 14);
  const auto none = shown<3>(this->camera<3>(), [&](DebugDraw<3>& draw) {
    draw.text(2 * this->camera<3>().eye(), "behind", {0, 0, 0});
  });
  EXPECT_EQ(count(none, isPaper), 320 * 240);
}

// Side by side: a view draws only into its own frame.
TEST_F(Canvas, AViewEndsAtItsFrame) {
  ViewCamera<2> left, right;
  left.resize(160, 240);
  right.resize(160, 200, 160, 40);
  GlCanvas<2> canvas;
  m_window.beginFrame();
  for (const auto& [camera, look] : {std::pair(&left, kRedBody), std::pair(&right, kBlueBody)}) {
    canvas.begin(*camera);
    canvas.shape(Shape<2>::box({1000, 1000}).view(), {}, look);
    canvas.end();
  }
  m_window.endFrame();
  const auto picture = m_window.screenshot();
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      EXPECT_EQ(picture.at(x, y), x < 160 ? kRed : y < 40 ? kPaper : kBlue) << x << ' ' << y;
    }
  }
}

// Meshes are cached by the shape's coordinates, not by address: a new hull may get the address of an old one.
TEST_F(Canvas, MeshesAreCachedByShape) {
  GlCanvas<2> canvas;
  int reds[2];
  for (const int k : {0, 1}) {
    const std::vector<Vec<2>> points = {{0, 0}, {1, 0}, {1, Real(1 + k)}, {0, Real(1 + k)}};
    const Shape<2> shape = Shape<2>::polytope(points, Real(0.1));
    reds[k] = count(test::shown<2>(m_window, canvas, camera<2>(),
                                   [&](DebugDraw<2>& draw) { draw.shape(shape.view(), {}, kRedBody); }),
                    isRed);
  }
  EXPECT_GT(reds[1], reds[0] * 3 / 2);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::gl_canvas_test
