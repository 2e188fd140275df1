// SPDX-License-Identifier: Zlib
#include "framework/slots.h"

#include <gtest/gtest.h>

#include <set>

#include "framework/random.h"
#include "tests/expect_caught.h"

namespace lpc::inline LPC_PRECISION::test::slots_test {
namespace {

// Takes and gives at random: always the lowest slot that is free, also after reading a table with holes.
template <class Subject>
bool givesTheLowest(Subject slots) {
  Random random(3);
  std::set<std::size_t> used;
  std::uint64_t visits = 0;
  for (int i = 0; i < 20'000; ++i) {
    // Grows to some hundred and shrinks to nothing, in turn.
    if (used.empty() || random.uniform() < (i / 1000 % 2 == 0 ? 0.7 : 0.3)) {
      std::size_t lowest = 0;
      while (used.count(lowest)) ++lowest;
      if (slots.take(visits) != lowest) return false;
      used.insert(lowest);
    } else {
      auto it = used.begin();
      std::advance(it, static_cast<std::ptrdiff_t>(random.below(used.size())));
      slots.give(*it, visits);
      used.erase(it);
    }
    if (slots.inUse() != static_cast<int>(used.size())) return false;
    if (i % 1000 == 0) {
      std::vector<int> table(slots.size());
      for (std::size_t slot : used) table[slot] = 1;
      slots.read(table, [](int inUse) { return inUse == 0; });
    }
  }
  return true;
}

// The slot that was freed last.
struct LastFreed {
  std::vector<std::size_t> free;
  std::size_t count = 0;
  std::size_t take(std::uint64_t&) {
    if (free.empty()) return count++;
    const std::size_t slot = free.back();
    free.pop_back();
    return slot;
  }
  void give(std::size_t slot, std::uint64_t&) { free.push_back(slot); }
  std::size_t size() const { return count; }
  int inUse() const { return static_cast<int>(count - free.size()); }
  template <class Table, class IsFree>
  void read(const Table&, const IsFree&) {}
};

TEST(SlotTable, TheLowestFreeOneIsNext) {
  EXPECT_TRUE(givesTheLowest(SlotTable()));
  expectCaught("slots: the last freed one is next", givesTheLowest(LastFreed()));
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test::slots_test
