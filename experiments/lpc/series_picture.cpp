// SPDX-License-Identifier: Zlib
#include "experiments/lpc/series_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Values = std::vector<double>;
struct Curve {
  const char *name, *colour;
  Values values;
};
constexpr double kFrom = 90, kAcross = 600, kHead = 24, kDown = 110, kPanel = 170;  // px

std::string axisText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string markupText(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return out;
}

// From the smaller of 0 and the smallest value to the largest one.
void putPanel(std::ostream& out, double top, const char* name, const std::vector<Curve>& lines, double dt) {
  double lo = 0, hi = 0;
  for (const Curve& line : lines) {
    for (const double v : line.values) {
      if (std::isfinite(v)) lo = std::min(lo, v), hi = std::max(hi, v);
    }
  }
  const double span = hi > lo ? hi - lo : 1;
  const std::size_t steps = lines.front().values.size();
  const auto text = [&](double x, double y, const char* anchor, const std::string& words, const char* colour) {
    out << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\" fill=\"" << colour << "\">"
        << markupText(words) << "</text>\n";
  };
  text(kFrom, top - 8, "start", name, "#000000");
  double end = kFrom + kAcross;
  for (auto line = lines.rbegin(); lines.size() > 1 && line != lines.rend(); ++line) {
    text(end, top - 8, "end", line->name, line->colour);
    end -= 14 + 7 * static_cast<double>(std::string_view(line->name).size());
  }
  out << "<rect x=\"" << kFrom << "\" y=\"" << top << "\" width=\"" << kAcross << "\" height=\"" << kDown
      << "\" fill=\"none\" stroke=\"#999999\"/>\n";
  if (hi > lo) text(kFrom - 6, top + 10, "end", axisText(hi), "#000000");
  text(kFrom - 6, top + kDown, "end", axisText(lo), "#000000");
  text(kFrom, top + kDown + 15, "middle", "0", "#000000");
  text(kFrom + kAcross, top + kDown + 15, "end", axisText(static_cast<double>(steps) * dt) + " s", "#000000");
  for (const Curve& line : lines) {
    out << "<path fill=\"none\" stroke=\"" << line.colour << "\" stroke-width=\"1.5\" d=\"";
    bool drawn = false;
    for (std::size_t i = 0; i < steps; ++i) {
      if (!std::isfinite(line.values[i])) {
        drawn = false;
        continue;
      }
      out << (drawn ? "L" : "M") << kFrom + kAcross * static_cast<double>(i + 1) / static_cast<double>(steps) << " "
          << top + kDown * (lo + span - line.values[i]) / span;
      if (!drawn) out << "h0";  // a lone value is a dot
      drawn = true;
    }
    out << "\" stroke-linecap=\"round\"/>\n";
  }
}

// Lines of whole words, as wide as the picture.
std::vector<std::string> linesOf(const std::string& text) {
  constexpr std::size_t kLetters = 100;
  std::vector<std::string> out = {""};
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!out.back().empty() && out.back().size() + word.size() > kLetters) out.emplace_back();
    out.back() += (out.back().empty() ? "" : " ") + word;
  }
  return out;
}

}  // namespace

std::string seriesPicture(const std::string& title, const std::map<std::string, Values>& series, double dt) {
  const auto of = [&](const char* name) {
    const auto it = series.find(name);
    return it == series.end() ? Values() : it->second;
  };
  const Values kinetic = of("kinetic"), potential = of("potential");
  Values sum = kinetic;
  for (std::size_t i = 0; i < std::min(sum.size(), potential.size()); ++i) sum[i] += potential[i];
  const std::pair<const char*, std::vector<Curve>> panels[] = {
      {"energy (J)", {{"kinetic", "#c05020", kinetic}, {"kinetic + potential of gravity", "#146ea0", sum}}},
      {"largest penetration (m)", {{"", "#146ea0", of("max_penetration")}}},
      {"speed of the fastest body (m/s)", {{"", "#146ea0", of("max_speed")}}}};
  std::ostringstream drawn;
  double y = 20;
  for (const std::string& line : linesOf(title)) {
    drawn << "<text x=\"10\" y=\"" << y << "\">" << markupText(line) << "</text>\n";
    y += 15;
  }
  double top = y + kHead;
  for (const auto& [name, lines] : panels) {
    if (lines[0].values.empty()) continue;
    putPanel(drawn, top, name, lines, dt);
    top += kPanel;
  }
  std::ostringstream out;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100%\" viewBox=\"0 0 " << kFrom + kAcross + 20 << " "
      << top - 10 << "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
      << "fill=\"#ffffff\"/>\n"
      << drawn.str() << "</svg>\n";
  return out.str();
}

}}  // namespace lpc::LPC_PRECISION
