// SPDX-License-Identifier: Zlib
// A run can be watched: strips, moving pictures and PNG frames of recordings, and two runs beside one another.
#include <regex>
#include <set>

#include "experiments/parse/toml_reader.h"
#include "tests/experiments/workspace.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using test::Outcome;
using test::Workspace;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

// The pixels from top to bottom that bodies which move cover in each picture of a film.
std::vector<std::pair<double, double>> heights(const std::string& svg) {
  std::vector<std::pair<double, double>> out;
  const std::regex path("<path d=\"([^\"]*)Z\" fill=\"#([0-9a-f]*)\""), corner("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::size_t from = svg.find("<text"), begin = 0; from != svg.npos;
       begin = from, from = svg.find("<text", from + 1)) {
    const std::string picture = svg.substr(begin, from - begin);
    std::pair<double, double> span(1e9, -1e9);
    for (std::sregex_iterator p(picture.begin(), picture.end(), path), end; p != end; ++p) {
      if ((*p)[2].str().substr(0, 2) == (*p)[2].str().substr(2, 2)) continue;  // grey: fixed
      const std::string corners = (*p)[1];
      for (std::sregex_iterator c(corners.begin(), corners.end(), corner); c != end; ++c) {
        const double y = std::stod((*c)[2]);
        span = {std::min(span.first, y), std::max(span.second, y)};
      }
    }
    out.push_back(span);
  }
  return out;
}

// What is drawn is where bodies are: a ball that falls from 5 m is drawn lower and lower, and as large as it is.
TEST(Film, DrawsWhatHappens) {
  for (const char* dimension : {"2", "3"}) {
    Workspace w;
    const Outcome out =
        w.lpc(std::string("run bouncing_ball --steps 55 --film ball.strip.svg --dimension ") + dimension);
    ASSERT_EQ(out.code, 0) << out.text;
    const std::string svg = readFile(w.path("ball.strip.svg"));
    EXPECT_EQ(countOf(svg, "<text"), 8u);
    EXPECT_NE(svg.find(">step 0, 0.00 s<"), svg.npos);
    EXPECT_NE(svg.find(">step 55, 0.92 s<"), svg.npos);
    const auto seen = heights(svg);
    ASSERT_EQ(seen.size(), 8u);
    for (std::size_t i = 1; i < seen.size(); ++i) {
      EXPECT_GT(seen[i].first, seen[i - 1].first) << "picture " << i << " in " << dimension << "D";
      EXPECT_NEAR(seen[i].second - seen[i].first, seen[0].second - seen[0].first, 0.5) << "it has another size";
    }
  }
}

TEST(Film, MovesOrIsAFolder) {
  Workspace w;
  ASSERT_EQ(w.lpc("run pyramid --param base=4 --steps 30 --film p.svg --record p.rec").code, 0);
  const std::string svg = readFile(w.path("p.svg"));
  EXPECT_EQ(countOf(svg, "<g style=\"animation-delay: "), 31u);
  EXPECT_NE(svg.find("animation: turn 0.5s"), svg.npos) << "as long as the run";

  const Outcome out = w.lpc("replay p.rec --film frames/");
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_NE(out.text.find("2D, steps 0 to 30 (0.5 s), 11 bodies"), std::string::npos) << out.text;
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(w.path("frames"))) {
    const std::string bytes = readFile(entry.path());
    EXPECT_TRUE(bytes.starts_with("\x89PNG") && bytes.size() > 1000) << entry.path();
    ++pictures;
  }
  EXPECT_EQ(pictures, 31u);
  // Every shape kind, in parts, has a picture.
  EXPECT_EQ(w.lpc("run cylinders --pipeline contacts=query_clip --steps 5 --film c.svg").code, 0);
  EXPECT_EQ(w.lpc("run compounds --dimension 3 --steps 5 --film d.svg").code, 0);
  EXPECT_EQ(w.lpc("run director_1 --steps 40 --film e.svg").code, 0);
}

