// SPDX-License-Identifier: Zlib
// A sweep keeps pictures of runs that fell: of the right runs, with bodies at the right places, and of no others.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "experiments/film/camera.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace falls_test { namespace {

using nlohmann::json;
using test::ask;
using test::Outcome;
using test::Workspace;

// The towers that are drawn fall in the plane of the picture, so that distances in it are those in space.
const std::string kTowers = R"(summary = "towers that fall"
kind = "world"
pipeline = "contacts=sat_clip cache=by_feature"
[axes]
scene = "vertical_stack"
n = [2, 7, 14]
dimension = [2, 3]
[axes.resolver]
"millington" = "solver=split_solver{velocity=millington{}}"
"catto" = "solver=split_solver{velocity=catto{iterations=4}}"
)";

const std::string kCrowd = R"(name = "crowd"
summary = "balls that fall out of the world"
dimensions = [2]
needs = []
gravity = [0, -10, 0]
dt = 0.01
steps = 50
[parameters]
n = { default = 10, min = 1, max = 1000, meaning = "balls" }
[limits]
drift = 0.1
[[body]]
repeat = { i = "n" }
position = ["3 * i", 5, 0]
shapes = [{ kind = "circle", radius = 0.5 }]
)",
                  kCrowds = "summary = \"s\"\nkind = \"world\"\npipeline = \"\"\n[axes]\nscene = \"crowd\"\nn = [1]\n";

struct Film {
  std::string key;
  int dimension;
  long fall;  // step
  json strip;
};

std::vector<Film> filmsOf(const std::string& store) {
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement s(db,
                      "SELECT t.key, json_extract(t.canonical, '$.dimension'), t.step, f.data FROM trial t "
                      "JOIN film f ON f.key = t.key ORDER BY 2");
  std::vector<Film> out;
  while (s.executeStep()) {
    out.push_back({s.getColumn(0), s.getColumn(1), s.getColumn(2), json::parse(s.getColumn(3).getString())});
  }
  return out;
}

// Positions (m) of a tower's boxes at a stored step, as the camera sees them, from the top down.
template <int D>
std::vector<Vec<2>> storedTower(const std::string& store, const Film& film, long step) {
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement s(db, "SELECT data FROM poses WHERE key=? AND step=?");
  s.bind(1, film.key), s.bind(2, static_cast<std::int64_t>(step));
  std::vector<Vec<2>> out;
  if (!s.executeStep()) return out;
  const auto* data = static_cast<const double*>(s.getColumn(0).getBlob());
  const auto count = static_cast<std::size_t>(s.getColumn(0).getBytes()) / sizeof(double);
  for (std::size_t at = 0; at + 1 < count; at += D == 2 ? 4 : 8) {
    if (data[at] > 0) out.push_back(Camera<D>().flat(Eigen::Map<const Vec<D>>(data + at + 1)));  // slot 0 is the floor
  }
  std::sort(out.begin(), out.end(), [](const Vec<2>& a, const Vec<2>& b) { return a[1] > b[1]; });
  return out;
}

// Bounding boxes (px) of the drawn boxes, from the top down.
struct Around {
  Vec<2> lo = Vec<2>::Constant(1e9), hi = Vec<2>::Constant(-1e9);
  Vec<2> middle() const { return (lo + hi) / 2; }
};
std::vector<Around> drawnTower(const json& picture, int dimension) {
  std::vector<Around> out;
  int seen = 0;
  for (const json& patch : picture.at("patches")) {
    const std::string fill = patch.at(0);
    if (fill.substr(1, 2) == fill.substr(3, 2)) continue;            // grey: the floor
    if (seen++ % (dimension == 2 ? 1 : 3) == 0) out.emplace_back();  // a box in 3D shows three faces
    for (std::size_t i = 0; i < patch.at(2).size(); i += 2) {
      const Vec<2> corner(patch.at(2)[i].get<double>(), patch.at(2)[i + 1].get<double>());
      out.back().lo = out.back().lo.cwiseMin(corner), out.back().hi = out.back().hi.cwiseMax(corner);
    }
  }
  std::sort(out.begin(), out.end(), [](const Around& a, const Around& b) { return a.middle()[1] < b.middle()[1]; });
  return out;
}

