// SPDX-License-Identifier: Zlib
#include "framework/world/contact_maker.h"

#include <algorithm>
#include <tuple>

#include "framework/world/contact_listener.h"
#include "framework/world/internal_edges.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
PairRecord recordOf(const ConvexPair<D>& pair, std::span<const ShapeRecord<D>> shapes) {
  const auto body = [&](std::int32_t shape) { return shapes[static_cast<std::size_t>(shape)].body; };
  const ShapePair& s = pair.shapes;
  return {
      .bodyA = body(s.a), .shapeA = s.a, .bodyB = body(s.b), .shapeB = s.b, .partA = pair.partA, .partB = pair.partB};
}

template <int D>
Real marginOf(const MakerInput<D>& in, const ShapePair& pair) {
  const auto at = std::partition_point(in.speculative.begin(), in.speculative.end(),
                                       [&](const SpeculativePair& p) { return p.shapes < pair; });
  return at != in.speculative.end() && at->shapes == pair ? at->margin : in.settings.margin;
}

// The material of the pair by its shapes and the mixing rules.
template <int D>
PairMaterial mixed(const MakerInput<D>& in, const Manifold<D>& m) {
  const ShapeRecord<D>&a = in.table.shapes[static_cast<std::size_t>(m.shapeA)],
        &b = in.table.shapes[static_cast<std::size_t>(m.shapeB)];
  return {in.settings.model.friction ? lpc::mix(in.settings.mixing.friction, a.friction, b.friction) : Real(0),
          lpc::mix(in.settings.mixing.restitution, a.restitution, b.restitution)};
}

}  // namespace

template <int D>
void ContactMaker<D>::findPairs(const BodyTable<D>& table, const NonCollidingPairs& nonColliding, WorkDone& work) {
  m_proxyPairs.clear();
  table.boxes.findPairs(m_proxyPairs, work);
  m_pairs.clear();
  for (const ProxyPair& p : m_proxyPairs) {
    ShapePair pair{p.a, p.b};
    std::int32_t a = table.shapes[static_cast<std::size_t>(p.a)].body,
                 b = table.shapes[static_cast<std::size_t>(p.b)].body;
    if (a > b) std::swap(a, b), std::swap(pair.a, pair.b);
    const bool moves = table.bodies.type[static_cast<std::size_t>(a)] == BodyType::dynamic ||
                       table.bodies.type[static_cast<std::size_t>(b)] == BodyType::dynamic;
    if (!moves || nonColliding.contains(a, b)) continue;
    m_pairs.push_back(pair);
  }
}

// This order does not affect the result, which depends on the order of the manifolds. Generators emit manifolds mostly
// in the order of the pairs, and moving pairs is cheaper.
template <int D>
void ContactMaker<D>::sortPairs(std::span<const ShapeRecord<D>> shapes, std::span<const SpeculativePair> speculative) {
  for (const SpeculativePair& p : speculative)
    m_pairs.push_back(p.shapes);  // the broadphase has already found the near ones
  for (const ShapePair& p : m_pairs) {
    m_order.add(
        {shapes[static_cast<std::size_t>(p.a)].body, p.a, shapes[static_cast<std::size_t>(p.b)].body, p.b, 0, 0});
  }
  m_order.apply(std::span(m_pairs));
  if (!speculative.empty()) m_pairs.erase(std::unique(m_pairs.begin(), m_pairs.end()), m_pairs.end());
}

// The memory of each pair; empty for a new pair. Both lists are sorted by key.
template <int D>
std::span<PairMemory> ContactMaker<D>::recall(const MakerInput<D>& in, std::span<const ConvexPair<D>> convexPairs) {
  m_memory.clear();
  if (!in.settings.model.cache || !in.generator.remembers()) return {};
  if (convexPairs.empty()) return {};
  const auto first = recordOf<D>(convexPairs[0], in.table.shapes).key();
  auto o = static_cast<std::size_t>(
      std::partition_point(records.begin(), records.end(), [&](const PairRecord& r) { return r.key() < first; }) -
      records.begin());
  for (const ConvexPair<D>& pair : convexPairs) {
    const auto key = recordOf<D>(pair, in.table.shapes).key();
    while (o < records.size() && records[o].key() < key) ++o;
    const bool known = o < records.size() && records[o].key() == key;
    m_memory.push_back(known ? records[o].memory : PairMemory{});
  }
  return m_memory;
}

