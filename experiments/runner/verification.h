// SPDX-License-Identifier: Zlib
// Runs a verification: blocks of seeded inputs in workers, one per core, booked in a store. What is booked is not asked
// again, and a method whose code has changed starts anew.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/runner/store.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Inputs are booked in blocks of this many; with their images, of which there are a dozen, in smaller ones: of a
/// witness that hangs on one question of seven for half a second each, a block must end within minutes.
inline constexpr int kVerifyBlock = 200, kRelationsBlock = 10;

/// Of these the last is not asked unless it is named.
inline constexpr StageKind kVerifiedStages[] = {StageKind::pairQuery, StageKind::contacts, StageKind::broadphase,
                                                StageKind::velocity, StageKind::timeOfImpact};

struct VerificationOptions {
  std::vector<StageKind> stages = {StageKind::pairQuery, StageKind::contacts, StageKind::broadphase};
  std::vector<int> dimensions = {2, 3};
  std::vector<std::string> precisions = {"f64"};
  std::vector<std::string> methods = {};   // specs; empty: all that are registered
  std::optional<AlgorithmRole> role = {};  // of the methods; none: all
  bool metamorphic = false;  // of pair queries: what must not matter (see verifyRelations), not the answers
  std::uint64_t seed = 1;
  long pairs = kVerifyBlock;  // per two kinds of shape (or sets of boxes, or problems), rounded up to whole blocks
  double minutes = 0;         // above 0: go on until then, whatever `pairs` says
  int jobs = 0;               // workers at once; 0: one per core
  bool quiet = false;
  std::vector<std::string> plugins = {};
};

struct VerificationSummary {
  long asked = 0, skipped = 0;  // inputs; skipped ones were booked before
  bool stopped = false;         // by Ctrl-C
};

/// Throws UserError for methods that do not exist in any of the stages and dimensions.
void checkVerification(const VerificationOptions& options);

VerificationSummary runVerification(const VerificationOptions& options, Store& store);

/// What the options are about, out of the store's ledger.
Ledger ledgerOf(const VerificationOptions& options, Store& store);

/// Who is asked when no methods are named: the method with its defaults, and a witness also at the tightest tolerance
/// that its library offers, the lower end of its parameter `tolerance` (Bullet's are constants of its build), and with
/// both shapes away from the origin (`frame=world`). Of velocity resolvers those that are to converge.
std::vector<Spec> specsToVerify(const Registered& method);

/// Writes the simplest pair of each failure and the worst of each method as one file each into the folder
/// STORE.found. Returns lines that say what is where.
std::vector<std::string> writeFoundCases(Store& store, const std::string& storePath);

}}  // namespace lpc::LPC_PRECISION
