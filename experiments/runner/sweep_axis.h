// SPDX-License-Identifier: Zlib
// An axis of a sweep as its file writes it, with the stars that stand for whoever is registered, so that a new file
// joins a sweep by itself. Where a method's name stands, in a list or in a pipeline,
//   *            is every competitor of that stage, and every engine where the stage is theirs
//   *witness     every witness
//   *-naive-sat  the same but for these, which the sweep treats otherwise or leaves out
// and `*{iterations=4}` gives the parameter to those that have one of that name, `*{effort=4}` to those that have an
// effort, whatever its name is.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/parse/toml_reader.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Who has written a value: the sweep's file, or the command line.
enum class WrittenBy { file, with, set };

/// One value of an axis: what the sweep calls it, and what it means.
struct AxisValue {
  nlohmann::json label;              // a number or text, as written
  std::string pipeline;              // of a labelled text: a part of a pipeline
  std::string written;               // the same as the file has it, with parameters that not everyone has
  const toml::node* node = nullptr;  // where; of one that was given on the command line, its axis
  WrittenBy by = WrittenBy::file;
};
struct Axis {
  std::string name;
  std::vector<AxisValue> values;
  bool labelled = false;
  const toml::node* node = nullptr;  // where
};

/// Values of the axis `seed`; empty where there is none.
std::vector<nlohmann::json> seedsOf(const std::vector<Axis>& axes);

/// What a store keeps of a sweep beside its axes (`roles` of the table `sweep`): no axis may have such a name.
inline constexpr std::array<std::string_view, 5> kNoAxes = {"break", "calibrate", "commands", "report",
                                                            "settings_told"};

/// A number, a text, a list of these, or a table of labelled parts of pipelines. A label whose text has stars says with
/// `$velocity` where the name goes that `velocity=*` became. Throws UserError with file and line.
Axis readAxis(const std::string& file, const std::string& name, const toml::node& node);

/// "AXIS=VALUE" as the command line has it, a number or a text. Throws UserError for what is no such text, and for a
/// star, which is many values.
struct SetAxis {
  explicit SetAxis(const std::string& given);
  std::string given, axis;
  nlohmann::json value;
};

/// A value of an axis as a text of a pipeline has it.
std::string valueText(const nlohmann::json& label);
/// Replaces each $name by the value of that axis, in one pass: what a value holds is not looked at again. Tells in
/// `used` which were. Throws UserError for a `$` that names no axis or stands in such a value.
std::string withValues(const std::string& text, const nlohmann::json& axes, std::set<std::string>& used);
/// The axes that a text names so.
std::set<std::string> namedIn(const std::string& text, const nlohmann::json& axes);

/// One more method, "LABEL=PIPELINE" as the command line has it, joins the labelled axis. Not where none is, or where
/// the text uses a `$name` that neither an axis nor `searched`, the setting that is calibrated, has. Throws UserError
/// for what is no such text, and for a label that is taken.
bool addMethod(const std::string& given, const std::string& searched, std::vector<Axis>& axes);

/// What plans one sweep again: of `only`, `with` and `set` what it takes, since it would refuse what is another's of
/// its set.
std::vector<std::string> commandOf(const std::string& name, const std::set<std::string>& only,
                                   const std::set<std::string>& used, const std::vector<std::string>& with,
                                   const std::vector<std::string>& set);

}}  // namespace lpc::LPC_PRECISION