// Two runs are the same until their solvers have told them apart; whoever looks less closely sees it later.
TEST(Film, TwoRunsFromWhereTheyPart) {
  Workspace w;
  const std::string run = "run pyramid --param base=4 --steps 60 --record ";
  ASSERT_EQ(w.lpc(run + "a.rec").code, 0);
  ASSERT_EQ(w.lpc(run + "b.rec --pipeline solver=soft_step").code, 0);
  EXPECT_NE(w.lpc("replay a.rec --beside a.rec").text.find("never part: 61 frames"), std::string::npos);
  const auto step = [&](const std::string& more) {
    const Outcome out = w.lpc("replay a.rec --beside b.rec " + more);
    EXPECT_EQ(out.code, 0) << out.text;
    std::smatch found;
    EXPECT_TRUE(std::regex_search(out.text, found, std::regex("part at step ([0-9]+): body [0-9]+ is "))) << out.text;
    return found.empty() ? -1 : std::stol(found[1]);
  };
  EXPECT_EQ(step(""), 1);
  const long later = step("--tolerance 0.0005 --film both.strip.svg");
  EXPECT_GT(later, 1);
  const std::string svg = readFile(w.path("both.strip.svg"));
  EXPECT_EQ(countOf(svg, ">step " + std::to_string(later - 1) + ", "), 2u) << "it begins before they part";
}

// The outlines that one half of a picture shows, in pixels from its left end.
std::multiset<std::string> drawnIn(const std::string& picture, double half, bool right) {
  std::multiset<std::string> out;
  const std::regex path("<path d=\"([^\"]*)Z\""), corner("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::sregex_iterator p(picture.begin(), picture.end(), path), end; p != end; ++p) {
    const std::string corners = (*p)[1];
    std::string text;
    double least = 1e9, most = -1e9;
    for (std::sregex_iterator c(corners.begin(), corners.end(), corner); c != end; ++c) {
      const double x = std::stod((*c)[1]);
      least = std::min(least, x), most = std::max(most, x);
      text += std::to_string(std::lround(right ? x - half : x)) + "," +
              std::to_string(std::lround(std::stod((*c)[2]))) + " ";
    }
    if (least == half && most == half) continue;  // what divides them
    EXPECT_TRUE(most <= half + 0.1 || least >= half - 0.1) << "one half covers the other: " << corners;
    if (right ? least >= half - 0.1 : most <= half + 0.1) out.insert(text);
  }
  return out;
}

// In the last step before they part both halves show the same, and neither floor, which has no end, hides the other
// run.
TEST(Film, BothHalvesAreSeen) {
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
    const std::string svg = readFile(w.path("both.strip.svg")), head = "<svg x=\"";
    const std::size_t first = svg.find(head);
    ASSERT_NE(first, svg.npos);
    const std::string picture = svg.substr(first, svg.find("</svg>", first) - first);
    std::smatch width;
    ASSERT_TRUE(std::regex_search(picture, width, std::regex("width=\"([0-9.]+)\"")));
    const double half = std::stod(width[1]) / 2;
    EXPECT_GE(half, 320) << "as large as a picture of one run";
    const auto left = drawnIn(picture, half, false), right = drawnIn(picture, half, true);
    EXPECT_GT(left.size(), 6u) << other;
    EXPECT_EQ(left, right) << other;
  }
}

TEST(Film, RefusesInOneLineAndLeavesNothing) {
  Workspace w;
  w.write("none.rec", "no recording");
  std::filesystem::create_directory(w.path("full"));
  w.write("full/of", "something");
  std::filesystem::create_directory(w.path("temporary"));
  const std::pair<const char*, const char*> cases[] = {
      {"run pyramid --film ball.mp4", "valid: NAME.svg"},
      {"run pyramid --film nowhere/ball.svg", "nowhere/ball.svg: cannot be written"},
      {"run pyramid --film full/", "full/: is there and not empty"},
      {"replay none.rec --film x.svg", "none.rec: this is not a recording"},
      {"replay absent.rec", "absent.rec: cannot be read"},
  };
  for (const auto& [arguments, part] : cases) {
    const Outcome out = w.lpc(arguments, "TMPDIR=" + w.path("temporary"));
    EXPECT_EQ(out.code, 2) << arguments;
    EXPECT_NE(out.text.find(part), std::string::npos) << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
  }
  ASSERT_EQ(w.lpc("run pyramid --param base=2 --steps 2 --film ok.svg", "TMPDIR=" + w.path("temporary")).code, 0);
  EXPECT_TRUE(std::filesystem::is_empty(w.path("temporary"))) << "the film's recording stayed";
  EXPECT_FALSE(std::filesystem::exists(w.path("x.svg")));
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
