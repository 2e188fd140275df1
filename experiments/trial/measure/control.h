// SPDX-License-Identifier: Zlib
#pragma once

#include <cmath>
#include <string>

#include "framework/scene/scene_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A control body that must move, for each test of rest. With coarse numbers, or a method that moves no body, every
/// body would pass as resting.
struct Control {
  double fallen = 0, right = 0;  // m: distance along gravity, and that of the closed form g t^2 / 2
  double slack = 0;              // m: error of steps of this length, plus a hundredth of the distance
  bool falls() const { return std::abs(fallen - right) <= slack; }  // false for NaN
  std::string reason() const;
};

/// Drops `body` alone in a simulation of its own, with the scene's settings, step and precision, from rest at its
/// initial pose, for half a second. Precondition: the scene has gravity.
template <int D>
Control dropAlone(const std::string& pipeline, const SceneSpec<D>& scene, const BodyDef<D>& body);

}}  // namespace lpc::LPC_PRECISION
