// SPDX-License-Identifier: Zlib
#include "framework/stage_sleep.h"

namespace lpc::inline LPC_PRECISION {

// Union-find with the lowest slot as root (path halving; Tarjan 1975), so that the answer does not depend on the order
// of manifolds and joints. A dynamic body that touches nobody is an island of its own.
template <int D>
std::vector<std::int32_t> islands(const Bodies<D>& bodies, std::span<const Manifold<D>> manifolds,
                                  std::span<const JointRecord<D>> joints) {
  const auto n = static_cast<std::size_t>(bodies.size());
  std::vector<std::int32_t> parent(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (bodies.used[i] && bodies.type[i] == BodyType::dynamic) parent[i] = static_cast<std::int32_t>(i);
  }
  const auto at = [&](std::int32_t i) -> std::int32_t& { return parent[static_cast<std::size_t>(i)]; };
  const auto root = [&](std::int32_t i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  };
  const auto join = [&](std::int32_t a, std::int32_t b) {
    if (a < 0 || b < 0 || at(a) < 0 || at(b) < 0) return;  // the ground connects nobody
    a = root(a), b = root(b);
    if (a != b) at(std::max(a, b)) = std::min(a, b);
  };
  for (const Manifold<D>& m : manifolds) {
    if (!m.ignored) join(m.bodyA, m.bodyB);
  }
  for (const JointRecord<D>& j : joints) {
    if (j.active()) join(j.bodyA, j.bodyB);
  }

  std::vector<std::int32_t> island(n, -1);
  std::int32_t next = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (parent[i] < 0) continue;
    const auto r = static_cast<std::size_t>(root(static_cast<std::int32_t>(i)));
    if (r == i) island[i] = next++;
    island[i] = island[r];  // a root comes before its members
  }
  return island;
}

template std::vector<std::int32_t> islands(const Bodies<2>&, std::span<const Manifold<2>>,
                                           std::span<const JointRecord<2>>);
template std::vector<std::int32_t> islands(const Bodies<3>&, std::span<const Manifold<3>>,
                                           std::span<const JointRecord<3>>);

}  // namespace lpc::inline LPC_PRECISION
