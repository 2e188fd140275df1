// SPDX-License-Identifier: Zlib
// A picture of a running simulation: what its film would show, plus marks that films do not have.
#include "experiments/film/picture_draw.h"

#include <gtest/gtest.h>
#include <png.h>

#include <fstream>

#include "experiments/film/film_file.h"
#include "experiments/film/raster.h"
#include "experiments/film/reel.h"
#include "experiments/parse/toml_reader.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace picture_draw_test { namespace {

using namespace test;

constexpr Real kDt = Real(1) / 60;

bool samePatches(const Picture& a, const Picture& b) {
  return std::equal(
      a.patches.begin(), a.patches.end(), b.patches.begin(), b.patches.end(),
      [](const Patch& p, const Patch& q) { return p.corners == q.corners && p.fill == q.fill && p.edge == q.edge; });
}

// Some bodies of a heap fall asleep. The picture of each step equals that of its film.
template <int D>
void aWorldIsItsFilm() {
  const Workspace w;
  World<D> world(Pipeline::parse("sleep=split_average"));
  addHeap(world, 8, 3);
  const ShapePart<D> parts[] = {{Shape<D>::sphere(Real(0.5)), {at<D>(-1, 0), {}}},
                                {Shape<D>::sphere(Real(0.5)), {at<D>(1, 0), {}}}};
  const BodyHandle held = world.add(body<D>(Shape<D>::compound(parts), at<D>(5, 1)));
  JointDef<D> joint{.kind = "pivot", .bodyB = held};
  joint.X_WJ.p = at<D>(5, 2);
  world.add(joint);
  const Camera<D> camera = cameraOf<D>(Viewport{{-6, -2}, {8, 13}}, 400);
  std::vector<Picture> live, awake;
  {
    std::ofstream out(w.path("run.rec"), std::ios::binary);
    Recorder<D> recorder(out);
    for (int i = 0; i < 12; ++i) {
      for (int k = 0; k < 20; ++k) world.step(kDt);
      recorder.frame(world);
      live.push_back(pictureOf(world, DrawLayers{}, camera));
      DrawLayers asIfAwake;
      asIfAwake.sleep = false;
      awake.push_back(pictureOf(world, asIfAwake, camera));
    }
  }
  const Reel<D> reel(w.path("run.rec"));
  ASSERT_EQ(reel.frames().size(), live.size());
  bool asIfAwake = true;
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_TRUE(samePatches(live[i], reel.picture(i, camera))) << "frame " << i;
    asIfAwake = asIfAwake && samePatches(awake[i], reel.picture(i, camera));
  }
  expectCaught("PictureDraw.PicturesEqualTheFilm: nobody is paler " + std::to_string(D) + 'D', asIfAwake);
}
TEST(PictureDraw, PicturesEqualTheFilm2) { aWorldIsItsFilm<2>(); }
TEST(PictureDraw, PicturesEqualTheFilm3) { aWorldIsItsFilm<3>(); }

struct Pixels {
  std::size_t width = 0, height = 0;
  std::vector<png_byte> rgb;

  DrawColour at(const Vec<2>& pixel) const {
    const png_byte* p = &rgb[3 * (static_cast<std::size_t>(pixel[1]) * width + static_cast<std::size_t>(pixel[0]))];
    return {p[0], p[1], p[2]};
  }
};
Pixels pixelsOf(const Picture& picture) {
  const Workspace w;
  const std::string path = w.path("picture.png");
  writePng(path, picture);
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  Pixels out;
  if (!png_image_begin_read_from_file(&head, path.c_str())) return out;
  head.format = PNG_FORMAT_RGB;
  out.width = head.width, out.height = head.height, out.rgb.resize(3 * out.width * out.height);
  png_image_finish_read(&head, nullptr, out.rgb.data(), 0, nullptr);
  return out;
}

constexpr DrawColour kPaper{247, 247, 245}, kInk{200, 0, 0}, kOther{0, 0, 200};

