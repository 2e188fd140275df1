// SPDX-License-Identifier: Zlib
#include "experiments/runner/sweep_size.h"

#include <algorithm>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Planning a trial of a world takes 7 kB and 0.3 ms: this limit is 0.7 GB and half a minute, and the trials run for
// hours. More is a typing error; the largest sweep of experiments/sweeps has 1300.
constexpr int kMostTrials = 100000;

}  // namespace

void SweepSize::add(const Product& product, const std::string& file, const toml::node& where) {
  std::string told;
  const auto tell = [&](const std::string& text) { told += (told.empty() ? " (" : ", ") + text; };
  const auto factor = [&](const std::string& name, auto n) {
    if (n > 1) tell(name + " " + asText(static_cast<double>(n)));
    return static_cast<double>(n);
  };
  const double repeats = factor("repeats", product.repeats);
  double cells = 1, others = 1;  // values other than the one that is timed twice
  for (const Axis& axis : product.axes) {
    cells *= factor(axis.name, axis.values.size());
    others *= static_cast<double>(std::count_if(axis.values.begin(), axis.values.end(),
                                                [&](const AxisValue& v) { return v.label != product.twice; }));
  }
  const double budgets = factor("budgets", product.budgets);
  const double search = factor("trials of a search", product.search);
  double trials = 0;
  if (product.untimed) trials += cells * (product.timed ? 1 : repeats);
  if (product.untimed && product.timed) tell("each cell once untimed");
  if (product.timed) trials += (cells + (cells - others)) * repeats;
  if (product.timed && cells > others) tell("'" + product.twice + "' twice");
  trials *= budgets * search;
  if (m_trials + trials > kMostTrials) {
    failAt(file, where,
           "the product of all axes is " + asText(trials) + " trials" + told + (told.empty() ? "" : ")") +
               (m_trials > 0 ? " after " + asText(m_trials) + " before it" : "") + "; valid: up to " +
               std::to_string(kMostTrials) + " in all");
  }
  m_trials += trials;
}

}}  // namespace lpc::LPC_PRECISION