// Why this strip does not show that fall; empty if it does. A single scale and camera position must map the store's
// positions to all pictures.
template <int D>
std::string wrong(const std::string& store, const Film& film) {
  const json& pictures = film.strip.at("pictures");
  if (pictures.size() != 5) return "it has " + std::to_string(pictures.size()) + " pictures";
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    if (pictures[i].at("step") <= pictures[i - 1].at("step")) return "the steps do not rise";
  }
  if (pictures[0].at("step") != 0 || pictures[4].at("step") != film.fall) return "it is not from the start to the fall";
  const auto start = storedTower<D>(store, film, 0);
  const auto first = drawnTower(pictures[0], D);
  if (start.size() < 2 || first.size() != start.size()) return "bodies are missing";
  const double scale = (first.back().middle()[1] - first[0].middle()[1]) / (start[0][1] - start.back()[1]);  // px/m
  for (const std::size_t i : {0u, 4u}) {
    const auto stored = storedTower<D>(store, film, pictures[i].at("step").get<long>());
    const auto drawn = drawnTower(pictures[i], D);
    if (drawn.size() != stored.size()) return "bodies are missing";
    for (std::size_t k = 0; k < stored.size(); ++k) {
      const Vec<2> way = scale * (stored[k] - start[0]);
      if ((drawn[k].middle() - first[0].middle() - Vec<2>(way[0], -way[1])).norm() > 0.3) return "a body is elsewhere";
    }
  }
  for (const Around& box : first) {  // 1 m, not yet rotated
    if (D == 2 && ((box.hi - box.lo).array() - scale).abs().maxCoeff() > 0.3) return "a body has another size";
  }
  // In between it falls: the farthest body is still 60, 30 and 10 % of its initial distance from its final place.
  const auto end = drawnTower(pictures[4], D);
  double all = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto now = drawnTower(pictures[i], D);
    if (now.size() != end.size()) return "bodies are missing";
    double way = 0;
    for (std::size_t k = 0; k < end.size(); ++k) way = std::max(way, (now[k].middle() - end[k].middle()).norm());
    if (i == 0) all = way;
    if (std::abs(way / all - std::array{1.0, 0.6, 0.3, 0.1}[i]) > 0.08) return "a picture is of another moment";
  }
  return "";
}

std::string wrong(const std::string& store, const Film& film) {
  return film.dimension == 2 ? wrong<2>(store, film) : wrong<3>(store, film);
}

// The last run of each kind is drawn once, also if the store has trials but no films. A run that stands is not drawn.
TEST(Falls, AreDrawnOnceAndAddedToAStoreWithoutThem) {
  Workspace w;
  w.write("towers.toml", kTowers);
  std::filesystem::create_directory(w.path("temporary"));
  const std::string sweep = "sweep ./towers.toml --store s.db --quiet";
  const Outcome out = w.lpc(sweep, "TMPDIR=" + w.path("temporary"));
  ASSERT_EQ(out.code, 0) << out.text;
  EXPECT_TRUE(std::filesystem::is_empty(w.path("temporary"))) << "the recordings stayed";
  const std::vector<Film> films = filmsOf(w.path("s.db"));
  ASSERT_EQ(films.size(), 2u) << "one in 2D, one in 3D";
  for (const Film& film : films) {
    EXPECT_EQ(std::to_string(film.fall),
              ask(w.path("s.db"),
                  "SELECT max(step) FROM trial WHERE outcome='collapsed' AND json_extract(canonical, "
                  "'$.dimension')=" +
                      std::to_string(film.dimension)));
    EXPECT_EQ(wrong(w.path("s.db"), film), "");
  }
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) > 2 FROM trial WHERE outcome='collapsed'"), "1");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) > 0 FROM trial WHERE outcome='ok'"), "1") << "no run stands";

  // Wrong films are distinguished from right ones.
  const std::pair<const char*, std::function<void(json&)>> twins[] = {
      {"the end as at the start", [](json& s) { s["pictures"][4]["patches"] = s["pictures"][0]["patches"]; }},
      {"an end before the fall", [](json& s) { s["pictures"].erase(4), s["pictures"].push_back(s["pictures"][3]); }},
      {"one moment all along", [](json& s) { s["pictures"][2]["patches"] = s["pictures"][1]["patches"]; }},
      {"a body left out",
       [](json& s) {
         json& patches = s["pictures"][4]["patches"];
         patches.erase(patches.end() - 4, patches.end());
       }},
      {"flat bodies",
       [](json& s) {
         for (json& patch : s["pictures"][0]["patches"]) patch[2][1] = patch[2][3] = patch[2][5];
       }},
      {"a camera that follows",
       [](json& s) {
         for (json& patch : s["pictures"][4]["patches"]) {
           for (std::size_t i = 0; i < patch[2].size(); i += 2) patch[2][i] = patch[2][i].get<double>() - 9;
         }
       }},
  };
  for (const auto& [name, bug] : twins) {
    for (Film film : films) {
      bug(film.strip);
      EXPECT_NE(wrong(w.path("s.db"), film), "") << name << " in " << film.dimension << "D";
    }
  }

  SQLite::Database(w.path("s.db"), SQLite::OPEN_READWRITE).exec("UPDATE film SET data='kept'");
  ASSERT_EQ(w.lpc(sweep).code, 0);
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM film WHERE data='kept'"), "2");
  ASSERT_EQ(w.lpc("merge m.db s.db").code, 0);
  EXPECT_EQ(ask(w.path("m.db"), "SELECT count(*) FROM film WHERE data='kept'"), "2");
  // As a store of an older program.
  SQLite::Database(w.path("s.db"), SQLite::OPEN_READWRITE).exec("DROP TABLE film");
  ASSERT_EQ(w.lpc("merge n.db s.db").code, 0);
  const Outcome again = w.lpc(sweep);
  EXPECT_NE(again.text.find("12 trials planned, 12 were done, 0 run"), std::string::npos) << again.text;
  for (const Film& film : filmsOf(w.path("s.db"))) EXPECT_EQ(wrong(w.path("s.db"), film), "");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM film"), "2");
}

