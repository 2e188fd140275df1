// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <limits>
#include <utility>

#include "algorithms/broadphase/fat_pairs.h"
#include "algorithms/broadphase/surface_split.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// A tree of enlarged (fat) boxes that is kept from step to step (Presson's btDbvt in Bullet; Catto 2019). A box is
// reinserted only when it leaves its fat box, at the place where it adds the least surface (branch and bound).
// Rotations on the way up keep sorted insertions from degenerating the tree into a list. Insertions of a large share of
// the boxes at once, as of a new scene, are replaced by a top-down build, as in Bullet's optimizeTopDown.
//
// Pairs of overlapping fat boxes are kept, too. A step then costs the tests of these pairs, and queries for the few
// boxes that were reinserted or got other filters or activity; all their pairs are dropped and found anew.
template <int D>
class DynamicTree final : public Broadphase<D> {
 public:
  struct Params {
    Real margin = Real(0.1), stretch = 4, bulk = Real(0.3);
    bool rotate = true;
    void visit(ParamVisitor& v) {
      v.real("margin", margin, 0, 10, "m", "margin of a fat box on every side");
      v.real("stretch", stretch, 0, 100, "1", "steps of motion that a fat box covers, limited to the size of its box");
      v.real("bulk", bulk, 0, 1, "1",
             "the tree is rebuilt if an update inserts or moves more than this share of more than 16 boxes; 1: never");
      v.flag("rotate", rotate, "tree rotations after an insertion where they reduce the surface area");
    }
  };
  explicit DynamicTree(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "dynamic_tree",
            .summary = "persistent tree of fat boxes, with the pairs of fat boxes kept between steps",
            .paper = "catto2019",
            .complexity = "pairs of fat boxes + log n per box that leaves its fat box, n log n if many do at once",
            .failures = {{.when = "all boxes are fast or rotate, and leave their fat boxes in each step",
                          .symptom = "the tree is built anew in each step; with bulk=1, every box is reinserted",
                          .test = "tree_all_fast_work"},
                         {.when = "rotate=false, and boxes are inserted one by one in sorted order",
                          .symptom = "a deep tree: each insertion visits many nodes",
                          .test = "tree_sorted_insertion_work"},
                         {.when = "boxes that have changed places many times, a few in each step",
                          .symptom = "a tree of worse quality than a rebuilt one",
                          .test = "tree_history_work"}}};
  }

  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    const auto n = static_cast<std::size_t>(proxies.size());
    if (n > m_leaf.size()) {
      m_leaf.resize(n, kNone), m_tight.resize(n), m_fat.resize(n), m_pairs.resize(n);
      m_nodes.reserve(2 * n), m_heap.reserve(2 * n), m_free.reserve(2 * n);
      m_placed.reserve(n), m_items.reserve(n), m_leaves.reserve(n);
    }
    for (const ProxyId i : changes.removed) takeOut(i);
    m_placed.clear();
    for (const ProxyId i : changes.added) place(proxies, i);
    for (const ProxyId i : changes.moved) place(proxies, i);
    putPlaced();
    if (proxies.active != m_active || proxies.category != m_category || proxies.mask != m_mask) {
      m_active.resize(proxies.active.size()), m_category.resize(m_active.size()), m_mask.resize(m_active.size());
      for (std::size_t i = 0; i < n; ++i) {
        const bool same = proxies.active[i] == m_active[i] && proxies.category[i] == m_category[i];
        if (!same || proxies.mask[i] != m_mask[i]) m_pairs.note(static_cast<ProxyId>(i));
      }
      m_active = proxies.active, m_category = proxies.category, m_mask = proxies.mask;
    }
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    m_pairs.keep(m_tight, out);
    const auto flush = [&] { m_pairs.addListed(proxies, m_tight, out); };
    if (isMany(m_pairs.changed().size())) {
      descend(flush);
    } else {
      queryChanged(flush);
    }
    flush();
    m_pairs.settle();
    work[WorkCount::boxTests] += m_pairs.size();
    work[WorkCount::nodeVisits] += std::exchange(m_visits, 0);
    work[WorkCount::sortMoves] += std::exchange(m_moves, 0);
  }

  void overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const override {
    visit([&](const Aabb<D>& b) { return b.overlaps(box); },
          [&](ProxyId i) {
            if (proxies.box(i).overlaps(box)) out.push_back(i);
          });
  }
  void ray(const Proxies<D>& proxies, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
           std::vector<RayHit<D>>& out) const override {
    RayHit<D> first{-1, maxT};
    const auto meets = [&](const Aabb<D>& b) {
      const Real t = castRay(b, p, direction, maxT);
      return t >= 0 && !(firstOnly && t > first.t);
    };
    visit(meets, [&](ProxyId i) {
      const Real t = castRay(proxies.box(i), p, direction, maxT);
      if (t < 0) return;
      if (!firstOnly) {
        out.push_back({i, t});
      } else if (first.proxy < 0 || t < first.t || (t == first.t && i < first.proxy)) {
        first = {i, t};
      }
    });
    if (first.proxy >= 0) out.push_back(first);
  }
  void sweep(const Proxies<D>& proxies, const Aabb<D>& box, const Vec<D>& displacement,
             std::vector<RayHit<D>>& out) const override {
    visit([&](const Aabb<D>& b) { return castBox(box, displacement, Real(1), b) >= 0; },
          [&](ProxyId i) {
            const Real t = castBox(box, displacement, Real(1), proxies.box(i));
            if (t >= 0) out.push_back({i, t});
          });
  }

  void structure(std::vector<StructureBox<D>>& out) const override {
    int level = 0;
    for (std::int32_t at = m_root; at != kNone;) {
      const Node& n = node(at);
      out.push_back({n.box, level, n.isLeaf()});
      if (!n.isLeaf()) {
        at = n.child[0], ++level;
        continue;
      }
      std::int32_t parent = n.parent;
      while (parent != kNone && node(parent).child[1] == at) at = parent, parent = node(at).parent, --level;
      at = parent == kNone ? kNone : node(parent).child[1];
    }
  }

 private:
  static constexpr std::int32_t kNone = -1, kWaits = -2;  // no node; no leaf yet

  struct Node {
    Aabb<D> box;
    std::int32_t parent;
    IndexedArray<std::int32_t, 2> child;  // of a leaf: kNone and its slot
    std::int32_t height;                  // 0 of a leaf

    bool isLeaf() const { return child[0] == kNone; }
  };
  struct Candidate {
    Real inherited;  // increase of surface of all nodes above
    std::int32_t node;
    bool operator<(const Candidate& o) const {  // a heap has its largest in front
      return inherited != o.inherited ? inherited > o.inherited : node > o.node;
    }
  };

  struct Range {  // of the items of a build
    std::size_t begin, count;
    std::int32_t node;  // that gets them
    int depth;
  };

  Node& node(std::int32_t at) { return m_nodes[at]; }
  const Node& node(std::int32_t at) const { return m_nodes[at]; }

  void place(const Proxies<D>& proxies, ProxyId i) {
    const Aabb<D> box = proxies.box(i);
    const bool known = m_leaf[i] != kNone;  // also if it waits: `added` and `moved` may both name it
    if (known && box.lo == m_tight[i].lo && box.hi == m_tight[i].hi) return;
    const Vec<D> way = known ? ahead(m_tight[i], box) : Vec<D>(Vec<D>::Zero());
    m_tight[i] = box;
    if (proxies.isFree(i) || !(box.lo[0] <= box.hi[0])) {
      takeOut(i);
      return;
    }
    if (known) {
      // Also places a box anew with a fat box made for a larger or faster one; it would otherwise keep false pairs for
      // ever.
      const Aabb<D>& fat = m_fat[i];
      const Real most = kMostMargins * m_params.margin + 2 * way.cwiseAbs().maxCoeff();
      if (fat.contains(box) && box.grown(most).contains(fat)) return;
    }
    Aabb<D>& fat = m_fat[i] = box.grown(m_params.margin);
    for (int d = 0; d < D; ++d) (way[d] > 0 ? fat.hi : fat.lo)[d] += way[d];
    m_pairs.note(i);
    m_placed.push_back(i);
    if (!known) m_leaf[i] = kWaits, ++m_count;
  }

  bool isMany(std::size_t boxes) const {
    return boxes > kFewest && static_cast<Real>(boxes) > m_params.bulk * static_cast<Real>(m_count);
  }
  void putPlaced() {
    m_moves += m_placed.size();
    if (isMany(m_placed.size())) {
      build();
      return;
    }
    // In the order of the nodes, see queryChanged.
    std::sort(m_placed.begin(), m_placed.end(),
              [&](ProxyId a, ProxyId b) { return m_leaf[a] != m_leaf[b] ? m_leaf[a] < m_leaf[b] : a < b; });
    for (const ProxyId i : m_placed) {
      const std::int32_t start = m_leaf[i] == kWaits ? m_root : cut(i);
      m_leaf[i] = newNode({m_fat[i], kNone, {kNone, i}, 0});
      insert(m_leaf[i], start);
    }
  }

  // Makes the whole tree anew. Siblings are adjacent in memory, and parents come before children.
  void build() {
    m_items.clear();
    for (std::size_t i = 0; i < m_leaf.size(); ++i) {
      if (m_leaf[i] != kNone) m_items.push_back({m_fat[i], static_cast<ProxyId>(i)});
    }
    m_nodes.clear(), m_free.clear();
    m_root = newNode({{}, kNone, {kNone, kNone}, 0});
    m_ranges.assign(1, {0, m_items.size(), m_root, 0});
    while (!m_ranges.empty()) {
      const Range range = m_ranges.back();
      m_ranges.pop_back();
      if (range.count == 1) {
        const SplitItem<D>& item = m_items[range.begin];
        node(range.node).box = item.box, node(range.node).child[1] = item.proxy;
        m_leaf[item.proxy] = range.node;
        continue;
      }
      const std::span<SplitItem<D>> items(&m_items[range.begin], range.count);
      const std::size_t few = split<D>(items, range.depth < kBySurface);
      const Node child = {{}, range.node, {kNone, kNone}, 0};
      const std::int32_t left = newNode(child), right = newNode(child);
      node(range.node).child = {left, right};
      m_ranges.push_back({range.begin + few, range.count - few, right, range.depth + 1});
      m_ranges.push_back({range.begin, few, left, range.depth + 1});
    }
    for (auto at = static_cast<std::int32_t>(m_nodes.size()); at-- > 0;) {
      if (!node(at).isLeaf()) fit(at);
    }
    m_visits += m_nodes.size();
  }

  // Both list the pairs of overlapping fat boxes of which at least one has changed, and call flush() when the list is
  // long. Queries cost less if few boxes have changed.
  template <class Flush>
  void queryChanged(const Flush& flush) {
    // In the order of the nodes, successive queries visit the same part of the tree, which is then in the cache.
    m_leaves.clear();
    for (const ProxyId i : m_pairs.changed()) {
      if (m_leaf[i] != kNone) m_leaves.push_back(m_leaf[i]);
    }
    std::sort(m_leaves.begin(), m_leaves.end());
    for (const std::int32_t leaf : m_leaves) {
      const ProxyId i = node(leaf).child[1];
      const Aabb<D> fat = node(leaf).box;
      m_visits += visit([&](const Aabb<D>& box) { return FatPairs<D>::near(box, fat); },
                        [&](ProxyId j) {
                          // If both boxes changed, both queries find the pair.
                          if (j != i && !(j < i && m_pairs.isChanged(j))) m_pairs.list(i, j);
                        });
      if (m_pairs.listIsLong()) flush();
    }
  }
  // The tree against itself.
  template <class Flush>
  void descend(const Flush& flush) {
    std::size_t top = 0;
    const auto push = [&](std::int32_t a, std::int32_t b) {
      ++m_visits;
      m_stack[top] = {a, b};  // without a branch: half of the tests hit
      top += FatPairs<D>::near(node(a).box, node(b).box);
    };
    m_stack.resize(std::max<std::size_t>(m_stack.size(), 256));
    if (m_root != kNone) push(m_root, m_root);
    while (top > 0) {
      const auto [a, b] = m_stack[--top];
      if (top + 4 > m_stack.size()) m_stack.resize(2 * m_stack.size());
      const Node &x = node(a), &y = node(b);
      if (a == b) {
        if (x.isLeaf()) continue;
        const auto [l, r] = x.child;
        push(l, r), push(r, r), push(l, l);
      } else if (x.height < y.height) {
        const auto [l, r] = y.child;
        push(a, r), push(a, l);
      } else if (!x.isLeaf()) {
        const auto [l, r] = x.child;
        push(r, b), push(l, b);
      } else if (const ProxyId i = x.child[1], j = y.child[1]; m_pairs.isChanged(i) || m_pairs.isChanged(j)) {
        m_pairs.list(i, j);
        if (m_pairs.listIsLong()) flush();
      }
    }
  }

  // The expected motion of the next steps if they are like the last one; no longer than the box, since a teleport is
  // not motion.
  Vec<D> ahead(const Aabb<D>& was, const Aabb<D>& is) const {
    const Real most = (is.hi - is.lo).maxCoeff();
    Vec<D> way;
    for (int d = 0; d < D; ++d) {
      const Real step = (is.lo[d] - was.lo[d]) / 2 + (is.hi[d] - was.hi[d]) / 2;
      way[d] = m_params.stretch * step;
      if (!(std::abs(way[d]) <= most)) way[d] = step < 0 ? -most : most;
    }
    return way;
  }

  void takeOut(ProxyId i) {
    if (m_leaf[i] == kNone) return;
    m_pairs.note(i);
    cut(i), --m_count;
  }
  // Frees a leaf. Returns the lowest remaining ancestor.
  std::int32_t cut(ProxyId i) {
    const std::int32_t leaf = std::exchange(m_leaf[i], kNone), parent = node(leaf).parent;
    std::int32_t above = kNone;
    if (parent == kNone) {
      m_root = kNone;
    } else {
      const std::int32_t sibling = node(parent).child[node(parent).child[0] == leaf ? 1 : 0];
      replace(parent, sibling);
      m_free.push_back(parent);
      above = node(sibling).parent;
      for (std::int32_t at = above; at != kNone && fit(at); at = node(at).parent) ++m_visits;
    }
    m_free.push_back(leaf);
    return above == kNone ? m_root : above;
  }

  std::int32_t newNode(const Node& made) {
    if (m_free.empty()) {
      m_nodes.push_back(made);
      return static_cast<std::int32_t>(m_nodes.size()) - 1;
    }
    const std::int32_t at = m_free.back();
    m_free.pop_back();
    node(at) = made;
    return at;
  }
  // Puts `by` in the place of `at`.
  void replace(std::int32_t at, std::int32_t by) {
    const std::int32_t parent = node(at).parent;
    node(by).parent = parent;
    if (parent == kNone) {
      m_root = by;
    } else {
      node(parent).child[node(parent).child[0] == at ? 0 : 1] = by;
    }
  }
  // Returns whether anything changed; if not, nothing changes above either.
  bool fit(std::int32_t at) {
    Node& n = node(at);
    const Node &a = node(n.child[0]), &b = node(n.child[1]);
    const Aabb<D> box = a.box.merged(b.box);
    const std::int32_t height = 1 + std::max(a.height, b.height);
    const bool changed = box.lo != n.box.lo || box.hi != n.box.hi || height != n.height;
    n.box = box, n.height = height;
    return changed;
  }

  // The search starts at the lowest node from `start` upwards that the new box does not enlarge: a box that has hardly
  // moved then stays near its old place.
  void insert(std::int32_t leaf, std::int32_t start) {
    if (m_root == kNone) {
      m_root = leaf;
      return;
    }
    const Aabb<D> box = node(leaf).box;
    while (start != m_root && !node(start).box.contains(box)) ++m_visits, start = node(start).parent;
    const std::int32_t sibling = bestSibling(box, start);
    const std::int32_t above = newNode({{}, kNone, {sibling, leaf}, 0});
    replace(sibling, above);
    node(sibling).parent = node(leaf).parent = above;
    for (std::int32_t at = above; at != kNone && fit(at); at = node(at).parent) {
      ++m_visits;
      if (m_params.rotate) rotate(at);
    }
  }

  // Returns the node beside which a new leaf adds the least surface: that of its new parent, and the increase of all
  // nodes above. Best first; a subtree is skipped if no leaf in it can be better.
  std::int32_t bestSibling(const Aabb<D>& box, std::int32_t start) {
    const Real own = halfSurface(box);
    std::int32_t best = start;
    Real least = std::numeric_limits<Real>::infinity();
    m_heap.assign(1, {Real(0), start});
    while (!m_heap.empty()) {
      const Candidate c = m_heap.front();
      if (c.inherited + own >= least) break;
      std::pop_heap(m_heap.begin(), m_heap.end()), m_heap.pop_back();
      ++m_visits;
      const Node& n = node(c.node);
      const Real direct = halfSurface(n.box.merged(box));
      if (c.inherited + direct < least) least = c.inherited + direct, best = c.node;
      if (n.isLeaf()) continue;
      const Real inherited = c.inherited + (direct - halfSurface(n.box));
      if (inherited + own >= least) continue;
      for (const std::int32_t child : n.child) {
        m_heap.push_back({inherited, child});
        std::push_heap(m_heap.begin(), m_heap.end());
      }
    }
    // Equal boxes have equal costs on every level. Inserting at the lowest level, beside the lower child, avoids a
    // list.
    while (!node(best).isLeaf()) {
      const auto [a, b] = node(best).child;
      const std::int32_t lower = node(a).height <= node(b).height ? a : b;
      const Real whole = halfSurface(node(best).box.merged(box));
      if (halfSurface(node(best).box) < whole || halfSurface(node(lower).box.merged(box)) > own) break;
      best = lower;
    }
    return best;
  }

  // Exchanges a child with a grandchild of the other side if that reduces the surface of the node between, by the
  // largest amount.
  void rotate(std::int32_t at) {
    Real most = 0;
    std::int32_t low = kNone, high = kNone;
    for (const int side : {0, 1}) {
      const std::int32_t upper = node(at).child[side];
      const Node& between = node(node(at).child[1 - side]);
      if (between.isLeaf()) continue;
      const Real now = halfSurface(between.box);
      for (const int which : {0, 1}) {
        const std::int32_t stays = between.child[1 - which];
        const Real gain = now - halfSurface(node(stays).box.merged(node(upper).box));
        if (gain > most) most = gain, high = upper, low = between.child[which];
      }
    }
    if (low == kNone) return;
    const std::int32_t between = node(low).parent;
    node(between).child[node(between).child[0] == low ? 0 : 1] = high;
    node(at).child[node(at).child[0] == high ? 0 : 1] = low;
    node(high).parent = between, node(low).parent = at;
    fit(between);
    fit(at);
  }

  // Calls found(slot) for each leaf such that meets(box) holds for its fat box and all boxes above; returns the number
  // of nodes tested. It follows links to parents instead of a stack, because the order of insertion decides the depth
  // of the tree.
  template <class Meets, class Found>
  std::uint64_t visit(const Meets& meets, const Found& found) const {
    std::uint64_t visits = 0;
    for (std::int32_t at = m_root; at != kNone;) {
      ++visits;
      const Node& n = node(at);
      if (meets(n.box)) {
        if (!n.isLeaf()) {
          at = n.child[0];
          continue;
        }
        found(n.child[1]);
      }
      std::int32_t parent = n.parent;
      while (parent != kNone && node(parent).child[1] == at) at = parent, parent = node(at).parent;
      at = parent == kNone ? kNone : node(parent).child[1];
    }
    return visits;
  }

  static constexpr Real kMostMargins = 4;     // of a fat box around its content, as in Box2D
  static constexpr std::size_t kFewest = 16;  // boxes that may be worth a build
  static constexpr int kBySurface = 40;       // levels; deeper ranges are halved

  Params m_params;
  std::int32_t m_root = kNone;
  IndexedVector<Node> m_nodes;
  std::vector<std::int32_t> m_free;    // nodes
  std::vector<Candidate> m_heap;       // scratch of bestSibling
  IndexedVector<std::int32_t> m_leaf;  // by slot, as the following
  IndexedVector<Aabb<D>> m_tight;      // as of the last update
  IndexedVector<Aabb<D>> m_fat;        // that of the leaf: update() reads it in the order of the slots
  IndexedVector<std::uint8_t> m_active;
  std::vector<std::uint32_t> m_category, m_mask;
  FatPairs<D> m_pairs;
  std::size_t m_count = 0;                           // boxes in the tree
  std::vector<ProxyId> m_placed;                     // boxes of an update that need a place
  IndexedVector<SplitItem<D>> m_items;               // scratch of build
  std::vector<Range> m_ranges;                       // the same
  std::vector<std::int32_t> m_leaves;                // scratch of queryChanged
  std::vector<std::array<std::int32_t, 2>> m_stack;  // scratch of descend
  std::uint64_t m_visits = 0, m_moves = 0;           // since the last findPairs
};

}  // namespace

LPC_REGISTER(Broadphase, DynamicTree, 2, 3);

}}  // namespace lpc::LPC_PRECISION
