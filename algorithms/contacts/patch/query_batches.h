// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>

#include "algorithms/contacts/patch/contact_patch.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// Runs a nested pair query on many pairs, sorted by kinds; answers come in the order of the kinds.
template <int D>
class QueryBatches {
 public:
  explicit QueryBatches(const Spec& query) : m_query(createStage<PairQuery<D>>(query)) {}

  bool remembers() const { return m_query->remembers(); }
  bool supports(ShapeKind a, ShapeKind b) const { return m_query->supports(std::min(a, b), std::max(a, b)); }

  /// Calls use(placed, answer) for each pair within the margin. The answer is that of the shapes, not of their cores,
  /// and always has a unit normal.
  template <class Use>
  void run(const ContactInput<D>& in, Real bias, WorkDone& work, const Use& use) {
    for (const std::size_t kinds : m_used) m_groups[kinds].clear();
    m_used.clear(), m_placed.clear();
    for (std::size_t i = 0; i < in.pairs.size(); ++i) {
      m_placed.push_back(placePair(in, in.pairs[i], bias));
      const auto k1 = static_cast<std::size_t>(m_placed.back().view1().kind);
      const auto k2 = static_cast<std::size_t>(m_placed.back().view2().kind);
      const std::size_t kinds = kShapeKinds * k1 + k2;
      if (m_groups[kinds].empty()) m_used.push_back(kinds);
      m_groups[kinds].push_back(i);
    }
    std::sort(m_used.begin(), m_used.end());
    for (const std::size_t kinds : m_used) {
      const auto& group = m_groups[kinds];
      ask(in, group, work);
      for (std::size_t i = 0; i < group.size(); ++i) {
        const PlacedPair<D>& placed = m_placed[group[i]];
        PairAnswer<D>& answer = m_answers[i];
        if (answer.status == QueryStatus::refused || answer.status == QueryStatus::failed) continue;
        if (!(answer.distance <= in.margin)) continue;
        if (!(answer.normal.squaredNorm() > 0)) {  // the method gave no normal: use the direction between the centres
          const Real length = placed.X_12.p.norm();
          answer.normal = length > 0 ? Vec<D>(placed.X_12.p / length) : Vec<D>(Vec<D>::Unit(0));
        }
        use(placed, answer);
      }
    }
  }

 private:
  void ask(const ContactInput<D>& in, std::span<const std::size_t> pairs, WorkDone& work) {
    m_views.clear(), m_memory.clear();
    for (std::size_t i : pairs) {
      m_views.push_back({m_placed[i].view1(), m_placed[i].view2(), m_placed[i].X_12});
      if (!in.memory.empty()) m_memory.push_back(in.memory[i]);
    }
    m_answers.assign(pairs.size(), {});
    m_query->query(m_views, QueryNeed::closestPoints, m_answers, m_memory, work);
    for (std::size_t i = 0; i < m_memory.size(); ++i) in.memory[pairs[i]] = m_memory[i];
  }

  std::unique_ptr<PairQuery<D>> m_query;
  std::array<std::vector<std::size_t>, kShapeKinds * kShapeKinds> m_groups;
  std::vector<std::size_t> m_used;  // batches that are not empty
  std::vector<PlacedPair<D>> m_placed;
  std::vector<PairView<D>> m_views;
  std::vector<PairAnswer<D>> m_answers;
  std::vector<PairMemory> m_memory;
};

/// A query's answer as a contact point of the cores, in frame 1 like the answer.
template <int D>
PatchPoint<D> witnessPoint(const PlacedPair<D>& placed, const PairAnswer<D>& answer) {
  const Real r1 = placed.view1().radius, r2 = placed.view2().radius;
  const Vec<D> p1 = answer.pA - r1 * answer.normal, p2 = answer.pB + r2 * answer.normal;
  return {p1, p2, (p2 - p1).dot(answer.normal), featureNumber(kNoFeature, kNoFeature)};
}

}}}  // namespace lpc::LPC_PRECISION::contacts
