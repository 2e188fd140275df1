// SPDX-License-Identifier: Zlib
// Names of bodies, joints and forces of a scene, and checks that a named body exists at that time.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "experiments/trial/scene/scene_parsed.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The block's `name`; empty if it has none.
std::string nameOf(TableReader& block);
/// Throws UserError at the line of this key if a body cannot have this name.
void checkName(TableReader& block, const std::string& key, const std::string& name);

/// The names of one kind of object. A name stands for all objects with it, in the order in which they were read:
/// "plank[i + 1]", "plank" for the first. "#12" is the thirteenth object of the scene itself, whatever its name;
/// objects of its script do not count, so a script can refer to unnamed objects. "##12" is the thirteenth object that
/// the script read.
class SceneNames {
 public:
  explicit SceneNames(std::string what) : m_what(std::move(what)) {}

  /// Declares a valid name, which no object need have.
  void know(const std::string& name) { m_named[name]; }
  /// An empty name: the object has none.
  void add(const std::string& name, int place) {
    if (!name.empty()) m_named[name].push_back(place);
  }
  void number(int place) { m_numbered.push_back(place); }
  void numberOfScript(int place) { m_ofScript.push_back(place); }
  /// The object at i is now at place[i]; numbers follow the new places.
  void renumber(const std::vector<int>& place);
  /// For bodies: Spawn::called.
  template <int D>
  void write(SceneSpec<D>& scene) const;
  /// The object that the text under this key names, as an index. Throws UserError at its line.
  int find(TableReader& block, SceneNumbers& numbers, const std::string& key) const;

 private:
  std::string m_what;
  std::map<std::string, std::vector<int>> m_named;
  std::vector<int> m_numbered, m_ofScript;
};

/// Checks that bodies exist at the times when they are named.
template <int D>
class ScenePresence {
 public:
  // For blocks other than events: before the events of its step, or after them.
  static constexpr int kBefore = -1, kAfter = std::numeric_limits<int>::max();

  /// `block`: the number of the event's block, or one of the constants above.
  void use(int body, long step, int block, const toml::table& place) {
    if (body >= 0) m_uses.push_back({body, {step, block}, &place});
  }
  /// All bodies are removed.
  void clear(long step, int block) { m_clears.push_back({step, block}); }
  /// Throws UserError at the line of the first use of a body that does not exist then.
  void check(const SceneSpec<D>& scene, const std::string& file);

 private:
  using When = std::pair<long, int>;  // step, block
  struct Use {
    int body;
    When when;
    const toml::table* place;
  };
  std::vector<Use> m_uses;
  std::vector<When> m_clears;
};

}}  // namespace lpc::LPC_PRECISION
