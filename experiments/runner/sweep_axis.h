// SPDX-License-Identifier: Zlib
// An axis of a sweep as written in its file. Stars stand for registered methods, so that a new method joins a sweep
// without an edit. In place of a method's name, in a list or in a pipeline,
// *            is every competitor of that stage, and every engine if the stage is `engine`
// *witness     every witness
// *-naive-sat  the same without these, which the sweep treats separately or omits
// and `*{iterations=4}` sets the parameter where a method has one of that name, `*{effort=4}` where a method has an
// effort, whatever its name.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/parse/toml_reader.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Origin of a value: the sweep's file, or the command line.
enum class WrittenBy { file, with, set };

/// One value of an axis: its label, and its meaning.
struct AxisValue {
  nlohmann::json label;              // a number or text, as written
  std::string pipeline;              // for a labelled text: a part of a pipeline
  std::string written;               // the same as written in the file, with parameters that not every method has
  const toml::node* node = nullptr;  // its position; if given on the command line, that of its axis
  WrittenBy by = WrittenBy::file;
};
struct Axis {
  std::string name;
  std::vector<AxisValue> values;
  bool labelled = false;
  const toml::node* node = nullptr;  // its position
};

/// Values of the axis `seed`; empty if there is none.
std::vector<nlohmann::json> seedsOf(const std::vector<Axis>& axes);

/// Keys that a store keeps besides the axes of a sweep (`roles` of the table `sweep`): no axis may have such a name.
inline constexpr std::array<std::string_view, 5> kNoAxes = {"break", "calibrate", "commands", "report",
                                                            "settings_told"};

/// A number, a text, a list of these, or a table of labelled parts of pipelines. In a label of a text with stars,
/// `$velocity` stands for the replacement of `velocity=*`. Throws UserError with file and line.
Axis readAxis(const std::string& file, const std::string& name, const toml::node& node);

/// "AXIS=VALUE" of the command line, a number or a text. Throws UserError for other texts, and for a star, which is
/// many values.
struct SetAxis {
  explicit SetAxis(const std::string& given);
  std::string given, axis;
  nlohmann::json value;
};

/// A value of an axis as text of a pipeline.
std::string valueText(const nlohmann::json& label);
/// Replaces each $name by the value of that axis, in one pass: inserted values are not scanned again. Writes the
/// replaced axes to `used`. Throws UserError for a `$` that names no axis or is inside a value.
std::string withValues(const std::string& text, const nlohmann::json& axes, std::set<std::string>& used);
/// The axes that a text names with `$`.
std::set<std::string> namedIn(const std::string& text, const nlohmann::json& axes);

/// Adds a method, "LABEL=PIPELINE" of the command line, to the labelled axis. Does nothing if there is no such axis, or
/// if the text uses a `$name` that is neither an axis nor `searched`, the calibrated setting. Throws UserError for
/// other texts, and for a label that exists.
bool addMethod(const std::string& given, const std::string& searched, std::vector<Axis>& axes);

/// The command that plans one sweep of a set again, with the parts of `only`, `with` and `set` that apply to it; it
/// would refuse the others.
std::vector<std::string> commandOf(const std::string& name, const std::set<std::string>& only,
                                   const std::set<std::string>& used, const std::vector<std::string>& with,
                                   const std::vector<std::string>& set);

}}  // namespace lpc::LPC_PRECISION
