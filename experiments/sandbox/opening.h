// SPDX-License-Identifier: Zlib
// What the sandbox shall show: a scene with its parameters, and the pipelines of its competitors.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {

struct Opening {
  std::string scene, script;  // paths; empty: no script
  ParameterValues parameters;
  std::optional<std::uint64_t> seed;
  int dimension = 2;
  std::vector<std::string> pipelines = {""};  // the first is the reference of the others
  std::optional<double> dt;
  std::optional<std::string> features;
  long steps = 0;   // made before it is shown, and then paused
  std::string say;  // the window's first message
  // Options of the command line, for the whole session.
  std::string profile;  // CSV of all steps, written at the end; empty: none
  bool plots = false;
  std::string input;  // a script of keys and mouse; empty: the user's
  std::vector<std::string> plugins;
};

Opening openingFromJson(const nlohmann::json& json);

/// Throws UserError with file and line. Skips parameters that this scene does not have.
template <int D>
SceneSpec<D> specOf(const SceneFile& file, const Opening& opening);

/// The command that runs it without a window, as the first competitor does, with that script.
std::string runOf(const Opening& opening, const SceneFile& file, const std::string& script);

}}  // namespace lpc::LPC_PRECISION
