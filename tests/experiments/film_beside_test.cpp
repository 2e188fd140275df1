// SPDX-License-Identifier: Zlib
// Two runs side by side: where they diverge, and that both are visible.
#include <png.h>

#include <regex>
#include <set>

#include "experiments/parse/toml_reader.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace film_beside_test { namespace {

using test::Outcome;
using test::Workspace;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

// Two runs are equal until their solvers differ; a larger tolerance reports it later.
TEST(FilmBeside, ShowsTwoRunsFromTheirDivergence) {
  Workspace w;
  const std::string run = "run pyramid --param base=4 --steps 60 --record ";
  ASSERT_EQ(w.lpc(run + "a.rec").code, 0);
  ASSERT_EQ(w.lpc(run + "b.rec --pipeline solver=soft_step").code, 0);
  EXPECT_NE(w.lpc("replay a.rec --beside a.rec").text.find("do not diverge: 61 frames"), std::string::npos);
  const auto step = [&](const std::string& more) {
    const Outcome out = w.lpc("replay a.rec --beside b.rec " + more);
    EXPECT_EQ(out.code, 0) << out.text;
    std::smatch found;
    EXPECT_TRUE(std::regex_search(out.text, found, std::regex("diverge at step ([0-9]+): body [0-9]+ is ")))
        << out.text;
    return found.empty() ? -1 : std::stol(found[1]);
  };
  EXPECT_EQ(step(""), 1);
  const long later = step("--tolerance 0.0005 --film both.strip.svg");
  EXPECT_GT(later, 1);
  const std::string svg = readFile(w.path("both.strip.svg"));
  EXPECT_EQ(countOf(svg, ">step " + std::to_string(later - 1) + ", "), 2u) << "it begins before they part";
}

struct Halves {
  std::multiset<std::string> left, right;  // outlines, in pixels from the left end of each half
  bool covered = false;                    // one half draws over the other
};

Halves halvesOf(const std::string& picture, double half) {
  Halves out;
  const std::regex path("<path d=\"([^\"]*)Z\""), corner("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::sregex_iterator p(picture.begin(), picture.end(), path), end; p != end; ++p) {
    const std::string corners = (*p)[1];
    std::vector<Vec<2>> points;
    double least = 1e9, most = -1e9;
    for (std::sregex_iterator c(corners.begin(), corners.end(), corner); c != end; ++c) {
      points.push_back({std::stod((*c)[1]), std::stod((*c)[2])});
      least = std::min(least, points.back()[0]), most = std::max(most, points.back()[0]);
    }
    if (least == half && most == half) continue;  // the dividing line
    const bool left = most <= half + 0.1, right = least >= half - 0.1;
    if (!left && !right) out.covered = true;
    std::string text;
    for (const Vec<2>& at : points) {
      text += std::to_string(std::lround(at[0] - (right ? half : 0))) + "," + std::to_string(std::lround(at[1])) + " ";
    }
    (right ? out.right : out.left).insert(text);
  }
  return out;
}

// The pictures of a strip.
std::vector<std::string> picturesOf(const std::string& svg) {
  std::vector<std::string> out;
  for (std::size_t at = svg.find("<svg x="); at != svg.npos; at = svg.find("<svg x=", at + 1)) {
    out.push_back(svg.substr(at, svg.find("</svg>", at) - at));
  }
  return out;
}
double halfOf(const std::string& picture) {
  std::smatch width;
  return std::regex_search(picture, width, std::regex("width=\"([0-9.]+)\"")) ? std::stod(width[1]) / 2 : 0;
}

// In the last step before they diverge, both halves show the same, and neither floor, which is endless, hides the other
// run.
TEST(FilmBeside, BothHalvesAreDrawn) {
  std::vector<std::string> others = {"2 --pipeline solver=soft_step", "3 --pipeline solver=soft_step"};
  if (std::filesystem::exists(LPC_BINARY_DIR "/bin/lpc-engine-worker-f64")) {
    others.push_back("3 --pipeline engine=bullet");
  }
  for (const std::string& other : others) {
    Workspace w;
    const std::string run = "run pyramid --param base=3 --steps 30 ", dimension = other.substr(0, 1);
    ASSERT_EQ(w.lpc(run + "--record a.rec --dimension " + dimension).code, 0);
    ASSERT_EQ(w.lpc(run + "--record b.rec --dimension " + other).code, 0);
    ASSERT_EQ(w.lpc("replay a.rec --beside b.rec --film both.strip.svg").code, 0);
    const auto pictures = picturesOf(readFile(w.path("both.strip.svg")));
    ASSERT_FALSE(pictures.empty());
    const double half = halfOf(pictures[0]);
    EXPECT_GE(half, 320) << "as large as a picture of one run";
    const Halves seen = halvesOf(pictures[0], half);
    EXPECT_FALSE(seen.covered) << other;
    EXPECT_GT(seen.left.size(), 6u) << other;
    EXPECT_EQ(seen.left, seen.right) << other;
    // Planted bug: the endless floor of the right run is not clipped.
    const std::string floor = "<path d=\"M-900.0 300.0L3000.0 300.0L3000.0 900.0L-900.0 900.0Z\"/>";
    EXPECT_TRUE(halvesOf(pictures[0] + floor, half).covered);
  }
}

