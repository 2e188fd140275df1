// SPDX-License-Identifier: Zlib
// Table entries for layouts of boxes and ways of drawing pairs. One entry is a struct with a name, a meaning,
// parameters and its function. Plans, errors and `lpc list` read the table.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "framework/math/names.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

struct EntryInfo {
  std::string name;  // never changes: result files contain it
  std::string meaning;
  std::vector<ParamInfo> params;
  std::function<Spec(const Spec&)> canonical;  // with every parameter written out; throws UserError for a wrong one
};

/// E has kName, kMeaning and visit(ParamVisitor&).
template <class E>
E readEntry(const Spec& spec) {
  E entry;
  readParams(spec, E::kName, [&](ParamVisitor& v) { entry.visit(v); });
  return entry;
}

template <class E>
EntryInfo entryInfo() {
  E defaults;
  return {E::kName, E::kMeaning, describeParams([&](ParamVisitor& v) { defaults.visit(v); }), [](const Spec& spec) {
            E entry = readEntry<E>(spec);
            return canonicalSpec(E::kName, 2, [&](ParamVisitor& v) { entry.visit(v); });  // no stages: any dimension
          }};
}

/// Throws UserError with the valid names. `what`: the kind of entry, for the message.
template <class Entry>
const Entry& findEntry(const std::vector<Entry>& table, const std::string& what, const std::string& name) {
  const auto it = std::find_if(table.begin(), table.end(), [&](const Entry& e) { return e.info.name == name; });
  if (it != table.end()) return *it;
  std::vector<std::string> names;
  for (const Entry& e : table) names.push_back(e.info.name);
  throw UserError("unknown " + what + " '" + name + "'" + validNames(names, name));
}

}}  // namespace lpc::LPC_PRECISION
