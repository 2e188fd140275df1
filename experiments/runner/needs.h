// SPDX-License-Identifier: Zlib
// What a scene needs: switches each part of its model one by one, over seeds, and compares with the model of its file.
#pragma once

#include "experiments/runner/store.h"
#include "experiments/runner/sweep_file.h"

namespace lpc { inline namespace LPC_PRECISION {

struct NeedsQuestion {
  std::string scene, pipeline;
  ParameterValues params;
  std::optional<int> dimension;  // none: the scene's first
  std::optional<long> steps;
  int seeds = 5;
  double perturbation = 1e-6;  // m and rad: perturbation of the initial poses, if seeds can perturb the scene
};

/// Timed trials of one sweep, `needs_<scene>`: every model once per seed, and the scene's own twice, which measures the
/// noise. Stages without a method get one (withPolicies), so that their switches have an effect. Throws UserError.
PlannedSweep planNeeds(const NeedsQuestion& question);

/// `pipeline` with a method for sleeping and for continuous collision if it names none; an engine's pipeline is
/// unchanged.
std::string withPolicies(const std::string& pipeline);

/// Results of one model, seed by seed relative to the scene's own model with the same seed.
struct ModelSeen {
  std::string model;                    // empty: the scene's own model again
  std::vector<double> time, rows;       // relative to the scene's own: time per step, row updates per step
  bool sameWork = true;                 // whether all counts are equal, in the same dimension
  std::string idle;                     // "sleep=none": the switched stage does nothing
  std::vector<double> median, largest;  // distance of the bodies' final positions from those of the own model (m)
  int trials = 0, failed = 0;           // failed: not ok, or not comparable
  std::string failure;                  // of the first of them
};
struct NeedsSeen {
  std::vector<ModelSeen> models;        // the scene's own first
  std::vector<double> median, largest;  // how far another seed alone moves the final positions (m)
  int seeds = 0, failed = 0;            // of the scene's own; nothing is compared for a failed seed
  std::string failure;
};

/// Remarks on a model's numbers: how it failed, that its switch has no effect, that its work is equal, or that its time
/// is not significant. Time is significant if the ratios over seeds do not overlap those of the own model's second run,
/// nor 1; with fewer than four seeds, only beyond a factor of 2, since the noise is unknown. reports/charts/needs.py
/// has the same rule.
std::string remarkOn(const ModelSeen& model, const ModelSeen& again);

/// From the trials in the store.
NeedsSeen readNeeds(const PlannedSweep& sweep, Store& store);

}}  // namespace lpc::LPC_PRECISION
