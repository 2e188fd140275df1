// SPDX-License-Identifier: Zlib
// What the values of axes mean to a trial.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "experiments/runner/trial_plan.h"
#include "framework/stage/spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Where a file is that a sweep file names: one that lies beside it comes before those in experiments/.
std::string beside(const std::string& sweep, const std::string& given, const char* ending = ".toml");

/// The files of a sweep's scenes and scripts. Results have their names alone: those of two files of one name would be
/// taken for repeats of one run.
class AxisFiles {
 public:
  /// Throws UserError when another file of that name was there.
  void add(const SceneFile& scene, bool scriptIsAnAxis);

 private:
  void add(const std::string& axis, const std::string& name, const std::string& path);
  std::map<std::pair<std::string, std::string>, std::string> m_paths;
};

/// The algorithms that a text names.
void collectNames(const Spec& spec, std::set<std::string>& out);

/// The pipeline of a cell: that of the sweep, with the parts that axes put in place of its stages.
class CellPipeline {
 public:
  /// `used` gets the axes that the text names.
  CellPipeline(const std::string& text, const nlohmann::json& axes, std::set<std::string>& used);
  /// `names` gets the algorithms.
  void put(const std::string& part, std::set<std::string>& names, std::set<std::string>& used);
  std::string finish(std::set<std::string>& names) const;
  /// The axes whose values it has: what names them may be replaced.
  std::set<std::string> named() const;

 private:
  const std::string& m_text;
  const nlohmann::json& m_axes;
  std::optional<Spec> m_engine;  // of the last part that names one: it stands in place of all stages
  Pipeline m_stages;
  std::set<StageKind> m_replaced;
  std::set<std::string> m_ofEngine, m_ofParts;
};

/// Of a trial of a world: its dimension, precision, dt, steps and seed, and its scene's parameters. `used` are the axes
/// that mean something already. Tells each axis its role, and returns the model. Throws UserError for an axis that
/// means nothing.
std::string readWorldAxes(const SceneFile& file, const nlohmann::json& axes, const std::set<std::string>& used,
                          WorldCell& cell, std::map<std::string, std::string>& roles);

/// Of boxes, pairs and problems: the axes are the trial.
PlannedTrial frozenTrial(Planner& planner, const std::string& kind, const nlohmann::json& axes, bool timed,
                         std::map<std::string, std::string>& roles, std::set<std::string>& names);

}}  // namespace lpc::LPC_PRECISION
