// SPDX-License-Identifier: Zlib
// The text that names an algorithm and its parameters, and a pipeline of them, in both directions:
//
//   broadphase=sort_and_sweep{axis=0} solver=split_solver{velocity=catto{iterations=20},position=split_impulse}
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/check.h"

namespace lpc {

/// `name` or `name{key=spec,...}`. A plain value is a Spec without fields.
struct Spec {
  struct Field;
  std::string name;
  std::vector<Field> fields;  // in the order of the text

  /// Throws UserError that quotes the text and marks the place.
  static Spec parse(std::string_view text);
  std::string text() const;

  const Spec* find(std::string_view key) const;
  /// Sets the field, or adds it.
  void set(std::string_view key, Spec value);
  bool operator==(const Spec& other) const;
};
struct Spec::Field {
  std::string key;
  Spec value;
  bool operator==(const Field&) const = default;
};

/// One spec per stage of a world. A stage that the text leaves out has its default.
struct Pipeline {
  Spec broadphase{"sort_and_sweep", {}};
  Spec contacts{"sat_clip", {}};
  Spec cache{"by_feature", {}};
  Spec solver{"split_solver", {}};
  Spec sleep{"none", {}};

  /// Stages are separated by spaces. Throws UserError for an unknown stage, listing the valid ones.
  static Pipeline parse(std::string_view text);
  /// Every stage, with the parameters that were given.
  std::string text() const;
  bool operator==(const Pipeline&) const = default;
};

}  // namespace lpc
