// SPDX-License-Identifier: Zlib
// The solvers that "every solver" means in tests: each registered solver by name, and split_solver with each part,
// order, loop and impact law that can be chosen.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline bool competes(const Registered& r) { return r.info.role == AlgorithmRole::competitor; }

/// Variants of a velocity resolver: each non-default choice of its row order, block solving or friction model, such as
/// "friction=box".
inline std::vector<std::string> otherManners(const Registered& r) {
  std::vector<std::string> out;
  for (const ParamInfo& p : r.params) {
    if (p.name != "sweep" && p.name != "block" && p.name != "friction" && p.name != "order") continue;
    for (const std::string& choice : p.choices) {
      if (choice != p.defaultText) out.push_back(p.name + "=" + choice);
    }
  }
  return out;
}

/// `inWorlds`: also solvers that request contacts within a step, which hand-made problems cannot make.
template <int D>
std::vector<std::string> everySolver(bool inWorlds = false) {
  std::vector<std::string> specs;
  for (const Registered* r : Registry::instance().list(StageKind::solver, D)) {
    if (!competes(*r)) continue;
    specs.push_back(r->info.name);
    for (const ParamInfo& p : r->params) {
      const bool manner =
          p.name == "order" || p.name == "loop" || p.name == "impact" || (inWorlds && p.name == "contacts");
      for (const std::string& choice : p.choices) {
        const std::string spec = r->info.name + "{" + p.name + "=" + choice + "}";
        const bool isDefault = r->canonical(Spec::parse(spec)) == r->canonical(Spec{r->info.name, {}});
        if (manner && !isDefault) specs.push_back(spec);
      }
    }
    for (const ParamInfo& p : r->params) {
      if (!p.stage) continue;
      for (const Registered* part : Registry::instance().list(p.stage->kind, D)) {
        if (!competes(*part)) continue;
        const std::string with = r->info.name + "{" + p.name + "=" + part->info.name;
        specs.push_back(with + "}");
        if (p.stage->kind != StageKind::velocity) continue;
        for (const std::string& manner : otherManners(*part)) specs.push_back(with + "{" + manner + "}}");
      }
    }
  }
  return specs;
}

/// A velocity resolver with this number of iterations, or of iterations per contact, and no early stop.
inline Spec withIterations(const Registered& entry, int iterations, int perContact) {
  Spec spec{entry.info.name, {}};
  for (const ParamInfo& p : entry.params) {
    if (p.role == ParamRole::effort) {
      spec.set(p.name, {std::to_string(p.type == "integer" ? iterations : perContact), {}});
    }
    if (p.role == ParamRole::tolerance) spec.set(p.name, {"0", {}});
  }
  return spec;
}

/// The default pipeline with each algorithm of the other stages.
template <int D>
std::vector<std::string> everyOtherStage() {
  std::vector<std::string> pipelines;
  for (const StageKind kind : kWorldStages) {
    if (kind == StageKind::solver) continue;
    for (const Registered* r : Registry::instance().list(kind, D)) {
      if (competes(*r)) pipelines.push_back(std::string(stageName(kind)) + "=" + r->info.name);
    }
  }
  return pipelines;
}

/// The same, and the default pipeline with every solver.
template <int D>
std::vector<std::string> everyPipeline() {
  std::vector<std::string> pipelines = everyOtherStage<D>();
  for (const std::string& solver : everySolver<D>()) pipelines.push_back("solver=" + solver);
  return pipelines;
}

/// Whether the method's info().failures declare that it fails `property`. If a failure's `when` begins with a value of
/// a parameter and a colon, "friction=box: a body that lands", the failure applies to that value only.
inline bool declares(const Registered& method, const Spec& spec, const std::string& property) {
  const auto applies = [&](const FailureMode& f) {
    for (const ParamInfo& p : method.params) {
      if (!f.when.starts_with(p.name + "=")) continue;
      const std::string value = f.when.substr(p.name.size() + 1, f.when.find(':') - p.name.size() - 1);
      if (value.find(' ') != value.npos) continue;  // a sentence about the parameter
      const Spec* given = spec.find(p.name);
      return (given ? given->name : p.defaultText) == value;
    }
    return true;
  };
  return std::any_of(method.info.failures.begin(), method.info.failures.end(),
                     [&](const FailureMode& f) { return f.test == property && applies(f); });
}

/// Whether a solver, or a part named in `spec`, declares in its info().failures that it fails `property`.
template <int D>
bool declares(const std::string& spec, const std::string& property) {
  const Spec parsed = Spec::parse(spec);
  const Registered& solver = Registry::instance().find(StageKind::solver, D, parsed.name);
  if (declares(solver, parsed, property)) return true;
  for (const ParamInfo& p : solver.params) {
    const Spec* part = p.stage ? parsed.find(p.name) : nullptr;
    if (part && declares(Registry::instance().find(p.stage->kind, D, part->name), *part, property)) return true;
  }
  return false;
}

}}}  // namespace lpc::LPC_PRECISION::test
