// SPDX-License-Identifier: Zlib
#include "framework/names.h"

#include <algorithm>
#include <cctype>

namespace lpc {
namespace {

// As people mix them up: neither case nor the sort of separator counts.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name) {
    out += c == '-' || c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

// Letters to put in, leave out, change or swap with their neighbour, until a is b (optimal string alignment).
std::size_t slips(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last, last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

std::string meantName(const std::vector<std::string>& names, std::string_view given) {
  const std::string asked = plain(given);
  std::string best, holding;
  std::size_t fewest = std::max<std::size_t>(1, asked.size() / 3) + 1;  // of so many, that is another word
  for (const std::string& name : names) {
    if (name == given) return "";  // it is right: something else is wrong
    const std::string known = plain(name);
    if (const std::size_t n = slips(asked, known); n < fewest && n < known.size()) fewest = n, best = name;
    if (asked.size() < 3) continue;
    if (known.starts_with(asked) && !plain(holding).starts_with(asked)) holding = name;
    if (holding.empty() && known.find(asked) != known.npos) holding = name;
  }
  return best.empty() ? holding : best;
}

std::string validNames(const std::vector<std::string>& names, std::string_view given) {
  if (names.empty()) return "; valid: none";
  const std::string meant = meantName(names, given);
  return (meant.empty() ? "; valid: " : "; did you mean '" + meant + "'? valid: ") + joined(names);
}

}  // namespace lpc
