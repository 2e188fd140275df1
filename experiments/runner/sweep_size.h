// SPDX-License-Identifier: Zlib
// How many trials a command plans, known before any is made.
#pragma once

#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/sweep_axis.h"

namespace lpc { inline namespace LPC_PRECISION {

class SweepSize {
 public:
  /// A product of axes and what else multiplies.
  struct Product {
    const std::vector<Axis>& axes;
    std::size_t budgets;
    long repeats;
    bool timed, untimed;
    std::string twice;  // a value: its cells are timed as if they were two
    int search = 1;     // trials at most, of a search for a breaking point
  };
  /// Throws UserError, which tells each factor, where it is too large by itself or together with what was added before.
  void add(const Product& product, const std::string& file, const toml::node& where);

 private:
  double m_trials = 0;  // holds what is too large for whole numbers
};

}}  // namespace lpc::LPC_PRECISION
