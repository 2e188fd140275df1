// SPDX-License-Identifier: Zlib
// Runs a verification: blocks of seeded inputs in workers, one per core, recorded in a store. Recorded blocks are not
// run again, and a method with changed code starts anew.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/runner/store.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Inputs are recorded in blocks of this size. With their transformed images, a dozen each, blocks are smaller: a block
/// of a witness that hangs on one query of seven for half a second each must end within minutes.
inline constexpr int kVerifyBlock = 200, kRelationsBlock = 10;

/// The last stage is verified only if it is named.
inline constexpr StageKind kVerifiedStages[] = {StageKind::pairQuery, StageKind::contacts, StageKind::broadphase,
                                                StageKind::velocity, StageKind::timeOfImpact};

struct VerificationOptions {
  std::vector<StageKind> stages = {StageKind::pairQuery, StageKind::contacts, StageKind::broadphase};
  std::vector<int> dimensions = {2, 3};
  std::vector<std::string> precisions = {"f64"};
  std::vector<std::string> methods = {};   // specs; empty: all registered ones
  std::optional<AlgorithmRole> role = {};  // of the methods; none: all
  bool metamorphic = false;  // for pair queries: checks relations (see verifyRelations) instead of answers
  std::uint64_t seed = 1;
  long pairs = kVerifyBlock;  // per two kinds of shape (or sets of boxes, or problems), rounded up to whole blocks
  double minutes = 0;         // above 0: continue until then, whatever `pairs` is
  int jobs = 0;               // workers at once; 0: one per core
  bool quiet = false;
  std::vector<std::string> plugins = {};
};

struct VerificationSummary {
  long asked = 0, skipped = 0;  // inputs; skipped ones were recorded before
  bool stopped = false;         // by Ctrl-C
};

/// Throws UserError for methods that do not exist in any of the stages and dimensions.
void checkVerification(const VerificationOptions& options);

VerificationSummary runVerification(const VerificationOptions& options, Store& store);

/// The part of the store's ledger that the options select.
Ledger ledgerOf(const VerificationOptions& options, Store& store);

/// The default methods: each with its defaults; a witness also at the tightest tolerance of its library, the lower end
/// of its parameter `tolerance` (Bullet's are compiled in), and with both shapes away from the origin (`frame=world`);
/// of velocity resolvers those that should converge.
std::vector<Spec> specsToVerify(const Registered& method);

/// Writes the simplest pair of each failure and the worst of each method as one file each into the folder STORE.found.
/// Returns lines that list the files.
std::vector<std::string> writeFoundCases(Store& store, const std::string& storePath);

}}  // namespace lpc::LPC_PRECISION
