// SPDX-License-Identifier: Zlib
// Kinds of joints and forces in blocks of a scene.
#include <algorithm>

#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {

// A block without turns may belong to the other dimension.
const Registered& kindOf(StageKind stage, const std::string& name, const SceneNumbers& numbers, int dimension) {
  const auto known = [&](int d) {
    const auto all = Registry::instance().list(stage, d);
    return std::any_of(all.begin(), all.end(), [&](const Registered* r) { return r->info.name == name; });
  };
  const bool other = numbers.rehearsing() && !known(dimension) && known(5 - dimension);
  return Registry::instance().find(stage, other ? 5 - dimension : dimension, name);
}

// A number may be an expression, so the kind tells which parameters are numbers.
Spec readKind(TableReader& block, SceneNumbers& numbers, StageKind stage, int dimension) {
  const std::string text = block.requireString("kind");
  const bool whole = text.find('{') != text.npos;  // with parameters, as a program writes it
  Spec spec = whole ? atBlock(block, [&] { return Spec::parse(text); }) : Spec{text, {}};
  const Registered& kind = *atBlock(block, [&] { return &kindOf(stage, spec.name, numbers, dimension); });
  const toml::table* given = block.table("parameters");
  if (!given) return spec;
  for (const auto& [key, node] : inFileOrder(*given)) {
    bool known = false;
    std::string value = "0";  // of a name that the kind does not know, which it reports itself
    for (const ParamInfo& p : kind.params) {
      if (p.name != key) continue;
      if (!p.choices.empty()) {
        value = node->is_boolean() ? (**node->as_boolean() ? "true" : "false") : node->value_or(std::string("number"));
        // As text it would be read with the part after a comma.
        if (std::find(p.choices.begin(), p.choices.end(), value) == p.choices.end()) {
          block.fail(*node, "'" + key + "' is '" + value + "'" + validNames(p.choices, value));
        }
      } else {
        value = asText(numbers.number(*node));
      }
      known = true;
    }
    if (known && numbers.rehearsing()) continue;  // it has no value
    spec.set(key, {value, {}});
  }
  return spec;
}

void readMixRule(TableReader& table, const std::string& key, MixRule& rule) {
  const std::string name = table.string(key, std::string(kMixRuleNames[static_cast<std::size_t>(rule)]));
  const auto found = std::find(kMixRuleNames.begin(), kMixRuleNames.end(), name);
  if (found == kMixRuleNames.end()) {
    const std::vector<std::string> valid(kMixRuleNames.begin(), kMixRuleNames.end());
    table.fail(table.require(key), "'" + key + "' is '" + name + "'" + validNames(valid, name));
  }
  rule = static_cast<MixRule>(found - kMixRuleNames.begin());
}

}}  // namespace lpc::LPC_PRECISION
