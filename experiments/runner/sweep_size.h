// SPDX-License-Identifier: Zlib
// The number of trials of a command, before any is planned.
#pragma once

#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/sweep_axis.h"

namespace lpc { inline namespace LPC_PRECISION {

class SweepSize {
 public:
  /// A product of axes and other factors.
  struct Product {
    const std::vector<Axis>& axes;
    std::size_t budgets;
    long repeats;
    bool timed, untimed;
    std::string twice;  // a value: its cells are timed as if they were two
    int search = 1;     // largest number of trials in a search for a breaking point
  };
  /// Throws UserError with each factor if it is too large, alone or together with what was added before.
  void add(const Product& product, const std::string& file, const toml::node& where);

 private:
  double m_trials = 0;  // a double, because the product may exceed integers
};

}}  // namespace lpc::LPC_PRECISION
