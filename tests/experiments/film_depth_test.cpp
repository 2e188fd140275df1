// SPDX-License-Identifier: Zlib
// Films in 3D: nearer bodies are drawn over farther ones, wherever their centres are.
#include <regex>

#include "experiments/film/camera.h"
#include "experiments/parse/toml_reader.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace film_depth_test { namespace {

using test::Outcome;
using test::Workspace;

// Colours of a static body's faces towards the viewer and upwards.
constexpr const char *kFront = "#a4a4a0", *kTop = "#cdcdc8";
// Colours of a scene's first bodies, awake.
constexpr const char* kBodies[] = {"#6699cc", "#eeaa55", "#77b277", "#cc7788", "#a08cc8", "#beb464"};

struct DrawnPath {
  std::vector<Vec<2>> corners;
  std::string fill;

  bool filled() const { return corners.size() > 2; }
  bool contains(const Vec<2>& p) const {
    int left = 0, right = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec<2> along = corners[(i + 1) % corners.size()] - corners[i], to = p - corners[i];
      (along[0] * to[1] - along[1] * to[0] > 0 ? left : right) += 1;
    }
    return left == 0 || right == 0;
  }
};

// Start of a run with two moving balls at kMarks, and other bodies: the positions of the balls in the picture give the
// camera.
const Vec<3> kMarks[] = {{-6, 6, 0}, {6, 6, 0}};
constexpr const char* kHead =
    "name = \"s\"\nsummary = \"s\"\ndimensions = [3]\nsteps = 1\ngravity = [0, 0, 0]\n"
    "[[body]]\nposition = [-6, 6, 0]\nshapes = [{ kind = \"sphere\", radius = 0.5 }]\n"
    "[[body]]\nposition = [6, 6, 0]\nshapes = [{ kind = \"sphere\", radius = 0.5 }]\n";

class FirstPicture {
 public:
  explicit FirstPicture(const std::string& bodies) {
    Workspace w;
    w.write("s.toml", kHead + bodies);
    const Outcome out = w.lpc("run ./s.toml --film s.strip.svg");
    EXPECT_EQ(out.code, 0) << out.text;
    const std::string svg = readFile(w.path("s.strip.svg")), picture = svg.substr(0, svg.find("<text"));
    const std::regex path("<path d=\"([^\"]*)Z\" fill=\"([^\"]*)\""), corner("[ML]([-0-9.]+) ([-0-9.]+)");
    for (std::sregex_iterator p(picture.begin(), picture.end(), path), end; p != end; ++p) {
      const std::string corners = (*p)[1];
      paths.push_back({{}, (*p)[2]});
      for (std::sregex_iterator c(corners.begin(), corners.end(), corner); c != end; ++c) {
        paths.back().corners.push_back({std::stod((*c)[1]), std::stod((*c)[2])});
      }
    }
    for (std::size_t i : {0, 1}) {
      const std::size_t at = indexOf(kBodies[i]);
      if (at == paths.size()) return;
      m_marks[i] = Vec<2>::Zero();
      for (const Vec<2>& c : paths[at].corners) m_marks[i] += c / static_cast<double>(paths[at].corners.size());
    }
  }

  /// Index of the first path of that colour; the number of paths if there is none.
  std::size_t indexOf(const std::string& fill) const {
    std::size_t i = 0;
    while (i < paths.size() && paths[i].fill != fill) ++i;
    EXPECT_LT(i, paths.size()) << "nothing is " << fill;
    return i;
  }
  /// The visible colour at a position in the world.
  std::string at(const Vec<3>& p_W) const {
    const Camera<3> camera;
    const Vec<2> from = camera.flat(kMarks[0]), to = camera.flat(kMarks[1]), there = camera.flat(p_W);
    const double scale = (m_marks[1] - m_marks[0]).norm() / (to - from).norm();
    const Vec<2> pixel = m_marks[0] + scale * Vec<2>(there[0] - from[0], from[1] - there[1]);
    std::string out = "nothing";
    for (const DrawnPath& p : paths) {
      if (p.filled() && p.contains(pixel)) out = p.fill;
    }
    return out;
  }

  std::vector<DrawnPath> paths;

 private:
  Vec<2> m_marks[2];
};

