// SPDX-License-Identifier: Zlib
#include "framework/math/slots.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "framework/math/random.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace slots_test { namespace {

// Takes and returns slots at random. Always gets the lowest free slot, also after reading a table with free slots.
template <class Subject>
bool givesTheLowest(Subject slots) {
  Random random(3);
  std::set<std::size_t> used;
  std::uint64_t visits = 0;
  for (int i = 0; i < 20'000; ++i) {
    // Grows to some hundred and shrinks to zero, in turn.
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

// Planted bug: gives the slot that was freed last.
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

std::vector<std::int32_t> listOf(std::span<const std::int32_t> slots) { return {slots.begin(), slots.end()}; }

// Random slots are added to and removed from three owners.
template <class Subject>
bool keepsEachHisOwnInOrder(Subject lists) {
  Random random(5);
  std::array<std::set<std::int32_t>, 3> truth;
  std::uint64_t visits = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto slot = static_cast<std::size_t>(random.below(40)), owner = slot % truth.size();
    if (truth[owner].insert(static_cast<std::int32_t>(slot)).second) {
      lists.add(owner, slot, visits);
    } else {
      truth[owner].erase(static_cast<std::int32_t>(slot));
      lists.remove(owner, slot, visits);
    }
    for (std::size_t o = 0; o < truth.size(); ++o) {
      if (listOf(lists.of(o, visits)) != std::vector<std::int32_t>(truth[o].begin(), truth[o].end())) return false;
    }
  }
  return true;
}

// Cost of n owners with three slots each: each list is read, and its slots are removed, the last one first.
template <class Subject>
bool costsWhatEachHas(Subject lists) {
  for (const std::size_t n : {10u, 1000u}) {
    std::uint64_t visits = 0;
    for (std::size_t slot = 0; slot < 3 * n; ++slot) lists.add(slot / 3, slot, visits);
    for (std::size_t owner = 0; owner < n; ++owner) {
      for (const std::int32_t slot : std::vector{2, 1, 0}) {
        if (lists.of(owner, visits).size() != static_cast<std::size_t>(slot) + 1) return false;
        lists.remove(owner, 3 * owner + static_cast<std::size_t>(slot), visits);
      }
    }
    if (visits != n * (3 + 2 + 1) + 3 * n) return false;
  }
  return true;
}

// Planted bug: slots in the order of adding.
struct Appended {
  std::vector<std::vector<std::int32_t>> lists = std::vector<std::vector<std::int32_t>>(9);
  std::span<const std::int32_t> of(std::size_t owner, std::uint64_t&) { return lists[owner]; }
  void add(std::size_t owner, std::size_t slot, std::uint64_t&) {
    lists[owner].push_back(static_cast<std::int32_t>(slot));
  }
  void remove(std::size_t owner, std::size_t slot, std::uint64_t&) {
    std::erase(lists[owner], static_cast<std::int32_t>(slot));
  }
};

// Planted bug: no lists, the table is searched.
struct Searched {
  std::vector<std::ptrdiff_t> owners;  // by slot
  std::vector<std::int32_t> found = {};
  std::span<const std::int32_t> of(std::size_t owner, std::uint64_t& visits) {
    found.clear(), visits += owners.size();
    for (std::size_t slot = 0; slot < owners.size(); ++slot) {
      if (owners[slot] == static_cast<std::ptrdiff_t>(owner)) found.push_back(static_cast<std::int32_t>(slot));
    }
    return found;
  }
  void add(std::size_t owner, std::size_t slot, std::uint64_t&) {
    owners.resize(std::max(owners.size(), slot + 1), -1);
    owners[slot] = static_cast<std::ptrdiff_t>(owner);
  }
  void remove(std::size_t, std::size_t slot, std::uint64_t& visits) { ++visits, owners[slot] = -1; }
};

TEST(SlotLists, EachOwnerHasItsSlotsInOrder) {
  EXPECT_TRUE(keepsEachHisOwnInOrder(SlotLists()));
  EXPECT_TRUE(keepsEachHisOwnInOrder(Searched()));
  expectCaught("whose slots, in the order in which they came", keepsEachHisOwnInOrder(Appended()));
}
TEST(SlotLists, CostIsThatOfTheOwnersSlots) {
  EXPECT_TRUE(costsWhatEachHas(SlotLists()));
  expectCaught("whose slots, searched for", costsWhatEachHas(Searched()));
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::slots_test
