// SPDX-License-Identifier: Zlib
// An adapter computes the same poses as a bare program of the same scene, bit for bit. So timings of an adapter are
// those of the engine with its usual settings.
#include "experiments/bench/bare_pyramid.h"
#include "tests/engines/engine_checks.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

constexpr int kSteps = 60;

template <int D>
std::unique_ptr<Simulation<D>> pyramid(const Start<D>& start) {
  auto s = start(gravity<D>(0, -kG));
  Vec<D> half = Vec<D>::Constant(100);
  half[1] = 1;
  const auto add = [&](const Shape<D>& shape, double x, double y, BodyType type) {
    BodyDef<D> def = body<D>(shape, at<D>(x, y), type);
    def.shapes[0].friction = Real(0.6);
    s->add(def);
  };
  add(Shape<D>::box(half), 0, -1, BodyType::fixed);
  for (int i = 0; i < bare::kBase; ++i) {
    for (int j = 0; j < bare::kBase - i; ++j)
      add(cube<D>(), 0.5 * (i + 1) + j - 0.5 * bare::kBase, 0.5 + i, BodyType::dynamic);
  }
  return s;
}

template <int D>
bool same(const Pose<D>& X, const bare::Placed& box) {
  for (int d = 0; d < D; ++d) {
    if (X.p[d] != Real(box[static_cast<std::size_t>(d)])) return false;
  }
  if constexpr (D == 2) {
    const auto q = Rot<2>{Real(box[3]), Real(box[4])}.normalized();
    return X.q.c == q.c && X.q.s == q.s;
  } else {
    const auto q = Rot<3>{Real(box[3]), Real(box[4]), Real(box[5]), Real(box[6])}.normalized();
    return X.q.w == q.w && X.q.x == q.x && X.q.y == q.y && X.q.z == q.z;
  }
}

/// The number of boxes with different poses in the adapter's pyramid and the bare one.
template <int D>
int apart(Simulation<D>& s, bare::Pyramid& pyramid) {
  for (int i = 0; i < kSteps; ++i) s.step(kDt), pyramid.step();
  const std::vector<bare::Placed> boxes = pyramid.boxes();
  EXPECT_EQ(s.bodies().pose.size(), boxes.size() + 1);
  int out = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) out += !same<D>(s.bodies().pose[i + 1], boxes[i]);
  return out;
}

/// `changes`: settings with which the bare program must differ. In f32 our inertia of a box differs from the engine's
/// in the last bit, which would change all poses: the bare program gets our inertia.
template <int D>
void equals(const std::string& name, std::unique_ptr<bare::Pyramid> (*make)(const bare::Settings&),
            const std::vector<bare::Settings>& changes) {
  bool found = false;
  for (const auto& e : engines<D>()) {
    if (e.name != name) continue;
    found = true;
    const auto equal = pyramid<D>(e.start);
    const double moment = sizeof(Real) == 4 ? double(equal->bodies().invInertiaBody[1].inverse()(0, 0)) : 0;
    EXPECT_EQ(apart<D>(*equal, *make({.moment = moment})), 0) << name;
    for (bare::Settings other : changes) {
      other.moment = moment;
      EXPECT_GT(apart<D>(*pyramid<D>(e.start), *make(other)), 100)
          << name << ": " << other.iterations << " iterations, friction " << other.friction << ", slop " << other.slop;
    }
  }
  EXPECT_TRUE(found) << name;
}

#ifdef LPC_BARE_BULLET
TEST(EngineBare, BulletHasThePosesOfABareProgram) {
  equals<3>("bullet", bare::bulletPyramid, {{.iterations = 9}, {.friction = 0.599}, {.slop = 0}});
}
#endif
#ifdef LPC_BARE_BOX2D
TEST(EngineBare, Box2dHasThePosesOfABareProgram) {
  equals<2>("box2d", bare::box2dPyramid, {{.iterations = 9}, {.friction = 0.599}});
}
#endif

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
