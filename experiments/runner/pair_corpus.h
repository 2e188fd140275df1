// SPDX-License-Identifier: Zlib
// Hard pairs with their proved distances, as a file for others: what a library's author runs it on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

struct PairCorpusOptions {
  std::string cases;  // the kept ones; empty: none
  std::vector<int> dimensions = {2, 3};
  std::uint64_t seed = 1;  // of the drawn ones
  long pairs = 5;          // drawn, per two kinds of shape
};

struct PairCorpus {
  /// A file of cases (oracles/corpus/cases.h), each with "interval" and "size" beside what is expected.
  std::string text;
  long kept = 0, drawn = 0, undecided = 0;
};

/// Pairs whose distance the referee cannot tell are left out and counted. Throws UserError for a wrong file.
PairCorpus pairCorpus(const PairCorpusOptions& options);

/// A program of Python that counts the wrong answers of a function to be filled in.
std::string pairCorpusRunner();

}}  // namespace lpc::LPC_PRECISION
