// SPDX-License-Identifier: Zlib
#include "framework/problem/contact_order.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "framework/math/random.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_order_test { namespace {

// Few bodies with many manifolds each, many bodies, and numbers that differ only in their highest bytes.
template <int D>
std::vector<Manifold<D>> drawManifolds(Random& random) {
  const std::uint64_t limits[] = {1, 5, 300, 70'000, 0x7fffffff};
  const std::uint64_t limit = limits[random.below(5)];
  const auto number = [&] { return static_cast<std::int32_t>(random.below(limit)); };
  std::vector<Manifold<D>> manifolds(random.below(400));
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    Manifold<D>& m = manifolds[i];
    m.bodyA = number(), m.bodyB = number(), m.shapeA = number(), m.shapeB = number();
    m.partA = number(), m.partB = number();
    m.count = static_cast<std::int32_t>(i);  // distinguishes equal keys
  }
  return manifolds;
}

template <int D, class Sort>
bool sortsAsStdDoes(Sort& sort) {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<Manifold<D>> manifolds = drawManifolds<D>(random), expected = manifolds;
    std::stable_sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
    sort(manifolds);
    const auto same = [](const auto& a, const auto& b) { return a.key() == b.key() && a.count == b.count; };
    if (!std::equal(manifolds.begin(), manifolds.end(), expected.begin(), expected.end(), same)) return false;
  }
  return true;
}

// Planted bug: sorts by the low byte of body numbers.
template <int D>
struct SortsByLowBytes {
  void operator()(std::vector<Manifold<D>>& manifolds) {
    std::stable_sort(manifolds.begin(), manifolds.end(), [](const auto& a, const auto& b) {
      return std::pair(a.bodyA & 0xff, a.key()) < std::pair(b.bodyA & 0xff, b.key());
    });
  }
};

template <int D>
struct SortsByOrder {
  ContactOrder order;
  void operator()(std::vector<Manifold<D>>& manifolds) {
    for (const Manifold<D>& m : manifolds) order.add(m.key());
    order.apply(std::span(manifolds));
  }
};

template <int D>
void sortsInBoth() {
  SortsByOrder<D> right;
  EXPECT_TRUE(sortsAsStdDoes<D>(right));
  SortsByLowBytes<D> bug;
  expectCaught("manifolds sorted by low bytes", sortsAsStdDoes<D>(bug));
}
TEST(ContactOrder, SortsAsStableSort) { sortsInBoth<2>(), sortsInBoth<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::contact_order_test
