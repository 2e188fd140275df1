// SPDX-License-Identifier: Zlib
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/trial/formats/problem_file.h"
#include "experiments/trial/request.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// One trial before it runs: the content of its key, and the worker's other input.
struct PlannedTrial {
  nlohmann::json axes;       // this cell's values as written in the sweep
  nlohmann::json canonical;  // the content of the key
  std::string key;
  TrialRequest request;     // the request for a worker
  std::string unsupported;  // the reason if the cell cannot run at all
  bool seeded = true;       // whether another seed is another trial; false if a scene draws nothing

  const TrialBase& asked() const { return request.base(); }
  const WorldRequest& world() const { return request.world(); }
  bool timed() const { return asked().timed; }
  void setRepeat(int repeat);
  void setSeed(std::uint64_t seed);
  /// Adds a value to the key that the worker does not see: another trial, with another row in a store.
  void mark(const char* name, nlohmann::json value);
};

/// A requested world trial; the scene supplies omitted values.
struct WorldCell {
  ParameterValues params;
  std::string script;            // name or path; empty: none
  std::optional<int> dimension;  // none: the scene's first
  std::string pipeline;
  std::string precision = "f64";
  std::optional<double> dt;
  std::optional<long> steps;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> features;  // "cache,friction"; none: the scene's needs
  int repeat = 0;
  bool timed = false;
  std::optional<double> posesEvery;  // s; none: every 60 steps
  bool series = true;                // whether to keep one value per step
};

/// Reads scene files once, and builds scenes once per set of parameters, to find mistakes before anything runs.
class Planner {
 public:
  const SceneFile& scene(const std::string& nameOrPath, const std::string& script = "");
  /// Throws UserError for mistakes; a valid cell that cannot run (an algorithm that exists only in the other dimension)
  /// gets `unsupported`.
  PlannedTrial world(const std::string& scene, const WorldCell& cell);
  PlannedTrial boxes(nlohmann::json cell);
  /// Drawn pairs of two kinds, or with the axis `scene` those recorded from a world.
  PlannedTrial pairs(nlohmann::json cell);
  /// A velocity resolver on a problem of a file, which sets the dimension.
  PlannedTrial problems(nlohmann::json cell);

 private:
  PlannedTrial streamOfPairs(nlohmann::json cell);
  struct Defaults {
    double dt;
    long steps;
    std::set<std::pair<StageKind, std::string>> kinds;  // of joints and forces, with their parameters
    bool seeded = true;
  };
  /// nullptr, with the reason in `unsupported`, if the kind of joint in the parameters does not fit.
  const Defaults* built(const SceneFile& file, const ParameterValues& params, std::uint64_t seed, int dimension,
                        std::string& unsupported);
  std::map<std::pair<std::string, std::string>, SceneFile> m_scenes;  // by names of scene and script
  std::map<std::string, Defaults> m_built;
  std::map<std::string, std::pair<std::string, ProblemFile>> m_problems;  // with the hash of the bytes
};

/// Whether a sweep of a kind without a world has such an axis.
bool isFrozenAxis(const std::string& kind, const std::string& axis);

/// The integer of an axis. Throws UserError if it is not an integer or out of range.
long wholeNumber(const nlohmann::json& axes, const std::string& name, long lo, long hi);

/// The key of a canonical trial.
std::string trialKey(const nlohmann::json& canonical);

}}  // namespace lpc::LPC_PRECISION
