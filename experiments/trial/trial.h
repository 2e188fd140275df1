// SPDX-License-Identifier: Zlib
// A trial is one cell of a sweep. It runs in a process of its own, which reads its request and writes its result as
// JSON.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "experiments/trial/request.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Memory of a scope of the profiler over all steps, without nested scopes.
struct ScopeMemory {
  std::string scope;
  MemoryUse use;
  long lastStep = -1;  // the last step in which it allocated, from 1; 0: before the first, -1: never
};

struct TrialResult {
  std::string outcome = "ok";  // or diverged, exploded, left, collapsed, sank, frozen, wrong, unsupported
  std::string reason;
  long step = -1;  // of the outcome
  std::string hash;
  std::map<std::string, double> metrics;  // NaN: undefined for this trial
  std::map<std::string, std::vector<double>> series;
  std::map<long, std::vector<double>> poses;
  std::vector<ScopeMemory> memory;  // if requested; all scopes together are the world's memory

  void fail(std::string what, std::string why, long at) {
    outcome = std::move(what), reason = std::move(why), step = at;
  }
};

/// Throws UserError for invalid requests.
TrialResult runTrial(const TrialRequest& request);

TrialResult runWorldTrial(const TrialRequest& request);
TrialResult runBoxesTrial(const BoxesRequest& asked);
TrialResult runPairsTrial(const PairsRequest& asked);
TrialResult runStreamTrial(const StreamRequest& asked, const std::string& sceneFile);
TrialResult runProblemsTrial(const ProblemRequest& asked, const std::string& problemFile);

nlohmann::json toJson(const TrialResult& result);
TrialResult resultFromJson(const nlohmann::json& json);

/// Processor time of this thread (s); other processes do not count.
double cpuSeconds();

}}  // namespace lpc::LPC_PRECISION
