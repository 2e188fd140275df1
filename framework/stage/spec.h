// SPDX-License-Identifier: Zlib
// The text form of an algorithm with its parameters, and of a pipeline:
//
//   broadphase=sort_and_sweep{axis=0} solver=split_solver{velocity=catto{iterations=20},position=split_impulse}
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/math/check.h"
#include "framework/math/indexed.h"
#include "framework/stage/stages.h"

namespace lpc {

/// `name` or `name{key=spec,...}`. A plain value is a Spec without fields.
struct Spec {
  struct Field;
  std::string name;
  std::vector<Field> fields;  // in the order of the text

  /// Parses a spec. Throws UserError that quotes the text and marks the position.
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

/// One spec per stage of a world (kWorldStages).
class Pipeline {
 public:
  /// All stages with their defaults.
  Pipeline();
  /// Parses a pipeline: stages separated by spaces; stages that the text omits keep their defaults. Throws UserError
  /// for an unknown stage, with the valid names.
  static Pipeline parse(std::string_view text);
  /// Replaces the stages that the text names, and returns their kinds.
  std::vector<StageKind> replace(std::string_view text);

  /// Precondition: `stage` is a stage of a world.
  Spec& operator[](StageKind stage);
  const Spec& operator[](StageKind stage) const;
  /// All stages, with the parameters as given.
  std::string text() const;
  bool operator==(const Pipeline&) const = default;

 private:
  IndexedArray<Spec, kStageKinds> m_specs;  // by kind; empty for kinds that are not stages of a world
};

/// The engine that replaces a pipeline: for "engine=bullet{iterations=10}" the spec after "=". Empty for a pipeline of
/// stages. Throws UserError when the text names anything besides the engine.
std::optional<Spec> engineOf(std::string_view pipelineText);

}  // namespace lpc
