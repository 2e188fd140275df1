// SPDX-License-Identifier: Zlib
// What a scene needs: each switch of its model turned one by one, over seeds, beside the model that its file asks for.
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
  double perturbation = 1e-6;  // m and rad: how far bodies start from their places, where seeds can move them
};

/// Timed trials of one sweep, `needs_<scene>`: every model once per seed, and the scene's own twice, which tells the
/// noise. Stages that do nothing unless the pipeline names one of their algorithms get one (withPolicies), so that
/// their switches have something to switch. Throws UserError.
PlannedSweep planNeeds(const NeedsQuestion& question);

/// `pipeline` with an algorithm for sleep and for continuous collision where it names none; an engine's as it is.
std::string withPolicies(const std::string& pipeline);

/// What one model did, seed by seed against the scene's own with the same seed.
struct ModelSeen {
  std::string model;                    // empty: the scene's own again
  std::vector<double> time, rows;       // times those of the scene's own: time per step, row updates per step
  bool sameWork = true;                 // all counts are equal, in the same dimension
  std::string idle;                     // "sleep=none": the stage that its switch turns does nothing
  std::vector<double> median, largest;  // over the bodies: how far they end from where they would (m)
  int trials = 0, failed = 0;           // failed: neither ok nor comparable
  std::string failure;                  // of the first of them
};
struct NeedsSeen {
  std::vector<ModelSeen> models;        // the scene's own first
  std::vector<double> median, largest;  // how far another seed alone takes the bodies (m)
  int seeds = 0, failed = 0;            // of the scene's own; with a seed that fails nothing is compared
  std::string failure;
};

/// What must be known of a model's numbers: how it failed, that its switch turns nothing, that its work is equal, that
/// its time tells nothing. It does not where its ratios over seeds meet those of the scene's own again, or 1; of fewer
/// than four seeds it tells only what is beyond 2 times, for then the noise is not measured. reports/charts/needs.py
/// has the same rule.
std::string remarkOn(const ModelSeen& model, const ModelSeen& again);

/// From the trials in the store.
NeedsSeen readNeeds(const PlannedSweep& sweep, Store& store);

}}  // namespace lpc::LPC_PRECISION
