// SPDX-License-Identifier: Zlib
// Distributions of boxes and ways of drawing pairs: a name always draws the same input, because stored results depend
// on it.
#include "experiments/trial/entry.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/runner/trial_plan.h"
#include "experiments/trial/box_distribution.h"
#include "experiments/trial/pair_drawing.h"
#include "framework/shape/support_map.h"
#include "oracles/referee/referee.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace entry_test { namespace {

// FNV-1a over the bits of numbers.
class Bits {
 public:
  void add(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    for (int i = 0; i < 64; i += 8) m_hash = (m_hash ^ ((bits >> i) & 255)) * 1099511628211u;
  }
  template <int D>
  void add(const Vec<D>& v) {
    for (int d = 0; d < D; ++d) add(static_cast<double>(v[d]));
  }
  std::uint64_t hash() const { return m_hash; }

 private:
  std::uint64_t m_hash = 14695981039346656037u;
};

template <int D>
std::uint64_t boxes(const std::string& distribution) {
  const MovingBoxes<D> boxes = makeMovingBoxes<D>(Spec::parse(distribution), 200, 7);
  Bits bits;
  for (std::size_t i = 0; i < boxes.place.size(); ++i) {
    bits.add<D>(boxes.place[i]), bits.add<D>(boxes.velocity[i]), bits.add(static_cast<double>(boxes.half[i]));
  }
  bits.add(static_cast<double>(boxes.room));
  return bits.hash();
}

template <int D>
double trueDistance(const DrawnPair<D>& p) {
  return referee<D>(p.a.view(), {}, p.b.view(), p.X_AB).interval().middle();
}

template <int D>
std::uint64_t pairs(const std::string& drawing) {
  Random random(5);
  Bits bits;
  for (int i = 0; i < 90; ++i) {
    const ShapeKind a = i % 2 ? ShapeKind::box : ShapeKind::capsule;
    const auto p = drawPair<D>(Spec::parse(drawing), {a, ShapeKind::polytope, i, trueDistance<D>}, random);
    bits.add<D>(p.X_AB.p), bits.add<D>(Vec<D>(p.X_AB.q * Vec<D>::Unit(0)));
    bits.add(static_cast<double>(boundingRadius(p.a.view()))),
        bits.add(static_cast<double>(boundingRadius(p.b.view())));
  }
  return bits.hash();
}

// Computed with the code before entries existed.
TEST(Entries, ANameAlwaysDrawsTheSame) {
  EXPECT_EQ(boxes<2>("uniform"), 0xa3a022688f626781u);
  EXPECT_EQ(boxes<3>("uniform"), 0xdc0c3532e7928c91u);
  EXPECT_EQ(boxes<2>("cluster"), 0x2749bafc16170283u);
  EXPECT_EQ(boxes<3>("cluster"), 0xef42594d5646a0aeu);
  EXPECT_EQ(boxes<2>("director_2"), 0xf6ded839a6f99ee3u);
  EXPECT_EQ(boxes<3>("director_2"), 0xcb02ba5f33a90f64u);
  // Each of these, which defeats one kind of broadphase, came with entries.
  EXPECT_EQ(boxes<2>("centre_line"), 0x40883aa04b9b3e30u);
  EXPECT_EQ(boxes<3>("centre_line"), 0x239f5b16c59fd7e5u);
  EXPECT_EQ(boxes<2>("towers"), 0xcb22ef2738bbc265u);
  EXPECT_EQ(boxes<3>("towers"), 0xef41ba5189fae8acu);
  EXPECT_EQ(boxes<2>("huge_ground"), 0x7759103232053fc0u);
  EXPECT_EQ(boxes<3>("huge_ground"), 0x07d160c13ccb9373u);
  EXPECT_EQ(boxes<2>("outlier"), 0xb69499fcc0ba8dd6u);
  EXPECT_EQ(boxes<3>("outlier"), 0xc335ce84f8dac598u);
  EXPECT_EQ(boxes<2>("batch_spawn"), 0x7776d964e83fd70cu);
  EXPECT_EQ(boxes<3>("batch_spawn"), 0xb507353d45f5f3b5u);
  EXPECT_EQ(pairs<2>("in_turn"), 0xb208c28634ea0e13u);
  // clang++ gives other last bits to pairs that are made to touch; only simulation steps are equal across compilers.
#if !defined(__clang__)
  EXPECT_EQ(pairs<3>("in_turn"), 0x02c6aba33821cc2fu);
#endif
  EXPECT_EQ(boxes<2>("cluster{spread=10}"), boxes<2>("cluster")) << "a default written out";
  test::expectCaught("clusters a hundredth wider", boxes<2>("cluster{spread=11}") == boxes<2>("cluster"));
  test::expectCaught("a family that does not take its turn", pairs<2>("near") == pairs<2>("in_turn"));
}

