// SPDX-License-Identifier: Zlib
#include <bit>
#include <numeric>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/packed_box.h"
#include "algorithms/broadphase/radix_sort.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// Quadtree in 2D, octree in 3D, rebuilt each step: that of the 2009 engine, with three ways to treat boxes that cross
// borders between regions.
// tight  the smallest region that contains the box (2009);
// loose  the region of the box's centre at the depth of its size, grown to `looseness` times its edge (Ulrich 2000);
// multi  every leaf region that the box touches.
// Regions are integers: the highest bits of a corner's coordinate (packed_box.h) are its cell at that depth.
template <int D>
class RegionTree final : public Broadphase<D> {
 public:
  enum class Mode { tight, multi, loose };
  struct Params {
    Mode mode = Mode::tight;
    int maxDepth = 12, capacity = 6;
    Real looseness = 2;
    void visit(ParamVisitor& v) {
      v.choice("mode", mode, {"tight", "multi", "loose"}, "where a box that crosses a border between regions stands");
      v.integer("max_depth", maxDepth, 0, 16, "halvings of the root at most");
      v.integer("capacity", capacity, 1, 1000, "boxes that a region holds before it is divided");
      v.real("looseness", looseness, Real(1.125), 4, "1", "loose only: edge of a grown region in edges of the region");
    }
  };
  explicit RegionTree(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "region_tree",
            .summary = "quadtree or octree, rebuilt each step",
            .paper = "finkel1974",
            .complexity = "n log n; tight: boxes across a high border meet all boxes",
            .failures = {{.when = "mode=tight and bodies on the centre line of the world",
                          .symptom = "all of them stay in the root, every pair is tested",
                          .test = "tree_centre_line_work"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    listSlots(proxies, m_slots);
    if (m_slots.size() < 2) return;
    m_packing = Packing<D>(widened(findWindow(proxies, m_slots, m_sample)));
    m_out = &out, m_tests = 0, m_visits = 0;
    if (m_params.mode == Mode::multi) {
      gatherUnsorted(proxies);
      const auto n = static_cast<std::int32_t>(m_boxes.size());
      m_items.resize(m_boxes.size());
      for (std::int32_t k = 0; k < n; ++k) m_items[k] = k;
      visitRegion(Cell{}, 0, 0, m_items.size());
    } else {
      gatherSorted(proxies);
      build();
      pairsWithin(0);
      work[WorkCount::sortMoves] += m_boxes.size();
    }
    work[WorkCount::boxTests] += m_tests;
    work[WorkCount::nodeVisits] += m_visits;
  }

  /// The regions; loose ones with their grown size. The variant multi keeps no tree: its boxes are divided again.
  void structure(std::vector<StructureBox<D>>& out) const override {
    if (m_slots.size() < 2) return;
    if (m_params.mode != Mode::multi) return tell(0, Cell{}, 0, out);
    std::vector<std::int32_t> items(m_boxes.size());
    std::iota(items.begin(), items.end(), 0);
    tellAgain(Cell{}, 0, items, out);
  }

 private:
  static constexpr int kBits = Packing<D>::kBits;
  static constexpr std::size_t kChildren = std::size_t{1} << D;
  using Cell = IndexedArray<std::uint32_t, D>;  // the lower corner of a region, in packed units

  struct Node {
    PackedBox bounds;              // of all boxes below
    std::int32_t begin, own, end;  // boxes [begin, own) belong to this node, [own, end) to nodes below
    std::int32_t child = 0, children = 0;
    bool active = false;  // any box below
  };

  // --- tight and loose: the boxes sorted by region, depth first; a region is an interval of them --------------------

  // Key of the region of a box: the interleaved coordinates as a path from the root, the depth below them, so that the
  // boxes of a region precede those of the regions inside it.
  std::uint64_t regionKey(const PackedBox& box) const {
    const int deepest = m_params.maxDepth;
    int depth = deepest;
    Cell corner{};
    for (int d = 0; d < D; ++d) {
      const std::uint64_t lo = Packing<D>::field(box.lo, d), hi = Packing<D>::field(box.hi, d);
      if (m_params.mode == Mode::tight) {
        depth = std::min(depth, kBits - static_cast<int>(std::bit_width(lo ^ hi)));
        corner[d] = static_cast<std::uint32_t>(lo);
      } else {
        const auto room = static_cast<std::uint64_t>(static_cast<double>(hi - lo) / (m_params.looseness - 1));
        depth = std::min(depth, kBits - static_cast<int>(std::bit_width(room)));
        corner[d] = static_cast<std::uint32_t>((lo + hi) / 2);
      }
    }
    depth = std::max(depth, 0);
    std::uint64_t path = 0;
    for (int level = 1; level <= deepest; ++level) {
      path <<= D;
      if (level > depth) continue;
      for (int d = 0; d < D; ++d) {
        path |= static_cast<std::uint64_t>((corner[d] >> (kBits - level)) & 1u) << d;
      }
    }
    return path << kDepthBits | static_cast<std::uint64_t>(depth);
  }
  std::size_t childDigit(std::int32_t item, int depth) const {
    const std::uint64_t path = m_order[item].key >> kDepthBits;
    return static_cast<std::size_t>(path >> (D * (m_params.maxDepth - depth - 1))) & (kChildren - 1);
  }
  int itemDepth(std::int32_t item) const { return static_cast<int>(m_order[item].key & ((1u << kDepthBits) - 1)); }

  void gatherSorted(const Proxies<D>& proxies) {
    gatherUnsorted(proxies);
    const std::size_t n = m_boxes.size();
    m_order.resize(n);
    for (std::size_t k = 0; k < n; ++k) m_order[k] = {regionKey(m_packed[k]), m_slots[k]};
    radixSort(m_order, m_scratch, D * m_params.maxDepth + kDepthBits);
    for (std::size_t k = 0; k < n; ++k) {
      m_boxes[k] = GatheredBox<D>::of(proxies, m_order[k].index);
      m_packed[k] = m_packing.pack(m_boxes[k].lo, m_boxes[k].hi);
    }
  }

  // Breadth first, so that the children of a node are neighbours; then the bounds from the leaves up.
  void build() {
    m_nodes.clear(), m_depth.clear();
    const auto n = static_cast<std::int32_t>(m_boxes.size());
    m_nodes.push_back({{}, 0, 0, n}), m_depth.push_back(0);
    for (std::size_t at = 0; at < m_nodes.size(); ++at) {
      Node node = m_nodes[at];
      const int depth = m_depth[at];
      const bool leaf = node.end - node.begin <= m_params.capacity || depth == m_params.maxDepth;
      node.own = leaf ? node.end : node.begin;
      while (node.own < node.end && itemDepth(node.own) == depth) ++node.own;
      node.child = static_cast<std::int32_t>(m_nodes.size());
      for (std::int32_t begin = node.own; begin < node.end;) {
        const std::size_t digit = childDigit(begin, depth);
        std::int32_t end = begin + 1;
        while (end < node.end && childDigit(end, depth) == digit) ++end;
        m_nodes.push_back({{}, begin, begin, end}), m_depth.push_back(depth + 1);
        begin = end;
      }
      node.children = static_cast<std::int32_t>(m_nodes.size()) - node.child;
      m_nodes[at] = node;
    }
    for (std::size_t at = m_nodes.size(); at-- > 0;) {
      Node& node = m_nodes[at];
      const bool any = node.own > node.begin;
      node.bounds = any ? m_packed[node.begin] : m_nodes[node.child].bounds;
      for (std::int32_t k = node.begin; k < node.own; ++k) {
        node.bounds = Packing<D>::merged(node.bounds, m_packed[k]);
        node.active = node.active || m_boxes[k].active();
      }
      for (std::int32_t c = 0; c < node.children; ++c) {
        const Node& child = m_nodes[node.child + c];
        node.bounds = Packing<D>::merged(node.bounds, child.bounds);
        node.active = node.active || child.active;
      }
    }
  }

  void pairsWithin(std::int32_t at) {
    const Node& node = m_nodes[at];
    ++m_visits;
    if (!node.active) return;
    for (std::int32_t k = node.begin; k < node.own; ++k) {
      test(k, k + 1, node.own);
      for (std::int32_t c = 0; c < node.children; ++c) pairsBelow(k, node.child + c);
    }
    for (std::int32_t c = 0; c < node.children; ++c) {
      pairsWithin(node.child + c);
      for (std::int32_t e = c + 1; e < node.children; ++e) pairsBetween(node.child + c, node.child + e);
    }
  }
  // Two disjoint subtrees, traversed together.
  void pairsBetween(std::int32_t a, std::int32_t b) {
    const Node &left = m_nodes[a], &right = m_nodes[b];
    ++m_visits;
    if (!(left.active || right.active) || !Packing<D>::overlap(left.bounds, right.bounds)) return;
    for (std::int32_t k = left.begin; k < left.own; ++k) pairsBelow(k, b);
    for (std::int32_t c = 0; c < left.children; ++c) {
      // Tests the right node's own boxes against the left children; the recursion handles its subtrees.
      for (std::int32_t k = right.begin; k < right.own; ++k) pairsBelow(k, left.child + c);
      for (std::int32_t e = 0; e < right.children; ++e) pairsBetween(left.child + c, right.child + e);
    }
  }
  // One box against a subtree.
  void pairsBelow(std::int32_t item, std::int32_t at) {
    const Node& node = m_nodes[at];
    ++m_visits;
    if (!Packing<D>::overlap(m_packed[item], node.bounds)) return;
    if (!node.active && !m_boxes[item].active()) return;
    test(item, node.begin, node.own);
    for (std::int32_t c = 0; c < node.children; ++c) pairsBelow(item, node.child + c);
  }
  void test(std::int32_t item, std::int32_t begin, std::int32_t end) {
    if (begin >= end) return;
    const auto most = static_cast<std::size_t>(end - begin);
    m_tests += most;
    if (m_hits.size() < most + kListAhead) m_hits.resize(most + kListAhead);
    const std::int32_t* stop = listOverlaps<D>(m_packed.data(), m_packed[item], begin, end, m_hits.data());
    for (const std::int32_t* hit = m_hits.data(); hit != stop; ++hit) {
      emitIfPair(m_boxes[item], m_boxes[*hit], *m_out);
    }
  }

  void tell(std::int32_t at, const Cell& corner, int depth, std::vector<StructureBox<D>>& out) const {
    const Node& node = m_nodes[at];
    const bool loose = m_params.mode == Mode::loose;
    out.push_back({regionBounds(corner, depth, loose ? m_params.looseness : Real(1)), depth, node.own > node.begin});
    for (std::int32_t c = node.child; c < node.child + node.children; ++c) {
      tell(c, part(corner, depth, childDigit(m_nodes[c].begin, depth)), depth + 1, out);
    }
  }

  // --- multi: no tree is kept; m_items is a stack with the list of the present region on top ------------------------

  void gatherUnsorted(const Proxies<D>& proxies) {
    m_boxes.resize(m_slots.size()), m_packed.resize(m_slots.size() + kListAhead);
    for (std::size_t k = 0; k < m_slots.size(); ++k) {
      m_boxes[k] = GatheredBox<D>::of(proxies, m_slots[k]);
      m_packed[k] = m_packing.pack(m_boxes[k].lo, m_boxes[k].hi);
    }
  }

  // Sub-region c of this region.
  static Cell part(Cell corner, int depth, std::size_t c) {
    for (std::size_t d = 0; d < D; ++d) corner[d] += static_cast<std::uint32_t>((c >> d) & 1) << (kBits - depth - 1);
    return corner;
  }
  // Enlarged to `looseness` times its edge. Box corners were truncated to integers, of which a float fills only the
  // high bits: a grown region gets one unit more.
  Aabb<D> regionBounds(const Cell& corner, int depth, Real looseness) const {
    const auto edge = static_cast<double>(std::uint64_t{1} << (kBits - depth));
    const double room = looseness > 1 ? edge * (static_cast<double>(looseness) - 1) / 2 + Packing<D>::kUnit : 0;
    IndexedArray<double, D> lo, hi;
    for (std::size_t d = 0; d < D; ++d) lo[d] = corner[d] - room, hi[d] = corner[d] + edge + room;
    return m_packing.region(lo, hi);
  }

  PackedBox regionBox(const Cell& corner, int depth) const {
    PackedBox box{0, 0};
    const std::uint64_t edge = (std::uint64_t{1} << (kBits - depth)) - 1;
    for (int d = 0; d < D; ++d) {
      const std::uint64_t lo = corner[d];
      box.lo |= lo << (d * (kBits + 1)), box.hi |= (lo + edge) << (d * (kBits + 1));
    }
    return box;
  }

  // Divides a region only while most of its boxes are smaller than a sub-region; larger boxes would be in all
  // sub-regions at every depth. Always inlined into the step: as a call it took a seventh of the step's time in 2D.
  __attribute__((always_inline)) bool divides(int depth, const std::int32_t* begin, const std::int32_t* end) const {
    if (end - begin <= m_params.capacity || depth >= m_params.maxDepth) return false;
    const std::uint64_t edge = std::uint64_t{1} << (kBits - depth - 1);
    std::ptrdiff_t fit = 0;
    for (const std::int32_t* item = begin; item < end; ++item) {
      const PackedBox& box = m_packed[*item];
      bool small = true;
      for (int d = 0; d < D; ++d) {
        small = small && Packing<D>::field(box.hi, d) - Packing<D>::field(box.lo, d) < edge;
      }
      fit += small ? 1 : 0;
    }
    return 2 * fit > end - begin;
  }

  void visitRegion(const Cell& corner, int depth, std::size_t begin, std::size_t end) {
    ++m_visits;
    const std::size_t count = end - begin;
    if (count < 2) return;
    if (divides(depth, m_items.data() + begin, m_items.data() + end)) {
      for (std::size_t c = 0; c < kChildren; ++c) {
        const Cell inner = part(corner, depth, c);
        const PackedBox box = regionBox(inner, depth + 1);
        m_items.resize(end);
        for (std::size_t k = begin; k < end; ++k) {
          const std::int32_t item = m_items[k];
          if (Packing<D>::overlap(m_packed[item], box)) m_items.push_back(item);
        }
        visitRegion(inner, depth + 1, end, m_items.size());
      }
      return;
    }
    pairsInLeaf(regionBox(corner, depth), begin, end);
  }

  // Repeats the decisions of visitRegion() for these boxes.
  void tellAgain(const Cell& corner, int depth, const std::vector<std::int32_t>& items,
                 std::vector<StructureBox<D>>& out) const {
    const bool leaf = items.size() < 2 || !divides(depth, items.data(), items.data() + items.size());
    out.push_back({regionBounds(corner, depth, Real(1)), depth, leaf && !items.empty()});
    if (leaf) return;
    for (std::size_t c = 0; c < kChildren; ++c) {
      const Cell inner = part(corner, depth, c);
      const PackedBox box = regionBox(inner, depth + 1);
      std::vector<std::int32_t> within(items.size());  // push_back would be shared with the step as well
      const auto end = std::copy_if(items.begin(), items.end(), within.begin(),
                                    [&](std::int32_t item) { return Packing<D>::overlap(m_packed[item], box); });
      within.erase(end, within.end());
      tellAgain(inner, depth + 1, within, out);
    }
  }

  // A pair may meet in several leaves. It counts in the leaf with the larger of the two lower corners, per axis: that
  // corner lies in both boxes, so both are in its leaf.
  void pairsInLeaf(const PackedBox& region, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = m_items[k];
      m_tests += end - k - 1;
      for (std::size_t l = k + 1; l < end; ++l) {
        const auto j = m_items[l];
        if (!Packing<D>::overlap(m_packed[i], m_packed[j])) continue;
        bool here = true;
        for (int d = 0; d < D; ++d) {
          const std::uint64_t lo = std::max(Packing<D>::field(m_packed[i].lo, d), Packing<D>::field(m_packed[j].lo, d));
          here = here && lo >= Packing<D>::field(region.lo, d) && lo <= Packing<D>::field(region.hi, d);
        }
        if (here) emitIfPair(m_boxes[i], m_boxes[j], *m_out);
      }
    }
  }

  static constexpr int kDepthBits = 5;

  Params m_params;
  Packing<D> m_packing;
  std::vector<ProxyPair>* m_out = nullptr;  // during findPairs
  std::uint64_t m_tests = 0, m_visits = 0;
  std::vector<ProxyId> m_slots;
  std::vector<Real> m_sample;
  IndexedVector<KeyedIndex<std::uint64_t>> m_order, m_scratch;
  IndexedVector<GatheredBox<D>> m_boxes;
  IndexedVector<PackedBox> m_packed;
  IndexedVector<Node> m_nodes;
  std::vector<int> m_depth;  // of each node, while building
  IndexedVector<std::int32_t> m_items, m_hits;
};

}  // namespace

LPC_REGISTER(Broadphase, RegionTree, 2, 3);

}}  // namespace lpc::LPC_PRECISION
