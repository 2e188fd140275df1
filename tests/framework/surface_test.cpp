// SPDX-License-Identifier: Zlib
// Triangles, meshes and chains as shapes: what they reject, what they derive (normals, borders, trees), and queries.
#include <gtest/gtest.h>

#include "framework/shape/parts_near.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"
#include "tests/surfaces.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace surface_test { namespace {

template <class F>
std::string messageOf(const F& make) {
  try {
    make();
  } catch (const UserError& e) {
    return e.what();
  }
  return "nothing was refused";
}
void refuses(const std::function<void()>& make, const std::string& says) {
  const std::string message = messageOf(make);
  EXPECT_NE(message.find(says), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

using Triangles = std::vector<std::array<int, 3>>;
const std::vector<Vec<3>> kSquare = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}};
const Triangles kLevel = {{0, 1, 2}, {0, 2, 3}};

TEST(Triangle, Refuses) {
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  refuses([] { Shape<2>::triangle({0, 0}, {1, 0}, {0, 1}); }, "triangle: 3D only");
  refuses([&] { Shape<3>::triangle({0, 0, 0}, {1, nan, 0}, {0, 1, 0}); }, "triangle: corner 1 is not finite");
  refuses([] { Shape<3>::triangle({0, 0, 0}, {1, 1, 1}, {3, 3, 3}); }, "on one line");
  refuses([] { Shape<3>::triangle({1, 2, 3}, {1, 2, 3}, {3, 3, 3}); }, "on one line");
  refuses([] { Shape<3>::triangle({2, 2, 2}, {2, 2, 2}, {2, 2, 2}); }, "on one line");
  refuses([] { Shape<3>::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, -1); }, "triangle: rounding is -1");
  refuses([] { Shape<3>::ofCorners(ShapeKind::triangle, kSquare); }, "4 points given; valid: 3");
}

// A closed hull, as all algorithms traverse it: loops, edges with their faces in loop order, unit normals.
TEST(Triangle, IsAPrismWithoutHeight) {
  const Shape<3> shape = Shape<3>::triangle({0, 1, 0}, {0, 1, 2}, {3, 1, 0});
  const Polytope<3>& t = *shape.view().hull;
  ASSERT_EQ(t.faces.size(), 5u);
  ASSERT_EQ(t.edges.size(), 6u);
  EXPECT_EQ(t.loop.size(), 12u);
  EXPECT_NEAR((t.faces[0].normal - Vec<3>(0, 1, 0)).norm(), 0, 1e-6);
  for (const auto& f : t.faces) {
    EXPECT_NEAR(f.normal.norm(), 1, 1e-6);
    for (const Vec<3>& v : t.vertices) EXPECT_LT(f.normal.dot(v) - f.offset, 1e-6);
    for (int i = f.begin; i < f.end; ++i) {
      EXPECT_NEAR(f.normal.dot(t.vertices[std::size_t(t.loop[std::size_t(i)])]), f.offset, 1e-6);
    }
  }
  for (const auto& e : t.edges) {
    const auto follows = [&](int face, int v0, int v1) {
      const auto& f = t.faces[std::size_t(face)];
      for (int i = f.begin; i < f.end; ++i) {
        const int next = i + 1 < f.end ? i + 1 : f.begin;
        if (t.loop[std::size_t(i)] == v0 && t.loop[std::size_t(next)] == v1) return true;
      }
      return false;
    };
    EXPECT_TRUE(follows(e.faceA, e.v0, e.v1) && follows(e.faceB, e.v1, e.v0));
    EXPECT_NEAR(t.faces[std::size_t(e.faceA)].normal.dot(t.faces[std::size_t(e.faceB)].normal), 0, 1e-6);
  }
  EXPECT_EQ(massProperties(shape, 1).mass, 0);
}

