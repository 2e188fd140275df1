// SPDX-License-Identifier: Zlib
#include "experiments/lpc/series_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Range {
  double lo = kNan, hi = kNan;  // of finite values; fmin and fmax skip NaN
};

Range rangeOf(const std::vector<double>& values) {
  Range r;
  for (const double v : values) {
    if (std::isfinite(v)) r.lo = std::fmin(r.lo, v), r.hi = std::fmax(r.hi, v);
  }
  return r;
}

// Ranges of at most `width` equal parts, so that peaks and dips of one step are kept.
std::vector<Range> partsOf(const std::vector<double>& series, std::size_t width) {
  const std::size_t count = std::min(width, series.size());
  std::vector<std::vector<double>> parts(count);
  for (std::size_t i = 0; i < series.size(); ++i) parts[i * count / series.size()].push_back(series[i]);
  std::vector<Range> out;
  for (const std::vector<double>& part : parts) out.push_back(rangeOf(part));
  return out;
}

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string withUnit(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

}  // namespace

std::vector<std::string> barRows(const std::vector<double>& series, std::size_t width, std::size_t height) {
  static constexpr std::array<const char*, 9> kEighths = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const Range range = rangeOf(series);
  const double low = std::fmin(0, range.lo), span = range.hi - low;
  // At least one eighth, so that every value is visible.
  const auto eighthsOf = [&](double value) {
    const double full = 8 * static_cast<double>(height);
    return std::isnan(value) ? 0 : span > 0 ? std::max(1L, std::lround((value - low) / span * full)) : 1;
  };
  std::vector<std::string> rows(height);
  for (const Range& part : partsOf(series, width)) {
    const long top = eighthsOf(part.hi), least = eighthsOf(part.lo);
    for (std::size_t row = 0; row < height; ++row) {
      const long below = 8 * static_cast<long>(height - 1 - row);
      const auto filled = static_cast<std::size_t>(std::clamp(top - below, 0L, 8L));
      rows[row] += filled == 8 && below >= least ? "░" : kEighths[filled];
    }
  }
  return rows;
}

std::string sparkline(const std::string& name, const std::vector<double>& series, const std::string& unit) {
  const Range range = rangeOf(series);
  if (std::isnan(range.lo)) return name + ": no finite value\n";
  std::string label = name;
  label.resize(std::max<std::size_t>(label.size() + 1, 20), ' ');
  return label + barRows(series, 60, 1)[0] + "  " + numberText(range.lo) + " .. " + numberText(range.hi) +
         withUnit(unit) + "\n";
}

std::string plot(const std::string& name, const std::vector<double>& series, const std::string& unit) {
  constexpr std::size_t kWidth = 90, kHeight = 12, kLabel = 11;
  const Range range = rangeOf(series);
  if (std::isnan(range.lo)) return name + ": no finite value\n";
  std::string out = name + withUnit(unit) + "\n";
  const std::vector<std::string> rows = barRows(series, kWidth, kHeight);
  for (std::size_t row = 0; row < kHeight; ++row) {
    std::string label = row == 0 ? numberText(range.hi) : row == kHeight - 1 ? numberText(std::fmin(0, range.lo)) : "";
    out += std::string(kLabel - std::min(kLabel, label.size()), ' ') + label + " |" + rows[row] + "\n";
  }
  const std::string last = std::to_string(series.size());
  const std::size_t columns = std::min(kWidth, series.size());
  out += std::string(kLabel + 2, ' ') + "1";
  if (columns > last.size() + 1) out += std::string(columns - last.size() - 1, ' ') + last;
  return out + "  step\n";
}

}}  // namespace lpc::LPC_PRECISION
