// SPDX-License-Identifier: Zlib
#include "tests/determinism/scenes.h"

#include <array>

#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {
namespace {

template <int D>
Vec<D> boxHalf(double x, double y) {
  Vec<D> half = Vec<D>::Constant(static_cast<Real>(x));
  half[1] = static_cast<Real>(y);
  return half;
}

template <int D>
void heap(World<D>& world) {
  addHeap(world, D == 2 ? 16 : 12, 5);
}

template <int D>
void towers(World<D>& world) {
  addGround(world);
  for (int tower = 0; tower < 3; ++tower) {
    for (int i = 0; i < 4; ++i) {
      world.add(body<D>(Shape<D>::box(boxHalf<D>(0.4, 0.4)), at<D>(1.5 * tower + 0.03 * i, 0.4 + 0.8 * i)));
    }
  }
}
// The towers fall asleep; then one loses its lowest box, and a ball hits them.
template <int D>
void disturb(World<D>& world, int step) {
  if (step == 90) world.remove(world.handle(1));
  if (step == 120) {
    BodyDef<D> ball = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(8, 2.2));
    ball.velocity = at<D>(-9, 1);
    ball.shapes[0].restitution = Real(0.6), ball.shapes[0].density = 3;
    world.add(ball);
  }
}

template <int D>
void pyramid(World<D>& world) {
  addGround(world);
  const int base = D == 2 ? 6 : 4;
  for (int row = 0; row < base; ++row) {
    for (int i = 0; i < base - row; ++i) {
      world.add(body<D>(Shape<D>::box(boxHalf<D>(0.5, 0.25)), at<D>(1.1 * (i + 0.5 * row), 0.25 + 0.5 * row)));
    }
  }
}

void rain(World<2>& world) {
  for (double side : {-1.0, 1.0}) {
    BodyDef<2> slide = body<2>(Shape<2>::segment(4), at<2>(4.2 * side, 0), BodyType::fixed);
    slide.X_WB.q = Rot<2>::angle(0.4 * side);
    world.add(slide);
  }
  Random random(11);
  for (int i = 0; i < 24; ++i) {
    const double x = random.uniform(-3, 3), radius = random.uniform(0.15, 0.35);
    BodyDef<2> drop = body<2>(Shape<2>::sphere(static_cast<Real>(radius)), at<2>(x, 2 + 0.4 * i));
    drop.shapes[0].restitution = Real(0.4);
    world.add(drop);
  }
}

void hulls(World<3>& world) {
  addGround(world);
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    std::array<Vec<3>, 14> points;
    for (Vec<3>& p : points) {
      for (int d = 0; d < 3; ++d) p[d] = static_cast<Real>(random.uniform(-0.6, 0.6));
    }
    const double x = random.uniform(-1, 1), z = random.uniform(-1, 1);
    BodyDef<3> hull = body<3>(Shape<3>::polytope(points), at<3>(x, 0.8 + 0.9 * i, z));
    hull.angularVelocity = {Real(0.3), Real(-1.1), Real(0.7)};
    world.add(hull);
  }
}

// A chain of unequal links that swings into a rod tumbling on a spring, in air.
void chain(World<3>& world) {
  BodyHandle last = world.add(body<3>(Shape<3>::sphere(Real(0.1)), at<3>(0, 6), BodyType::fixed));
  for (int i = 0; i < 7; ++i) {
    BodyDef<3> link = body<3>(Shape<3>::capsule(Real(0.25), Real(0.08)), at<3>(0.5 + 0.8 * i, 6));
    link.shapes[0].density = static_cast<Real>(1 + i % 3);
    const BodyHandle next = world.add(link);
    world.add(JointDef<3>{.bodyA = last, .bodyB = next, .X_WJ = {at<3>(0.1 + 0.8 * i, 6), {}}});
    last = next;
  }
  BodyDef<3> rod = body<3>(Shape<3>::box({Real(1.2), Real(0.1), Real(0.3)}), at<3>(0.3, 3));
  rod.angularVelocity = {Real(0.2), Real(6), Real(0.1)};
  world.add(ForceDef<3>{.kind = "spring{stiffness=20,rest_length=1,damping=0.3}",
                        .bodyB = world.add(rod),
                        .anchorA = Vec<3>(1, 5, 0),
                        .anchorB = Vec<3>(1, 0, 0)});
  world.add(ForceDef<3>{.kind = "drag"});
}

