// SPDX-License-Identifier: Zlib
#include "framework/draw/draw_structure.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

template <int D>
struct Lines final : DebugDraw<D> {
  struct Line {
    Vec<D> a, b;
    DrawColour colour;
  };
  std::vector<Line> lines;

  void point(const Vec<D>&, double, const DrawColour&) override { FAIL(); }
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) override { lines.push_back({a, b, colour}); }
  void shape(const ShapeView<D>&, const Pose<D>&, const Look&) override { FAIL(); }
  void text(const Vec<D>&, std::string_view, const DrawColour&) override { FAIL(); }
};

Pipeline by(const std::string& broadphase) { return Pipeline::parse("broadphase=" + broadphase); }

// Two balls of radius 1 m, 8 m apart.
template <int D>
Lines<D> drawnOfTwo(const char* broadphase) {
  World<D> world(by(broadphase));
  world.setGravity(Vec<D>::Zero());
  world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 0)));
  world.add(body<D>(Shape<D>::sphere(1), at<D>(8, 0)));
  world.step(Real(0.01));
  Lines<D> drawn;
  drawStructure(world, drawn);
  return drawn;
}

template <int D>
void checkTwo() {
  const std::size_t edges = D == 2 ? 4 : 12;
  const auto tree = drawnOfTwo<D>("dynamic_tree").lines;
  ASSERT_EQ(tree.size(), 3 * edges);  // the root, and a box around each ball
  std::set<std::tuple<std::size_t, std::array<Real, D>, std::array<Real, D>>> each;
  for (std::size_t k = 0; k < tree.size(); ++k) {
    const auto& [a, b, colour] = tree[k];
    EXPECT_EQ((a.array() != b.array()).count(), 1) << "an edge lies along an axis";
    std::array<Real, D> from, to;
    std::copy(a.data(), a.data() + D, from.begin()), std::copy(b.data(), b.data() + D, to.begin());
    each.emplace(k / edges, from, to);
    EXPECT_EQ(colour == tree[0].colour, k < edges) << "the root has its own colour";
    EXPECT_EQ(colour == tree[edges].colour, k >= edges) << "both leaves have one";
  }
  EXPECT_EQ(each.size(), tree.size()) << "no edge of a box twice";
  EXPECT_LT(tree[0].colour.alpha, 255);
  EXPECT_EQ(tree[edges].colour.alpha, 255);
  EXPECT_TRUE(drawnOfTwo<D>("naive").lines.empty());

  // The whole space, bounded by the boxes.
  const auto space = drawnOfTwo<D>("bsp").lines;
  ASSERT_EQ(space.size(), edges);
  Aabb<D> all;
  for (const auto& l : space) all = all.merged({l.a, l.a}).merged({l.b, l.b});
  EXPECT_NEAR(all.lo[0], -1, 0.05);
  EXPECT_NEAR(all.hi[0], 9, 0.05);
  EXPECT_NEAR(all.lo[1], -1, 0.05);
  EXPECT_NEAR(all.hi[1], 1, 0.05);
}
TEST(DrawStructure, LinesAreTheEdges) {
  checkTwo<2>();
  checkTwo<3>();
}

/// A heap falls with this broadphase; calls `look` after each step.
template <int D>
std::uint64_t hashOfFall(const std::string& broadphase, const std::function<void(World<D>&)>& look) {
  World<D> world(by(broadphase));
  addHeap(world, 12, 1);
  for (int step = 0; step < 40; ++step) {
    world.step(Real(1) / 60);
    look(world);
  }
  return world.hash();
}

template <int D>
void checkNothingChanges() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    if (algorithm->info.role != AlgorithmRole::competitor) continue;
    const std::string& name = algorithm->info.name;
    std::size_t lines = 0;
    const auto look = [&](World<D>& world) {
      Lines<D> drawn;
      drawStructure(world, drawn);
      lines += drawn.lines.size();
      for (const auto& l : drawn.lines) ASSERT_TRUE(l.a.allFinite() && l.b.allFinite()) << name;
    };
    EXPECT_EQ(hashOfFall<D>(name, look), hashOfFall<D>(name, [](World<D>&) {})) << name;
    EXPECT_EQ(lines > 0, !name.starts_with("naive")) << name;
  }
  // Planted bug: drawing changes gravity.
  const auto push = [](World<D>& world) { world.setGravity(at<D>(0, -9.7)); };
  expectCaught("looking at a structure pushes", hashOfFall<D>("bsp", push) == hashOfFall<D>("bsp", [](World<D>&) {}));
}
TEST(DrawStructure, ChangesNothing) {
  checkNothingChanges<2>();
  checkNothingChanges<3>();
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
