// SPDX-License-Identifier: Zlib
// A tower and a ball that rolls at it, in a window.
#include <experiments/sandbox/view.h>
#include <lpc/shape_between.h>
#include <lpc/world.h>

int main() try {
  lpc::World<3> world(lpc::Pipeline::parse("solver=soft_step"));
  world.add(lpc::boxBetween<3>({-20, -1, -20}, {20, 0, 20}));
  for (int i = 0; i < 12; ++i) {
    for (int k = 0; k < 2; ++k) {
      const lpc::Vec<3> half = i % 2 ? lpc::Vec<3>(1, 0.25, 0.4) : lpc::Vec<3>(0.4, 0.25, 1);
      lpc::BodyDef<3> block;
      block.X_WB.p = {i % 2 ? 0 : 1.2 * k - 0.6, 0.25 + 0.5 * i, i % 2 ? 1.2 * k - 0.6 : 0};
      block.shapes = {{.shape = lpc::Shape<3>::box(half)}};
      world.add(block);
    }
  }
  lpc::BodyDef<3> ball{.X_WB = {{-8, 1, 0.3}}};
  ball.shapes = {{.shape = lpc::Shape<3>::sphere(1), .density = 5}};
  world.setMotion(world.add(ball), {{9, 0, 0}, {0, 0, -9}});
  lpc::view(world, 1.0 / 120);
} catch (const lpc::UserError& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