// The runner makes the trials of calibrated sweeps after the plan.
TEST(Falls, OfCalibratedSweepsAreDrawn) {
  Workspace w;
  w.write("equal.toml", R"(summary = "towers at equal cost"
kind = "world"
pipeline = "contacts=sat_clip cache=by_feature"
calibrate = { equal = "cost", metric = "work_row_updates", setting = "iterations", most = 64 }
budgets = [400]
[axes]
scene = "vertical_stack"
n = [14]
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=$iterations}}"
)");
  const Outcome out = w.lpc("sweep ./equal.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const std::vector<Film> films = filmsOf(w.path("s.db"));
  ASSERT_EQ(films.size(), 1u) << ask(w.path("s.db"),
                                     "SELECT outcome || ': ' || reason FROM trial JOIN planned USING(key)");
  EXPECT_EQ(films[0].key, ask(w.path("s.db"), "SELECT key FROM planned"));
  EXPECT_EQ(wrong(w.path("s.db"), films[0]), "");
}

// The sweep continues: it has its trials.
TEST(Falls, AreNotDrawnWithoutAResult) {
  Workspace w;
  w.write("crowd.toml", kCrowd), w.write("crowds.toml", kCrowds);
  const std::string worker = w.write("lpc-worker-f64", R"(#!/bin/sh
request=$(cat)
case "$request" in *'"record":"/'*) echo nothing ;; *) printf %s "$request" | ")" LPC_BINARY_DIR
                                                       R"(/bin/lpc-worker-f64" ;; esac)");
  std::filesystem::permissions(worker, std::filesystem::perms::owner_all);
  const Outcome out = w.lpc("sweep ./crowds.toml --quiet --store s.db --set n=3", "LPC_WORKERS=" + w.path(""));
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_NE(out.text.find("is crash, the worker's result is unreadable when repeated: not drawn"), std::string::npos)
      << out.text;
  EXPECT_EQ(ask(w.path("s.db"), "SELECT outcome FROM trial"), "collapsed");
}

TEST(Falls, OfTooManyBodiesAreNotDrawn) {
  Workspace w;
  w.write("crowd.toml", kCrowd);
  w.write("crowds.toml", kCrowds);
  for (const auto& [n, filmed] : {std::pair("300", true), std::pair("301", false)}) {
    const std::string store = "c" + std::string(n) + ".db";
    const Outcome out = w.lpc("sweep ./crowds.toml --quiet --store " + store + " --set n=" + n);
    ASSERT_EQ(out.code, 0) << out.text;
    EXPECT_EQ(ask(w.path(store), "SELECT outcome FROM trial"), "collapsed");
    EXPECT_EQ(ask(w.path(store), "SELECT count(*) FROM sqlite_master WHERE name='film'"), filmed ? "1" : "0");
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::falls_test
