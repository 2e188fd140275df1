// SPDX-License-Identifier: Zlib
// A request reaches its worker unchanged, field by field.
#include "experiments/trial/request.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

using nlohmann::json;

// Each field differs from its default, so that a field that is not written or not read is detected.
template <class Asked>
Asked base() {
  Asked out;
  out.dimension = 3, out.precision = "f32", out.seed = 7, out.repeat = 2, out.timed = true;
  return out;
}
std::vector<decltype(TrialRequest::trial)> everyKind() {
  auto world = base<WorldRequest>();
  world.scene = "pyramid", world.script = "rain", world.params = {{"base", 4.0}, {"joint", std::string("weld")}};
  world.pipeline = "engine=box2d", world.dt = 0.01, world.steps = 12, world.features = "cache";
  world.posesEvery = 0.5, world.series = false;
  auto boxes = base<BoxesRequest>();
  boxes.n = 5, boxes.frames = 6, boxes.distribution = "uniform", boxes.broadphase = "naive";
  auto pairs = base<PairsRequest>();
  pairs.pairQuery = "sat", pairs.drawing = "apart", pairs.kindA = "box", pairs.kindB = "polytope", pairs.n = 8;
  pairs.vertices = 9;
  auto stream = base<StreamRequest>();
  stream.pairQuery = "sat", stream.drawing = "near", stream.stream = "warm", stream.params = {{"base", 4.0}};
  stream.from = 3, stream.steps = 4;
  auto problem = base<ProblemRequest>();
  problem.velocity = "catto", problem.problem = 2, problem.iterations = 9, problem.cold = problem.coloured = true;
  problem.friction = false;
  return {world, boxes, pairs, stream, problem};
}

// The difference between two documents; "" if there is none.
std::string difference(const json& a, const json& b) { return a == b ? "" : json::diff(a, b).dump(); }

TEST(Request, ReachesItsWorkerUnchanged) {
  for (const auto& trial : everyKind()) {
    TrialRequest request{.trial = trial, .sceneFile = "a.toml", .scriptFile = "b.toml"};
    request.plugins = {"c.so"}, request.profile = "d.csv", request.record = "e.lpcr", request.trajectory = "h.csv",
    request.saves = {{4, "f.toml"}};
    request.memory = request.progress = true;
    const json sent = toJson(request);
    const TrialRequest got = requestFromJson(json::parse(sent.dump()));
    EXPECT_EQ(difference(toJson(got), sent), "");
    EXPECT_EQ(got.trial.index(), trial.index());
    EXPECT_EQ(got.ofEngine(), request.ofEngine());
    for (const auto& [name, value] : sent.at("trial").items()) {  // the planted bug: a field is not sent
      json lost = sent;
      lost["trial"].erase(name);
      bool seen = true;
      try {
        seen = difference(toJson(requestFromJson(lost)), sent) != "";
      } catch (const std::exception&) {
      }
      EXPECT_TRUE(seen) << sent.at("trial").at("kind") << " without " << name;
    }
  }
}

TEST(Request, RefusesAnUnknownKind) {
  try {
    trialFromJson({{"kind", "wolrd"}});
    FAIL() << "it was taken";
  } catch (const UserError& e) {
    EXPECT_EQ(std::string(e.what()), "unknown trial kind 'wolrd'; valid: world, boxes, pairs, problems");
  }
}

}  // namespace
}}  // namespace lpc::LPC_PRECISION
