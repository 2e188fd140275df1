// SPDX-License-Identifier: Zlib
#include "framework/world/contact_maker.h"

#include <algorithm>
#include <numeric>
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

// Searches sorted pairs of shapes for manifolds or records, which come in ascending order.
template <int D>
class PairSearch {
 public:
  PairSearch(std::span<const ShapePair> pairs, std::span<const ShapeRecord<D>> shapes)
      : m_pairs(pairs), m_shapes(shapes) {}

  template <class M>
  bool contains(const M& m) {
    if (isAt(m_at, m)) return true;
    if (isAt(m_at + 1, m)) return ++m_at, true;  // the usual case: the next pair
    const std::tuple key(m.bodyA, m.shapeA, m.bodyB, m.shapeB);
    while (m_at < m_pairs.size() && keyAt(m_at) < key) ++m_at;
    return isAt(m_at, m);
  }

 private:
  template <class M>
  bool isAt(std::size_t i, const M& m) const {
    return i < m_pairs.size() && m_pairs[i].a == m.shapeA && m_pairs[i].b == m.shapeB;
  }
  auto keyAt(std::size_t i) const {
    const ShapePair& p = m_pairs[i];
    return std::tuple(m_shapes[static_cast<std::size_t>(p.a)].body, p.a, m_shapes[static_cast<std::size_t>(p.b)].body,
                      p.b);
  }

  std::span<const ShapePair> m_pairs;
  std::span<const ShapeRecord<D>> m_shapes;
  std::size_t m_at = 0;
};