// Whether the cache keeps the contacts of two shapes that may collide. Takes a record or a manifold.
template <int D>
template <class Pair>
bool ContactMaker<D>::cacheKeeps(const MakerInput<D>& in, const Pair& pair) const {
  const auto keyOf = [&](const ShapePair& p) {
    return std::tuple(in.table.shapes[static_cast<std::size_t>(p.a)].body, p.a,
                      in.table.shapes[static_cast<std::size_t>(p.b)].body, p.b);
  };
  const std::tuple key(pair.bodyA, pair.shapeA, pair.bodyB, pair.shapeB);
  const auto among = [&](const std::vector<ShapePair>& pairs) {
    const auto at =
        std::partition_point(pairs.begin(), pairs.end(), [&](const ShapePair& p) { return keyOf(p) < key; });
    return at != pairs.end() && keyOf(*at) == key;
  };
  return among(m_pairs) && !among(m_regenerate);
}

// Runs after the generator has written its memory. A pair that was not passed to the generator keeps its record: it
// rests, or the cache keeps its contacts. Other records are dropped.
template <int D>
void ContactMaker<D>::remember(const MakerInput<D>& in) {
  std::swap(records, m_oldRecords);
  records.clear();
  if (!in.settings.model.cache || !in.generator.remembers()) return;
  std::size_t o = 0;
  const auto keepUpTo = [&](const auto& isPast) {
    for (; o < m_oldRecords.size() && !isPast(m_oldRecords[o]); ++o) {
      const PairRecord& r = m_oldRecords[o];
      if (in.table.resting(r) || cacheKeeps(in, r)) records.push_back(r);
    }
  };
  for (const PairRecord& r : m_asked) {
    keepUpTo([&](const PairRecord& old) { return old.key() >= r.key(); });
    if (o < m_oldRecords.size() && m_oldRecords[o].key() == r.key()) ++o;
    records.push_back(r);
  }
  keepUpTo([](const PairRecord&) { return false; });
}

template <int D>
void ContactMaker<D>::generate(const MakerInput<D>& in, std::span<const ShapePair> pairs, Real margin) {
  WorkDone& work = in.profiler.frame().work;
  const auto convexPairs = m_partPairs.of(pairs, in.table.shapes, in.table.bodies.pose, margin, work);
  const std::span<PairMemory> memory = recall(in, convexPairs);
  const std::span<const Manifold<D>> old = m_old;
  const std::size_t before = manifolds.size();
  in.generator.generate({convexPairs, in.table.shapes, in.table.bodies.pose, margin, in.settings.model.friction,
                         in.settings.mixing, memory, in.settings.model.cache ? old : std::span<const Manifold<D>>()},
                        manifolds, work);
  correctSurfaceContacts<D>(in.table.shapes, in.table.bodies.pose, margin, before, manifolds);
  for (std::size_t i = 0; i < memory.size(); ++i) {
    m_asked.push_back(recordOf<D>(convexPairs[i], in.table.shapes));
    m_asked.back().memory = memory[i];
  }
}

template <int D>
void ContactMaker<D>::correctFlush(const MakerInput<D>& in) {
  m_kept.clear();
  if (m_regenerate.size() < m_pairs.size()) {
    for (const Manifold<D>& m : m_old) {
      if (cacheKeeps(in, m)) m_kept.push_back(&m);
    }
  }
  m_flush.correct(in.table, m_kept, m_old, manifolds);
}

