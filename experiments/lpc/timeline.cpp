// SPDX-License-Identifier: Zlib
#include "experiments/lpc/timeline.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "experiments/lpc/series_plot.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/trial.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Series = std::vector<double>;

constexpr std::size_t kWidth = 90, kHeight = 16, kLabel = 11;

struct Phase {
  char letter;
  const char* name;
  Series seconds;
};

// The report's phases from our profiler scopes, as in the chart `script_profile`, and the remaining time. For a solver
// without a phase of velocities, that phase contains all its work except integrating, moving and positions.
std::vector<Phase> phasesOf(const std::map<std::string, Series>& series, const Series& whole) {
  const auto of = [&](const char* scope) {
    const auto it = series.find(scope);
    return it == series.end() ? Series(whole.size(), 0.0) : it->second;
  };
  const Series integrate = of("sec_solver_integrate"), move = of("sec_solver_move"), apart = of("sec_solver_position");
  Series resolve = of("sec_solver_velocity");
  if (!series.count("sec_solver_velocity")) {
    resolve = of("sec_solver");
    for (std::size_t i = 0; i < whole.size(); ++i) resolve[i] -= integrate[i] + move[i] + apart[i];
  }
  std::vector<Phase> out = {{'p', "findPairs", of("sec_broadphase")},
                            {'c', "findContacts", of("sec_contacts")},
                            {'f', "applyForces", integrate},
                            {'v', "resolveVelocities", resolve},
                            {'m', "moveApart", apart},
                            {'.', "other", whole}};
  for (std::size_t i = 0; i < whole.size(); ++i) {
    double& other = out.back().seconds[i];
    for (std::size_t k = 0; k + 1 < out.size(); ++k) other -= out[k].seconds[i];
    other = std::max(0.0, other);  // a step has processor time, its scopes have wall time
  }
  return out;
}

Series sumOf(const std::vector<Phase>& phases) {
  Series out(phases.front().seconds.size(), 0.0);
  for (const Phase& phase : phases) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += phase.seconds[i];
  }
  return out;
}

// The median of each of `count` equal parts: a step that waited for another process does not stand out.
Series mediansOf(const Series& series, std::size_t count) {
  Series out;
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = [&](std::size_t part) {
      return series.begin() + static_cast<std::ptrdiff_t>((part * series.size() + count - 1) / count);
    };
    out.push_back(quantile(Series(at(k), at(k + 1)), 0.5));
  }
  return out;
}

std::string line(const char* format, auto... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

std::string timeline(const std::map<std::string, Series>& series) {
  const auto it = series.find("seconds");
  if (it == series.end() || it->second.empty()) return "timeline: this run has no step\n";
  const std::vector<Phase> phases = phasesOf(series, it->second);
  const Series whole = sumOf(phases);
  const std::size_t columns = std::min(kWidth, whole.size());
  std::vector<Series> tops;  // of each phase on top of those below it, per column
  for (const Phase& phase : phases) {
    Series top = mediansOf(phase.seconds, columns);
    for (std::size_t k = 0; k < columns && !tops.empty(); ++k) top[k] += tops.back()[k];
    tops.push_back(top);
  }
  const double most = *std::max_element(tops.back().begin(), tops.back().end());

  std::string out = line("timeline: ms a step by phases, the median of each column's %zu step%s\n",
                         (whole.size() + columns - 1) / columns, whole.size() > columns ? "s" : "");
  for (std::size_t row = 0; row < kHeight; ++row) {
    const std::string label = row == 0 ? line("%.4g", 1e3 * most) : row == kHeight - 1 ? "0" : "";
    out += std::string(kLabel - std::min(kLabel, label.size()), ' ') + label + " |";
    const double middle = (static_cast<double>(kHeight - row) - 0.5) / static_cast<double>(kHeight) * most;
    for (std::size_t k = 0; k < columns; ++k) {
      const auto phase = std::find_if(tops.begin(), tops.end(), [&](const Series& top) { return top[k] >= middle; });
      out += phase == tops.end() ? ' ' : phases[static_cast<std::size_t>(phase - tops.begin())].letter;
    }
    out += "\n";
  }
  const std::string last = std::to_string(whole.size());
  out += std::string(kLabel + 2, ' ') + "1";
  if (columns > last.size() + 1) out += std::string(columns - last.size() - 1, ' ') + last;
  out += "  step\n";
  for (const char* count : {"awake", "bodies"}) {
    const auto counted = series.find(count);
    if (counted == series.end()) continue;
    const auto [least, largest] = std::minmax_element(counted->second.begin(), counted->second.end());
    out += line("%*s |", static_cast<int>(kLabel), count) + barRows(counted->second, columns, 1)[0] +
           line("  %.4g .. %.4g\n", *least, *largest);
  }
  out += line("%*s  %-20s %10s %14s %14s\n", static_cast<int>(kLabel), "", "phase", "share", "median ms", "largest ms");
  const auto total = [](const Series& x) { return std::accumulate(x.begin(), x.end(), 0.0); };
  const auto row = [&](char letter, const char* name, const Series& seconds) {
    out += line("%*c  %-20s %8.1f %% %14.4g %14.4g\n", static_cast<int>(kLabel), letter, name,
                100 * total(seconds) / total(whole), 1e3 * quantile(seconds, 0.5),
                1e3 * *std::max_element(seconds.begin(), seconds.end()));
  };
  for (const Phase& phase : phases) row(phase.letter, phase.name, phase.seconds);
  row(' ', "step", whole);
  return out;
}

}}  // namespace lpc::LPC_PRECISION