void balls(World<3>& world) {
  world.add(body<3>(Shape<3>::sphere(20), at<3>(0, -20), BodyType::fixed));
  Random random(29);
  for (int i = 0; i < 14; ++i) {
    const double x = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const Shape<3> shape = i % 2 ? Shape<3>::sphere(Real(0.35))
                                 : Shape<3>::capsule(Real(0.3), static_cast<Real>(random.uniform(0.2, 0.4)));
    BodyDef<3> def = body<3>(shape, at<3>(x, 0.6 + 0.7 * i, z));
    def.X_WB.q = Rot<3>::vector({Real(0.1 * i), Real(0.3), Real(-0.2 * i)});
    world.add(def);
  }
}

}  // namespace

template <>
const std::vector<PinnedScene<2>>& pinnedScenes<2>() {
  static const std::vector<PinnedScene<2>> all = {
      {"heap_2d", "broadphase=sort_and_sweep contacts=sat_clip solver=split_solver", 120, heap<2>},
      {"towers_2d", "broadphase=uniform_grid solver=soft_step sleep=split_average", 240, towers<2>, disturb<2>},
      {"pyramid_2d",
       "broadphase=region_tree contacts=query_clip "
       "solver=split_solver{velocity=millington,position=nonlinear,order=bottom_up}",
       120, pyramid<2>},
      {"rain_2d",
       "broadphase=naive_sphere contacts=deepest_point cache=none "
       "solver=split_solver{velocity=naive,position=linear,integrator=explicit_euler}",
       120, rain}};
  return all;
}

template <>
const std::vector<PinnedScene<3>>& pinnedScenes<3>() {
  static const std::vector<PinnedScene<3>> all = {
      {"heap_3d", "broadphase=uniform_grid contacts=sat_clip solver=soft_step sleep=split_average", 120, heap<3>},
      {"towers_3d", "broadphase=sort_and_sweep solver=split_solver{position=none} sleep=split_average", 180, towers<3>,
       disturb<3>},
      {"pyramid_3d",
       "broadphase=naive_sphere contacts=query_clip{query=sat} "
       "solver=split_solver{velocity=millington,position=split_impulse,loop=resolve_then_force_move}",
       60, pyramid<3>},
      {"hulls_3d",
       "broadphase=region_tree contacts=query_clip{query=gjk_epa} "
       "solver=split_solver{position=baumgarte,order=random}",
       90, hulls},
      {"chain_3d",
       "broadphase=naive "
       "solver=split_solver{integrator=rk4,velocity=catto{sweep=symmetric},position=nonlinear}",
       180, chain},
      {"balls_3d",
       "broadphase=uniform_grid contacts=query_clip{query=closed_form} solver=split_solver{position=linear}", 90,
       balls}};
  return all;
}

template <int D>
void play(const PinnedScene<D>& scene, ContactListener<D>* listener, const std::function<bool(World<D>&)>& seen) {
  World<D> world(Pipeline::parse(scene.pipeline));
  scene.build(world);
  if (listener) world.addListener(listener);
  for (int step = 0; step < scene.steps; ++step) {
    if (scene.act) scene.act(world, step);
    world.step(Real(1) / 60);
    if (!seen(world)) return;
  }
}

template <int D>
std::uint64_t historyHash(const PinnedScene<D>& scene) {
  std::uint64_t hash = 0;
  play<D>(scene, nullptr, [&](World<D>& world) {
    hash = hash * 0x100000001b3u ^ world.hash();
    return true;
  });
  return hash;
}

#define LPC_INSTANTIATE(D)                                                                                  \
  template void play<D>(const PinnedScene<D>&, ContactListener<D>*, const std::function<bool(World<D>&)>&); \
  template std::uint64_t historyHash<D>(const PinnedScene<D>&)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}}  // namespace lpc::LPC_PRECISION::test
