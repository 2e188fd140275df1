// SPDX-License-Identifier: Zlib
// Hard pairs with their proved distances, as a file for authors of libraries.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

struct PairCorpusOptions {
  std::string cases;  // file of kept cases; empty: none
  std::vector<int> dimensions = {2, 3};
  std::uint64_t seed = 1;  // of the drawn ones
  long pairs = 5;          // drawn pairs, per two kinds of shape
};

struct PairCorpus {
  /// A file of cases (oracles/corpus/cases.h), each with "interval" and "size" besides the expected result.
  std::string text;
  long kept = 0, drawn = 0, undecided = 0;
};

/// Pairs without a decided distance are omitted and counted. Throws UserError for an invalid file.
PairCorpus pairCorpus(const PairCorpusOptions& options);

/// A Python program that counts the wrong answers of a function to be filled in.
std::string pairCorpusRunner();

}}  // namespace lpc::LPC_PRECISION