// Stable counting sort: binOf(item) is below `bins`.
template <class T, class F>
void sortByBin(std::vector<T>& items, std::vector<T>& scratch, std::vector<std::uint32_t>& begin, std::size_t bins,
               const F& binOf) {
  begin.assign(bins + 1, 0);
  for (const T& item : items) ++begin[static_cast<std::size_t>(binOf(item)) + 1];
  for (std::size_t i = 1; i < bins; ++i) begin[i] += begin[i - 1];
  scratch.resize(items.size());
  for (const T& item : items) scratch[begin[static_cast<std::size_t>(binOf(item))]++] = item;
  std::swap(items, scratch);
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
// in the order of the pairs, and moving pairs is cheaper. Shapes get places in the order of bodies, then slots. Pairs
// are sorted by the place of B, then by that of A.
template <int D>
void ContactMaker<D>::sortPairs(std::span<const ShapeRecord<D>> shapes, std::span<const SpeculativePair> speculative) {
  for (const SpeculativePair& p : speculative)
    m_pairs.push_back(p.shapes);  // the broadphase has already found the near ones
  if (m_pairs.empty()) return;
  m_places.resize(shapes.size());
  std::iota(m_places.begin(), m_places.end(), 0);
  const auto inBodyOrder = [](const ShapeRecord<D>& s, const ShapeRecord<D>& t) { return s.body < t.body; };
  if (!std::is_sorted(shapes.begin(), shapes.end(), inBodyOrder)) {
    const std::int32_t last = std::max_element(shapes.begin(), shapes.end(), inBodyOrder)->body;
    m_shapeOrder = m_places;
    sortByBin(m_shapeOrder, m_scratchOrder, m_begin, static_cast<std::size_t>(last) + 2,
              [&](std::int32_t s) { return shapes[static_cast<std::size_t>(s)].body + 1; });  // a free slot's is -1
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      m_places[static_cast<std::size_t>(m_shapeOrder[i])] = static_cast<std::int32_t>(i);
    }
  }
  const auto placeOf = [&](std::int32_t shape) { return m_places[static_cast<std::size_t>(shape)]; };
  sortByBin(m_pairs, m_scratchPairs, m_begin, shapes.size(), [&](const ShapePair& p) { return placeOf(p.b); });
  sortByBin(m_pairs, m_scratchPairs, m_begin, shapes.size(), [&](const ShapePair& p) { return placeOf(p.a); });
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

// Runs after the generator has written its memory. A pair that was not passed to the generator keeps its record: it
// rests, or the cache keeps its contacts. Other records are dropped.
template <int D>
void ContactMaker<D>::remember(const MakerInput<D>& in) {
  std::swap(records, m_oldRecords);
  records.clear();
  if (!in.settings.model.cache || !in.generator.remembers()) return;
  PairSearch<D> near(m_pairs, in.table.shapes), selected(m_regenerate, in.table.shapes);
  std::size_t o = 0;
  const auto keepUpTo = [&](const auto& isPast) {
    for (; o < m_oldRecords.size() && !isPast(m_oldRecords[o]); ++o) {
      const PairRecord& r = m_oldRecords[o];
      if (in.table.resting(r) || (near.contains(r) && !selected.contains(r))) records.push_back(r);
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
  const std::span<const Manifold<D>> old = manifolds;
  const std::size_t before = m_fresh.size();
  in.generator.generate({convexPairs, in.table.shapes, in.table.bodies.pose, margin, in.settings.model.friction,
                         in.settings.mixing, memory, in.settings.model.cache ? old : std::span<const Manifold<D>>()},
                        m_fresh, work);
  correctSurfaceContacts<D>(in.table.shapes, in.table.bodies.pose, margin, before, m_fresh);
  for (std::size_t i = 0; i < memory.size(); ++i) {
    m_asked.push_back(recordOf<D>(convexPairs[i], in.table.shapes));
    m_asked.back().memory = memory[i];
  }
}

template <int D>
void ContactMaker<D>::correctFlush(const MakerInput<D>& in) {
  m_kept.clear();
  for (const OldPair& pair : m_oldPairs) {
    for (std::size_t i = 0; pair.kept && i < pair.count; ++i) m_kept.push_back(&manifolds[pair.first + i]);
  }
  m_flush.correct(in.table, m_kept, manifolds, m_fresh);
}

// The broadphase does not report a pair without an active proxy: its manifolds stay as they were.
template <int D>
void ContactMaker<D>::findOld(const MakerInput<D>& in) {
  m_oldPairs.clear();
  const bool noneKept = m_regenerate.size() == m_pairs.size();
  PairSearch<D> near(m_pairs, in.table.shapes), selected(m_regenerate, in.table.shapes);
  std::size_t first = 0;
  for (std::span<const Manifold<D>> rest = manifolds; !rest.empty();) {
    const Manifold<D>& m = rest[0];
    const std::size_t count = firstPair(rest).size();
    const bool kept = !noneKept && near.contains(m) && !selected.contains(m);
    if (kept || !in.table.resting(m)) m_oldPairs.push_back({first, count, kept});
    first += count, rest = rest.subspan(count);
  }
}

template <int D>
void ContactMaker<D>::make(const MakerInput<D>& in) {
  m_before.clear(), m_fresh.clear(), m_asked.clear(), m_past = {};
  // When all bodies rest, contacts stay in place: copying them took most of the time of such a step.
  const auto rests = [&](const Manifold<D>& m) { return in.table.resting(m); };
  if (m_pairs.empty() && std::all_of(manifolds.begin(), manifolds.end(), rests)) {
    Profiler::Scope scope(in.profiler, "contacts");
    remember(in);
    return;
  }
  const CacheInput<D> cacheInput{m_pairs, manifolds, in.table.shapes, in.table.bodies.pose, in.settings.margin};
  {
    Profiler::Scope scope(in.profiler, "cache");
    if (in.settings.model.cache) {
      in.cache.select(cacheInput, m_regenerate);
    } else {
      m_regenerate = m_pairs;
    }
    findOld(in);
  }
  {
    Profiler::Scope scope(in.profiler, "contacts");
    for (std::span<const ShapePair> rest = m_regenerate; !rest.empty();) {  // most pairs have the same margin
      const Real margin = marginOf(in, rest[0]);
      std::size_t n = 1;
      while (n < rest.size() && (in.speculative.empty() || marginOf(in, rest[n]) == margin)) ++n;
      generate(in, rest.first(n), margin);
      rest = rest.subspan(n);
    }
    remember(in);
    if (!m_fresh.empty()) correctFlush(in);
    for (Manifold<D>& m : m_fresh) {
      const Pose<D>& X_WA = in.table.bodies.pose[static_cast<std::size_t>(m.bodyA)];
      m.X_AB = poseBetween(X_WA, in.table.bodies.pose[static_cast<std::size_t>(m.bodyB)]);
      m.normalA = X_WA.q.inverse() * m.normal;
    }
  }
  Profiler::Scope scope(in.profiler, "cache");
  if (!std::is_sorted(m_fresh.begin(), m_fresh.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); })) {
    for (const Manifold<D>& m : m_fresh) m_order.add(m.key());
    m_order.apply(std::span(m_fresh));
  }
  if (in.settings.model.cache) in.cache.carry(cacheInput, m_fresh);
  renewKept(in, cacheInput);
  insertFresh();
}

// A kept manifold still has the material that a listener set, or that a shape had before it changed. All other contacts
// were made in this step, with the material of their shapes, or rest.
template <int D>
void ContactMaker<D>::renewKept(const MakerInput<D>& in, const CacheInput<D>& cacheInput) {
  for (const OldPair& old : m_oldPairs) {
    const std::span<Manifold<D>> pair = manifolds.part(old.first, old.count);
    m_before.emplace_back(std::span<const Manifold<D>>(pair));
    if (!old.kept) continue;
    in.cache.renew(cacheInput, pair);
    const PairMaterial material = mixed(in, pair[0]);
    for (Manifold<D>& m : pair) m.friction = material.friction, m.restitution = material.restitution;
  }
}

// Puts the fresh manifolds in place of those that are gone. Others move only where the number of manifolds before them
// changes.
template <int D>
void ContactMaker<D>::insertFresh() {
  m_gone.clear();
  std::size_t gone = 0;
  for (const OldPair& pair : m_oldPairs) gone += pair.kept ? 0 : pair.count;
  if (gone == 0 && m_fresh.empty()) return;
  if (gone == manifolds.size()) {
    std::swap(manifolds, m_fresh);
    m_past = m_fresh;
    return;
  }
  auto to = manifolds.begin(), from = to;  // removes those that are gone
  for (const OldPair& pair : m_oldPairs) {
    if (pair.kept) continue;
    const auto first = manifolds.begin() + static_cast<std::ptrdiff_t>(pair.first);
    const auto end = first + static_cast<std::ptrdiff_t>(pair.count);
    m_gone.insert(m_gone.end(), first, end);
    to = from == to ? first : std::copy(from, first, to);
    from = end;
  }
  if (from != to) manifolds.erase(std::copy(from, manifolds.end(), to), manifolds.end());
  m_past = m_gone;
  std::size_t left = manifolds.size(), add = m_fresh.size(), out = left + add;  // merges from the end
  manifolds.resize(out);
  while (add > 0) {
    const bool moves = left > 0 && m_fresh[add - 1].key() < manifolds[left - 1].key();
    --out;
    manifolds[out] = moves ? manifolds[--left] : m_fresh[--add];
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
