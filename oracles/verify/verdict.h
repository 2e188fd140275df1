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

/// How one method did on one input.
struct Verdict {
  Tally end = Tally::agree;
  bool wrongSide = false, capped = false;
  bool sideAlone = false;  // the method claims no distance here: none was judged
  bool wider = false;      // right, but by a scale that holds where frames are, and not by that of the posed shapes
  double value = 0;        // the distance, or of contacts that of the deepest point (m), where there is an error
  std::optional<double> error;  // over s, of an answer with a value
  std::string failure;          // what went wrong, as in names of files; empty when nothing did
};

/// There is no answer: it ended like this.
Verdict withoutAnswer(Tally end);

/// Values of the further axes: {"family", "ties"}, ...
using Labels = std::vector<std::pair<std::string, std::string>>;

/// An axis of pairs that are right by the wider scale alone: see Verdict.
inline constexpr const char* kWiderScale = "right_by_scale_of";

/// Books the verdict under axis `all` and under each label. `text` is the input as a line of a file of cases; it is
/// asked for only when the line is kept.
void book(Ledger& ledger, LedgerKey subject, AlgorithmRole role, const Labels& labels, const Verdict& verdict,
          double nanoseconds, const std::function<std::string()>& text);

/// What was wrong with whom, as a field of a case: see CaseFinding.
std::string findingText(const LedgerKey& subject, const Verdict& verdict, std::uint64_t seed, int index);

/// What `findingText` has where nothing was wrong: of the largest error of a method that was right.
inline constexpr std::string_view kNoFailure = "\"failure\": \"none\"";

/// A name for one input: of kinds (empty for none), seed and number.
std::string inputName(const LedgerKey& subject, std::uint64_t seed, int index);

/// The subject of a method in this build's precision; its axis is set by `book`.
LedgerKey subjectOf(StageKind stage, int dimension, const std::string& method);

/// Is this an approximate pair query? It owes the side alone: what else is wrong with its answers is booked, as of a
/// witness, and no fault of ours. (Other stages have no side, and what they owe is said where they are judged.)
bool owesSideAlone(StageKind stage, const AlgorithmInfo& info);

/// The faults in this entry for which `lpc verify` fails: those of a competitor, by what it owes.
long faultsOfOurs(const LedgerKey& key, const LedgerEntry& entry);

}}  // namespace lpc::LPC_PRECISION
