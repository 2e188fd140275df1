// SPDX-License-Identifier: Zlib
#include "experiments/trial/request.h"

#include <nlohmann/json.hpp>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

json ofBase(const char* kind, const TrialBase& t) {
  return {{"kind", kind},   {"dimension", t.dimension}, {"precision", t.precision},
          {"seed", t.seed}, {"repeat", t.repeat},       {"timed", t.timed}};
}
void readBase(const json& j, TrialBase& t) {
  t.dimension = j.at("dimension"), t.precision = j.value("precision", t.precision), t.seed = j.value("seed", t.seed);
  t.repeat = j.value("repeat", 0), t.timed = j.value("timed", false);
}

json toJson(const BoxesRequest& t) {
  json out = ofBase(t.kKind, t);
  out["n"] = t.n, out["frames"] = t.frames, out["distribution"] = t.distribution, out["broadphase"] = t.broadphase;
  return out;
}
json toJson(const PairsRequest& t) {
  json out = ofBase(t.kKind, t);
  out["pair_query"] = t.pairQuery, out["drawing"] = t.drawing, out["kind_a"] = t.kindA, out["kind_b"] = t.kindB;
  out["n"] = t.n;
  if (t.vertices > 0) out["vertices"] = t.vertices;
  return out;
}
json toJson(const StreamRequest& t) {
  json out = ofBase(t.kKind, t);
  out["pair_query"] = t.pairQuery, out["drawing"] = t.drawing, out["stream"] = t.stream, out["params"] = t.params;
  out["from"] = t.from, out["steps"] = t.steps;
  return out;
}
json toJson(const ProblemRequest& t) {
  json out = ofBase(t.kKind, t);
  out["velocity"] = t.velocity, out["problem"] = t.problem, out["iterations"] = t.iterations;
  out["start"] = t.cold ? "cold" : "warm", out["order"] = t.coloured ? "coloured" : "recorded";
  out["friction"] = t.friction ? "on" : "off";
  return out;
}

WorldRequest worldFromJson(const json& j) {
  WorldRequest t;
  readBase(j, t);
  t.scene = j.value("scene", ""), t.script = j.value("script", "");
  t.params = j.at("params").get<ParameterValues>(), t.pipeline = j.at("pipeline");
  t.dt = j.at("dt"), t.steps = j.at("steps");
  t.features = j.at("features"), t.posesEvery = j.value("poses_every", 0.0), t.series = j.value("series", true);
  return t;
}
BoxesRequest boxesFromJson(const json& j) {
  BoxesRequest t;
  readBase(j, t);
  t.n = j.at("n"), t.frames = j.at("frames");
  t.distribution = j.at("distribution"), t.broadphase = j.at("broadphase");
  return t;
}
PairsRequest pairsFromJson(const json& j) {
  PairsRequest t;
  readBase(j, t);
  t.pairQuery = j.at("pair_query"), t.drawing = j.value("drawing", t.drawing);
  t.kindA = j.at("kind_a"), t.kindB = j.at("kind_b"), t.n = j.at("n"), t.vertices = j.value("vertices", 0);
  return t;
}
StreamRequest streamFromJson(const json& j) {
  StreamRequest t;
  readBase(j, t);
  t.pairQuery = j.at("pair_query"), t.drawing = j.at("drawing"), t.stream = j.at("stream");
  t.params = j.at("params").get<ParameterValues>(), t.from = j.at("from"), t.steps = j.at("steps");
  return t;
}
ProblemRequest problemFromJson(const json& j) {
  ProblemRequest t;
  readBase(j, t);
  t.velocity = j.at("velocity"), t.problem = j.at("problem"), t.iterations = j.at("iterations");
  t.cold = j.at("start") == "cold", t.coloured = j.at("order") == "coloured", t.friction = j.at("friction") != "off";
  return t;
}

}  // namespace

const TrialBase& TrialRequest::base() const {
  return std::visit([](const auto& t) -> const TrialBase& { return t; }, trial);
}

TrialBase& TrialRequest::base() {
  return std::visit([](auto& t) -> TrialBase& { return t; }, trial);
}
bool TrialRequest::ofEngine() const {
  const auto* ofWorld = std::get_if<WorldRequest>(&trial);
  return ofWorld && ofWorld->ofEngine();
}

json toJson(const WorldRequest& t) {
  json out = ofBase(t.kKind, t);
  out["scene"] = t.scene, out["params"] = t.params, out["pipeline"] = t.pipeline, out["dt"] = t.dt;
  out["steps"] = t.steps, out["features"] = t.features;
  if (!t.script.empty()) out["script"] = t.script;
  if (t.posesEvery > 0) out["poses_every"] = t.posesEvery;
  if (!t.series) out["series"] = false;
  return out;
}

decltype(TrialRequest::trial) trialFromJson(const json& j) {
  const std::string kind = j.at("kind");
  if (kind == WorldRequest::kKind) return worldFromJson(j);
  if (kind == BoxesRequest::kKind) return boxesFromJson(j);
  if (kind == PairsRequest::kKind && j.contains("stream")) return streamFromJson(j);
  if (kind == PairsRequest::kKind) return pairsFromJson(j);
  if (kind == ProblemRequest::kKind) return problemFromJson(j);
  throw UserError("unknown trial kind '" + kind + "'; valid: world, boxes, pairs, problems");
}

json toJson(const TrialRequest& r) {
  json saves = json::array();
  for (const SaveRequest& s : r.saves) saves.push_back({{"step", s.step}, {"scene", s.scene}});
  return {{"trial", std::visit([](const auto& t) { return toJson(t); }, r.trial)},
          {"scene_file", r.sceneFile},
          {"script_file", r.scriptFile},
          {"plugins", r.plugins},
          {"profile", r.profile},
          {"record", r.record},
          {"trajectory", r.trajectory},
          {"saves", saves},
          {"memory", r.memory},
          {"progress", r.progress}};
}

TrialRequest requestFromJson(const json& j) {
  TrialRequest out{.trial = trialFromJson(j.at("trial")),
                   .sceneFile = j.at("scene_file"),
                   .scriptFile = j.at("script_file"),
                   .plugins = j.at("plugins"),
                   .profile = j.at("profile"),
                   .record = j.at("record"),
                   .trajectory = j.at("trajectory"),
                   .memory = j.at("memory"),
                   .progress = j.at("progress")};
  for (const json& s : j.at("saves")) out.saves.push_back({s.at("step"), s.at("scene")});
  return out;
}

}}  // namespace lpc::LPC_PRECISION
