// SPDX-License-Identifier: Zlib
// How many trials a command plans, known before any is made.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "experiments/parse/toml_reader.h"

namespace lpc::inline LPC_PRECISION {

class SweepSize {
 public:
  /// A product of axes and what else multiplies. Throws UserError, which tells each factor, where it is too large by
  /// itself or together with what was added before.
  void add(const std::vector<std::pair<std::string, double>>& factors, const std::string& file,
           const toml::node& where);

 private:
  double m_trials = 0;  // holds what is too large for whole numbers
};

}  // namespace lpc::inline LPC_PRECISION
