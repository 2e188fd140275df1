// SPDX-License-Identifier: Zlib
#include "experiments/trial/trial.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>

#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {

using nlohmann::json;

json toJson(const TrialResult& r) {
  json poses = json::array();
  for (const auto& [step, data] : r.poses) poses.push_back({{"step", step}, {"data", data}});
  json out = {{"outcome", r.outcome}, {"reason", oneLine(r.reason)}, {"step", r.step}, {"hash", r.hash},
              {"metrics", r.metrics}, {"series", r.series},          {"poses", poses}};
  for (const ScopeMemory& m : r.memory) {
    out["memory"].push_back({{"scope", m.scope},
                             {"held", m.use.held},
                             {"allocated", m.use.allocated},
                             {"allocations", m.use.allocations},
                             {"last_step", m.lastStep}});
  }
  return out;
}

TrialResult resultFromJson(const json& j) {
  const auto number = [](const json& x) {
    return x.is_null() ? std::numeric_limits<double>::quiet_NaN() : x.get<double>();
  };
  const auto numbers = [&](const json& list) {
    std::vector<double> out;
    for (const json& x : list) out.push_back(number(x));
    return out;
  };
  TrialResult r;
  r.outcome = j.at("outcome"), r.reason = j.at("reason"), r.step = j.at("step"), r.hash = j.at("hash");
  for (const auto& [name, value] : j.at("metrics").items()) r.metrics[name] = number(value);
  for (const auto& [name, list] : j.at("series").items()) r.series[name] = numbers(list);
  for (const json& p : j.at("poses")) r.poses[p.at("step").get<long>()] = numbers(p.at("data"));
  for (const json& m : j.value("memory", json::array())) {
    r.memory.push_back({m.at("scope"), {m.at("allocations"), m.at("allocated"), m.at("held")}, m.at("last_step")});
  }
  return r;
}

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}}  // namespace lpc::LPC_PRECISION