// A family drawn alone equals the same family in its turn.
template <int D>
void takeTurns() {
  const char* families[] = {"apart", "near", "touching", "overlapping", "centred", "parallel_faces"};
  for (int i = 0; i < 24; ++i) {
    const PairRequest<D> request{ShapeKind::box, ShapeKind::capsule, i, trueDistance<D>};
    Random a(3), b(3);
    const auto alone = drawPair<D>(Spec::parse(families[i % 6]), request, a),
               turn = drawPair<D>({"in_turn", {}}, request, b);
    EXPECT_EQ(alone.X_AB.p, turn.X_AB.p) << families[i % 6];
    EXPECT_EQ(a.next(), b.next()) << "all draw as many numbers";
    const double gap = trueDistance<D>(turn);
    const bool apart = i % 6 == 0, touching = i % 6 == 2 || i % 6 == 5, deep = i % 6 == 4;
    EXPECT_TRUE(!apart || gap > 0) << gap;
    EXPECT_TRUE(!touching || std::abs(gap) < 2e-9) << gap;
    EXPECT_TRUE(!deep || gap < 0) << gap;
  }
}
TEST(Entries, FamiliesTakeTurns) { takeTurns<2>(), takeTurns<3>(); }

// Both hulls have the requested number of vertices, and later draws do not depend on it.
template <int D>
int verticesDrawn(int vertices) {
  Random random(11);
  int least = 1 << 20;
  for (int i = 0; i < 12; ++i) {
    const auto p = drawPair<D>(Spec::parse("near"),
                               {ShapeKind::polytope, ShapeKind::polytope, i, trueDistance<D>, vertices}, random);
    for (const auto* shape : {&p.a, &p.b}) {
      const auto& points = shape->view().hull->vertices;
      least = std::min(least, static_cast<int>(points.size()));
    }
  }
  return least;
}
TEST(Entries, HullsHaveTheRequestedVertices) {
  for (const int n : {4, 8, 32, 256}) {
    EXPECT_EQ(verticesDrawn<2>(n), n);
    EXPECT_EQ(verticesDrawn<3>(n), n);
  }
  test::expectCaught("points anywhere, of which some lie within the hull", verticesDrawn<3>(0) == 12);
  test::expectCaught("points anywhere, of which some lie within the polygon", verticesDrawn<2>(0) == 12);
}

template <class F>
std::string errorOf(const F& f) {
  try {
    f();
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Entries, PlansAcceptThem) {
  Planner planner;
  const auto boxesOf = [&](const char* distribution) {
    return planner.boxes({{"dimension", 3}, {"n", 8}, {"distribution", distribution}, {"broadphase", "naive"}});
  };
  const auto pairsBy = [&](const char* drawing) {
    return planner.pairs(
        {{"dimension", 3}, {"kind_a", "box"}, {"kind_b", "box"}, {"pair_query", "sat"}, {"drawing", drawing}});
  };
  EXPECT_EQ(boxesOf("cluster").key, boxesOf("cluster{spread=10}").key) << "a default written out";
  EXPECT_NE(boxesOf("cluster").key, boxesOf("cluster{spread=11}").key);
  EXPECT_NE(pairsBy("in_turn").key, pairsBy("near").key);
  EXPECT_EQ(pairsBy("in_turn").key,
            planner.pairs({{"dimension", 3}, {"kind_a", "box"}, {"kind_b", "box"}, {"pair_query", "sat"}}).key);
  const auto hullsOf = [&](const char* kind, int vertices) {
    return planner.pairs(
        {{"dimension", 3}, {"kind_a", "box"}, {"kind_b", kind}, {"pair_query", "sat"}, {"vertices", vertices}});
  };
  EXPECT_NE(hullsOf("polytope", 8).key, hullsOf("polytope", 16).key);
  EXPECT_EQ(errorOf([&] { hullsOf("polytope", 3); }), "axis 'vertices' is 3; valid: whole numbers from 4 to 4096");
  EXPECT_EQ(errorOf([&] { hullsOf("box", 8); }),
            "axis 'vertices' is for hulls; valid: with 'polytope' as kind_a or kind_b");
  EXPECT_EQ(
      errorOf([&] { boxesOf("clusters"); }),
      "unknown distribution 'clusters'; did you mean 'cluster'? valid: uniform, cluster, director_2, centre_line, "
      "towers, huge_ground, outlier, batch_spawn");
  EXPECT_EQ(errorOf([&] { boxesOf("cluster{spread=0}"); }),
            "parameter 'spread' of 'cluster' is '0'; valid: a whole number from 1 to 100");
  EXPECT_EQ(errorOf([&] { boxesOf("uniform{side=3}"); }), "'uniform' has no parameter 'side'; valid: none");
  EXPECT_EQ(errorOf([&] { pairsBy("nearer"); }),
            "unknown drawing 'nearer'; did you mean 'near'? valid: in_turn, apart, near, touching, overlapping, "
            "centred, parallel_faces");
}

TEST(Entries, DescribeThemselves) {
  const auto look = [](const EntryInfo& e) {
    EXPECT_FALSE(e.meaning.empty()) << e.name;
    for (const ParamInfo& p : e.params) EXPECT_FALSE(p.meaning.empty()) << e.name << ' ' << p.name;
    EXPECT_EQ(e.canonical(Spec{e.name, {}}).fields.size(), e.params.size());
  };
  for (const BoxDistribution& e : boxDistributions()) look(e.info);
  for (const PairDrawing& e : pairDrawings()) look(e.info);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::entry_test
