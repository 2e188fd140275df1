// SPDX-License-Identifier: Zlib
#include "oracles/verify.h"

#include "framework/check.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <class StageOf>
std::vector<Candidate<StageOf>> candidates(const std::vector<std::string>& specs) {
  std::vector<Candidate<StageOf>> out;
  for (const std::string& text : specs) {
    const Spec spec = Spec::parse(text);
    const AlgorithmInfo info = Registry::instance().find(StageOf::kStage, StageOf::kDimension, spec.name).info;
    out.push_back({text, info, [spec] { return createStage<StageOf>(spec); }});
  }
  return out;
}

template <int D>
Verified verifyIn(const VerifyTask& task) {
  Verified out;
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
    default:
      throw UserError("verify: no such stage; valid: pair_query, contacts, broadphase");
  }
}

}  // namespace

double verifyTolerance() { return sizeof(Real) == 8 ? 1e-12 : 1e-5; }

Verified verify(const VerifyTask& task) {
  if (task.dimension == 2) return verifyIn<2>(task);
  if (task.dimension == 3) return verifyIn<3>(task);
  throw UserError("verify: the dimension is " + std::to_string(task.dimension) + "; valid: 2, 3");
}

}  // namespace lpc::inline LPC_PRECISION
