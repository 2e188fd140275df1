// SPDX-License-Identifier: Zlib
// Translates the values of axes into a trial.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "experiments/runner/trial_plan.h"
#include "framework/stage/spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Path of a file that a sweep file names: a file beside the sweep precedes one in experiments/.
std::string beside(const std::string& sweep, const std::string& given, const char* ending = ".toml");

/// The files of a sweep's scenes and scripts. Results contain names only: two files with one name would pass for
/// repeats of one run.
class AxisFiles {
 public:
  /// Throws UserError if there was another file of that name.
  void add(const SceneFile& scene, bool scriptIsAnAxis);

 private:
  void add(const std::string& axis, const std::string& name, const std::string& path);
  std::map<std::pair<std::string, std::string>, std::string> m_paths;
};

/// Collects the algorithms that a text names.
void collectNames(const Spec& spec, std::set<std::string>& out);

/// The pipeline of a cell: that of the sweep, with stages replaced by parts from axes.
class CellPipeline {
 public:
  /// `used` gets the axes that the text names.
  CellPipeline(const std::string& text, const nlohmann::json& axes, std::set<std::string>& used);
  /// `names` gets the algorithms.
  void put(const std::string& part, std::set<std::string>& names, std::set<std::string>& used);
  std::string finish(std::set<std::string>& names) const;
  /// The axes with values in the pipeline: a text that names them may be replaced.
  std::set<std::string> named() const;

 private:
  const std::string& m_text;
  const nlohmann::json& m_axes;
  std::optional<Spec> m_engine;  // of the last part that names one: it replaces all stages
  Pipeline m_stages;
  std::set<StageKind> m_replaced;
  std::set<std::string> m_ofEngine, m_ofParts;
};

/// Reads a world trial's dimension, precision, dt, steps and seed, and its scene's parameters. `used` are the axes with
/// a known meaning. Sets the role of each axis, and returns the model. Throws UserError for an axis without a meaning.
std::string readWorldAxes(const SceneFile& file, const nlohmann::json& axes, const std::set<std::string>& used,
                          WorldCell& cell, std::map<std::string, std::string>& roles);

/// For boxes, pairs and problems: the axes are the trial.
PlannedTrial frozenTrial(Planner& planner, const std::string& kind, const nlohmann::json& axes, bool timed,
                         std::map<std::string, std::string>& roles, std::set<std::string>& names);

}}  // namespace lpc::LPC_PRECISION
