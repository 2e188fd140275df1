// SPDX-License-Identifier: Zlib
#include "framework/world/pose_penetration.h"

#include <algorithm>

#include "framework/math/worse.h"

namespace lpc { inline namespace LPC_PRECISION {

// gjk_epa is the only pair query that takes every kind of shape.
template <int D>
PosePenetration<D>::PosePenetration()
    : m_query(createStage<PairQuery<D>>({"gjk_epa", {}})), m_pairs(kShapeKinds * kShapeKinds) {}

template <int D>
void PosePenetration<D>::collectPairs(const Simulation<D>& simulation) {
  const Bodies<D>& bodies = simulation.bodies();
  const auto shapes = simulation.shapes();
  m_parts.clear(), m_nonColliding.clear();
  for (auto& list : m_pairs) list.clear();
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].body < 0) continue;
    const Pose<D>& X_WC = bodies.pose[static_cast<std::size_t>(shapes[s].body)];
    forParts(shapes[s].shape, X_WC * shapes[s].X_CS, [&](const ShapeView<D>& view, const Pose<D>& X_WP) {
      m_parts.push_back({boundingBox(view, X_WP), view, X_WP, static_cast<std::int32_t>(s)});
    });
  }
  for (const JointRecord<D>& j : simulation.joints()) {
    if (simulation.settings().model.joints && j.active() && j.bodyA >= 0 && !j.collide)
      m_nonColliding.emplace_back(std::minmax(j.bodyA, j.bodyB));
  }
  std::sort(m_nonColliding.begin(), m_nonColliding.end());
  std::sort(m_parts.begin(), m_parts.end(), [](const Part& a, const Part& b) { return a.box.lo[0] < b.box.lo[0]; });
  const auto mayCollide = [&](const Part& p, const Part& q) {
    const ShapeRecord<D>&a = shapes[static_cast<std::size_t>(p.shape)], &b = shapes[static_cast<std::size_t>(q.shape)];
    const auto moves = [&](std::int32_t body) {
      return bodies.type[static_cast<std::size_t>(body)] == BodyType::dynamic;
    };
    return a.body != b.body && (moves(a.body) || moves(b.body)) && (a.category & b.mask) && (b.category & a.mask) &&
           !std::binary_search(m_nonColliding.begin(), m_nonColliding.end(),
                               std::pair<std::int32_t, std::int32_t>(std::minmax(a.body, b.body)));
  };
  for (std::size_t i = 0; i < m_parts.size(); ++i) {
    for (std::size_t j = i + 1; j < m_parts.size() && m_parts[j].box.lo[0] <= m_parts[i].box.hi[0]; ++j) {
      const Part *p = &m_parts[i], *q = &m_parts[j];
      if (!p->box.overlaps(q->box) || !mayCollide(*p, *q)) continue;
      if (p->view.kind > q->view.kind) std::swap(p, q);
      m_pairs[static_cast<std::size_t>(p->view.kind) * kShapeKinds + static_cast<std::size_t>(q->view.kind)]
          .emplace_back(p, q);
    }
  }
}

template <int D>
typename PosePenetration<D>::Depths PosePenetration<D>::of(const Simulation<D>& simulation) {
  collectPairs(simulation);
  Depths out;
  double sum = 0;
  WorkDone work;
  for (const auto& pairs : m_pairs) {
    m_views.clear();
    for (const auto& [a, b] : pairs) m_views.push_back({a->view, b->view, a->X_WP.inverse() * b->X_WP});
    m_answers.assign(m_views.size(), {});
    m_query->query(m_views, QueryNeed::distance, m_answers, {}, work);
    for (const PairAnswer<D>& answer : m_answers) {
      const double depth = -static_cast<double>(answer.distance);
      if (depth <= 0) continue;
      out.max = worse(out.max, depth);
      sum += depth, ++out.pairs;
    }
  }
  out.mean = out.pairs ? sum / out.pairs : 0;
  return out;
}

template class PosePenetration<2>;
template class PosePenetration<3>;

}}  // namespace lpc::LPC_PRECISION