// Marks appear where the camera projects their positions, over a shape that covers these.
template <int D>
void marksAreOverShapes() {
  const Camera<D> camera = cameraOf<D>(Viewport{{-3, -2}, {3, 2}}, 300);
  PictureDraw<D> draw(camera);
  const auto ball = Shape<D>::sphere(1), far = Shape<D>::sphere(Real(0.5));
  draw.point(at<D>(0.3, 0.2), 9, kInk);
  draw.line(at<D>(-2, 1.5), at<D>(2, 1.5), kInk);
  draw.shape(ball.view(), {at<D>(0, 0), {}}, {kOther, kOther});
  Look glass{kOther, kOther};
  glass.outline = true;
  draw.shape(far.view(), {at<D>(2, -0.5), {}}, glass);
  const Pixels seen = pixelsOf(draw.picture());
  ASSERT_GT(seen.width, 0u);
  const auto colourAt = [&](double x, double y) { return seen.at(camera.pixel(at<D>(x, y))); };
  EXPECT_EQ(colourAt(0.3, 0.2), kInk);
  EXPECT_EQ(colourAt(-0.3, -0.2), kOther);
  EXPECT_EQ(colourAt(-2, 0.5), kPaper);
  EXPECT_EQ(colourAt(2, -0.3), kPaper) << "within an outline";
  const DrawColour line = colourAt(-1.5, 1.5);
  EXPECT_GT(line.red, line.blue + 60);
  EXPECT_TRUE(draw.picture().patches.empty()) << "the next picture begins anew";
}
TEST(PictureDraw, MarksAreOverShapes2) { marksAreOverShapes<2>(); }
TEST(PictureDraw, MarksAreOverShapes3) { marksAreOverShapes<3>(); }

// A plane fills the area below it and hides no body; its outline leaves everything visible.
TEST(PictureDraw, PlanesAreBehind) {
  const Camera<2> camera = cameraOf<2>(Viewport{{-3, -2}, {3, 2}}, 300);
  PictureDraw<2> draw(camera);
  const auto ball = Shape<2>::sphere(1), plane = Shape<2>::plane();
  draw.shape(ball.view(), {}, {kOther, kOther});
  draw.shape(plane.view(), {}, {kInk, kInk, false, false});
  Pixels seen = pixelsOf(draw.picture());
  EXPECT_EQ(seen.at(camera.pixel({0.3, -0.5})), kOther);
  EXPECT_EQ(seen.at(camera.pixel({2, -1})), kInk);
  EXPECT_EQ(seen.at(camera.pixel({2, 1})), kPaper);
  draw.shape(plane.view(), {}, {kInk, kInk, false, true});
  seen = pixelsOf(draw.picture());
  EXPECT_EQ(seen.at(camera.pixel({2, -1})), kPaper);
}

// Transparent shapes show half of what is behind them, in both file formats; words have their colour.
TEST(PictureDraw, ShinesThroughAndHasWords) {
  const Camera<2> camera = cameraOf<2>(Viewport{{-3, -2}, {3, 2}}, 300);
  PictureDraw<2> draw(camera);
  const auto ball = Shape<2>::sphere(1);
  const DrawColour half{200, 0, 0, 128};
  draw.shape(ball.view(), {}, {half, half});
  draw.text({1, 1}, "300 mm", kOther);
  const Picture picture = draw.picture();
  const DrawColour seen = pixelsOf(picture).at(camera.pixel({0.3, 0.3}));
  EXPECT_NEAR(seen.red, (200 + 247) / 2, 2);
  EXPECT_NEAR(seen.blue, 245 / 2, 2);
  const Workspace w;
  writeFilm(w.path("one.strip.svg"), FilmKind::strip, {1, 0, [&](std::size_t) { return picture; }});
  const std::string svg = readFile(w.path("one.strip.svg"));
  EXPECT_NE(svg.find("fill=\"#c8000080\""), svg.npos);
  EXPECT_NE(svg.find("fill=\"#0000c8\""), svg.npos);
  EXPECT_NE(svg.find(">300 mm</text>"), svg.npos);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::picture_draw_test
