// SPDX-License-Identifier: Zlib
#include "experiments/runner/ledger_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <set>

#include "experiments/runner/catalogue.h"
#include "oracles/verify/metamorphic.h"
#include "oracles/verify/verdict.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::size_t kMethodWidth = 20;  // or the length of the longest name

// Lower end of the decade of the median.
std::string medianOf(const LedgerEntry& e) {
  std::vector<std::pair<int, long>> decades;
  long all = 0;
  for (const auto& [decade, count] : e.histogram) {
    decades.emplace_back(decade == "zero" ? -1000 : std::stoi(decade), count);
    all += count;
  }
  std::sort(decades.begin(), decades.end());
  long below = 0;
  for (const auto& [decade, count] : decades) {
    below += count;
    if (2 * below >= all) return decade == -1000 ? "0" : fmt::format("1e{}", decade);
  }
  return "-";
}

long withoutAnswer(const LedgerEntry& e) {
  return e[Tally::notFinite] + e[Tally::threw] + e[Tally::crashed] + e[Tally::hung];
}

// Answers judged by the side alone, without a measured error.
long withoutValue(const LedgerEntry& e) {
  long values = 0;
  for (const auto& [decade, count] : e.histogram) values += count;
  return e[Tally::agree] + e[Tally::tie] + e[Tally::wrong] - values;
}

std::string nanosecondsOf(const LedgerEntry& e) {
  return e[Tally::asked] ? fmt::format("{:.0f}", e.nanoseconds / static_cast<double>(e[Tally::asked])) : "-";
}

// `faults`: number of faults that make the run fail.
std::string remark(const LedgerEntry& e, long faults) {
  if (e.role != AlgorithmRole::competitor) return "  (" + std::string(roleName(e.role)) + ")";
  return faults ? "  WRONG" : e.faults() ? "  (approximate)" : "";
}

/// Stage, dimension and precision: one section of the output.
using Section = std::tuple<std::string, int, std::string>;

class Printer {
 public:
  Printer(const Ledger& ledger, const Section& section, std::ostream& out) : m_out(out) {
    for (const auto& [key, entry] : ledger) {
      if (Section(key.stage, key.dimension, key.precision) != section) continue;
      if (key.axis == "all") {
        m_methods[key.method].add(entry);
        const long faults = faultsOfOurs(key, entry);
        m_kinds[{key.kindA, key.kindB}][key.method] = {entry, faults};
        m_faults[key.method] += faults;
      } else if (key.axis == kRelationAxis) {
        m_relations[key.method][key.value].add(entry);
        m_faults[key.method] += faultsOfOurs(key, entry);
      } else {
        m_axes[key.axis][key.value][key.method].add(entry);
      }
    }
    const auto& [stage, dimension, precision] = section;
    m_pairQueries = stage == stageName(StageKind::pairQuery);
    m_out << fmt::format("{} in {}D, {}\n", stage, dimension, precision);
    for (const auto& [name, e] : m_methods) m_width = std::max(m_width, name.size() + 1);
    for (const auto& [name, e] : m_relations) m_width = std::max(m_width, name.size() + 1);
  }

  int print() {
    if (!m_methods.empty()) verdicts();
    for (const char* axis : {"family", "regime", "scale", "offset"}) faultsBy(axis);
    widerScale();
    if (m_kinds.size() > 1) byKinds();
    relations("violations per million", Tally::wrong);
    relations("of equal truth, other bits per million", Tally::tie);
    m_out << "\n";
    return static_cast<int>(
        std::count_if(m_faults.begin(), m_faults.end(), [](const auto& m) { return m.second > 0; }));
  }

 private:
  struct OfKinds {
    LedgerEntry entry;
    long faults;
  };

  void verdicts() {
    m_out << fmt::format("\n  {:<{}}", "method", m_width);
    for (const char* head : {"asked", "agree", "tie", "wrong", "side", "undecided", "refused", "not_finite", "threw",
                             "crashed", "hung", "capped", "max error", "median", "ns"}) {
      if (m_pairQueries && std::string_view(head) == "max error") m_out << fmt::format("{:>11}", "no value");
      m_out << fmt::format("{:>11}", head);
    }
    m_out << "\n";
    for (const auto& [name, e] : m_methods) {
      m_out << fmt::format("  {:<{}}", name, m_width);
      for (const Tally t : {Tally::asked, Tally::agree, Tally::tie, Tally::wrong, Tally::wrongSide, Tally::undecided,
                            Tally::refused, Tally::notFinite, Tally::threw, Tally::crashed, Tally::hung, Tally::capped})
        m_out << fmt::format("{:>11}", e[t]);
      if (m_pairQueries) m_out << fmt::format("{:>11}", withoutValue(e));
      m_out << fmt::format("{:>11.1e}{:>11}{:>11}{}\n", e.maxError, medianOf(e), nanosecondsOf(e),
                           remark(e, m_faults.at(name)));
    }
  }