constexpr const char* kGround =
    "[[body]]\ntype = \"fixed\"\nshapes = [{ kind = \"mesh\", points = [[-10, 0, -10], [-10, 0, 10], [10, 0, 10], "
    "[10, 0, -10]], triangles = [[0, 1, 2], [0, 2, 3]] }]\n";

std::string block(const std::string& type, const std::string& position, const std::string& half) {
  return "[[body]]\ntype = \"" + type + "\"\nposition = " + position + "\nshapes = [{ kind = \"box\", half = " + half +
         " }]\n";
}
std::string ball(const std::string& position) {
  return "[[body]]\nposition = " + position + "\nshapes = [{ kind = \"sphere\", radius = 0.5 }]\n";
}

// The triangles of a ground are ordered by their distance, not by the ground's origin. The origin is nearer than the
// pillar and farther than the body under the ground.
TEST(FilmDepth, TheGroundIsBehindBodiesOnItAndBeforeBodiesUnderIt) {
  const FirstPicture seen(kGround + block("fixed", "[0, 1, -5]", "[1, 1, 1]") +
                          block("fixed", "[1, -2, 3]", "[1, 1, 1]"));
  EXPECT_EQ(seen.at({0, 1, -4}), kFront) << "the pillar's front";
  EXPECT_EQ(seen.at({0, 2, -5}), kTop) << "the pillar's top";
  EXPECT_EQ(seen.at({1, -2, 4}), kTop) << "the ground over the front of what is under it";
  EXPECT_EQ(seen.at({1, -2, 4}), seen.at({5, 0, 5})) << "the ground";
}

TEST(FilmDepth, ABodyIsVisibleOnAPlatformWithANearerCentre) {
  const FirstPicture seen(ball("[-8, 0.5, -8]") + block("kinematic", "[0, -0.5, 0]", "[10, 0.5, 10]"));
  EXPECT_EQ(seen.at({-8, 0.5, -8}), kBodies[2]);
  EXPECT_EQ(seen.at({0, 0, 0}), "#cc7788") << "the platform";
}

// Slots: 2 is the static body, 3 and 4 the balls.
TEST(FilmDepth, AStaticBodyIsTransparentBeforeOtherBodies) {
  const std::string wall = block("fixed", "[0, 2, 0]", "[3, 2, 0.2]"), before = ball("[1, 2, 2]");
  const FirstPicture one(wall + before);
  EXPECT_EQ(one.at({1, 2, 2}), kBodies[3]);
  EXPECT_EQ(one.at({-2, 1, 0.2}), kFront) << "the wall";

  const FirstPicture both(wall + before + ball("[-1, 2, -2]"));
  EXPECT_EQ(both.at({1, 2, 2}), kBodies[3]);
  EXPECT_EQ(both.at({-1, 2, -2}), kBodies[4]) << "the ball behind the wall";
  EXPECT_EQ(both.at({-2, 1, 0.2}), "nothing") << "the wall is not of glass";
  std::size_t lines = 0;
  for (std::size_t i = both.indexOf(kBodies[4]) + 1; i < both.indexOf(kBodies[3]); ++i)
    lines += !both.paths[i].filled();
  EXPECT_EQ(lines, 12u) << "the edges of three faces are drawn over the ball behind them, under that before them";
}

// The ground is transparent over bodies that fell through it.
TEST(FilmDepth, ABodyBelowTheGroundIsVisible) {
  const FirstPicture seen(kGround + ball("[0, 1, 0]") + ball("[1, -2, 3]"));
  EXPECT_EQ(seen.at({0, 1, 0}), kBodies[3]);
  EXPECT_EQ(seen.at({1, -2, 3}), kBodies[4]);
}

// Bodies that interpenetrate may cover each other in a cycle, which has no order.
TEST(FilmDepth, CyclesOfBodiesLoseNoBody) {
  const FirstPicture seen(
      "[[body]]\ntype = \"kinematic\"\nrepeat = { i = 40 }\nposition = [\"rand(-1, 1)\", \"rand(-1, 1)\", "
      "\"rand(-1, 1)\"]\nangle = [\"rand(0, 3)\", \"rand(0, 3)\", \"rand(0, 3)\"]\n"
      "shapes = [{ kind = \"box\", half = [2, 0.1, 0.1] }]\n");
  EXPECT_EQ(seen.paths.size(), 2u + 3 * 40);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::film_depth_test
