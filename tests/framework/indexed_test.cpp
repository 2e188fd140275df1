// SPDX-License-Identifier: Zlib
#include "framework/math/indexed.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace indexed_test { namespace {

enum class Colour { red, green, blue };

// Functions that take the standard containers accept these.
int sumOf(std::span<const int> all) {
  int sum = 0;
  for (const int x : all) sum += x;
  return sum;
}
void grow(std::vector<int>& all) { all.push_back(8); }

TEST(Indexed, AnyIntegerAndNumberedNameIsAnIndex) {
  IndexedVector<int> v = {5, 6, 7};
  const std::int32_t slot = 2;
  v[slot] += 1, v[std::size_t{0}] = v[Colour::green];
  EXPECT_EQ(v, (std::vector<int>{6, 6, 8}));
  const IndexedSpan<const int> s = v;
  EXPECT_EQ(s[slot], 8);
  IndexedArray<int, 3> a = {1, 2, 3};
  a[slot] = a[Colour::red];
  EXPECT_EQ(a, (std::array<int, 3>{1, 2, 1}));
}

TEST(Indexed, ConvertsToItsBase) {
  IndexedVector<int> v = std::vector<int>{1, 2};
  grow(v);
  EXPECT_EQ(sumOf(v), 11);
  EXPECT_EQ(sumOf(IndexedSpan<int>(v)), 11);
  const auto [x, y] = IndexedArray<int, 2>{3, 4};
  EXPECT_EQ(10 * x + y, 34);
}

TEST(Indexed, PartOfIt) {
  const IndexedVector<int> v = {1, 2, 4, 8};
  EXPECT_EQ(sumOf(v.part(1, 2)), 6);
  EXPECT_EQ(sumOf(IndexedSpan<const int>(v).part(3, 1)), 8);
  EXPECT_TRUE(v.part(4, 0).empty());
}

TEST(Indexed, OutOfRangeIsAMistake) {
  const IndexedVector<int> v(3);
  const IndexedSpan<const int> s = v;
  const IndexedArray<int, 3> a{};
  for (const int i : {-1, 3}) {
    EXPECT_DEATH((void)v[i], "assertion failed");
    EXPECT_DEATH((void)s[i], "assertion failed");
    EXPECT_DEATH((void)a[i], "assertion failed");
  }
}

// A conversion would make a new vector: memory allocated in each step.
TEST(Indexed, TakesAPlainVectorIntoItsOwnMemory) {
  IndexedVector<double> to(100);
  const double* const memory = to.data();
  std::vector<double> from(50, 1.0);
  to = from;
  EXPECT_EQ(to.data(), memory);
  EXPECT_EQ(to.size(), 50u);
  to = IndexedVector<double>(from);  // planted bug: by a conversion
  EXPECT_NE(to.data(), memory);
  const double* const moved = from.data();
  to = std::move(from);
  EXPECT_EQ(to.data(), moved);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::indexed_test
