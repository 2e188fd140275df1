// SPDX-License-Identifier: Zlib
// How bodies, joints and forces of a scene are called, and whether a body is there when somebody names it.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "experiments/trial/scene/scene_parsed.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Of a block: its `name`, empty where it has none.
std::string nameOf(TableReader& block);
/// Throws UserError at the line of this key where a body cannot be called so.
void checkName(TableReader& block, const std::string& key, const std::string& name);

/// The names of one kind of thing. A name is of all that have it, in the order in which they were read: "plank[i + 1]",
/// "plank" for the first. "#12" is the thirteenth of the scene's own, whatever it is called: those of its script do not
/// count, so that a script can name who has no name. Of those "##12" is the thirteenth that was read.
class SceneNames {
 public:
  explicit SceneNames(std::string what) : m_what(std::move(what)) {}

  /// A name that is valid, also when nobody has it.
  void know(const std::string& name) { m_named[name]; }
  /// An empty name: it has none.
  void add(const std::string& name, int place) {
    if (!name.empty()) m_named[name].push_back(place);
  }
  void number(int place) { m_numbered.push_back(place); }
  void numberOfScript(int place) { m_ofScript.push_back(place); }
  /// Who was at i is now at place[i]; numbers follow the new places.
  void renumber(const std::vector<int>& place);
  /// Of bodies: Spawn::called.
  template <int D>
  void write(SceneSpec<D>& scene) const;
  /// Whom the text under this key means, as a place. Throws UserError at its line.
  int find(TableReader& block, SceneNumbers& numbers, const std::string& key) const;

 private:
  std::string m_what;
  std::map<std::string, std::vector<int>> m_named;
  std::vector<int> m_numbered, m_ofScript;
};

/// When bodies are named, which must be there then.
template <int D>
class ScenePresence {
 public:
  // Of what stands in no event: before those of its step, or after them.
  static constexpr int kBefore = -1, kAfter = std::numeric_limits<int>::max();

  /// `block`: the number of the event's block, or one of the above.
  void use(int body, long step, int block, const toml::table& place) {
    if (body >= 0) m_uses.push_back({body, {step, block}, &place});
  }
  /// All go.
  void clear(long step, int block) { m_clears.push_back({step, block}); }
  /// Throws UserError at the line of the first who names a body that is not there.
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
