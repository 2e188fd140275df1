// A world of one's own in twenty lines: drop a box, read its pose.
#include <framework/world.h>

#include <cstdio>

int main() {
  lpc::World<2> world(lpc::Pipeline::parse("solver=split_solver{velocity=catto}"));

  lpc::BodyDef<2> ground{.type = lpc::BodyType::fixed, .X_WB = {{0, -1}}};
  ground.shapes.push_back({.shape = lpc::Shape<2>::box({10, 1})});
  world.add(ground);

  lpc::BodyDef<2> box{.X_WB = {{0, 3}}};
  box.shapes.push_back({.shape = lpc::Shape<2>::box({0.5, 0.5})});
  const lpc::Handle handle = world.add(box);

  for (int i = 0; i < 180; ++i) world.step(lpc::Real(1) / 60);
  const lpc::Pose<2> pose = world.pose(handle);
  std::printf("the box rests at height %.3f m\n", double(pose.p[1]));
  return pose.p[1] > 0.48 && pose.p[1] < 0.52 ? 0 : 1;
}
