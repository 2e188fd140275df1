// SPDX-License-Identifier: Zlib
// One list of parameters per algorithm, which feeds the pipeline text, sweep files, `lpc list` and the report.
//
//   struct Params {
//     int iterations = 10;
//     bool warmStart = true;
//     void visit(ParamVisitor& v) {
//       v.integer("iterations", iterations, 0, 10000, "sweeps over all contacts", ParamRole::effort);
//       v.flag("warm_start", warmStart, "start from the last step's impulses");
//     }
//   };
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/math/space.h"
#include "framework/stage/spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The role of a parameter. Searches at equal cost, curves over iterations and tests of convergence find parameters by
/// role, not by name.
enum class ParamRole {
  manner,    // how the method works; also factors of an effort, such as sweeps within each sub-step
  effort,    // a larger value costs more and is more accurate; a real number is a multiple of the contacts
  tolerance  // the error at which the method stops
};

class ParamVisitor {
 public:
  virtual ~ParamVisitor() = default;
  virtual void integer(std::string_view name, int& value, int lo, int hi, std::string_view meaning,
                       ParamRole role = ParamRole::manner) = 0;
  /// `unit` is SI, "1" when there is none.
  virtual void real(std::string_view name, Real& value, Real lo, Real hi, std::string_view unit,
                    std::string_view meaning, ParamRole role = ParamRole::manner) = 0;
  virtual void flag(std::string_view name, bool& value, std::string_view meaning) = 0;
  /// Another algorithm inside this one, such as a solver's velocity resolver.
  virtual void stage(std::string_view name, Spec& value, StageKind kind, std::string_view meaning) = 0;
  /// An enum with values from 0, in the order of `names`.
  template <class Enum>
  void choice(std::string_view name, Enum& value, std::initializer_list<std::string_view> names,
              std::string_view meaning) {
    int index = static_cast<int>(value);
    choiceIndex(name, index, std::vector<std::string_view>(names), meaning);
    value = static_cast<Enum>(index);
  }

 protected:
  virtual void choiceIndex(std::string_view name, int& index, const std::vector<std::string_view>& names,
                           std::string_view meaning) = 0;
};

/// For algorithms without parameters.
struct NoParams {
  void visit(ParamVisitor&) {}
};

/// Describes a parameter for users and programs.
struct ParamInfo {
  struct Range {
    double lo, hi;  // in `unit`; both ends are valid
  };
  std::string name, type, unit, meaning, defaultText;
  std::optional<Range> range;        // of an integer or real
  std::vector<std::string> choices;  // of a choice, flag or stage
  /// The stage of a parameter that names an algorithm; nullptr for numbers, choices and flags.
  const StageInfo* stage = nullptr;
  ParamRole role = ParamRole::manner;
};

/// The first parameter of a role; nullptr when there is none.
const ParamInfo* firstOf(ParamRole role, const std::vector<ParamInfo>& params);

}}  // namespace lpc::LPC_PRECISION