template <int D>
void ContactMaker<D>::make(const MakerInput<D>& in) {
  // When all bodies rest, contacts stay in place: copying them took most of the time of such a step.
  const auto rests = [&](const Manifold<D>& m) { return in.table.resting(m); };
  if (m_pairs.empty() && std::all_of(manifolds.begin(), manifolds.end(), rests)) {
    Profiler::Scope scope(in.profiler, "contacts");
    m_old.clear(), m_asked.clear();
    remember(in);
    return;
  }
  std::swap(manifolds, m_old);
  manifolds.clear();
  const CacheInput<D> cacheInput{m_pairs, m_old, in.table.shapes, in.table.bodies.pose, in.settings.margin};
  {
    Profiler::Scope scope(in.profiler, "cache");
    if (in.settings.model.cache) {
      in.cache.select(cacheInput, m_regenerate);
    } else {
      m_regenerate = m_pairs;
    }
  }
  {
    Profiler::Scope scope(in.profiler, "contacts");
    m_asked.clear();
    for (std::span<const ShapePair> rest = m_regenerate; !rest.empty();) {  // most pairs have the same margin
      const Real margin = marginOf(in, rest[0]);
      std::size_t n = 1;
      while (n < rest.size() && (in.speculative.empty() || marginOf(in, rest[n]) == margin)) ++n;
      generate(in, rest.first(n), margin);
      rest = rest.subspan(n);
    }
    remember(in);
    correctFlush(in);
    for (Manifold<D>& m : manifolds) {
      const Pose<D>& X_WA = in.table.bodies.pose[static_cast<std::size_t>(m.bodyA)];
      m.X_AB = poseBetween(X_WA, in.table.bodies.pose[static_cast<std::size_t>(m.bodyB)]);
      m.normalA = X_WA.q.inverse() * m.normal;
    }
  }
  Profiler::Scope scope(in.profiler, "cache");
  // The broadphase does not report a pair without an active proxy: its manifold stays as it was.
  for (const Manifold<D>& m : m_old) {
    if (in.table.resting(m)) manifolds.push_back(m);
  }
  for (const Manifold<D>& m : manifolds) m_order.add(m.key());
  m_order.apply(std::span(manifolds));
  if (!in.settings.model.cache) return;
  in.cache.carry(cacheInput, manifolds);
  if (m_regenerate.size() < m_pairs.size()) mixKept(in);
}

// Manifolds kept by a cache still have the material that a listener set, or that a shape had before it changed. All
// other contacts were made in this step, with the material of their shapes, or rest.
template <int D>
void ContactMaker<D>::mixKept(const MakerInput<D>& in) {
  std::span<const ShapePair> fresh = m_regenerate;  // in the order of the manifolds
  for (Manifold<D>& m : manifolds) {
    const auto before = [&](const ShapePair& p) {
      return std::tuple(in.table.shapes[static_cast<std::size_t>(p.a)].body, p.a,
                        in.table.shapes[static_cast<std::size_t>(p.b)].body, p.b) < m.shapeKey();
    };
    while (!fresh.empty() && before(fresh[0])) fresh = fresh.subspan(1);
    if (in.table.resting(m) || (!fresh.empty() && fresh[0] == ShapePair{m.shapeA, m.shapeB})) continue;
    const PairMaterial material = mixed(in, m);
    m.friction = material.friction, m.restitution = material.restitution;
  }
}

template <int D>
IndexedVector<int>& ContactMaker<D>::collectActive(const Bodies<D>& bodies) {
  m_active.clear();
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    const Manifold<D>& m = manifolds[i];
    if (!m.ignored && (bodies.active(m.bodyA) || bodies.active(m.bodyB))) m_active.push_back(static_cast<int>(i));
  }
  return m_active;
}

template <int D>
void ContactMaker<D>::moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits) {
  const auto slot = static_cast<std::int32_t>(body);
  visits += manifolds.size();
  for (Manifold<D>& m : manifolds) {
    if (m.bodyA != slot && m.bodyB != slot) continue;
    for (ContactPoint<D>& c : m.points) (m.bodyA == slot ? c.localA : c.localB) -= by;
    m.X_AB.p += m.bodyA == slot ? Vec<D>(-by) : Vec<D>(m.X_AB.q * by);
  }
}

template class ContactMaker<2>;
template class ContactMaker<3>;

}}  // namespace lpc::LPC_PRECISION
