// SPDX-License-Identifier: Zlib
#include "experiments/trial/scene/scene_names.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {

std::string nameOf(TableReader& block) {
  std::string name = block.string("name", "");
  checkName(block, "name", name);
  return name;
}

void checkName(TableReader& block, const std::string& key, const std::string& name) {
  if (name != "world" && name.find('[') == name.npos && !name.starts_with('#')) return;
  block.fail(*block.find(key),
             "'" + key + "' is '" + name + "'; valid: any name except 'world', without '[' and leading '#'");
}

void SceneNames::renumber(const std::vector<int>& place) {
  const auto moved = [&](int i) { return place[static_cast<std::size_t>(i)]; };
  for (auto& [name, list] : m_named) std::transform(list.begin(), list.end(), list.begin(), moved);
  for (auto* list : {&m_numbered, &m_ofScript}) std::transform(list->begin(), list->end(), list->begin(), moved);
  std::sort(m_numbered.begin(), m_numbered.end());
}

// A continued script adds bodies, which are read before those made of others (`take_apart`). The latter have names,
// whose order does not change.
template <int D>
void SceneNames::write(SceneSpec<D>& scene) const {
  const auto call = [&](const std::vector<int>& list, const std::string& before, const std::string& after) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      scene.spawns.at(static_cast<std::size_t>(list[i])).called = before + std::to_string(i) + after;
    }
  };
  call(m_ofScript, "##", "");
  for (const auto& [name, list] : m_named) call(list, name + "[", "]");
  call(m_numbered, "#", "");
}
template void SceneNames::write(SceneSpec<2>&) const;
template void SceneNames::write(SceneSpec<3>&) const;

int SceneNames::find(TableReader& block, SceneNumbers& numbers, const std::string& key) const {
  const toml::node& node = block.require(key);
  const std::string text = block.requireString(key), many = m_what == "body" ? "bodies" : m_what + "s";
  if (text.starts_with('#')) {
    const bool ofScript = text.starts_with("##");
    const std::string sign = ofScript ? "##" : "#";
    const std::vector<int>& list = ofScript ? m_ofScript : m_numbered;
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data() + sign.size(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || number >= list.size()) {
      block.fail(node, "'" + key + "' is '" + text + "', and the " + (ofScript ? "script" : "scene") + " has " +
                           std::to_string(list.size()) + " " + many + " of its own; valid: " + sign +
                           "0 for the first, and so on");
    }
    return numbers.rehearsing() ? 0 : list[number];
  }
  const std::size_t bracket = text.find('[');
  const auto it = m_named.find(text.substr(0, bracket));
  if (it == m_named.end()) {
    std::vector<std::string> names;
    for (const auto& [name, list] : m_named) names.push_back(name);
    block.fail(node, "unknown " + m_what + " '" + text + "'" + validNames(names, text));
  }
  double index = 0;
  if (bracket != std::string::npos) {
    if (text.back() != ']') block.fail(node, "']' is missing in '" + text + "'");
    try {
      const std::string inside = text.substr(bracket + 1, text.size() - bracket - 2);
      if (numbers.rehearsing()) numbers.expressions.check(inside);
      if (!numbers.rehearsing()) index = numbers.expressions.evaluate(inside);
    } catch (const UserError& e) {
      block.fail(node, e.what());
    }
  }
  if (numbers.rehearsing()) return 0;
  if (index < 0 || index >= static_cast<double>(it->second.size()) || index != std::floor(index)) {
    block.fail(node, "'" + it->first + "' has " + std::to_string(it->second.size()) + " " + many + "; asked: number " +
                         asText(index));
  }
  return it->second[static_cast<std::size_t>(index)];
}

template <int D>
void ScenePresence<D>::check(const SceneSpec<D>& scene, const std::string& file) {
  std::sort(m_clears.begin(), m_clears.end());
  for (const Use& use : m_uses) {
    const auto& spawn = scene.spawns[static_cast<std::size_t>(use.body)];
    const When comes(spawn.step, spawn.addedBy);
    When goes(spawn.removeAt, spawn.removedBy >= 0 ? spawn.removedBy : kAfter);
    const auto cleared = std::lower_bound(m_clears.begin(), m_clears.end(), comes);
    const bool byClear = cleared != m_clears.end() && (spawn.removeAt < 0 || *cleared < goes);
    if (byClear) goes = *cleared;
    const std::string subject =
        "at step " + std::to_string(use.when.first) + " '" + spawn.body.name + "' does not exist: it ";
    if (use.when < comes) {
      failAt(file, *use.place,
             subject + "is added at " + std::to_string(comes.first) +
                 (use.when.first == comes.first ? ", by a later event of the file" : ""));
    }
    if ((byClear || spawn.removeAt >= 0) && use.when > goes) {
      failAt(file, *use.place, subject + (byClear ? "is cleared at " : "is removed at ") + std::to_string(goes.first));
    }
  }
}

template class ScenePresence<2>;
template class ScenePresence<3>;

}}  // namespace lpc::LPC_PRECISION
