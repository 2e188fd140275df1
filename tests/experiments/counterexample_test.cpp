// SPDX-License-Identifier: Zlib
// The shapes that a failed property prints are a scene file: reading it gives the same shapes in the same poses.
#include <gtest/gtest.h>

#include <sstream>

#include "experiments/trial/scene/scene_file.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace counterexample_test { namespace {

template <int D>
void readsBack() {
  PlainDraw draw(7);
  int read = 0;
  for (int i = 0; i < 400; ++i) {
    const ShapePairCase<D> c = drawShapePair<D>(draw);
    std::ostringstream text;
    // Static, because a point has no mass and a plane cannot move.
    text << "name = \"t\"\nsummary = \"s\"\ndimensions = [" << D << "]\n" << c;
    std::string scene = text.str();
    for (std::size_t at = 0; (at = scene.find("[[body]]\n", at)) != scene.npos; at += 9)
      scene.insert(at + 9, "type = \"fixed\"\n");
    const SceneSpec<D> spec = SceneFile::parse(scene, "t.toml").build<D>({}, 1);
    ASSERT_EQ(spec.spawns.size(), 2u);
    for (std::size_t k : {0u, 1u}) {
      const BodyDef<D>& body = spec.spawns[k].body;
      const Shape<D>& shape = k ? c.b : c.a;
      const Pose<D>& X = k ? c.X_WB : c.X_WA;
      ASSERT_EQ(body.shapes.size(), 1u);
      ASSERT_EQ(body.shapes[0].shape.kind(), shape.kind()) << scene;
      EXPECT_EQ(body.X_WB.p, X.p) << scene;
      if (shape.isPlane()) continue;
      const Aabb<D> found = boundingBox(body.shapes[0].shape, body.X_WB), truly = boundingBox(shape, X);
      const Real small = Real(1e-12) * (X.p.norm() + sizeOf(shape));
      EXPECT_LE((found.lo - truly.lo).norm(), small) << scene;
      EXPECT_LE((found.hi - truly.hi).norm(), small) << scene;
      ++read;
    }
  }
  EXPECT_GT(read, 600);
}

TEST(Counterexample, IsASceneFile2) { readsBack<2>(); }
TEST(Counterexample, IsASceneFile3) { readsBack<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::counterexample_test
