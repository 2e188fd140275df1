// SPDX-License-Identifier: Zlib
// A game of dominoes, like those of the first users of the 2009 engine: it has its own broadphase, and listeners that
// count points. The player chooses the speed of the ball: just fast enough earns the most.
#include <lpc/shape_between.h>
#include <lpc/world.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>

namespace {

using namespace lpc;

constexpr int kDominoes = 20;
constexpr std::uint64_t kBall = 1000;  // the dominoes' numbers are 1 to 20

std::uint64_t numberOf(const World<3>& world, std::int32_t body) {
  return world.bodies().userData[static_cast<std::size_t>(body)];
}

// A point for each domino that its neighbour hits. The ball's own hit does not count, and is frictionless.
class Score final : public ContactListener<3> {
 public:
  std::set<std::uint64_t> fallen;
  void mix(const World<3>& world, const Manifold<3>& m, PairMaterial& material) override {
    if (numberOf(world, m.bodyA) == kBall || numberOf(world, m.bodyB) == kBall) material.friction = 0;
  }
  bool begin(const World<3>& world, const Manifold<3>& m) override {
    const auto [low, high] = std::minmax({numberOf(world, m.bodyA), numberOf(world, m.bodyB)});
    if (low >= 1 && high == low + 1) fallen.insert(high);
    return true;
  }
};

// Listens to the bell only.
class Bell final : public ContactListener<3> {
 public:
  bool rung = false;
  bool begin(const World<3>&, const Manifold<3>&) override { return rung = true; }
};

}  // namespace

int main(int count, char** words) {
  char* end = nullptr;
  const double speed = count == 2 ? std::strtod(words[1], &end) : -1;
  if (count != 2 || end == words[1] || *end != 0 || !(speed >= 0 && speed <= 20)) {
    std::fprintf(stderr, "usage: dominoes SPEED\n\nRolls a ball at 20 dominoes, 0 to 20 m/s. Example: dominoes 3\n");
    return 2;
  }
  World<3> world(Pipeline::parse("broadphase=lane sleep=split_average"));
  world.add(boxBetween<3>({-10, -1, -2}, {20, 0, 2}));
  for (int i = 0; i < kDominoes; ++i) {
    BodyDef<3> domino;
    domino.X_WB.p = {Real(0.6 * i), Real(0.5), 0};
    domino.shapes = {{.shape = Shape<3>::box({Real(0.1), Real(0.5), Real(0.25)}), .density = 2}};
    domino.userData = static_cast<std::uint64_t>(i + 1);
    world.add(domino);
  }
  Score score;
  world.addListener(&score);
  Bell bell;
  const Real last = Real(0.6) * (kDominoes - 1);
  world.addListener(world.add(boxBetween<3>({last + Real(0.6), 0, -1}, {last + 1, Real(0.3), 1})), &bell);

  BodyDef<3> ball;
  ball.X_WB.p = {-2, Real(0.4), 0};
  ball.shapes = {{.shape = Shape<3>::sphere(Real(0.4)), .density = 1}};
  ball.userData = kBall;
  const BodyHandle rolled = world.add(ball);
  world.applyImpulse(rolled, {world.mass(rolled) * Real(speed), 0, 0}, world.pose(rolled).p);

  for (int step = 0; step < 900; ++step) world.step(Real(1) / 60);
  const int points = static_cast<int>(score.fallen.size()) + (bell.rung ? 5 : 0);
  std::printf("%zu of %d dominoes were knocked over%s: %d points\n", score.fallen.size(), kDominoes - 1,
              bell.rung ? ", and the bell rang" : "", points);
}
