// SPDX-License-Identifier: Zlib
// For tests of parts of a world without a world.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "framework/world/body_table.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// A typed suite of this type runs in 2D and 3D: TypeParam::D.
template <int Dim>
struct InDimension {
  static constexpr int D = Dim;
};
using BothDimensions = testing::Types<InDimension<2>, InDimension<3>>;

/// Bodies and shapes with their own broadphase.
template <int D>
struct Inhabitants {
  std::unique_ptr<Broadphase<D>> broadphase = createStage<Broadphase<D>>({"naive", {}});
  WorldSettings<D> settings{};
  BodyTable<D> table{*broadphase, settings.margin};
  Profiler profiler;

  /// As it is after the step that follows.
  std::size_t add(const BodyDef<D>& def) {
    const std::size_t i = table.add(def, checkBody(def));
    table.events.clear();
    return i;
  }
  /// A unit ball.
  std::size_t ball(const Vec<D>& place, BodyType type = BodyType::dynamic) {
    return add(body<D>(Shape<D>::sphere(1), place, type));
  }
  BodyHandle handle(std::size_t body) const { return table.handle(static_cast<std::int32_t>(body)); }
};

template <class F>
std::string refusalOf(const F& f) {
  try {
    f();
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

}}}  // namespace lpc::LPC_PRECISION::test
