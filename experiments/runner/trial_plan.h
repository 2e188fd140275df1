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

/// One trial before it runs: what its key is made of, and what the worker needs beside it.
struct PlannedTrial {
  nlohmann::json axes;       // this cell's values as the sweep writes them
  nlohmann::json canonical;  // what the key is made of
  std::string key;
  TrialRequest request;     // what a worker is asked for
  std::string unsupported;  // a reason when the cell cannot run at all
  bool seeded = true;       // another seed is another trial; not so where a scene draws nothing

  const TrialBase& asked() const { return request.base(); }
  const WorldRequest& world() const { return request.world(); }
  bool timed() const { return asked().timed; }
  void setRepeat(int repeat);
  void setSeed(std::uint64_t seed);
  /// Writes something that no worker is told into the key: another trial, with another row in a store.
  void mark(const char* name, nlohmann::json value);
};

/// A world trial as asked for; what is left out comes from the scene.
struct WorldCell {
  ParameterValues params;
  std::string script;            // name or path; empty: none
  std::optional<int> dimension;  // none: the scene's first
  std::string pipeline;
  std::string precision = "f64";
  std::optional<double> dt;
  std::optional<long> steps;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> features;  // "cache,friction"; none: what the scene needs
  int repeat = 0;
  bool timed = false;
  std::optional<double> posesEvery;  // s; none: every 60 steps
  bool series = true;                // one value per step is kept
};

/// Scene files are read once, and scenes are built once per set of parameters: to find mistakes before anything runs.
class Planner {
 public:
  const SceneFile& scene(const std::string& nameOrPath, const std::string& script = "");
  /// Throws UserError for mistakes; a cell that is right but cannot run (an algorithm that exists only in the other
  /// dimension) gets `unsupported`.
  PlannedTrial world(const std::string& scene, const WorldCell& cell);
  PlannedTrial boxes(nlohmann::json cell);
  /// Drawn pairs of two kinds or, with the axis `scene`, those of a stream that a world asks about.
  PlannedTrial pairs(nlohmann::json cell);
  /// A velocity resolver on a problem of a file; the dimension is the file's.
  PlannedTrial problems(nlohmann::json cell);

 private:
  PlannedTrial streamOfPairs(nlohmann::json cell);
  struct Defaults {
    double dt;
    long steps;
    std::set<std::pair<StageKind, std::string>> kinds;  // of joints and forces, with their parameters
    bool seeded = true;
  };
  /// nullptr, and `unsupported` says why, where the kind of joint that the parameters choose does not fit.
  const Defaults* built(const SceneFile& file, const ParameterValues& params, std::uint64_t seed, int dimension,
                        std::string& unsupported);
  std::map<std::pair<std::string, std::string>, SceneFile> m_scenes;  // by names of scene and script
  std::map<std::string, Defaults> m_built;
  std::map<std::string, std::pair<std::string, ProblemFile>> m_problems;  // with the hash of the bytes
};

/// Whether a sweep of a kind without a world has such an axis.
bool isFrozenAxis(const std::string& kind, const std::string& axis);

/// The whole number that an axis holds. Throws UserError when it holds something else or is out of range.
long wholeNumber(const nlohmann::json& axes, const std::string& name, long lo, long hi);

/// The key of a canonical trial.
std::string trialKey(const nlohmann::json& canonical);

}}  // namespace lpc::LPC_PRECISION