// A ball at rest and a flying ball above a floor.
void writeFlight(const Workspace& w) {
  w.write("flight.toml",
          "name = \"flight\"\nsummary = \"s\"\ndimensions = [2, 3]\nsteps = 12\ngravity = [0, 0, 0]\n"
          "[parameters]\nspeed = { default = 0, min = -200, max = 200, meaning = \"m/s\" }\n"
          "[[body]]\ntype = \"fixed\"\nposition = [0, -1]\nshapes = [{ kind = \"plane\" }]\n"
          "[[body]]\nshapes = [{ kind = \"circle\", radius = 0.5 }]\n"
          "[[body]]\nposition = [3, 2]\nvelocity = [\"speed\", 0]\nshapes = [{ kind = \"circle\", radius = 0.5 }]\n");
}

struct Image {
  std::size_t width = 0, height = 0;
  std::vector<png_byte> rgb;

  png_byte* at(std::size_t x, std::size_t y) { return &rgb[3 * (y * width + x)]; }
  const png_byte* at(std::size_t x, std::size_t y) const { return &rgb[3 * (y * width + x)]; }
  // Static bodies, the ground and the dividing line are grey.
  bool coloured(std::size_t x, std::size_t y) const {
    const auto [least, most] = std::minmax({at(x, y)[0], at(x, y)[1], at(x, y)[2]});
    return most - least > 12;
  }
};

Image readPng(const std::string& path) {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  Image out;
  if (!png_image_begin_read_from_file(&head, path.c_str())) return out;
  head.format = PNG_FORMAT_RGB;
  out.width = head.width, out.height = head.height;
  out.rgb.resize(3 * out.width * out.height);
  png_image_finish_read(&head, nullptr, out.rgb.data(), 0, nullptr);
  return out;
}

// A film of b beside a must equal that of a beside b with its halves swapped, and each half must show a moving body.
// Empty if this holds.
std::string faultOf(const Image& ab, const Image& ba) {
  const std::size_t half = ab.width / 2;
  if (half == 0 || ba.width != ab.width || ba.height != ab.height) return "no two pictures of one size";
  std::size_t left = 0, right = 0;
  for (std::size_t y = 2; y + 2 < ab.height; ++y) {
    for (std::size_t x = 2; x + 2 < half; ++x) {  // without the frame
      left += ab.coloured(x, y), right += ab.coloured(half + x, y);
      if (!std::equal(ab.at(x, y), ab.at(x, y) + 3, ba.at(half + x, y)) ||
          !std::equal(ba.at(x, y), ba.at(x, y) + 3, ab.at(half + x, y))) {
        return "another pixel at " + std::to_string(x) + ", " + std::to_string(y);
      }
    }
  }
  if (left < 50 || right < 50) return "nobody on the " + std::string(left < 50 ? "left" : "right");
  return "";
}

// The ball of the right run leaves its half to the left, and the floor is endless.
TEST(FilmBeside, BothHalvesAreSeenInPixels) {
  for (const char* dimension : {"2", "3"}) {
    Workspace w;
    writeFlight(w);
    const std::string run = "run flight.toml --steps 6 --dimension " + std::string(dimension) + " --param speed=";
    ASSERT_EQ(w.lpc(run + "0 --record a.rec").code, 0);
    ASSERT_EQ(w.lpc(run + "-120 --record b.rec").code, 0);
    ASSERT_EQ(w.lpc("replay a.rec --beside b.rec --film ab/").code, 0);
    ASSERT_EQ(w.lpc("replay b.rec --beside a.rec --film ba/").code, 0);
    for (int i = 0; i < 7; ++i) {
      const std::string name = "/0000" + std::to_string(i) + ".png";
      EXPECT_EQ(faultOf(readPng(w.path("ab" + name)), readPng(w.path("ba" + name))), "") << dimension << "D, " << name;
    }
    // Planted bugs: a left half that is painted over in both films, and a ball of one run in the other's half.
    Image ab = readPng(w.path("ab/00005.png")), ba = readPng(w.path("ba/00005.png"));
    Image strayed = ab;
    for (std::size_t y = 100; y < 110; ++y) std::fill(strayed.at(100, y), strayed.at(110, y), png_byte{102});
    EXPECT_NE(faultOf(strayed, ba), "");
    for (Image* hidden : {&ab, &ba}) {
      for (std::size_t y = 0; y < ab.height; ++y) {
        std::fill(hidden->at(0, y), hidden->at(0, y) + 3 * (ab.width / 2), png_byte{205});
      }
    }
    EXPECT_NE(faultOf(ab, ba), "");
  }
}

