// SPDX-License-Identifier: Zlib
#include "framework/math/names.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace lpc {
namespace {

constexpr std::size_t kLongestQuote = 400, kLongestMessage = 1500;  // bytes; a whole pipeline has about 350

// Normalises a name: case and kind of separator do not count.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name) {
    out += c == '-' || c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

// Edit distance of a and b: letters to insert, delete, change or swap with a neighbour (optimal string alignment).
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

// Number of bytes of a printable character at the front; 0: it is not printable.
std::size_t shown(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xc0u) == 0x80u; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return first >= 0x20 && first != 0x7f;
  if (first < 0xc2 || first > 0xf4 || !follows(1)) return 0;
  if (first < 0xe0) return first == 0xc2 && second < 0xa0 ? 0 : 2;  // C2 80 to C2 9F are control characters
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) || !follows(2)) return 0;
  if (first == 0xe2 && second == 0x80 && (byte(2) == 0xa8 || byte(2) == 0xa9)) return 0;  // line separators
  if (first < 0xf0) return 3;
  return (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90) || !follows(3) ? 0 : 4;
}

std::string cutTo(std::size_t most, const std::string& text) {
  if (text.size() <= most) return text;
  const std::size_t kept = most - 40;  // the rest is for the text between, so that a cut text is not cut again
  std::size_t head = kept * 2 / 3, tail = text.size() - kept / 3;
  const auto within = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xc0u) == 0x80u; };
  while (within(head)) --head;
  while (tail < text.size() && within(tail)) ++tail;
  return text.substr(0, head) + " ... (" + std::to_string(tail - head) + " bytes) ... " + text.substr(tail);
}

}  // namespace

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

std::string meantName(const std::vector<std::string>& names, std::string_view given) {
  if (given.size() > 100) return "";  // not a typing error; and the table below would be quadratic in size
  const std::string asked = plain(given);
  std::string best, holding;
  std::size_t fewest = std::max<std::size_t>(1, asked.size() / 3) + 1;  // more changes than this make another word
  for (const std::string& name : names) {
    if (name == given) return "";  // the name is right; the error is elsewhere
    const std::string known = plain(name);
    const std::size_t more = known.size() > asked.size() ? known.size() - asked.size() : 0;
    const std::size_t n = more < fewest ? slips(asked, known) : more;
    if (n < fewest && n < known.size()) fewest = n, best = name;
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

std::string oneLine(std::string_view message) {
  std::string out;
  while (!message.empty()) {
    if (const std::size_t n = shown(message); n > 0) {
      out += message.substr(0, n), message.remove_prefix(n);
      continue;
    }
    char code[8];
    std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(message[0])));
    out += message[0] == '\n' ? "\\n" : message[0] == '\t' ? "\\t" : code;
    message.remove_prefix(1);
  }
  // First shorten each quote alone, so that the text between two quotes stays, then the whole.
  std::string cut;
  std::size_t begin = 0;
  for (std::size_t quote = out.find('\''); quote != out.npos; quote = out.find('\'', begin)) {
    cut += cutTo(kLongestQuote, out.substr(begin, quote - begin)) + "'";
    begin = quote + 1;
  }
  cut += out.substr(begin);
  return cutTo(kLongestMessage, cut);
}

}  // namespace lpc
