// SPDX-License-Identifier: Zlib
// Seeds that decide nothing: whoever plans the same run several times should hear of it.
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
  /// A trial of a sweep; `choices` are the values of its axes that may decide whether its scene draws.
  void saw(const PlannedTrial& trial, const nlohmann::json& choices);
  /// One sentence per scene with cells that differ by nothing but an idle seed.
  std::vector<std::string> notes() const;

 private:
  struct Cell {
    std::string scene;
    std::set<std::string> choices;  // "perturb=0"
    std::set<std::uint64_t> seeds;
    bool seeded = false;
  };
  std::map<std::string, Cell> m_cells;  // by the key that a trial has without its seed and its repeat
};

}}  // namespace lpc::LPC_PRECISION
