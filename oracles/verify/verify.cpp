// SPDX-License-Identifier: Zlib
#include "oracles/verify/verify.h"

#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

#include "framework/math/check.h"
#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <class StageOf>
Candidate<StageOf> candidate(const std::string& text) {
  const Spec spec = Spec::parse(text);
  const AlgorithmInfo info = Registry::instance().find(StageOf::kStage, StageOf::kDimension, spec.name).info;
  return {text, info, [spec] { return createStage<StageOf>(spec); }};
}

template <class StageOf>
std::vector<Candidate<StageOf>> candidates(const std::vector<std::string>& specs) {
  std::vector<Candidate<StageOf>> out;
  for (const std::string& text : specs) out.push_back(candidate<StageOf>(text));
  return out;
}

template <int D>
Verified verifyIn(const VerifyTask& task) {
  Verified out;
  if (task.relations) {
    if (task.stage != StageKind::pairQuery)
      throw UserError("verify: metamorphic relations exist for pair queries only");
    verifyRelations<D>(task.kindA, task.kindB, task.range, candidates<PairQuery<D>>(task.methods), out);
    return out;
  }
  switch (task.stage) {
    case StageKind::pairQuery:
      verifyPairQueries<D>(task.kindA, task.kindB, task.range, candidates<PairQuery<D>>(task.methods), out);
      return out;
    case StageKind::contacts:
      verifyContacts<D>(task.kindA, task.kindB, task.range, candidates<ContactGenerator<D>>(task.methods), out);
      return out;
    case StageKind::broadphase:
      verifyBroadphases<D>(task.range, candidates<Broadphase<D>>(task.methods), out);
      return out;
    case StageKind::velocity:
      verifyVelocities<D>(task.range, candidates<VelocityResolver<D>>(task.methods), out);
      return out;
    case StageKind::timeOfImpact:
      verifyImpacts<D>(task.kindA, task.kindB, task.range, candidates<TimeOfImpact<D>>(task.methods), out);
      return out;
    default:
      throw UserError("verify: no such stage; valid: pair_query, contacts, broadphase, velocity, time_of_impact");
  }
}

template <class StageOf, int D>
Verdict askPair(const CaseGeometry<D>& g, const std::string& text) {
  const Candidate<StageOf> method = candidate<StageOf>(text);
  if (!g.a.shape || !g.b.shape || !method.create()->supports(g.a.shape->kind(), g.b.shape->kind())) {
    return {.end = Tally::refused, .error = {}, .failure = "unsupported_shape"};
  }
  return verifyPair(g.pair(), method);
}

template <int D>
Verdict askAgainIn(const CaseGeometry<D>& g, StageKind stage, const std::string& method) {
  if (stage == StageKind::broadphase) return verifyScript(g.script, candidate<Broadphase<D>>(method));
  if (stage == StageKind::contacts) return askPair<ContactGenerator<D>>(g, method);
  return askPair<PairQuery<D>>(g, method);
}

// Runs the method of a kept text alone: true when the same failure, with the same error, appears again.
bool failsAgain(const std::string& text) {
  const Case c = parseCases("{\"cases\": [" + text + "]}", "a kept failure").front();
  const Verdict verdict = askAgain(c, c.finding->method);
  return verdict.failure == c.finding->failure &&
         verdict.error.value_or(-1) == (std::isnan(c.finding->error) ? -1 : c.finding->error);
}

constexpr std::string_view kFound = "\"found\": {";

// A finding must not depend on the queries before it. The simplest pair and the one with the largest error are often
// the same, which is then run once.
void askKeptAgain(Verified& out) {
  std::map<std::string, bool> asked;
  const auto again = [&](const std::string& text) {
    const auto [at, fresh] = asked.try_emplace(text, false);
    if (fresh) at->second = failsAgain(text);
    return at->second;
  };
  const auto marked = [](std::string text) {
    return text.insert(text.find(kFound) + kFound.size(), "\"again\": false, ");
  };
  std::vector<FoundCase> once;
  for (auto at = out.found.begin(); at != out.found.end();) {
    if (again(at->second.text)) {
      ++at;
    } else {
      once.push_back(at->second);
      at = out.found.erase(at);
    }
  }
  for (FoundCase& c : once) {
    c.failure += "_once", c.text = marked(c.text);
    out.keep(std::move(c));
  }
  for (auto& [key, entry] : out.ledger) {
    const bool failure = !entry.worst.empty() && entry.worst.find(kNoFailure) == std::string::npos;
    if (failure && !again(entry.worst)) entry.worst = marked(entry.worst);
  }
}

}  // namespace

Verdict askAgain(const Case& c, const std::string& method) {
  return std::visit([&](const auto& g) { return askAgainIn(g, c.finding->stage, method); }, c.geometry);
}

Verified verify(const VerifyTask& task) {
  if (task.dimension == 2 || task.dimension == 3) {
    Verified out = task.dimension == 2 ? verifyIn<2>(task) : verifyIn<3>(task);
    if (!task.range.ended) askKeptAgain(out);
    return out;
  }
  throw UserError("verify: the dimension is " + std::to_string(task.dimension) + "; valid: 2, 3");
}

}}  // namespace lpc::LPC_PRECISION
