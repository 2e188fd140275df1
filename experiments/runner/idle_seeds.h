// SPDX-License-Identifier: Zlib
// Warns of seeds without effect: the same run would be planned several times.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "experiments/runner/trial_plan.h"

namespace lpc { inline namespace LPC_PRECISION {

class IdleSeeds {
 public:
  /// A trial of a sweep; `choices` are the values of axes that may decide whether its scene draws random numbers.
  void saw(const PlannedTrial& trial, const nlohmann::json& choices);
  /// One sentence per scene with cells that differ only by a seed without effect.
  std::vector<std::string> notes() const;

 private:
  struct Cell {
    std::string scene;
    std::set<std::string> choices;  // "perturb=0"
    std::set<std::uint64_t> seeds;
    bool seeded = false;
  };
  std::map<std::string, Cell> m_cells;  // by the key of a trial without its seed and its repeat
};

}}  // namespace lpc::LPC_PRECISION
