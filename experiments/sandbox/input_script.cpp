// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/input_script.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "experiments/parse/toml_reader.h"
#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class Words { text, number, whole };
struct OrderKind {
  const char* name;
  std::size_t least, most;  // number of words after it
  Words words = Words::text;
  double lowest = 0, highest = 0;  // of numbers
};
constexpr OrderKind kKinds[] = {{"key", 1, 3},
                                {"down", 1, 3},
                                {"up", 1, 3},
                                {"at", 2, 3, Words::number, -1e6, 1e6},
                                {"pixel", 2, 2, Words::number, -1e4, 1e4},
                                {"on", 1, 20},
                                {"press", 1, 1},
                                {"release", 1, 1},
                                {"wheel", 1, 1, Words::whole, -1000, 1000},
                                {"type", 1, 20},
                                {"wait", 1, 1, Words::whole, 0, 1e6},
                                {"until", 1, 1, Words::whole, 0, 1e9},
                                {"shot", 1, 1},
                                {"state", 1, 1},
                                {"drop", 1, 1},
                                {"size", 2, 2, Words::whole, 200, 8000},
                                {"quit", 0, 0}};

// Why the words of an order are invalid; empty if they are valid.
std::string faultOf(const OrderKind& kind, const std::vector<std::string>& words) {
  if (words.size() < kind.least || words.size() > kind.most) {
    return std::to_string(words.size()) + " arguments; valid: " + std::to_string(kind.least) +
           (kind.most > kind.least ? " to " + std::to_string(kind.most) : "");
  }
  for (const std::string& word : words) {
    if (kind.words == Words::text) break;
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    const bool whole = kind.words == Words::whole;
    if (*end || !(value >= kind.lowest && value <= kind.highest) || (whole && value != std::round(value))) {
      return "'" + word + "'; valid: " + (whole ? "a whole number" : "a number") + " from " + asText(kind.lowest) +
             " to " + asText(kind.highest);
    }
  }
  if (std::string_view(kind.name) == "shot" && !words[0].ends_with(".png"))
    return "'" + words[0] + "'; valid: FILE.png";
  return "";
}

}  // namespace

InputScript::InputScript(const std::string& path) : m_path(path) {
  std::ifstream in(path);
  if (!in) throw UserError(path + ": cannot be read: " + std::strerror(errno));
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::istringstream words(text.substr(0, text.find('#')));
    InputOrder order{line, {}, {}};
    words >> order.name;
    if (order.name.empty()) continue;
    for (std::string word; words >> word;) order.words.push_back(word);
    m_orders.push_back(order);
    m_next = m_orders.size() - 1;  // for the message
    const auto kind =
        std::find_if(std::begin(kKinds), std::end(kKinds), [&](const OrderKind& k) { return k.name == order.name; });
    if (kind == std::end(kKinds)) {
      std::vector<std::string> names;
      for (const OrderKind& k : kKinds) names.emplace_back(k.name);
      fail("unknown order '" + order.name + "'" + validNames(names, order.name));
    }
    const std::string fault = faultOf(*kind, order.words);
    if (!fault.empty()) fail("'" + order.name + "' has " + fault);
  }
  m_next = 0;
}

void InputScript::fail(const std::string& why) const {
  throw UserError(m_path + ":" + std::to_string(m_orders[m_next].line) + ": " + why);
}

}}  // namespace lpc::LPC_PRECISION
