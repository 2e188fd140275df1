// SPDX-License-Identifier: Zlib
// The text that names an algorithm and its parameters, and a pipeline of them, in both directions:
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

/// One spec per stage of a world (kWorldStages).
class Pipeline {
 public:
  /// Every stage has its default.
  Pipeline();
  /// The defaults with what the text names. Stages are separated by spaces. Throws UserError for an unknown stage,
  /// listing the valid ones.
  static Pipeline parse(std::string_view text);
  /// Replaces the stages that the text names, and returns which these are.
  std::vector<StageKind> replace(std::string_view text);

  /// Precondition: a stage of a world.
  Spec& operator[](StageKind stage);
  const Spec& operator[](StageKind stage) const;
  /// Every stage, with the parameters that were given.
  std::string text() const;
  bool operator==(const Pipeline&) const = default;

 private:
  IndexedArray<Spec, kStageKinds> m_specs;  // by kind; empty where it is no stage of a world
};

/// The engine that stands where a pipeline stands: of "engine=bullet{iterations=10}" the spec after the "="; nothing of
/// a pipeline of stages. Throws UserError when anything stands beside the engine.
std::optional<Spec> engineOf(std::string_view pipelineText);

}  // namespace lpc
