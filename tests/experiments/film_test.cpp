// SPDX-License-Identifier: Zlib
// Films of one run: strips, animations and PNG frames from recordings. film_beside_test.cpp tests two runs.
#include <nlohmann/json.hpp>
#include <regex>

#include "experiments/parse/toml_reader.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace film_test { namespace {

using nlohmann::json;
using test::Outcome;
using test::Workspace;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

// The vertical pixel range covered by moving bodies in each picture of a film.
std::vector<std::pair<double, double>> heights(const std::string& svg) {
  std::vector<std::pair<double, double>> out;
  const std::regex path("<path d=\"([^\"]*)Z\" fill=\"#([0-9a-f]*)\""), corner("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::size_t from = svg.find(">step "), begin = 0; from != svg.npos;
       begin = from, from = svg.find(">step ", from + 1)) {
    const std::string picture = svg.substr(begin, from - begin);
    std::pair<double, double> span(1e9, -1e9);
    for (std::sregex_iterator p(picture.begin(), picture.end(), path), end; p != end; ++p) {
      if ((*p)[2].str().substr(0, 2) == (*p)[2].str().substr(2, 2)) continue;  // grey: static
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

// Bodies are drawn where they are: a ball that falls from 5 m is drawn lower and lower, at its size.
TEST(Film, DrawsWhatHappens) {
  for (const char* dimension : {"2", "3"}) {
    Workspace w;
    const Outcome out =
        w.lpc(std::string("run bouncing_ball --steps 55 --film ball.strip.svg --dimension ") + dimension);
    ASSERT_EQ(out.code, 0) << out.text;
    const std::string svg = readFile(w.path("ball.strip.svg"));
    EXPECT_EQ(countOf(svg, ">split_solver catto split_impulse<"), 8u);
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

// Of each picture of a strip: faces of static bodies, which are grey, and of moving ones that reach into it.
struct Seen {
  std::size_t fixed = 0, moving = 0;
};
std::vector<Seen> seenIn(const std::string& svg) {
  std::vector<Seen> out;
  const std::regex size(" width=\"([0-9.]+)\" height=\"([0-9.]+)\""), corner("[ML]([-0-9.]+) ([-0-9.]+)");
  const std::regex path("<path d=\"([^\"]*)Z\" fill=\"#([0-9a-f]*)\"");
  for (std::size_t at = svg.find("<svg x="); at != svg.npos; at = svg.find("<svg x=", at + 1)) {
    const std::string picture = svg.substr(at, svg.find("</svg>", at) - at);
    std::smatch wide;
    if (!std::regex_search(picture, wide, size)) continue;
    Seen seen;
    for (std::sregex_iterator p(picture.begin(), picture.end(), path), end; p != end; ++p) {
      const std::string corners = (*p)[1], fill = (*p)[2];
      double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
      for (std::sregex_iterator c(corners.begin(), corners.end(), corner); c != end; ++c) {
        const double x = std::stod((*c)[1]), y = std::stod((*c)[2]);
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
      }
      if (right < 0 || left > std::stod(wide[1]) || bottom < 0 || top > std::stod(wide[2])) continue;
      ++(fill.substr(0, 2) == fill.substr(2, 2) ? seen.fixed : seen.moving);
    }
    out.push_back(seen);
  }
  return out;
}

// The camera sees the bodies until the end, and the ground: at a fall of 28 m, beside a body that flies off at 60 m/s,
// with bodies that come later, and with a lone body that flies 4 km. A fixed camera of 10 m showed empty pictures.
TEST(Film, KeepsBodiesAndGroundInView) {
  const std::string head = "name = \"s\"\nsummary = \"s\"\ndimensions = [2, 3]\nsteps = 140\n",
                    floor =
                        "[[body]]\ntype = \"fixed\"\nposition = [0, -1]\n"
                        "shapes = [{ kind = \"box\", half = [30, 1, 3] }]\n",
                    ball = "shapes = [{ kind = \"circle\", radius = 0.5 }]\n";
  const auto body = [&](const std::string& keys) { return "[[body]]\n" + keys + ball; };
  struct Case {
    const char* what;
    std::string scene;
    bool ground;
  };
  const Case cases[] = {
      {"fall", head + floor + body("position = [0, 28]\n"), true},
      {"slide", head + floor + body("position = [-28, 0.5]\nvelocity = [24, 0]\n"), true},
      {"one flies off",
       head + floor + body("position = [0, 0.5]\n") + body("position = [3, 0.5]\n") +
           body("position = [6, 0.5]\nvelocity = [60, 60]\n"),
       true},
      {"later",
       head + floor + body("position = [0, 0.5]\n") + "[[event]]\ndo = \"add\"\nstep = 20\nposition = [8, 24]\n" + ball,
       true},
      {"flight", "gravity = [0, 0]\n" + head + body("velocity = [2000, 1000]\n"), false},
  };
  for (const Case& c : cases) {
    for (const std::string dimension : {"2", "3"}) {
      Workspace w;
      w.write("s.toml", c.scene);
      const Outcome ran = w.lpc("run s.toml --film s.strip.svg --dimension " + dimension);
      ASSERT_NE(ran.code, 2) << c.what << ": " << ran.text;
      const std::vector<Seen> seen = seenIn(readFile(w.path("s.strip.svg")));
      ASSERT_EQ(seen.size(), 8u) << c.what;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        EXPECT_GT(seen[i].moving, 0u) << c.what << ", picture " << i << " in " << dimension << "D";
        EXPECT_TRUE(!c.ground || seen[i].fixed > 0) << c.what << ", picture " << i << " in " << dimension << "D";
      }
    }
  }
}

// A film is as wide as its page, and draws joints and springs.
TEST(Film, ScalesAndShowsWhatHoldsBodies) {
  Workspace w;
  const std::string scene =
      "name = \"s\"\nsummary = \"s\"\ndimensions = [2, 3]\nsteps = 2\n[[body]]\nname = \"b\"\nposition = [1, -2]\n"
      "shapes = [{ kind = \"circle\", radius = 0.5 }]\n";
  const std::string nail =
      "[[body]]\nname = \"nail\"\ntype = \"fixed\"\nshapes = [{ kind = \"circle\", radius = 0.1, mask = 0 }]\n";
  w.write("joint.toml", "needs = [\"joints\"]\n" + scene + nail +
                            "[[joint]]\nkind = \"pivot\"\na = \"nail\"\nb = \"b\"\nanchor = [0, 0]\n");
  w.write("spring.toml", scene + "[[force]]\nkind = \"spring\"\nb = \"b\"\nanchor_a = [0, 0]\nanchor_b = [0.3, 0]\n");
  w.write("free.toml", scene);
  const std::string joint = "fill=\"#146ea0\"", spring = "fill=\"#8c5a28\"";
  for (const std::string dimension : {"2", "3"}) {
    for (const std::string name : {"joint", "spring", "free"}) {
      const Outcome ran = w.lpc("run " + name + ".toml --film s.strip.svg --dimension " + dimension);
      ASSERT_EQ(ran.code, 0) << ran.text;
      const std::string svg = readFile(w.path("s.strip.svg")), root = svg.substr(0, svg.find('>'));
      EXPECT_NE(root.find("width=\"100%\" viewBox=\"0 0 "), root.npos) << root;
      EXPECT_EQ(root.find("height="), root.npos) << root;
      // In each of three pictures two anchors, a line from that of the body to its centre, and a spring between them.
      EXPECT_EQ(countOf(svg, joint), name == "joint" ? 9u : 0u) << name << dimension;
      EXPECT_EQ(countOf(svg, spring), name == "spring" ? 12u : 0u) << name << dimension;
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

// A ball falls from 1 m: after step n at semi-implicit Euler it is g dt^2 n (n + 1) / 2 lower. The rows say so, to the
// last digits, in CSV and JSON.
TEST(Trajectory, RowsAreTheRun) {
  Workspace w;
  w.write("fall.toml",
          "name = \"f\"\nsummary = \"s\"\ndimensions = [2, 3]\nsteps = 10\ndt = 0.125\ngravity = [0, -8]\n"
          "[[body]]\nposition = [0, 100]\nvelocity = [3, 0]\nshapes = [{ kind = \"sphere\", radius = 1 }]\n");
  for (const std::string dimension : {"2", "3"}) {
    const std::string run = "run fall.toml --dimension " + dimension + " --record ";
    const Outcome out = w.lpc(run + "r.csv --film f.svg");
    ASSERT_EQ(out.code, 0) << out.text;
    EXPECT_NE(out.text.find("rows      r.csv"), out.text.npos) << out.text;
    const std::string csv = readFile(w.path("r.csv"));
    const bool flat = dimension == "2";
    EXPECT_TRUE(csv.starts_with(flat
                                    ? "step,time,body,generation,x,y,angle,vx,vy,omega,awake\n0,0,0,0,0,100,0,3,0,0,1\n"
                                    : "step,time,body,generation,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz,awake\n"))
        << csv;
    const std::string last =
        flat ? "\n10,1.25,0,0,3.75,93.125,0,3,-10,0,1\n" : "\n10,1.25,0,0,3.75,93.125,0,1,0,0,0,3,-10,0,0,0,0,1\n";
    EXPECT_TRUE(csv.ends_with(last)) << csv;
    ASSERT_EQ(w.lpc(run + "r.json").code, 0);
    const json all = json::parse(readFile(w.path("r.json")));
    EXPECT_EQ(all.at("rows").size(), 11u);
    EXPECT_EQ(all.at("columns").size(), all.at("rows")[0].size());
    EXPECT_EQ(all.at("rows")[10][5], 93.125);
    EXPECT_EQ(all.at("dimension"), flat ? 2 : 3);
  }
  EXPECT_EQ(w.lpc("replay r.csv").code, 2) << "rows are for other programs";
}

// The rotation of a shape in its body has unit length only to the rounding of the precision that wrote it.
TEST(Film, OfSinglePrecision) {
  if (!test::kSingle) GTEST_SKIP() << "this build has no f32";
  Workspace w;
  w.write("turned.toml",
          "name = \"t\"\nsummary = \"s\"\ndimensions = [2, 3]\nsteps = 3\n[[body]]\nrepeat = { i = 20 }\n"
          "position = [\"4 * i\", 0]\nangle = \"i\"\n"
          "shapes = [{ kind = \"box\", half = [1, 1, 1], angle = [0, \"i / 3\", \"i / 7\"] }]\n");
  for (const std::string dimension : {"2", "3"}) {
    const Outcome ran = w.lpc("run turned.toml --precision f32 --record r.rec --dimension " + dimension);
    ASSERT_EQ(ran.code, 0) << ran.text;
    const Outcome out = w.lpc("replay r.rec --film r.svg");
    EXPECT_EQ(out.code, 0) << out.text;
    EXPECT_NE(out.text.find("film      r.svg"), std::string::npos) << out.text;
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
      {"run pyramid --film full/", "full/: the folder exists and is not empty"},
      {"run pyramid --film nowhere/frames/ --record early.rec", "nowhere/frames/: cannot be written: No such file"},
      {"run pyramid --film full/of/frames/ --record early.rec", "full/of/frames/: cannot be written: Not a directory"},
      {"replay none.rec --film x.svg", "none.rec: this is not a recording"},
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
  EXPECT_FALSE(std::filesystem::exists(w.path("early.rec"))) << "it ran before it was refused";
  const Outcome homeless = w.lpc("run pyramid --film x.svg", "TMPDIR=/nonexistent");
  EXPECT_EQ(homeless.code, 2) << homeless.text;
  EXPECT_TRUE(homeless.text.starts_with("lpc: TMPDIR=/nonexistent: ")) << homeless.text;
}

// A folder is first written under another name; an existing folder of that name is not used.
TEST(Film, LeavesOtherFoldersAlone) {
  Workspace w;
  std::filesystem::create_directory(w.path("keep.partial"));
  w.write("keep.partial/mine", "1");
  const Outcome out = w.lpc("run pyramid --param base=2 --steps 2 --film keep/");
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(readFile(w.path("keep.partial/mine")), "1");
  EXPECT_TRUE(std::filesystem::exists(w.path("keep/00002.png")));
  const std::filesystem::directory_iterator all(w.path(""));
  EXPECT_EQ(std::distance(begin(all), end(all)), 2) << "something half-written stayed";
}

// A failed film does not lose the run's results.
TEST(Film, IsDrawnAfterTheResultsArePrinted) {
  Workspace w;
  std::filesystem::create_symlink("/dev/full", w.path("full.svg"));
  const Outcome out = w.lpc("run pyramid --param base=2 --steps 2 --film full.svg");
  EXPECT_EQ(out.code, 2) << out.text;
  EXPECT_NE(out.text.find("\nhash "), std::string::npos) << out.text;
  EXPECT_NE(out.text.find("\nlpc: full.svg: cannot be written: No space left"), std::string::npos) << out.text;
}

// Sends a signal at a known moment: once `started` exists.
Outcome stopped(const Workspace& w, const std::string& command, const std::string& started) {
  return w.shell(
      "{ TMPDIR=$PWD/temporary " LPC_BINARY_DIR "/bin/lpc " + command + " > out.txt & i=0; while ! ls " + started +
      " > none.txt 2>&1 && [ $i -lt 600 ]; do sleep 0.1; i=$((i + 1)); done; kill -TERM $!; wait $!; code=$?; " +
      "cat out.txt; rm -f out.txt none.txt; exit $code; }");
}

TEST(Film, InterruptedLeavesNothing) {
  Workspace w;
  std::filesystem::create_directory(w.path("temporary"));
  const std::string run = "run pyramid --param base=2 --dimension 2 --steps ";
  Outcome out = stopped(w, run + "100000000 --film x.svg", "temporary/*/*.partial");
  EXPECT_EQ(out.code, 130) << out.text;
  EXPECT_TRUE(std::filesystem::is_empty(w.path("temporary"))) << "the film's recording stayed";
  out = stopped(w, run + "100000000 --record r.rec --profile p.csv", "r.rec.partial");
  EXPECT_EQ(out.code, 130) << out.text;
  ASSERT_EQ(w.lpc(run + "3000 --record whole.rec").code, 0);
  out = stopped(w, "replay whole.rec --film frames/", "frames.partial/00000.png");
  EXPECT_EQ(out.code, 130) << out.text;
  std::string left;
  for (const auto& entry : std::filesystem::directory_iterator(w.path("")))
    left += entry.path().filename().string() + " ";
  EXPECT_TRUE(left == "temporary whole.rec " || left == "whole.rec temporary ") << left;
}

// The film of a long run shows a part of it and says so. For PNG files the message also says that steps and times are
// missing.
TEST(Film, ReportsWhatItOmits) {
#if defined(LPC_SANITIZED)
  GTEST_SKIP() << "600 pictures by what other tests draw under sanitizers";
#endif
  Workspace w;
  // Bodies in a long row make pictures low, so that 600 are made quickly.
  w.write("fly.toml",
          "name = \"fly\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 700\ngravity = [0, 0]\n"
          "[[body]]\nrepeat = { i = 2 }\nposition = [\"100 * i\", 0]\nvelocity = [10, 0]\n"
          "shapes = [{ kind = \"circle\", radius = 0.1 }]\n");
  ASSERT_EQ(w.lpc("run fly.toml --record r.rec").code, 0);
  const std::pair<const char*, const char*> cases[] = {
      {"x.svg", "film      x.svg: 120 of 701 frames\n"},
      {"x.strip.svg", "film      x.strip.svg: 8 of 701 frames\n"},
      {"x/", "film      x/: 600 of 701 frames, without step numbers and times\n"},
  };
  for (const auto& [name, line] : cases) {
    const Outcome out = w.lpc(std::string("replay r.rec --film ") + name);
    EXPECT_TRUE(out.text.ends_with(line)) << out.text;
  }
}

// A body that flies as far as a run allows still gives a path of complete coordinate pairs.
TEST(Film, FarBodiesGiveValidPaths) {
  Workspace w;
  w.write("fly.toml",
          "name = \"fly\"\nsummary = \"s\"\ndimensions = [2, 3]\ndt = 10\nsteps = 20000\ngravity = [0, 0, 0]\n"
          "[[body]]\nvelocity = [-2.0e8, 1.5e8]\nshapes = [{ kind = \"circle\", radius = 1e-3 }]\n");
  ASSERT_EQ(w.lpc("run fly.toml --film far.strip.svg").code, 0);
  const std::string svg = readFile(w.path("far.strip.svg"));
  const std::regex path("<path d=\"([^\"]*)Z\""), whole("(([ML]-?[0-9]+\\.[0-9] -?[0-9]+\\.[0-9]))+");
  std::size_t paths = 0;
  for (std::sregex_iterator p(svg.begin(), svg.end(), path), end; p != end; ++p, ++paths) {
    EXPECT_TRUE(std::regex_match((*p)[1].str(), whole)) << (*p)[1];
  }
  EXPECT_GE(paths, 8u);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::film_test
