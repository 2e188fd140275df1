// SPDX-License-Identifier: Zlib
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/trial/measure/metric.h"
#include "experiments/trial/measure/rest.h"
#include "experiments/trial/measure/settling.h"
#include "framework/scene/scene_spec.h"
#include "framework/world/invariants.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Observations of a world trial so far: the input of the entries in world_metrics.cpp. Lengths in m, from a body's
/// initial position.
template <int D>
struct WorldSeen {
  explicit WorldSeen(const SceneSpec<D>& spec) : scene(spec) {}

  const SceneSpec<D>& scene;
  bool timed = false;
  bool isolated = false;  // free bodies alone in space
  long steps = 0;
  StateInvariants<D> start;
  double startDepth = 0;  // m, from poses; NaN: not measured
  // After the last step:
  Invariants<D> now;
  Profiler::Frame frame;
  double seconds = 0;  // processor time of the step
  double depth = 0;    // m, from poses; NaN if not measured after this step
  Rest rest;           // at the end
  double drift = 0, topDrift = 0, slid = 0;
  Settling<D> settling;
  double naturalMap = 0;       // m/s, of the last step's velocity problem; NaN: the solver exposed none
  double supportsChanged = 0;  // NaN: not reported
  double fellThrough = 0;
  double tunnelled = 0;  // NaN: not measured
  double ghostHits = 0;  // NaN: not measured, or not reported
  double height = 0;     // m, of the highest body
  double weight = 0;     // kg, of all dynamic bodies
  // Over all steps:
  double energyMax = 0;               // J
  double lostTime = 0;                // s, summed over bodies; NaN: not reported
  double deepest = 0, meanDepth = 0;  // m, from poses; the mean is that of the last measurement
  std::map<std::string, std::vector<double>> series;

  bool has(TrialNeed need) const;
  /// Of a series. Throw std::logic_error with the valid names for an unknown series.
  double largest(const char* name) const;
  double total(const char* name) const;
  double end(const char* name) const;                          // 0 before the first step
  double quantileOf(const std::string& name, double q) const;  // without the first steps, in which caches are cold
};

/// One value of each series.
template <int D>
void putSeries(WorldSeen<D>& seen);
template <int D>
std::map<std::string, double> worldMetrics(const WorldSeen<D>& seen);

}}  // namespace lpc::LPC_PRECISION
