// SPDX-License-Identifier: Zlib
// Planted bugs of contact graphs.
#pragma once

#include <algorithm>
#include <array>

#include "framework/problem/contact_graph.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

struct GraphInput {
  Bodies<2> bodies;
  std::vector<Manifold<2>> manifolds;
  std::vector<JointRecord<2>> joints;
  std::vector<int> contacts;  // the contacts to colour

  bool node(int body) const {
    const auto i = static_cast<std::size_t>(body);
    return bodies.used[i] && bodies.type[i] == BodyType::dynamic;
  }
};
struct GraphAnswers {
  std::vector<std::int32_t> islands, groups, levels;
  std::vector<int> order, offsets;
  bool operator==(const GraphAnswers&) const = default;
};
enum class Asked { islands, groups, levels, colours };
inline constexpr std::array kEachOnce = {Asked::islands, Asked::groups, Asked::levels, Asked::colours};

inline GraphAnswers answersOf(const GraphInput& in, std::span<const Asked> questions = kEachOnce) {
  WorkDone work;
  ContactGraph<2> graph;
  graph.reset(in.bodies, in.manifolds, in.joints, work);
  GraphAnswers out;
  const auto copy = [](std::span<const std::int32_t> s) { return std::vector<std::int32_t>(s.begin(), s.end()); };
  for (const Asked q : questions) {
    if (q == Asked::islands) out.islands = copy(graph.islands());
    if (q == Asked::groups) out.groups = copy(graph.jointedGroups());
    if (q == Asked::levels) out.levels = copy(graph.supportLevels());
    if (q == Asked::colours) graph.colour(in.contacts, out.order, out.offsets);
  }
  return out;
}

/// The ground connects the bodies on it.
inline GraphAnswers throughTheGround(const GraphInput& in) {
  GraphInput all = in;
  for (BodyType& type : all.bodies.type) type = BodyType::dynamic;
  return answersOf(all);
}
inline GraphAnswers withoutJoints(const GraphInput& in) {
  GraphInput some = in;
  some.joints.clear();
  return answersOf(some);
}
inline GraphAnswers throughBrokenJoints(const GraphInput& in) {
  GraphInput all = in;
  for (JointRecord<2>& j : all.joints) j.broken = 0;
  return answersOf(all);
}
/// Ignores vetoes.
inline GraphAnswers hearsNoVeto(const GraphInput& in) {
  GraphInput all = in;
  for (Manifold<2>& m : all.manifolds) m.ignored = 0;
  return answersOf(all);
}
/// Contacts connect body A to body B only: a body reached from two sides keeps its first number.
inline GraphAnswers cutsIslands(const GraphInput& in) {
  GraphAnswers out = answersOf(in);
  std::fill(out.islands.begin(), out.islands.end(), -1);
  std::int32_t next = 0;
  for (int i = 0; i < in.bodies.size(); ++i) {
    if (!in.node(i)) continue;
    std::int32_t& mine = out.islands[static_cast<std::size_t>(i)];
    if (mine < 0) mine = next++;
    for (const Manifold<2>& m : in.manifolds) {
      if (m.bodyA == i && !m.ignored && in.node(m.bodyB)) out.islands[static_cast<std::size_t>(m.bodyB)] = mine;
    }
  }
  return out;
}
/// Depth first: a body's level is the length of the path that found it, not of the shortest one.
inline GraphAnswers skipsLevels(const GraphInput& in) {
  GraphAnswers out = answersOf(in);
  for (std::int32_t& level : out.levels) level = std::min(level, 0);
  const auto climb = [&](const auto& self, int body) -> void {
    for (const Manifold<2>& m : in.manifolds) {
      if (m.ignored || (m.bodyA != body && m.bodyB != body)) continue;
      const int other = m.bodyA == body ? m.bodyB : m.bodyA;
      if (!in.node(other) || out.levels[static_cast<std::size_t>(other)] >= 0) continue;
      out.levels[static_cast<std::size_t>(other)] = out.levels[static_cast<std::size_t>(body)] + 1;
      self(self, other);
    }
  };
  for (int i = 0; i < in.bodies.size(); ++i) {
    if (in.bodies.used[static_cast<std::size_t>(i)] && !in.node(i)) climb(climb, i);
  }
  return out;
}
/// Checks body A only: two contacts of one body share a colour.
inline GraphAnswers coloursByOneBody(const GraphInput& in) {
  GraphInput half = in;
  for (Manifold<2>& m : half.manifolds) {
    if (half.node(m.bodyA)) m.bodyB = m.bodyA;
  }
  GraphAnswers out = answersOf(in);
  const GraphAnswers wrong = answersOf(half);
  out.order = wrong.order, out.offsets = wrong.offsets;
  return out;
}
/// A colour for each contact: correct, but useless.
inline GraphAnswers coloursEach(const GraphInput& in) {
  GraphAnswers out = answersOf(in);
  out.order = in.contacts;
  out.offsets.clear();
  for (std::size_t i = 0; i <= in.contacts.size(); ++i) out.offsets.push_back(static_cast<int>(i));
  return out;
}
/// The last contact is forgotten.
inline GraphAnswers coloursAllButOne(const GraphInput& in) {
  GraphInput some = in;
  if (!some.contacts.empty()) some.contacts.pop_back();
  return answersOf(some);
}

}}}  // namespace lpc::LPC_PRECISION::test
