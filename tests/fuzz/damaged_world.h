// SPDX-License-Identifier: Zlib
// Saved worlds, damaged but with a valid checksum.
#pragma once

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cstring>
#include <limits>

#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr std::size_t kSavedChecksum = 27, kSavedBody = 35;  // after format, two numbers and length

/// Corrects length and checksum, so that the reader's own validation is tested.
inline std::string sealed(std::string bytes) {
  const std::uint64_t size = bytes.size() - kSavedBody, sum = XXH64(bytes.data() + kSavedBody, size, 0);
  bytes.replace(kSavedChecksum - sizeof size, sizeof size, reinterpret_cast<const char*>(&size), sizeof size);
  bytes.replace(kSavedChecksum, sizeof sum, reinterpret_cast<const char*>(&sum), sizeof sum);
  return bytes;
}

/// Every class of shape, a joint, forces, contacts, the slots of removed bodies, an event.
template <int D>
void addEverything(World<D>& world) {
  world.add(body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed));
  const BodyHandle gone = world.add(body<D>(Shape<D>::sphere(1), at<D>(50, 50)));
  std::vector<Vec<D>> corners;
  for (int bits = 0; bits < 1 << D; ++bits) {
    Vec<D> v;
    for (int k = 0; k < D; ++k) v[k] = (bits >> k) & 1 ? Real(0.4) : Real(-0.4);
    corners.push_back(v);
  }
  world.add(body<D>(Shape<D>::polytope(corners, Real(0.01)), at<D>(0, 0.41)));
  const BodyHandle box = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.3))), at<D>(0.1, 1.12)));
  std::vector<Real> sizes(static_cast<std::size_t>(D), Real(0.3));
  world.add(body<D>(Shape<D>::curved(ShapeKind::ellipsoid, sizes), at<D>(1.5, 0.3)));
  if constexpr (D == 3) {
    const std::vector<Real> cylinder = {Real(0.2), Real(0.3)};
    world.add(body<D>(Shape<D>::curved(ShapeKind::cylinder, cylinder), at<D>(-1.5, 0.3)));
  }
  const Shape<D> ball = Shape<D>::sphere(Real(0.2)), hull = Shape<D>::polytope(corners);
  const std::vector<ShapePart<D>> parts = {{ball, {at<D>(0.4, 0), {}}}, {hull, {}}};
  world.add(body<D>(Shape<D>::compound(parts), at<D>(4, 0.4)));
  const BodyHandle bob = world.add(body<D>(Shape<D>::capsule(Real(0.2), Real(0.1)), at<D>(1, 2)));
  world.add(pivot<D>(box, bob, at<D>(0.5, 1.5)));
  const ForceHandle off = world.add(ForceDef<D>{.kind = "drag"});
  world.add(ForceDef<D>{.kind = "spring{rest_length=1}", .bodyA = box, .bodyB = bob, .anchorA = at<D>(0.1, 0.1)});
  world.add(ForceDef<D>{.kind = "rolling_resistance"});
  world.remove(off);
  for (int i = 0; i < 3; ++i) world.step(Real(1) / 60);
  world.remove(gone);
  world.applyForce(box, at<D>(1, 0), at<D>(0.1, 1));
}

/// Every stage that keeps a data structure, and every kind of solver memory.
inline constexpr std::array<const char*, 7> kDamagedPipelines = {
    "contacts=query_clip sleep=split_average",
    "broadphase=uniform_grid contacts=query_clip solver=soft_step",
    "contacts=sat_clip sleep=split_average",
    "broadphase=region_tree contacts=query_clip solver=split_solver{velocity=millington,position=nonlinear}",
    "broadphase=naive_sphere contacts=query_clip solver=split_solver{position=split_impulse,integrator=rk4}",
    "broadphase=naive contacts=query_clip cache=none sleep=split_average solver=split_solver{position=linear}",
    "contacts=deepest_point solver=split_solver{velocity=naive,position=none,integrator=explicit_euler}"};

/// The bytes after the header of a saved world that contains some of everything, in the pipeline with this number.
template <int D>
std::string payloadOf(std::size_t pipeline) {
  World<D> world(Pipeline::parse(kDamagedPipelines[pipeline]));
  if (pipeline == 1) {
    addJointed(world, at<D>(0, 5));
    for (int i = 0; i < 3; ++i) world.step(Real(1) / 60);
  } else if (pipeline == 2) {  // shapes that sat_clip supports
    addHeap(world, 3, 7);
    for (int i = 0; i < 60; ++i) world.step(Real(1) / 60);
  } else {
    addEverything(world);
  }
  return saved(world).substr(kSavedBody);
}

/// Overwrites bytes with an extreme value, at the offset of a number or beside it.
inline void putEdge(std::string& payload, Random& random) {
  const auto put = [&](const auto& value) {
    if (payload.size() < sizeof value) return;
    std::memcpy(payload.data() + random.below(payload.size() - sizeof value + 1), &value, sizeof value);
  };
  using Limits = std::numeric_limits<Real>;
  constexpr Real kReals[] = {
      0, -1,        Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::max(), Limits::min(),
      1, Real(1e9), Real(-1e-9)};
  constexpr std::int64_t kWhole[] = {0,
                                     1,
                                     2,
                                     -1,
                                     7,
                                     255,
                                     65535,
                                     std::numeric_limits<std::int32_t>::max(),
                                     std::numeric_limits<std::int32_t>::min(),
                                     std::numeric_limits<std::int64_t>::max()};
  const std::int64_t whole = kWhole[random.below(std::size(kWhole))];
  switch (random.below(5)) {
    case 0:
    case 1:
      return put(kReals[random.below(std::size(kReals))]);
    case 2:
      return put(static_cast<std::int32_t>(whole));
    case 3:
      return put(whole);
    default:
      return put(static_cast<std::uint8_t>(random.below(256)));
  }
}

/// Outcome of loading a payload. It has no fault if it was rejected with a message, or if the world steps and can be
/// saved.
struct Life {
  bool loaded = false;
  std::string fault;
};
/// With `again`, the saved world must load again.
template <int D>
Life livesOn(const std::string& payload, const char* pipeline, bool again) {
  World<D> world(Pipeline::parse(pipeline));
  static const std::string header = saved(World<D>()).substr(0, kSavedBody);
  std::istringstream in(sealed(header + payload));
  try {
    world.load(in);
  } catch (const UserError& e) {
    const std::string what = e.what();
    return {false, what.starts_with("load: ") ? "" : "a refusal that does not say who refuses: " + what};
  }
  for (int i = 0; i < 3; ++i) world.step(Real(1) / 60);
  std::istringstream out(saved(world));
  if (!again) return {true, ""};
  try {
    World<D>(Pipeline::parse(pipeline)).load(out);
  } catch (const UserError& e) {
    return {true, std::string("a world that stepped is saved as none: ") + e.what()};
  }
  return {true, ""};
}

}}}  // namespace lpc::LPC_PRECISION::test
