// SPDX-License-Identifier: Zlib
#include "experiments/runner/message_place.h"

#include <algorithm>
#include <cctype>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::vector<std::string> quotedIn(const std::string& message) {
  const std::string found = message.substr(0, message.find("; "));  // valid names follow
  std::vector<std::string> out;
  for (std::size_t open = found.find('\''); open != found.npos; open = found.find('\'', open + 1)) {
    const std::size_t close = found.find('\'', open + 1);
    if (close == found.npos) break;
    out.push_back(found.substr(open + 1, close - open - 1));
    open = close;
  }
  return out;
}

// As a separate word: `iteration` is not in "iterations=4".
bool hasWord(const std::string& text, const std::string& word) {
  const auto inName = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_');
  };
  for (std::size_t at = text.find(word); at != text.npos && !word.empty(); at = text.find(word, at + 1)) {
    if (!(at > 0 && inName(at - 1)) && !inName(at + word.size())) return true;
  }
  return false;
}

}  // namespace

void failWhereWritten(const std::string& file, const std::string& message, const std::vector<WrittenText>& texts,
                      const toml::node& otherwise) {
  const std::vector<std::string> names = quotedIn(message);
  const WrittenText* place = nullptr;
  long most = 0;
  for (const WrittenText& t : texts) {
    const bool named = std::find(names.begin(), names.end(), t.name) != names.end();
    const long held = std::count_if(names.begin(), names.end(),
                                    [&](const std::string& name) { return name == t.name || hasWord(t.text, name); });
    if (2 * held + named > most) most = 2 * held + named, place = &t;
  }
  for (const WrittenText& t : texts) {
    if (!place && !t.given.empty() && hasWord(message, t.name)) place = &t;
  }
  if (place && !place->given.empty()) throw UserError(place->given + ": " + message);
  failAt(file, place ? *place->node : otherwise, message);
}

}}  // namespace lpc::LPC_PRECISION
