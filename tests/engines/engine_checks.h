// SPDX-License-Identifier: Zlib
// The tested engines, and small scenes. A check is a function of how a simulation starts, so it runs on every engine,
// on our own world, and on planted adapters.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "framework/world/world.h"
#include "tests/planted_bugs/engine_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr Real kDt = Real(1) / 60;
inline constexpr double kG = 10;

template <int D>
struct Named {
  std::string name;
  Start<D> start;
};

// The engines that this build and this precision have.
template <int D>
std::vector<Named<D>> engines() {
  std::vector<Named<D>> out;
  for (const Registered* r : Registry::instance().list(StageKind::engine, D)) {
    const std::shared_ptr<Engine<D>> engine = createStage<Engine<D>>({r->info.name, {}});
    try {
      engine->start({});
    } catch (const UserError& e) {
      std::printf("[ absent   ] %s %dD: %s\n", r->info.name.c_str(), D, e.what());
      continue;
    }
    out.push_back({r->info.name, [engine](const WorldSettings<D>& s) { return engine->start(s); }});
  }
  return out;
}

template <int D>
Vec<D> at(double x, double y) {
  Vec<D> p = Vec<D>::Zero();
  p[0] = Real(x), p[1] = Real(y);
  return p;
}
template <int D>
WorldSettings<D> gravity(double x, double y) {
  WorldSettings<D> s;
  s.gravity = at<D>(x, y);
  return s;
}
template <int D>
BodyDef<D> body(const Shape<D>& shape, const Vec<D>& p, BodyType type = BodyType::dynamic) {
  BodyDef<D> def;
  def.type = type, def.X_WB.p = p;
  def.shapes.resize(1);
  def.shapes[0].shape = shape;
  return def;
}
template <int D>
BodyDef<D> ground() {
  Vec<D> half = Vec<D>::Constant(50);
  half[1] = 1;
  return body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed);
}
template <int D>
Shape<D> cube() {
  return Shape<D>::box(Vec<D>::Constant(Real(0.5)));
}
template <int D>
void run(Simulation<D>& s, double seconds) {
  for (long i = 0; i < std::lround(seconds / double(kDt)); ++i) s.step(kDt);
}
inline bool near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

template <int D>
void everyEngine(const char* what, bool (*check)(const Start<D>&)) {
  for (const auto& e : engines<D>()) EXPECT_TRUE(check(e.start)) << e.name << " " << D << "D: " << what;
}
inline void everywhere(const char* what, bool (*two)(const Start<2>&), bool (*three)(const Start<3>&)) {
  everyEngine<2>(what, two), everyEngine<3>(what, three);
}

template <int D>
Start<D> ownWorld(const std::string& pipeline = "") {
  return [pipeline](const WorldSettings<D>& s) { return std::make_unique<World<D>>(Pipeline::parse(pipeline), s); };
}

}}}  // namespace lpc::LPC_PRECISION::test
