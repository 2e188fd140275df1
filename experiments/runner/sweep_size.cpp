// SPDX-License-Identifier: Zlib
#include "experiments/runner/sweep_size.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// A trial of a world takes 7 kB and 0.3 ms to plan: this many are 0.7 GB and half a minute, before they run for hours.
// More are a slip of the pen; the largest sweep of experiments/sweeps has 1300.
constexpr int kMostTrials = 100000;

}  // namespace

void SweepSize::add(const std::vector<std::pair<std::string, double>>& factors, const std::string& file,
                    const toml::node& where) {
  double trials = 1;
  std::string told;
  for (const auto& [name, n] : factors) {
    trials *= n;
    if (n > 1) told += (told.empty() ? " (" : ", ") + name + " " + asText(n);
  }
  if (m_trials + trials > kMostTrials) {
    failAt(file, where,
           "the product of all axes is " + asText(trials) + " trials" + told + (told.empty() ? "" : ")") +
               (m_trials > 0 ? " after " + asText(m_trials) + " before it" : "") + "; valid: up to " +
               std::to_string(kMostTrials) + " in all");
  }
  m_trials += trials;
}

}  // namespace lpc::inline LPC_PRECISION
