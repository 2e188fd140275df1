// SPDX-License-Identifier: Zlib
// Planted bugs of sleep policies; the conformance test must catch them.
#pragma once

#include <algorithm>

#include "framework/stage/stage_sleep.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Averages as in the 2009 report, and nothing else: a body falls asleep at the top of a throw.
template <int D>
class AveragesOnly final : public SleepPolicy<D> {
 public:
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (in.bodies.type[i] != BodyType::dynamic) continue;
      memory[i][0] = (memory[i][0] + in.bodies.motion[i].v.norm()) / 2;
      memory[i][1] = (memory[i][1] + in.bodies.motion[i].w.norm()) / 2;
      if (memory[i][0] < Real(1.5) && memory[i][1] < Real(0.01)) awake[i] = 0;
    }
  }
};

/// All bodies sleep, for ever.
template <int D>
class SleepsAtOnce final : public SleepPolicy<D> {
 public:
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>>) override {
    for (std::size_t i = 0; i < awake.size(); ++i) awake[i] = in.bodies.type[i] != BodyType::dynamic;
  }
};

/// An impact wakes the struck body only; the bodies behind it act as walls.
template <int D>
class WakesOnlyTheStruck final : public SleepPolicy<D> {
 public:
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>>) override {
    for (const SleepEvent& e : in.events) awake[static_cast<std::size_t>(e.body)] = 1;
  }
};

/// Sleeping as in Millington's book, and nothing else: one average of v^2 + w^2, per step as printed in the 2009
/// report. A touching awake body with enough speed wakes a sleeper.
template <int D>
class BookAlone final : public SleepPolicy<D> {
 public:
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    const std::vector<std::uint8_t> before(awake.begin(), awake.end());
    for (const Manifold<D>& m : in.manifolds) {
      for (const auto& [from, to] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        const auto i = static_cast<std::size_t>(to), other = static_cast<std::size_t>(from);
        if (before[i] || !before[other] || in.bodies.type[i] != BodyType::dynamic) continue;
        if (in.bodies.motion[other].v.norm() > in.restitutionThreshold) awake[i] = 1, memory[i][0] = 2 * kEpsilon;
      }
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (in.bodies.type[i] != BodyType::dynamic || !awake[i]) continue;
      const Motion<D>& motion = in.bodies.motion[i];
      memory[i][0] = (memory[i][0] + motion.v.squaredNorm() + motion.w.squaredNorm()) / 2;
      if (memory[i][0] < kEpsilon && in.bodies.canSleep[i]) awake[i] = 0;
      memory[i][0] = std::min(memory[i][0], 10 * kEpsilon);
    }
  }

 private:
  static constexpr Real kEpsilon = Real(0.3);
};

/// One island for the whole world, connected through the ground: no body sleeps while any body moves.
template <int D>
class IslandOfTheGround final : public SleepPolicy<D> {
 public:
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>>) override {
    bool anybody = false;
    for (const Motion<D>& m : in.bodies.motion) anybody = anybody || m.v.norm() > 0 || m.w.norm() > 0;
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (in.bodies.type[i] == BodyType::dynamic) awake[i] = anybody;
    }
  }
};

/// A body sleeps after half a second at rest, with or without a support.
template <int D>
class CountsSeconds : public SleepPolicy<D> {
 public:
  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (in.bodies.type[i] != BodyType::dynamic) continue;
      const bool still = in.bodies.motion[i].v.norm() < Real(0.01) && in.bodies.motion[i].w.norm() < Real(0.01);
      memory[i][0] = still ? memory[i][0] + tick(in.dt) : Real(0);
      if (memory[i][0] > Real(0.5)) awake[i] = 0;
    }
  }

 protected:
  virtual Real tick(Real dt) const { return dt; }
};

/// The same, counted in the steps of half a second at 60 Hz.
template <int D>
class CountsSteps final : public CountsSeconds<D> {
  Real tick(Real) const override { return Real(1) / 60; }
};

}}}  // namespace lpc::LPC_PRECISION::test