// Points and rays against a flat core: above it, beside an edge, beyond a corner, and exactly in its plane.
TEST(Triangle, PointsAndRays) {
  const Shape<3> sharp = Shape<3>::triangle({0, 0, 0}, {0, 0, 2}, {2, 0, 0});
  const Shape<3> round = Shape<3>::triangle({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, Real(0.25));
  const auto holds = [](const Shape<3>& s, const Vec<3>& p) { return containsPoint(s.view(), Pose<3>{}, p); };
  EXPECT_TRUE(holds(sharp, at<3>(0.5, 0, 0.5)));
  EXPECT_FALSE(holds(sharp, at<3>(0.5, 1e-3, 0.5)));
  EXPECT_FALSE(holds(sharp, at<3>(3, 0, 0)));
  EXPECT_TRUE(holds(round, at<3>(0.5, 0.24, 0.5)) && holds(round, at<3>(0.5, -0.24, 0.5)) &&
              holds(round, at<3>(1.1, 0, 1.1)));
  EXPECT_FALSE(holds(round, at<3>(0.5, 0.26, 0.5)) || holds(round, at<3>(1.3, 0, 1.3)) ||
               holds(round, at<3>(-0.2, 0, -0.2)));
  EXPECT_FALSE(holds(round, at<3>(-0.26, 0, 5)) ||
               holds(round, at<3>(0, 0, 2.3)));  // on the line of an edge, beyond its end
  for (const Real side : {Real(1), Real(-1)}) {
    const auto meets = [&](const Shape<3>& s, const Vec<3>& p) {
      return rayEntry(s.view(), Pose<3>{}, p, Vec<3>(0, -side, 0), Real(10));
    };
    EXPECT_NEAR(meets(sharp, at<3>(0.5, double(side), 0.5)).t, 1, 1e-6);
    EXPECT_NEAR(meets(sharp, at<3>(0.5, double(side), 0.5)).normal[1], side, 1e-6);
    EXPECT_LT(meets(sharp, at<3>(1.5, double(side), 1.5)).t, 0);
    EXPECT_NEAR(meets(round, at<3>(0.5, double(side), 0.5)).t, 0.75, 1e-6);
    EXPECT_LT(meets(round, at<3>(1.3, double(side), 1.3)).t, 0);
  }
  const RayEntry<3> edgeOn = rayEntry(round.view(), Pose<3>{}, Vec<3>(-2, 0, 1), Vec<3>(1, 0, 0), Real(10));
  EXPECT_NEAR(edgeOn.t, 1.75, 1e-6);
  EXPECT_TRUE(overlapsBox(sharp.view(), Pose<3>{}, Aabb<3>{at<3>(0.4, -1, 0.4), at<3>(0.6, 1, 0.6)}));
  EXPECT_FALSE(overlapsBox(sharp.view(), Pose<3>{}, Aabb<3>{at<3>(1.2, -1, 1.2), at<3>(2, 1, 2)}));
  EXPECT_FALSE(overlapsBox(sharp.view(), Pose<3>{}, Aabb<3>{at<3>(0, 0.1, 0), at<3>(2, 1, 2)}));
}

TEST(Mesh, Refuses) {
  const auto mesh = [](std::vector<Vec<3>> points, const Triangles& triangles) {
    return [=] { Shape<3>::mesh(points, triangles); };
  };
  std::vector<Vec<3>> spoiled = kSquare;
  spoiled[2][1] = std::numeric_limits<Real>::quiet_NaN();
  refuses(mesh(spoiled, kLevel), "mesh: point 2 is not finite");
  refuses(mesh(kSquare, {}), "mesh: no triangles");
  refuses(mesh(kSquare, {{0, 1, 2}, {0, 2, 4}}), "mesh, triangle 1: unknown point 4; valid: 0 to 3");
  refuses(mesh(kSquare, {{-1, 1, 2}}), "unknown point -1");
  refuses(mesh(kSquare, {{0, 1, 2}, {2, 2, 3}}), "mesh, triangle 1: its corners lie on one line");
  refuses(mesh(kSquare, {{0, 1, 2}, {0, 3, 2}}), "points 0 and 2: triangles 0 and 1 are wound oppositely");
  std::vector<Vec<3>> fin = kSquare;
  fin.push_back(at<3>(0.5, 1, 0.5));
  refuses(mesh(fin, {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}), "points 0 and 2: belongs to 3 triangles");
  refuses([] { Shape<2>::mesh(std::vector<Vec<2>>{}, Triangles{}); }, "mesh: 3D only");
  EXPECT_NO_THROW(mesh(kSquare, kLevel)());
}
TEST(Chain, Refuses) {
  const auto chain = [](std::vector<Vec<2>> points, bool closed) { return [=] { Shape<2>::chain(points, closed); }; };
  refuses(chain({{0, 0}}, false), "chain: 1 points given");
  refuses(chain({{0, 0}, {1, 0}}, true), "chain: 2 points given");
  refuses(chain({{0, 0}, {1, 0}, {1, 0}}, false), "chain, segment 1: it is 0.000000 m long");
  refuses(chain({{0, 0}, {std::numeric_limits<Real>::infinity(), 0}}, false), "chain: point 1 is not finite");
  refuses([] { Shape<3>::chain(std::vector<Vec<3>>(3, Vec<3>(0, 0, 0)), true); }, "chain: 2D only");
}

template <int D>
Shape<D> smallSurface() {
  if constexpr (D == 2) {
    return Shape<2>::chain(std::vector<Vec<2>>{{1, 0}, {0, 0}}, false);
  } else {
    return Shape<3>::mesh(kSquare, kLevel);
  }
}
template <int D>
void onlyForFixedBodies() {
  for (const BodyType type : {BodyType::dynamic, BodyType::kinematic}) {
    World<D> world;
    refuses([&] { world.add(body<D>(smallSurface<D>(), Vec<D>::Zero(), type)); },
            "on a moving body; valid for moving bodies");
  }
  const ShapePart<D> part{smallSurface<D>(), {}};
  refuses([&] { Shape<D>::compound({&part, 1}); }, "is a mesh or chain");
}
TEST(Surface, OnlyForFixedBodies) {
  onlyForFixedBodies<2>();
  onlyForFixedBodies<3>();
}

// Normals point to the right along a chain and to the side from which a triangle appears counter-clockwise. Border
// normals point outwards.
TEST(Surface, KnowsItsBorders) {
  const Shape<3> mesh = Shape<3>::mesh(kSquare, kLevel);
  const Surface<3>& s = *mesh.surface();
  EXPECT_NEAR(s.normal(0)[1], 1, 1e-6);
  int inner = 0;
  for (std::int32_t part = 0; part < 2; ++part) {
    for (int k = 0; k < 3; ++k) {
      const auto border = s.border(part, k);
      EXPECT_LT((s.parts()[std::size_t(part)].X_SP.p - border.at).dot(border.outward), 0);
      if (border.neighbour < 0) continue;
      EXPECT_EQ(border.neighbour, 1 - part);
      ++inner;
    }
  }
  EXPECT_EQ(inner, 2);
  const Shape<2> chain = Shape<2>::chain(std::vector<Vec<2>>{{2, 0}, {0, 0}, {-1, 1}}, false);
  EXPECT_NEAR(chain.surface()->normal(0)[1], 1, 1e-6);
  EXPECT_EQ(chain.surface()->border(0, 0).neighbour, -1);
  EXPECT_EQ(chain.surface()->border(0, 1).neighbour, 1);
  EXPECT_NEAR((chain.surface()->border(0, 1).at - Vec<2>(0, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((chain.surface()->border(0, 1).outward - Vec<2>(-1, 0)).norm(), 0, 1e-6);
}

double bumpy(double x) { return 0.5 * std::abs(x - 2 * std::floor(x / 2) - 1) + 0.02 * x; }

// The tree finds the same parts as a loop over all parts, in the same order, for any pose and box.
template <int D>
bool treeFindsWhatIsNear(Real widens) {
  PlainDraw draw(11);
  const Shape<D> shape = roughGround<D>(3, GroundOf::surface, bumpy);
  std::vector<std::int32_t> scratch;
  long seen = 0;
  for (int i = 0; i < 200; ++i) {
    const Pose<D> X = drawPose<D>(draw, 30);
    const Vec<D> half = drawHalf<D>(draw) / 2;
    const auto& parts = shape.surfaceParts();
    const Vec<D> at =
        (X * parts[std::size_t(draw.below(int(parts.size())))].X_SP).p + half.cwiseProduct(drawVector<D>(draw));
    const Aabb<D> box{at - half, at + half};
    std::vector<std::int32_t> near;
    WorkDone work;
    forPartsNear(shape, X, {}, box.grown(widens), scratch, work,
                 [&](std::int32_t number, const ShapeView<D>& view, const Pose<D>& X_WP) {
                   if (overlapsBox(view, X_WP, box)) near.push_back(number);
                 });
    std::vector<std::int32_t> all;
    std::int32_t number = 0;
    forParts(shape, X, [&](const ShapeView<D>& view, const Pose<D>& X_WP) {
      if (overlapsBox(view, X_WP, box)) all.push_back(number);
      ++number;
    });
    if (near != all) return false;
    seen += long(all.size());
  }
  EXPECT_GT(seen, 200);
  return true;
}
TEST(Surface, TreeFindsWhatIsNear) {
  EXPECT_TRUE(treeFindsWhatIsNear<2>(0));
  EXPECT_TRUE(treeFindsWhatIsNear<3>(0));
  expectCaught("a tree that is asked with a box too small, 2D", treeFindsWhatIsNear<2>(Real(-0.1)));
  expectCaught("a tree that is asked with a box too small, 3D", treeFindsWhatIsNear<3>(Real(-0.1)));
}

// Rays, points and boxes hit a surface where they hit the same parts as a compound.
template <int D>
void answersAsItsParts() {
  World<D> whole, loose;
  BodyDef<D> def = body<D>(roughGround<D>(3, GroundOf::surface, bumpy), at<D>(3, 1), BodyType::fixed);
  def.X_WB.q = turn(Ang<D>(Ang<D>::Constant(Real(0.3))));
  whole.add(def);
  def.shapes[0].shape = looseParts<D>(def.shapes[0].shape);
  loose.add(def);
  PlainDraw draw(5);
  int hits = 0, boxes = 0;
  for (int i = 0; i < 600; ++i) {
    const Vec<D> p = 10 * drawVector<D>(draw) + at<D>(8, 0), d = 20 * drawDirection<D>(draw);
    const auto a = whole.rayFirst(p, d, 2), b = loose.rayFirst(p, d, 2);
    ASSERT_EQ(a.has_value(), b.has_value());
    hits += a.has_value();
    if (a) {
      EXPECT_NEAR(a->t, b->t, 1000 * kEps);  // a compound has its own centre of mass
      EXPECT_NEAR((a->normal - b->normal).norm(), 0, 1000 * kEps);
    }
    const Aabb<D> box{p - Vec<D>::Constant(1), p + Vec<D>::Constant(1)};
    EXPECT_EQ(whole.overlap(box).size(), loose.overlap(box).size());
    boxes += !whole.overlap(box).empty();
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(boxes, 10);
}
TEST(Surface, AnswersAsItsParts2) { answersAsItsParts<2>(); }
TEST(Surface, AnswersAsItsParts3) { answersAsItsParts<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::surface_test
