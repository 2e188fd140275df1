// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/lane_label.h"

#include "framework/registry.h"
#include "framework/stage_engine.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// Without the parameters that it has anyhow.
Spec shortened(const Spec& spec, StageKind stage, int dimension) {
  const Registered& entry = Registry::instance().find(stage, dimension, spec.name);
  const Spec usual = entry.canonical(Spec{spec.name, {}});
  Spec out{spec.name, {}};
  for (const ParamInfo& p : entry.params) {
    const Spec* given = spec.find(p.name);
    if (!given || *given == *usual.find(p.name)) continue;
    out.set(p.name, p.stage ? shortened(*given, p.stage->kind, dimension) : *given);
  }
  return out;
}

}  // namespace

std::string laneLabel(const std::string& text, int dimension) {
  if (engineOf(text)) return text;
  const Pipeline pipeline = Pipeline::parse(canonicalText(Pipeline::parse(text), dimension));
  const Pipeline usual = Pipeline::parse(canonicalText(Pipeline(), dimension));
  std::string out;
  for (const StageKind kind : kWorldStages) {
    if (pipeline[kind] == usual[kind]) continue;
    out += (out.empty() ? "" : " ") + std::string(stageName(kind)) + "=" +
           shortened(pipeline[kind], kind, dimension).text();
  }
  return out.empty() ? "the default stages" : out;
}

}  // namespace lpc::inline LPC_PRECISION
