// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>

#include "algorithms/contacts/contact_patch.h"

namespace lpc::inline LPC_PRECISION::contacts {

/// Asks a nested pair query about many pairs: sorted by kinds, in blocks of PairBatch::kCapacity, answers in the order
/// of the batches.
template <int D>
class QueryBatches {
 public:
  explicit QueryBatches(const Spec& query) : m_query(createStage<PairQuery<D>>(query)) {}

  bool supports(ShapeKind a, ShapeKind b) const { return m_query->supports(std::min(a, b), std::max(a, b)); }

  /// Calls use(placed, answer) for each pair that is within the margin. The answer is that of the shapes, not of
  /// their cores, and always has a unit normal.
  template <class Use>
  void run(const ContactInput<D>& in, Real bias, WorkDone& work, const Use& use) {
    for (auto& group : m_groups) group.clear();
    m_placed.clear();
    for (std::size_t i = 0; i < in.pairs.size(); ++i) {
      m_placed.push_back(placePair(in, in.pairs[i], bias));
      const auto k1 = static_cast<std::size_t>(m_placed.back().view1().kind);
      const auto k2 = static_cast<std::size_t>(m_placed.back().view2().kind);
      m_groups[kShapeKinds * k1 + k2].push_back(i);
    }
    work[WorkCount::pairQueries] += in.pairs.size();
    for (const auto& group : m_groups) {
      for (std::size_t at = 0; at < group.size(); at += PairBatch<D>::kCapacity) {
        const std::size_t count = std::min<std::size_t>(group.size() - at, PairBatch<D>::kCapacity);
        ask({group.data() + at, count}, work);
        for (std::size_t i = 0; i < count; ++i) {
          const PlacedPair<D>& placed = m_placed[group[at + i]];
          PairAnswer<D> answer = m_answers->get(static_cast<int>(i));
          if (answer.status == QueryStatus::refused || answer.status == QueryStatus::failed) continue;
          if (!(answer.distance <= in.margin)) continue;
          if (!(answer.normal.squaredNorm() >
                0)) {  // the method has none: from centre to centre is better than nothing
            const Real length = placed.X_12.p.norm();
            answer.normal = length > 0 ? Vec<D>(placed.X_12.p / length) : Vec<D>(Vec<D>::Unit(0));
          }
          use(placed, answer);
        }
      }
    }
  }

 private:
  void ask(std::span<const std::size_t> pairs, WorkDone& work) {
    const PlacedPair<D>& first = m_placed[pairs[0]];
    m_batch->clear(first.view1().kind, first.view2().kind);
    for (std::size_t i : pairs) {
      m_batch->add(m_placed[i].view1(), m_placed[i].view2(), m_placed[i].X_12);
    }
    m_query->query(*m_batch, QueryNeed::witnesses, *m_answers, {}, work);
  }

  std::unique_ptr<PairQuery<D>> m_query;
  std::unique_ptr<PairBatch<D>> m_batch = std::make_unique<PairBatch<D>>();
  std::unique_ptr<PairAnswers<D>> m_answers = std::make_unique<PairAnswers<D>>();
  std::array<std::vector<std::size_t>, kShapeKinds * kShapeKinds> m_groups;
  std::vector<PlacedPair<D>> m_placed;
};

/// A query's answer as a contact point of the cores. In frame 1, as answers are.
template <int D>
PatchPoint<D> witnessPoint(const PlacedPair<D>& placed, const PairAnswer<D>& answer) {
  const Real r1 = placed.view1().radius, r2 = placed.view2().radius;
  const Vec<D> p1 = answer.pA - r1 * answer.normal, p2 = answer.pB + r2 * answer.normal;
  return {p1, p2, (p2 - p1).dot(answer.normal), featureNumber(kNoFeature, kNoFeature)};
}

}  // namespace lpc::inline LPC_PRECISION::contacts
