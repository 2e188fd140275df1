// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "framework/stage/registry.h"
#include "oracles/verify/ledger.h"
#include "oracles/witnesses/thread_time.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Result of one method on one input.
struct Verdict {
  Tally end = Tally::agree;
  bool wrongSide = false, capped = false;
  bool sideAlone = false;  // the method claims no distance here: none was judged
  bool wider = false;      // right only by the error scale that depends on the position of frames, not by that of the
                           // posed shapes
  double value = 0;        // the distance, or for contacts that of the deepest point (m), when there is an error
  std::optional<double> error;  // relative to s, for an answer with a value
  std::string failure;          // what went wrong, as in file names; empty when nothing did
};

/// Verdict without an answer, with this outcome.
Verdict withoutAnswer(Tally end);

/// Values of the further axes: {"family", "ties"}, ...
using Labels = std::vector<std::pair<std::string, std::string>>;

/// Axis of pairs that are right only by the wider scale: see Verdict.
inline constexpr const char* kWiderScale = "right_by_scale_of";

/// Records the verdict under axis `all` and under each label. `text` returns the input as a line of a file of cases; it
/// is called only when the line is kept.
void book(Ledger& ledger, LedgerKey subject, AlgorithmRole role, const Labels& labels, const Verdict& verdict,
          double nanoseconds, const std::function<std::string()>& text);

/// The finding as a field of a case: see CaseFinding.
std::string findingText(const LedgerKey& subject, const Verdict& verdict, std::uint64_t seed, int index);

/// In `findingText` when nothing was wrong: the case of the largest error of a correct method.
inline constexpr std::string_view kNoFailure = "\"failure\": \"none\"";

/// Name of one input: kinds (empty for none), seed and number.
std::string inputName(const LedgerKey& subject, std::uint64_t seed, int index);

/// Subject of a method in this build's precision; `book` sets its axis.
LedgerKey subjectOf(StageKind stage, int dimension, const std::string& method);

/// True for an approximate pair query: only its side must be right. Its other errors are recorded, as for a witness,
/// and do not count as our faults. (Other stages have no side; their requirements are defined where they are judged.)
bool owesSideAlone(StageKind stage, const AlgorithmInfo& info);

/// The faults in this entry for which `lpc verify` fails: those of a competitor, by its requirements.
long faultsOfOurs(const LedgerKey& key, const LedgerEntry& entry);

}}  // namespace lpc::LPC_PRECISION
