// SPDX-License-Identifier: Zlib
// The typed request of a trial for a worker. Only request.cpp knows the JSON of a trial's key and of a request.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {

struct TrialBase {
  int dimension = 2;
  std::string precision = "f64";
  std::uint64_t seed = 1;
  int repeat = 0;
  bool timed = false;
};

struct WorldRequest : TrialBase {
  static constexpr const char* kKind = "world";
  std::string scene, script;  // names, without paths; the second is empty if there is none
  ParameterValues params;
  std::string pipeline;  // stages, or "engine=NAME{...}"
  bool ofEngine() const { return pipeline.starts_with("engine="); }
  double dt = 0;  // s
  long steps = 0;
  std::string features;   // "cache,friction"
  double posesEvery = 0;  // s; 0: every 60 steps
  bool series = true;     // whether to keep one value per step
};

struct BoxesRequest : TrialBase {
  static constexpr const char* kKind = "boxes";
  int n = 0, frames = 60;
  std::string distribution, broadphase;  // specs
};

/// Drawn pairs of two kinds.
struct PairsRequest : TrialBase {
  static constexpr const char* kKind = "pairs";
  std::string pairQuery;  // spec
  std::string drawing = "in_turn";
  std::string kindA, kindB;
  int n = 0;
  int vertices = 0;  // of hulls; 0: those of twelve points
};

/// The pairs that a world queries.
struct StreamRequest : TrialBase {
  static constexpr const char* kKind = "pairs";
  std::string pairQuery, drawing;  // specs
  std::string stream;              // cold, warm or drawn
  ParameterValues params;
  long from = 0, steps = 60;
};

struct ProblemRequest : TrialBase {
  static constexpr const char* kKind = "problems";
  std::string velocity;  // spec
  std::size_t problem = 0;
  int iterations = 50;
  bool cold = false, coloured = false, friction = true;
};

/// A world to be saved as a scene after this number of steps.
struct SaveRequest {
  long step = 0;
  std::string scene;  // path
};

struct TrialRequest {
  std::variant<WorldRequest, BoxesRequest, PairsRequest, StreamRequest, ProblemRequest> trial;
  std::string sceneFile = {};   // path of the scene or the problems; empty: none
  std::string scriptFile = {};  // path; empty: none
  std::vector<std::string> plugins = {};
  std::string profile = {}, record = {}, trajectory = {};  // output paths; empty: none
  std::vector<SaveRequest> saves = {};
  bool memory = false;    // whether allocations are counted
  bool progress = false;  // whether it is printed on standard error

  const TrialBase& base() const;
  TrialBase& base();
  bool ofEngine() const;
  /// Precondition: the trial is one of a world.
  const WorldRequest& world() const { return std::get<WorldRequest>(trial); }
  WorldRequest& world() { return std::get<WorldRequest>(trial); }
};

nlohmann::json toJson(const TrialRequest& request);
/// Throws UserError for an unknown kind of trial.
TrialRequest requestFromJson(const nlohmann::json& json);

/// The part of a world in the document of a trial's key.
nlohmann::json toJson(const WorldRequest& world);
/// The trial of a key's document, of any kind.
decltype(TrialRequest::trial) trialFromJson(const nlohmann::json& document);

}}  // namespace lpc::LPC_PRECISION
