// SPDX-License-Identifier: Zlib
// The only list of stages. Folder names, pipeline texts, axes of sweeps, `lpc list`, keys of results and the rule of
// allowed includes follow from it. A new stage needs a StageKind, a row in kStages, an interface (stage_<name>.h), an
// algorithm, and a call in World::step.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>

namespace lpc {

enum class StageKind {
  broadphase,
  pairQuery,
  contacts,
  cache,
  timeOfImpact,
  continuous,
  solver,
  velocity,
  position,
  integrator,
  sleep,
  joint,
  force,
  engine
};

struct StageInfo {
  StageKind kind;
  std::string_view name;   // in pipeline texts and result files, so it never changes; its algorithms are in
                           // algorithms/<name>/
  std::string_view group;  // stages of one group share kernel headers, which no other stage includes
  /// The algorithm that a world uses unless its pipeline names another. Empty: not a stage of a world, but a part of
  /// other stages, named in their parameters, or of scenes.
  std::string_view worldDefault;
};

/// In the order of pipeline texts and of `lpc list`.
inline constexpr StageInfo kStages[] = {
    {StageKind::broadphase, "broadphase", "broadphase", "sort_and_sweep"},
    {StageKind::pairQuery, "pair_query", "narrowphase", ""},
    {StageKind::contacts, "contacts", "narrowphase", "sat_clip"},
    {StageKind::cache, "cache", "narrowphase", "by_feature"},
    {StageKind::timeOfImpact, "time_of_impact", "continuous", ""},
    {StageKind::continuous, "continuous", "continuous", "none"},
    {StageKind::solver, "solver", "solver", "split_solver"},
    {StageKind::velocity, "velocity", "solver", ""},
    {StageKind::position, "position", "solver", ""},
    {StageKind::integrator, "integrator", "solver", ""},
    {StageKind::sleep, "sleep", "sleep", "none"},
    {StageKind::joint, "joint", "solver", ""},
    {StageKind::force, "force", "force", ""},
    {StageKind::engine, "engine", "engine", ""},
};
inline constexpr int kStageKinds = static_cast<int>(std::size(kStages));

constexpr const StageInfo& stageInfo(StageKind kind) { return kStages[static_cast<std::size_t>(kind)]; }
/// True except for engines, which are complete external simulations in oracles/engines, not in algorithms/.
constexpr bool isOurs(const StageInfo& stage) { return stage.kind != StageKind::engine; }
constexpr std::string_view stageName(StageKind kind) { return stageInfo(kind).name; }
constexpr bool isWorldStage(const StageInfo& stage) { return !stage.worldDefault.empty(); }
/// False for nullptr.
constexpr bool isWorldStage(const StageInfo* stage) { return stage && isWorldStage(*stage); }

/// nullptr when no stage has this name.
constexpr const StageInfo* stageByName(std::string_view name) {
  for (const StageInfo& s : kStages) {
    if (s.name == name) return &s;
  }
  return nullptr;
}

/// The stage of the folder that contains this path of the project; nullptr outside of `algorithms/NAME/`.
constexpr const StageInfo* stageOfPath(std::string_view path) {
  constexpr std::string_view kFolder = "algorithms/";
  if (!path.starts_with(kFolder)) return nullptr;
  path.remove_prefix(kFolder.size());
  const std::size_t end = path.find('/');
  return end == path.npos ? nullptr : stageByName(path.substr(0, end));
}

/// The stages of a world, one algorithm each.
inline constexpr auto kWorldStages = [] {
  constexpr std::size_t kCount = [] {
    std::size_t n = 0;
    for (const StageInfo& s : kStages) n += isWorldStage(s);
    return n;
  }();
  std::array<StageKind, kCount> kinds{};
  std::size_t n = 0;
  for (const StageInfo& s : kStages) {
    if (isWorldStage(s)) kinds[n++] = s.kind;
  }
  return kinds;
}();

static_assert(
    [] {
      for (std::size_t i = 0; i < std::size(kStages); ++i) {
        if (kStages[i].kind != static_cast<StageKind>(i)) return false;
      }
      return true;
    }(),
    "the rows of kStages stand in the order of StageKind");

}  // namespace lpc
