// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/input_script.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

struct OrderKind {
  const char* name;
  std::size_t least, most;  // number of words after it
};
constexpr OrderKind kKinds[] = {{"key", 1, 3},  {"down", 1, 3},  {"up", 1, 3},      {"at", 2, 3},    {"pixel", 2, 2},
                                {"on", 1, 20},  {"press", 1, 1}, {"release", 1, 1}, {"wheel", 1, 1}, {"type", 1, 20},
                                {"wait", 1, 1}, {"until", 1, 1}, {"shot", 1, 1},    {"state", 1, 1}, {"drop", 1, 1},
                                {"size", 2, 2}, {"quit", 0, 0}};

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
    if (order.words.size() < kind->least || order.words.size() > kind->most) {
      fail("'" + order.name + "' has " + std::to_string(order.words.size()) + " arguments; valid: " +
           std::to_string(kind->least) + (kind->most > kind->least ? " to " + std::to_string(kind->most) : ""));
    }
  }
  m_next = 0;
}

void InputScript::fail(const std::string& why) const {
  throw UserError(m_path + ":" + std::to_string(m_orders[m_next].line) + ": " + why);
}

}}  // namespace lpc::LPC_PRECISION
