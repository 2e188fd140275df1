// SPDX-License-Identifier: Zlib
#pragma once

#include <charconv>
#include <vector>

#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// The default, each value of each choice, and both ends of each range.
inline std::vector<Spec> variants(const Registered& algorithm) {
  std::vector<Spec> out = {{algorithm.info.name, {}}};
  const auto add = [&](const std::string& key, const std::string& value) {
    Spec spec{algorithm.info.name, {}};
    spec.set(key, {value, {}});
    out.push_back(std::move(spec));
  };
  for (const ParamInfo& p : algorithm.params) {
    for (const std::string& choice : p.choices) add(p.name, choice);
    if (!p.range) continue;
    for (const double end : {p.range->lo, p.range->hi}) {
      char text[32];
      const bool whole = p.type == "integer";
      const auto last = whole ? std::to_chars(text, text + sizeof text, static_cast<long>(end)).ptr
                              : std::to_chars(text, text + sizeof text, static_cast<Real>(end)).ptr;
      add(p.name, {text, last});
    }
  }
  // Each choice with the other parameters at their ends: a mode may read parameters that the default ignores.
  const std::size_t single = out.size();
  for (std::size_t i = 1; i < single; ++i) {
    for (const ParamInfo& p : algorithm.params) {
      if (p.type != "choice" || out[i].find(p.name)) continue;
      for (const std::string& choice : p.choices) {
        Spec both = out[i];
        both.set(p.name, {choice, {}});
        out.push_back(std::move(both));
      }
    }
  }
  return out;
}

}}}  // namespace lpc::LPC_PRECISION::test
