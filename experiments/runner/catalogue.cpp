// SPDX-License-Identifier: Zlib
#include "experiments/runner/catalogue.h"

#include <algorithm>
#include <array>
#include <set>

#include "experiments/runner/code_identity.h"
#include "experiments/trial/measure/metric.h"
#include "framework/math/check.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {

using nlohmann::json;

namespace {

// Two numbers, integers for an integer parameter; null if it has no range.
json rangeOf(const ParamInfo& p) {
  if (!p.range) return nullptr;
  if (p.type != "integer") return {p.range->lo, p.range->hi};
  return {static_cast<long>(p.range->lo), static_cast<long>(p.range->hi)};
}

std::string_view roleName(ParamRole role) {
  constexpr std::array<std::string_view, 3> kNames = {"manner", "effort", "tolerance"};
  return kNames[static_cast<std::size_t>(role)];
}

const char* guaranteeName(Guarantee g) {
  return g == Guarantee::exact ? "exact" : (g == Guarantee::conservative ? "conservative" : "approximate");
}

// Whether it is a library in float, whatever the precision of the query.
bool isInFloat(const Registered& entry) {
  if (entry.stage != StageKind::pairQuery || entry.info.role != AlgorithmRole::witness || isOfPlugin(entry))
    return false;
  const auto made = entry.create(Spec{entry.info.name, {}});
  const auto* flat = dynamic_cast<const Witness<2>*>(made.get());
  const auto* solid = dynamic_cast<const Witness<3>*>(made.get());
  return (flat && flat->computesInFloat()) || (solid && solid->computesInFloat());
}

}  // namespace

std::string_view roleName(AlgorithmRole role) {
  constexpr std::array<std::string_view, 4> kNames = {"competitor", "witness", "referee", "engine"};
  return kNames[static_cast<std::size_t>(role)];
}

json describeParams(const std::vector<ParamInfo>& params) {
  json out = json::array();
  for (const ParamInfo& p : params) {
    out.push_back({{"name", p.name},
                   {"type", p.type},
                   {"role", roleName(p.role)},
                   {"unit", p.unit},
                   {"meaning", p.meaning},
                   {"default", p.defaultText},
                   {"range", rangeOf(p)},
                   {"choices", p.choices}});
  }
  return out;
}

/// The declared failures of a method, each with its dimensions.
void declare(json& failures, const Registered& entry) {
  for (const FailureMode& f : entry.info.failures) {
    const auto same = [&](const json& known) { return known["when"] == f.when && known["test"] == f.test; };
    const auto known = std::find_if(failures.begin(), failures.end(), same);
    if (known == failures.end()) {
      failures.push_back(
          {{"when", f.when}, {"symptom", f.symptom}, {"test", f.test}, {"dimensions", {entry.dimension}}});
    } else {
      (*known)["dimensions"].push_back(entry.dimension);
    }
  }
}

/// The parameters of a method in this dimension.
void addParams(json& params, const Registered& entry) {
  for (json& p : describeParams(entry.params)) {
    const auto same = [&](const json& known) { return known["name"] == p["name"]; };
    if (std::none_of(params.begin(), params.end(), same)) params.push_back(std::move(p));
  }
}

json describeAlgorithms() {
  json out = json::array();
  for (const auto& [key, entry] : Registry::instance().all()) {
    const std::string stage{stageName(entry.stage)};
    json* known = nullptr;
    for (json& a : out) {
      if (a["stage"] == stage && a["name"] == entry.info.name) known = &a;
    }
    if (known) {
      (*known)["dimensions"].push_back(entry.dimension);
      declare((*known)["failures"], entry);
      addParams((*known)["params"], entry);
      continue;
    }
    json failures = json::array();
    declare(failures, entry);
    json otherFriction = json::object();
    for (const FrictionChoice& other : entry.info.otherFriction) {
      otherFriction[other.parameter + '=' + other.choice] = frictionLawName(other.law);
    }
    out.push_back({{"stage", stage},
                   {"group", stageInfo(entry.stage).group},
                   {"name", entry.info.name},
                   {"summary", entry.info.summary},
                   {"paper", entry.info.paper},
                   {"complexity", entry.info.complexity},
                   {"guarantee", guaranteeName(entry.info.guarantee)},
                   {"friction", frictionLawName(entry.info.friction)},
                   {"other_friction", otherFriction},
                   {"role", roleName(entry.info.role)},
                   {"no_effort", entry.info.noEffort},
                   {"in_float", isInFloat(entry)},
                   {"dimensions", {entry.dimension}},
                   {"params", describeParams(entry.params)},
                   {"failures", failures}});
  }
  return out;
}

json describeMeasures() {
  json out = json::array();
  for (const DescribedMetric& m : describeMetrics()) {
    out.push_back({{"what", m.what},
                   {"kind", m.kind},
                   {"name", m.info.name},
                   {"title", m.info.title},
                   {"unit", m.info.unit},
                   {"meaning", m.info.meaning},
                   {"role", roleName(m.info.role)},
                   {"smaller", m.info.smaller},
                   {"needs", needName(m.info.need)}});
  }
  return out;
}

void describeProgram(Store& store) {
  store.setMeta("registry", json{{"algorithms", describeAlgorithms()}}.dump());
  store.describe(describeMetrics());
}

std::string withNames(const std::string& page) {
  const std::string begin = "<!-- registry -->\n", end = "<!-- end -->";
  const std::size_t from = page.find(begin), to = page.find(end, from == page.npos ? from : from + begin.size());
  if (to == page.npos)
    throw UserError("the lines <!-- registry --> and <!-- end --> are missing, between which the names are written");
  std::string table = "| stage | names |\n| --- | --- |\n";
  for (const StageInfo& stage : kStages) {
    std::set<std::string> names;
    for (const auto& [key, entry] : Registry::instance().all()) {
      const bool listed = entry.info.role == AlgorithmRole::competitor || entry.info.role == AlgorithmRole::engine;
      if (entry.stage == stage.kind && listed) names.insert(entry.info.name);
    }
    table += "| " + std::string(stage.name) + " | ";
    for (const std::string& name : names) table += (name == *names.begin() ? "" : ", ") + name;
    table += " |\n";
  }
  return page.substr(0, from + begin.size()) + table + page.substr(to);
}

}}  // namespace lpc::LPC_PRECISION
