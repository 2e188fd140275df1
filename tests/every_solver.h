// SPDX-License-Identifier: Zlib
// What "every solver" means to a test: each registered one by name, and one that is put together from parts with each
// part, order and loop that can be exchanged.
#pragma once

#include <string>
#include <vector>

#include "framework/stage_solver.h"

namespace lpc::inline LPC_PRECISION::test {

inline bool competes(const Registered& r) { return r.info.role == Role::competitor; }

template <int D>
std::vector<std::string> everySolver() {
  std::vector<std::string> specs;
  for (const Registered* r : Registry::instance().list(StageKind::solver, D)) {
    if (!competes(*r)) continue;
    specs.push_back(r->info.name);
    for (const ParamInfo& p : r->params) {
      const bool manner = p.name == "order" || p.name == "loop";
      for (const std::string& choice : p.choices) {
        if (manner) specs.push_back(r->info.name + "{" + p.name + "=" + choice + "}");
      }
    }
    if (r->info.name != "split_solver") continue;
    for (StageKind kind : {StageKind::velocity, StageKind::position, StageKind::integrator}) {
      for (const Registered* part : Registry::instance().list(kind, D)) {
        if (competes(*part))
          specs.push_back("split_solver{" + std::string(stageName(kind)) + "=" + part->info.name + "}");
      }
    }
  }
  return specs;
}

/// The default pipeline with each algorithm of the stages around the solver.
template <int D>
std::vector<std::string> everyOtherStage() {
  std::vector<std::string> pipelines;
  for (StageKind kind : {StageKind::broadphase, StageKind::contacts, StageKind::cache, StageKind::sleep}) {
    for (const Registered* r : Registry::instance().list(kind, D)) {
      if (competes(*r)) pipelines.push_back(std::string(stageName(kind)) + "=" + r->info.name);
    }
  }
  return pipelines;
}

/// The same with every solver.
template <int D>
std::vector<std::string> everyPipeline() {
  std::vector<std::string> pipelines = everyOtherStage<D>();
  for (const std::string& solver : everySolver<D>()) pipelines.push_back("solver=" + solver);
  return pipelines;
}

/// Does a solver or the part that is named in `spec` say in its info().failures that it fails `property`?
template <int D>
bool declares(const std::string& spec, const std::string& property) {
  for (StageKind kind : {StageKind::solver, StageKind::velocity, StageKind::position, StageKind::integrator}) {
    for (const Registered* r : Registry::instance().list(kind, D)) {
      const bool named = kind == StageKind::solver
                             ? Spec::parse(spec).name == r->info.name
                             : spec.find("{" + std::string(stageName(kind)) + "=" + r->info.name + "}") != spec.npos;
      if (!named) continue;
      for (const FailureMode& f : r->info.failures) {
        if (f.test == property) return true;
      }
    }
  }
  return false;
}

}  // namespace lpc::inline LPC_PRECISION::test
