// SPDX-License-Identifier: Zlib
#pragma once

#include <cmath>
#include <string>

#include "framework/scene/scene_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A body that must move, beside each test of stillness. Where numbers are coarse, or a method moves no body, every
/// body rests.
struct Control {
  double fallen = 0, right = 0;  // m: way along gravity, and that of the closed form g t^2 / 2
  double slack = 0;              // m: what steps of this length may err by, and a hundredth of the way
  bool falls() const { return std::abs(fallen - right) <= slack; }  // false for NaN
  std::string reason() const;
};

/// Drops `body` alone in a simulation of its own, with the scene's settings, step and precision, from rest where it
/// came into the world, for half a second. Precondition: the scene has gravity.
template <int D>
Control dropAlone(const std::string& pipeline, const SceneSpec<D>& scene, const BodyDef<D>& body);

}}  // namespace lpc::LPC_PRECISION
