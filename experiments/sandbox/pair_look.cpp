// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/pair_look.h"

#include <limits>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
struct LookedAt {
  ShapeView<D> view;
  Pose<D> X_WP;
};

template <int D>
std::vector<LookedAt<D>> partsOf(const std::vector<std::pair<Shape<D>, Pose<D>>>& shapes) {
  std::vector<LookedAt<D>> out;
  for (const auto& [shape, X_WS] : shapes) {
    forParts(shape, X_WS, [&](const ShapeView<D>& view, const Pose<D>& X_WP) { out.push_back({view, X_WP}); });
  }
  return out;
}

// The two entries of two lists with the nearest centres.
template <int D>
std::optional<std::pair<LookedAt<D>, LookedAt<D>>> nearestOf(const std::vector<LookedAt<D>>& ofA,
                                                             const std::vector<LookedAt<D>>& ofB) {
  std::optional<std::pair<LookedAt<D>, LookedAt<D>>> out;
  Real nearest = std::numeric_limits<Real>::infinity();
  for (const LookedAt<D>& p : ofA) {
    for (const LookedAt<D>& q : ofB) {
      const Real far = (p.X_WP.p - q.X_WP.p).norm();
      if (far < nearest) nearest = far, out = std::pair(p, q);
    }
  }
  return out;
}

bool sameTurn(const Rot<2>& a, const Rot<2>& b) { return a.c == b.c && a.s == b.s; }
bool sameTurn(const Rot<3>& a, const Rot<3>& b) { return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace

template <int D>
bool PairLook<D>::same(const std::vector<Placed>& one, const std::vector<Placed>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](const Placed& p, const Placed& q) {
    return p.first.same(q.first) && p.second.p == q.second.p && sameTurn(p.second.q, q.second.q);
  });
}

template <int D>
void PairLook<D>::nobody(std::string why) {
  m_asked.reset(), m_trace.reset();
  m_says = std::move(why);
}

template <int D>
void PairLook<D>::look(const std::string& query, const Simulation<D>& world, std::int32_t a, std::int32_t b) {
  Asked now{query, {}, {}};
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body != a && s.body != b) continue;
    (s.body == a ? now.a : now.b).push_back({s.shape, world.bodies().pose[static_cast<std::size_t>(s.body)] * s.X_CS});
  }
  if (m_asked && m_asked->query == query && same(m_asked->a, now.a) && same(m_asked->b, now.b)) return;
  nobody("one of them has no shape");
  m_asked = std::move(now);
  const auto parts = nearestOf<D>(partsOf<D>(m_asked->a), partsOf<D>(m_asked->b));
  if (!parts) return;
  const auto& [p, q] = *parts;
  try {
    m_trace = tracePair<D>(query, p.view, q.view, p.X_WP.inverse() * q.X_WP);
    m_X_WA = m_trace->swapped ? q.X_WP : p.X_WP;
    ++m_made;
  } catch (const UserError& e) {
    m_says = e.what();
  }
}

template <int D>
std::size_t PairLook<D>::found() const {
  const auto& steps = m_trace->steps;
  std::size_t at = steps.size() - 1;
  while (at > 0 && steps[at - 1].best == steps.back().best && steps[at - 1].bestAxis == steps.back().bestAxis) --at;
  return at;
}

template class PairLook<2>;
template class PairLook<3>;

}}  // namespace lpc::LPC_PRECISION
