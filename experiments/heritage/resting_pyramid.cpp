// SPDX-License-Identifier: Zlib
// The resting pyramid of the 2009 report's figures 7.6 and 7.7, in 2D and by its settings, but awake: one that sleeps
// costs next to nothing under any compiler. A program for each compiler and level of optimisation, of the framework and
// the algorithms of 2009 alone. experiments/heritage/compilers builds and runs it.
// usage: resting_pyramid BASE STEPS > steps.csv
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "framework/stage/profiler.h"
#include "framework/world/settings.h"
#include "framework/world/world.h"

namespace {

// The report's name of a phase and the scope of ours that does the same, as reports/charts/stages.py has them.
constexpr const char* kPhases[][2] = {{"findPairs", "broadphase"},
                                      {"findContacts", "contacts"},
                                      {"applyForces", "solver.integrate"},
                                      {"resolveVelocities", "solver.velocity"},
                                      {"moveApart", "solver.position"}};

double secondsOf(const lpc::Profiler::Frame& frame, const char* scope) {
  double sum = 0;
  for (const lpc::Profiler::Time& time : frame.times) {
    if (std::strcmp(time.name, scope) == 0) sum += time.seconds;
  }
  return sum;
}

}  // namespace

int main(int count, char** arguments) {
  const int base = count == 3 ? std::atoi(arguments[1]) : 0, steps = count == 3 ? std::atoi(arguments[2]) : 0;
  if (base < 1 || steps < 1) {
    std::fputs("usage: resting_pyramid BASE STEPS, two numbers of at least 1\n", stderr);
    return 2;
  }
  lpc::Settings settings = lpc::Settings::lpc2009();
  settings.sleeping = false;
  lpc::World<2> world(settings.pipeline(), settings.world<2>());
  lpc::BodyDef<2> ground{.type = lpc::BodyType::fixed, .X_WB = {{0, -1}}};
  ground.shapes.push_back(settings.shape(lpc::Shape<2>::box({static_cast<lpc::Real>(base + 20), 1})));
  world.add(ground);
  for (int row = 0; row < base; ++row) {
    for (int i = 0; i < base - row; ++i) {
      lpc::BodyDef<2> box;
      const double x = i - (base - row - 1) / 2.0, y = 0.5 + row;
      box.X_WB.p = {static_cast<lpc::Real>(x), static_cast<lpc::Real>(y)};
      box.shapes.push_back(settings.shape(lpc::Shape<2>::box({lpc::Real(0.5), lpc::Real(0.5)})));
      world.add(box);
    }
  }
  std::printf("step,whole [s]");
  for (const auto& phase : kPhases) std::printf(",%s [s]", phase[0]);
  std::printf(",bodies,contact points,state\n");
  for (int step = 0; step < steps; ++step) {
    world.step(settings.dt);
    const lpc::Profiler::Frame& frame = world.profiler().frame();
    std::printf("%d,%.9g", step, frame.seconds);
    for (const auto& phase : kPhases) std::printf(",%.9g", secondsOf(frame, phase[1]));
    // The state of the last step alone: to hash is not in the times, but would warm other caches.
    std::printf(",%d,%d,", frame.bodies, frame.points);
    if (step + 1 == steps) std::printf("%016llx", static_cast<unsigned long long>(world.hash()));
    std::printf("\n");
  }
}
