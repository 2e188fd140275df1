// SPDX-License-Identifier: Zlib
// Labels, colours and tiles of several competitors on one screen, without a window.
#include <gtest/gtest.h>

#include "experiments/sandbox/competitor_colours.h"
#include "experiments/sandbox/competitor_label.h"
#include "experiments/sandbox/tiles.h"
#include "framework/stage/registry.h"
#include "framework/world/world.h"
#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/sandbox/box_at.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace competitors_seen_test { namespace {

// --- labels ---------------------------------------------------------------------------------------------------------

TEST(CompareSeen, TitlesShowDifferences) {
  EXPECT_EQ(competitorTitle("", 2), "the default stages");
  EXPECT_EQ(competitorTitle("solver=soft_step{substeps=2}", 3), "solver=soft_step{substeps=2}");
  EXPECT_EQ(competitorTitle("solver=split_solver{velocity=naive}", 2), "velocity=naive");
  EXPECT_EQ(competitorTitle("solver=split_solver{velocity=catto{iterations=20},position=none} broadphase=naive", 2),
            "broadphase=naive velocity=catto{iterations=20} position=none");
  EXPECT_EQ(competitorTitle("engine=bullet{iterations=10}", 3), "engine=bullet{iterations=10}");
  for (const auto& [length, text] : {std::pair(0.0, "0 m"), std::pair(12.345, "12.3 m"), std::pair(0.99996, "1 m"),
                                     std::pair(0.00677, "6.77 mm"), std::pair(3.2e-8, "32 nm")}) {
    EXPECT_EQ(lengthText(length), text);
  }
}

void linesFit() {
  RapidCheckDraw draw;
  std::string text;
  for (int i = 0, n = 1 + draw.below(120); i < n; ++i) text += draw.pick({'a', 'b', 'c', 'd', ' ', '{', ',', '='});
  const std::size_t width = static_cast<std::size_t>(4 + draw.below(50)), most = 1 + draw.below(3);
  const std::vector<std::string> lines = brokenIntoLines(text, width, most);
  RC_ASSERT(!lines.empty() && lines.size() <= most);
  std::string joined;
  for (const std::string& line : lines) {
    RC_ASSERT(line.size() <= width);
    joined += line;
  }
  if (joined == text) return;
  RC_ASSERT(joined.ends_with("..."));  // it shows that text is missing
  RC_ASSERT(lines.size() == most && text.starts_with(joined.substr(0, joined.size() - 3)));
}
TEST(CompareSeen, LinesFit) { check("any text", linesFit, 200); }

// --- colours and tiles ----------------------------------------------------------------------------------------------

// Any competitors, in any order.
template <bool kFirstColours>
void coloursAreToldApart() {
  RapidCheckDraw draw;
  std::vector<std::string> known = {"", "engine=stand_in", "solver=split_solver{velocity=catto{iterations=30}}"};
  for (const StageKind stage : {StageKind::solver, StageKind::broadphase}) {
    for (const Registered* r : Registry::instance().list(stage, 2)) {
      known.push_back(std::string(stageName(stage)) + "=" + r->info.name);
    }
  }
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 2)) {
    known.push_back("solver=split_solver{velocity=" + r->info.name + "}");
  }
  std::vector<std::string> competitors;
  for (int i = 0, n = 2 + draw.below(7); i < n; ++i) {
    competitors.push_back(known[static_cast<std::size_t>(draw.below(static_cast<int>(known.size())))]);
  }
  std::vector<DrawColour> colours = competitorColours(competitors, 2);
  if (kFirstColours) {  // planted: each has its family's colour, whatever the others are
    colours.clear();
    for (const std::string& competitor : competitors) colours.push_back(competitorColours({competitor}, 2)[0]);
  }
  RC_ASSERT(colours.size() == competitors.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) RC_ASSERT(difference(colours[i], colours[j]) >= kToldApart);
  }
}
TEST(CompareSeen, ColoursAreDistinct) {
  check("any competitors", coloursAreToldApart<false>, 100);
  expectFalsified("the family's colour for all of it", coloursAreToldApart<true>);
}

TEST(CompareSeen, ColoursStayWithTheCompetitor) {
  const DrawColour soft = competitorColours({"", "solver=soft_step"}, 2)[1];
  EXPECT_EQ(competitorColours({"solver=soft_step{substeps=2}", "solver=avbd", ""}, 3)[0], soft);
  EXPECT_EQ(competitorColours({"", "engine=stand_in", "solver=soft_step sleep=none"}, 2)[2], soft);
  EXPECT_NE(competitorColours({"solver=soft_step", "solver=soft_step{substeps=2}"}, 2)[1], soft);
}

void tilesShareTheWindow() {
  RapidCheckDraw draw;
  const Tile area{draw.below(50), draw.below(50), 300 + draw.below(1000), 300 + draw.below(1000)};
  const auto count = static_cast<std::size_t>(1 + draw.below(8));
  const std::vector<Tile> tiles = tilesOf(count, 1 + draw.below(static_cast<int>(count)), area);
  RC_ASSERT(tiles.size() == count);
  for (const Tile& t : tiles) {
    RC_ASSERT(t.left >= area.left && t.top >= area.top && t.width == tiles[0].width && t.height == tiles[0].height);
    RC_ASSERT(t.left + t.width <= area.left + area.width && t.top + t.height <= area.top + area.height);
    int over = 0;
    for (const Tile& other : tiles) {
      over += t.left < other.left + other.width && other.left < t.left + t.width && t.top < other.top + other.height &&
              other.top < t.top + t.height;
    }
    RC_ASSERT(over == 1);
  }
}
TEST(CompareSeen, TilesShareTheWindow) { check("any window", tilesShareTheWindow, 100); }

template <int D>
int columnsOf(Real width, Real height) {
  World<D> world;
  for (const Real side : {Real(-1), Real(1)}) world.add(boxAt<D>(side * (width - 1) / 2, side * (height - 1) / 2));
  return columnsFor(ViewCamera<D>(), world, 8, {0, 20, 1280, 740}, 40);
}
TEST(CompareSeen, TilesHaveTheShapeOfTheScene) {
  EXPECT_EQ(columnsOf<2>(10, 10), 4);
  EXPECT_EQ(columnsOf<2>(100, 2), 1);
  EXPECT_EQ(columnsOf<2>(2, 100), 8);
  EXPECT_EQ(columnsOf<3>(10, 10), 4);
  EXPECT_EQ(columnsOf<3>(2, 100), 8);
  EXPECT_EQ(columnsFor(ViewCamera<2>(), World<2>(), 8, {0, 20, 1280, 740}, 40), 4);  // an empty world
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::competitors_seen_test
