// SPDX-License-Identifier: Zlib
#include "framework/stage/spec.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "framework/math/names.h"
#include "framework/math/nesting.h"
#include "framework/stage/registry.h"

namespace lpc {
namespace {

// spec := name [ '{' [ key '=' spec { ',' key '=' spec } ] '}' ]
// A sweep's placeholders, `*` and `$axis`, may replace a name or value. No algorithm has such a name, so a placeholder
// left over is rejected with the valid names.
class Parser {
 public:
  explicit Parser(std::string_view text) : m_text(text) {}

  Spec spec(int depth = 0) {
    Spec s{word("a name or value"), {}};
    if (!take('{')) return s;
    if (depth == kMostNested) fail("nested more than " + std::to_string(kMostNested) + " deep");
    if (take('}')) return s;
    do {
      const std::string key = word("a parameter name");
      if (s.find(key)) fail("parameter '" + key + "' is given twice");
      if (!take('=')) fail("'=' is missing after '" + key + "'");
      s.fields.push_back({key, spec(depth + 1)});
    } while (take(','));
    if (!take('}')) fail("',' or '}' is missing");
    return s;
  }
  bool atEnd() {
    skipSpace();
    return m_at == m_text.size();
  }
  bool take(char c) {
    skipSpace();
    if (m_at == m_text.size() || m_text[m_at] != c) return false;
    ++m_at;
    return true;
  }
  std::string word(const char* what) {
    skipSpace();
    const std::size_t begin = m_at;
    while (m_at < m_text.size() && (std::isalnum(static_cast<unsigned char>(m_text[m_at])) ||
                                    std::string_view("_.+-*$").find(m_text[m_at]) != std::string_view::npos)) {
      ++m_at;
    }
    if (m_at == begin) fail(std::string(what) + " is missing");
    return std::string(m_text.substr(begin, m_at - begin));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw UserError("'" + std::string(m_text) + "', character " + std::to_string(m_at + 1) + ": " + what);
  }

 private:
  void skipSpace() {
    while (m_at < m_text.size() && std::isspace(static_cast<unsigned char>(m_text[m_at]))) ++m_at;
  }
  std::string_view m_text;
  std::size_t m_at = 0;
};

[[noreturn]] void failStage(Parser& p, const std::string& key) {
  if (const StageInfo* stage = stageByName(key)) {
    p.fail(placeInPipeline(*stage, p.take('=') ? p.spec().text() : "NAME"));
  }
  std::vector<std::string> names;
  for (const StageKind kind : kWorldStages) names.emplace_back(stageName(kind));
  p.fail("unknown stage '" + key + "'" + validNames(names, key));
}

}  // namespace

Spec Spec::parse(std::string_view text) {
  Parser p(text);
  Spec s = p.spec();
  if (!p.atEnd()) p.fail("unexpected text after the end");
  return s;
}

std::string Spec::text() const {
  std::string out = name;
  if (fields.empty()) return out;
  char separator = '{';
  for (const auto& [key, value] : fields) {
    out += separator + key + '=' + value.text();
    separator = ',';
  }
  return out + '}';
}

bool Spec::operator==(const Spec& other) const { return name == other.name && fields == other.fields; }

const Spec* Spec::find(std::string_view key) const {
  for (const auto& [k, value] : fields) {
    if (k == key) return &value;
  }
  return nullptr;
}

void Spec::set(std::string_view key, Spec value) {
  for (auto& [k, old] : fields) {
    if (k == key) {
      old = std::move(value);
      return;
    }
  }
  fields.push_back({std::string(key), std::move(value)});
}

Pipeline::Pipeline() {
  for (const StageKind stage : kWorldStages) (*this)[stage].name = stageInfo(stage).worldDefault;
}

Spec& Pipeline::operator[](StageKind stage) {
  LPC_ASSERT(isWorldStage(&stageInfo(stage)));
  return m_specs[stage];
}
const Spec& Pipeline::operator[](StageKind stage) const { return const_cast<Pipeline&>(*this)[stage]; }

Pipeline Pipeline::parse(std::string_view text) {
  Pipeline pipeline;
  pipeline.replace(text);
  return pipeline;
}

std::vector<StageKind> Pipeline::replace(std::string_view text) {
  std::vector<StageKind> named;
  Parser p(text);
  while (!p.atEnd()) {
    const std::string key = p.word("a stage");
    const StageInfo* stage = stageByName(key);
    if (!isWorldStage(stage)) failStage(p, key);
    if (std::find(named.begin(), named.end(), stage->kind) != named.end()) p.fail("stage '" + key + "' is given twice");
    named.push_back(stage->kind);
    if (!p.take('=')) p.fail("'=' is missing after '" + key + "'");
    (*this)[stage->kind] = p.spec();
  }
  return named;
}

std::string Pipeline::text() const {
  std::string out;
  for (const StageKind stage : kWorldStages) {
    out += (out.empty() ? "" : " ") + std::string(stageName(stage)) + '=' + (*this)[stage].text();
  }
  return out;
}

std::optional<Spec> engineOf(std::string_view pipelineText) {
  constexpr std::string_view kKey = "engine=";
  pipelineText.remove_prefix(std::min(pipelineText.find_first_not_of(' '), pipelineText.size()));
  if (!pipelineText.starts_with(kKey)) return std::nullopt;
  return Spec::parse(pipelineText.substr(kKey.size()));
}

}  // namespace lpc
