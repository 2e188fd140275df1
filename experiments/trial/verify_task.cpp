// SPDX-License-Identifier: Zlib
#include "experiments/trial/verify_task.h"

#include <nlohmann/json.hpp>

#include "experiments/trial/formats/ledger_json.h"
#include "experiments/trial/plugin.h"
#include "framework/math/check.h"
#include "oracles/verify/case_run.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <class Names>
int indexOf(const Names& names, const std::string& name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<int>(i);
  }
  throw UserError("verify: unknown name '" + name + "'");
}

void loadPlugins(const nlohmann::json& request) {
  for (const auto& path : request.value("plugins", std::vector<std::string>{})) loadPlugin(path);
}

}  // namespace

nlohmann::json runCasesTask(const nlohmann::json& request) {
  loadPlugins(request);
  const nlohmann::json& t = request.at("cases");
  const std::vector<Case> cases = readCases(t.at("file"), BrokenCases::kept);
  std::vector<CaseResult> rows;
  for (const auto& [number, method] : t.at("questions").get<std::vector<std::pair<std::size_t, std::string>>>()) {
    const Case& c = cases.at(number);
    if (method.empty()) {
      const std::vector<CaseResult> all = runCases({c});
      rows.insert(rows.end(), all.begin(), all.end());
    } else if (c.mistake.empty() || rows.empty() || rows.back().id != c.id) {  // one row of an unread case
      rows.push_back(askFound(c, method));
    }
  }
  return caseRowsToJson(rows);
}

nlohmann::json runVerifyTask(const nlohmann::json& request) {
  loadPlugins(request);
  const nlohmann::json& t = request.at("verify");
  const StageInfo* stage = stageByName(t.at("stage").get<std::string>());
  if (!stage) throw UserError("verify: unknown stage " + t.at("stage").dump());
  VerifyTask task{.stage = stage->kind,
                  .dimension = t.at("dimension"),
                  .range = {.seed = t.at("seed"), .first = t.at("first"), .count = t.at("count")},
                  .methods = t.at("methods"),
                  .relations = t.value("relations", false)};
  if (t.contains("kind_a")) {
    task.kindA = shapeKindFromName(t.at("kind_a").get<std::string>());
    task.kindB = shapeKindFromName(t.at("kind_b").get<std::string>());
  }
  if (t.contains("ended")) task.range.ended = static_cast<Tally>(indexOf(kTallyNames, t.at("ended")));
  return toJson(verify(task));
}

}}  // namespace lpc::LPC_PRECISION