// In either order, the film is as long as the longer run and wide enough for both.
TEST(FilmBeside, IsAsLongAndAsWideAsBothNeed) {
  Workspace w;
  writeFlight(w);
  const std::string run = "run flight.toml --steps ";
  ASSERT_EQ(w.lpc(run + "3 --record short.rec").code, 0);
  ASSERT_EQ(w.lpc(run + "63 --record long.rec").code, 0);
  ASSERT_EQ(w.lpc(run + "12 --param speed=30 --record flies.rec").code, 0);
  const std::string film = " --film x.svg", names[] = {"short.rec --beside long.rec", "long.rec --beside short.rec"};
  for (const std::string& both : names) {
    const Outcome out = w.lpc("replay " + both + film);
    EXPECT_NE(out.text.find("diverge at step 3: one run continues"), std::string::npos) << out.text;
    EXPECT_NE(readFile(w.path("x.svg")).find("animation: turn 1.01667s"), std::string::npos)
        << both;  // 2/60 to 63/60 s
  }
  for (const bool swapped : {false, true}) {
    const std::string other = swapped ? "flies.rec --beside short.rec" : "short.rec --beside flies.rec";
    ASSERT_EQ(w.lpc("replay " + other + " --film x.strip.svg").code, 0);
    const std::string last = picturesOf(readFile(w.path("x.strip.svg"))).back();
    const Halves seen = halvesOf(last, halfOf(last));
    EXPECT_EQ(seen.left.size(), 5u) << "a floor, two balls and how they are turned: " << last;
    EXPECT_EQ(seen.right.size(), 5u) << last;
  }
}

// Bodies correspond if slot and generation agree. A body that only one run has is named.
TEST(FilmBeside, CorrespondingBodiesHaveOneSlotAndGeneration) {
  Workspace w;
  std::string scene =
      "name = \"cast\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 8\ngravity = [0, 0, 0]\n"
      "[parameters]\nghost = { default = 99, min = 0, max = 99, meaning = \"when one comes and goes\" }\n";
  for (const char* n : {"0", "1", "2", "3"}) {
    scene += "gone_" + std::string(n) + " = { default = 99, min = 0, max = 99, meaning = \"when this one goes\" }\n";
  }
  // Events run in the order of the file: the new body is added before another is removed, so it does not get that slot.
  const std::string ball = "position = [1, 0]\nshapes = [{ kind = \"circle\", radius = 0.2 }]\n";
  std::string going = "[[event]]\ndo = \"remove\"\nstep = \"ghost\"\nbody = \"ghost\"\n";  // in no frame
  for (const std::string n : {"0", "1", "2", "3"}) {
    scene += "[[body]]\nname = \"body_" + n + "\"\nposition = [" + n +
             ", 0]\nshapes = [{ kind = \"circle\", radius = 0.2 }]\n";
    going += "[[event]]\ndo = \"remove\"\nstep = \"gone_" + n + "\"\nbody = \"body_" + n + "\"\n";
  }
  scene += "[[event]]\ndo = \"add\"\nstep = \"ghost\"\nname = \"ghost\"\n" + ball +
           "[[event]]\ndo = \"add\"\nstep = 5\nname = \"new\"\n" + ball + going;
  w.write("cast.toml", scene);
  const auto record = [&](const std::string& name, const std::string& parameters) {
    const Outcome out = w.lpc("run cast.toml " + parameters + " --record " + name);
    ASSERT_EQ(out.code, 0) << out.text;
  };
  record("without_1.rec", "--param gone_1=5"), record("without_3.rec", "--param gone_3=5");
  record("all.rec", ""), record("ghost.rec", "--param ghost=3");
  const std::pair<const char*, const char*> cases[] = {
      {"without_1.rec --beside without_3.rec", ": body 1 exists in one run only\n"},  // bodies 0, 2, 3 and 0, 1, 2
      {"without_3.rec --beside without_1.rec", ": body 1 exists in one run only\n"},
      {"all.rec --beside without_1.rec", ": one run has 5 bodies, the other 4\n"},
      {"all.rec --beside all.rec", "the runs do not diverge: 9 frames are within 1e-06 m and rad\n"},
      {"all.rec --beside ghost.rec --tolerance 5", ": body 4 is a different body in each run\n"},
  };
  for (const auto& [arguments, end] : cases) {
    const Outcome out = w.lpc(std::string("replay ") + arguments);
    EXPECT_TRUE(out.text.ends_with(end)) << arguments << ": " << out.text;
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::film_beside_test