  // The share of wrong and missing answers in per cent, by method and value of the axis.
  void faultsBy(const std::string& axis) {
    const auto found = m_axes.find(axis);
    if (found == m_axes.end()) return;
    m_out << fmt::format("\n  faults, %, by {:<{}}", axis, kMethodWidth);
    const auto width = [](const std::string& name) { return std::max(kMethodWidth, name.size() + 2); };
    for (const auto& [name, e] : m_methods) m_out << fmt::format("{:>{}}", name, width(name));
    m_out << "\n";
    for (const auto& [value, entries] : found->second) {
      m_out << fmt::format("  {:<{}}", value, kMethodWidth + 14);
      for (const auto& [name, e] : m_methods) {
        const auto at = entries.find(name);
        std::string text = "-";
        if (at != entries.end()) {
          const double faults = static_cast<double>(at->second.faults());
          text = faults > 0 ? fmt::format("{:.3g}", 100 * faults / static_cast<double>(at->second[Tally::asked])) : "0";
        }
        m_out << fmt::format("{:>{}}", text, width(name));
      }
      m_out << "\n";
    }
  }

  // For pair queries: the scale of the error is that of extents and distance, or also that of coordinates in frames.
  void widerScale() {
    if (!m_pairQueries) return;
    m_out << "\n  right only by the scale with frames' coordinates:";
    const auto found = m_axes.find(kWiderScale);
    for (const auto& [name, e] : m_methods) {
      const bool any = found != m_axes.end() && found->second.begin()->second.contains(name);
      m_out << fmt::format(" {} {}", name, any ? found->second.begin()->second.at(name)[Tally::asked] : 0);
    }
    m_out << "\n";
  }

  void byKinds() {
    m_out << fmt::format("\n  {:<20}{:<{}}", "shapes", "method", m_width);
    for (const char* head : {"asked", "wrong", "side", "refused", "no answer", "max error", "median", "ns"}) {
      m_out << fmt::format("{:>11}", head);
    }
    m_out << "\n";
    for (const auto& [kinds, entries] : m_kinds) {
      for (const auto& [name, row] : entries) {
        const LedgerEntry& e = row.entry;
        m_out << fmt::format("  {:<20}{:<{}}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11.1e}{:>11}{:>11}{}\n",
                             kinds.first + " " + kinds.second, name, m_width, e[Tally::asked], e[Tally::wrong],
                             e[Tally::wrongSide], e[Tally::refused], withoutAnswer(e), e.maxError, medianOf(e),
                             nanosecondsOf(e), remark(e, row.faults));
      }
    }
  }

  // Each rate is followed by the number of compared pairs. Relations with rounding have no bits to compare.
  void relations(const std::string& what, Tally tally) {
    if (m_relations.empty()) return;
    m_out << fmt::format("\n  {}, of so many pairs\n  {:<{}}", what, "method", m_width);
    for (const std::string_view name : kRelationNames) m_out << fmt::format("{:>18}", name);
    m_out << fmt::format("{:>11}{:>11}\n", "undecided", "no answer");
    for (const auto& [name, entries] : m_relations) {
      m_out << fmt::format("  {:<{}}", name, m_width);
      LedgerEntry all;
      for (std::size_t r = 0; r < kRelations; ++r) {
        const auto at = entries.find(std::string(kRelationNames[r]));
        if (at == entries.end() || (tally == Tally::tie && !keepsTruth(static_cast<Relation>(r)))) {
          m_out << fmt::format("{:>18}", "-");
          continue;
        }
        const LedgerEntry& e = at->second;
        all.add(e);
        const long told = e[Tally::agree] + e[Tally::tie] + e[Tally::wrong];
        const double rate = told ? 1e6 * static_cast<double>(e[tally]) / static_cast<double>(told) : 0;
        m_out << fmt::format("{:>18}", fmt::format("{:.0f} of {}", rate, told));
      }
      m_out << fmt::format("{:>11}{:>11}{}\n", all[Tally::undecided], withoutAnswer(all) + all[Tally::refused],
                           tally == Tally::wrong ? remark(all, m_faults.at(name)) : "");
    }
  }

  std::ostream& m_out;
  bool m_pairQueries = false;
  std::size_t m_width = kMethodWidth;
  std::map<std::string, LedgerEntry> m_methods;  // sums over kinds
  std::map<std::string, long> m_faults;          // faults that make the run fail
  std::map<std::string, std::map<std::string, std::map<std::string, LedgerEntry>>> m_axes;  // axis, value, method
  std::map<std::pair<std::string, std::string>, std::map<std::string, OfKinds>> m_kinds;
  std::map<std::string, std::map<std::string, LedgerEntry>> m_relations;  // method, relation
};

}  // namespace

int printLedger(const Ledger& ledger, std::ostream& out) {
  std::set<Section> sections;
  for (const auto& [key, entry] : ledger) sections.emplace(key.stage, key.dimension, key.precision);
  int faults = 0;
  for (const Section& section : sections) faults += Printer(ledger, section, out).print();
  return faults;
}

}}  // namespace lpc::LPC_PRECISION
