// SPDX-License-Identifier: Zlib
// The ledger of a verification: queries and outcomes by method, by kinds of shape, and by one further axis at a time.
// Entries can be added, so that blocks may be verified in any order, on any machine.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Outcomes of a query. The first ones after `asked` add up to it; the last two are counted in addition.
enum class Tally {
  asked,
  agree,
  wrong,      // value, normal or side, proved by the referee; candidate or witness by the method's role
  tie,        // correct along another normal than the referee's, or features changed by chance
  undecided,  // the referee has no answer
  refused,
  notFinite,
  threw,
  crashed,
  hung,
  wrongSide,  // of the wrong answers: separated and overlapping confused
  capped,     // stopped at the iteration limit, or in a case that it cannot finish
  kCount
};
inline constexpr std::size_t kTallies = static_cast<std::size_t>(Tally::kCount);
inline constexpr std::array<std::string_view, kTallies> kTallyNames = {"asked",     "agree",   "wrong",      "tie",
                                                                       "undecided", "refused", "not_finite", "threw",
                                                                       "crashed",   "hung",    "wrong_side", "capped"};

struct LedgerKey {
  std::string stage, precision;
  int dimension = 3;
  std::string kindA, kindB;  // empty for broadphases
  std::string axis, value;   // all and empty, or family, regime, scale, offset or kWiderScale with its value
  std::string method;
  auto operator<=>(const LedgerKey&) const = default;
};

struct LedgerEntry {
  AlgorithmRole role = AlgorithmRole::competitor;
  std::array<long, kTallies> tallies{};
  double maxError = 0, nanoseconds = 0;   // error / s; time inside the method
  std::map<std::string, long> histogram;  // of errors, by decade: "-17" for 1e-17 up to 1e-16, "zero"
  std::string worst;                      // the case of maxError, as a line of a file of cases; only for axis `all`

  long& operator[](Tally t) { return tallies[static_cast<std::size_t>(t)]; }
  long operator[](Tally t) const { return tallies[static_cast<std::size_t>(t)]; }
  /// Queries that ended neither right nor undecided.
  long faults() const {
    const LedgerEntry& e = *this;
    return e[Tally::asked] - e[Tally::agree] - e[Tally::tie] - e[Tally::undecided];
  }

  void add(const LedgerEntry& other) {
    role = other.role;
    for (std::size_t i = 0; i < kTallies; ++i) tallies[i] += other.tallies[i];
    nanoseconds += other.nanoseconds;
    for (const auto& [decade, count] : other.histogram) histogram[decade] += count;
    if (worst.empty() || other.maxError > maxError) worst = other.worst;
    maxError = maxError < other.maxError ? other.maxError : maxError;
  }
};

using Ledger = std::map<LedgerKey, LedgerEntry>;

/// A pair on which a method failed in one way; replaced when a simpler pair is found.
struct FoundCase {
  std::string method, failure;
  int vertices = 0;  // simpler: fewer vertices, then a smaller s
  double size = 0;
  std::string text;  // a line of a file of cases

  bool simplerThan(const FoundCase& other) const {
    return vertices != other.vertices ? vertices < other.vertices : size < other.size;
  }
};

struct Verified {
  Ledger ledger;
  std::map<std::pair<std::string, std::string>, FoundCase> found;  // by method and failure

  void keep(FoundCase c) {
    const auto [at, fresh] = found.try_emplace({c.method, c.failure}, c);
    if (!fresh && c.simplerThan(at->second)) at->second = std::move(c);
  }
  void add(const Verified& other) {
    for (const auto& [key, entry] : other.ledger) ledger[key].add(entry);
    for (const auto& [name, c] : other.found) keep(c);
  }
};

}}  // namespace lpc::LPC_PRECISION
