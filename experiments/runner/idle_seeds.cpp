// SPDX-License-Identifier: Zlib
#include "experiments/runner/idle_seeds.h"

namespace lpc { inline namespace LPC_PRECISION {

using nlohmann::json;

void IdleSeeds::saw(const PlannedTrial& trial, const json& choices) {
  json rest = trial.canonical;
  for (const char* name : {"seed", "repeat", "timed"}) rest.erase(name);
  Cell& cell = m_cells[trialKey(rest)];
  cell.scene = trial.world().scene;
  for (const auto& [name, value] : choices.items()) {
    cell.choices.insert(name + "=" + (value.is_string() ? value.get<std::string>() : value.dump()));
  }
  cell.seeds.insert(trial.asked().seed);
  cell.seeded = cell.seeded || trial.seeded;
}

std::vector<std::string> IdleSeeds::notes() const {
  struct Scene {
    bool idle = false, drawn = false;
    std::set<std::string> whereIdle, whereDrawn;
  };
  std::map<std::string, Scene> scenes;
  for (const auto& [key, cell] : m_cells) {
    if (cell.seeds.size() < 2) continue;
    Scene& scene = scenes[cell.scene];
    (cell.seeded ? scene.drawn : scene.idle) = true;
    (cell.seeded ? scene.whereDrawn : scene.whereIdle).insert(cell.choices.begin(), cell.choices.end());
  }
  std::vector<std::string> out;
  for (const auto& [name, scene] : scenes) {
    if (!scene.idle) continue;
    std::string where;  // cells without an effect of the seed
    for (const std::string& choice : scene.whereIdle) {
      if (scene.drawn && !scene.whereDrawn.count(choice)) where += (where.empty() ? " where " : " or ") + choice;
    }
    if (scene.drawn && where.empty()) where = " in some cells";
    out.push_back("the seed decides nothing in scene '" + name + "'" + where + ": set its parameter '" +
                  kPerturbParameter + "', such as 1e-6 (m and rad)");
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
