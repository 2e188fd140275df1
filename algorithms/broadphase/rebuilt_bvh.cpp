// SPDX-License-Identifier: Zlib
#include <bit>
#include <utility>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/packed_box.h"
#include "algorithms/broadphase/radix_sort.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// A binary tree of boxes, built anew in each update and descended against itself. Nodes have the exact bounds of what
// is below, so that boxes of any scales together cost nothing but the build; boxes of a leaf are compared packed first.
//   median  half of the boxes on either side of the median centre, on the axis where centres spread most
//   sah     the border between two of `bins` slices of that axis with the least surface times boxes (Wald 2007)
//   morton  sorted along a Morton curve, split where its codes differ first (Lauterbach 2009, Karras 2012)
template <int D>
class RebuiltBvh final : public Broadphase<D> {
 public:
  enum class Build { median, sah, morton };
  struct Params {
    Build build = Build::morton;
    int leaf = 16, bins = 16, refit = 0;
    void visit(ParamVisitor& v) {
      v.choice("build", build, {"median", "sah", "morton"}, "where the boxes of a node are divided");
      v.integer("leaf", leaf, 1, kMostInLeaf, "boxes in a leaf at most");
      v.integer("bins", bins, 2, kMostBins, "sah only: slices of a node's centres");
      v.integer("refit", refit, 0, 1000, "updates that only refit the boxes of the tree before it is built again");
    }
  };
  explicit RebuiltBvh(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "rebuilt_bvh",
            .summary = "binary tree of tight boxes, rebuilt each step",
            .paper = "lauterbach2009",
            .complexity = "n log n + pairs of nodes that overlap",
            .failures = {{.when = "build=morton and more than a twentieth of the boxes far from all others",
                          .symptom = "the others have one code and stand in the order of their slots",
                          .test = "morton_far_crowd_work"},
                         {.when = "refit > 0 and boxes that change places",
                          .symptom = "nodes grow over each other until the next build",
                          .test = "refit_shuffled_work"}}};
  }

  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    listSlots(proxies, m_listed);
    const bool same = changes.added.empty() && changes.removed.empty() && m_listed == m_slots;
    if (same && m_age < m_params.refit) {
      ++m_age;
    } else {
      m_slots.swap(m_listed), m_age = 0;
      m_nodes.clear();
      if (!m_slots.empty()) build(proxies);
    }
    if (!m_slots.empty()) fit(proxies);
  }

  void findPairs(const Proxies<D>&, std::vector<ProxyPair>& out, WorkDone& work) override {
    work[WorkCount::sortMoves] += std::exchange(m_moves, 0);
    if (m_nodes.empty()) return;
    std::uint64_t visits = 0, tests = 0;
    // A popped pair pushes at most three pairs, one of them a level deeper; one place is written ahead.
    std::array<std::array<std::int32_t, 2>, 4 * kDeepest> stack;
    std::size_t top = 0;
    const auto push = [&](std::int32_t a, std::int32_t b) {
      const Node &x = m_nodes[a], &y = m_nodes[b];
      ++visits;
      stack[top] = {a, b};  // without a branch: half of the tests hit
      top += static_cast<std::size_t>((x.active | y.active) & static_cast<int>(x.overlaps(y)));
    };
    m_hits = 0;
    push(0, 0);
    while (top > 0) {
      const auto [a, b] = stack[--top];
      const Node &x = m_nodes[a], &y = m_nodes[b];
      const bool leafX = isLeaf(a), leafY = isLeaf(b);
      if (leafX && leafY) {
        tests += a == b ? hitsInLeaf(x) : hitsOfLeaves(x, y);
        if (m_hits >= kFlush) flush(out);
      } else if (a == b) {
        const std::int32_t right = rightOf(a);
        push(a + 1, right), push(right, right), push(a + 1, a + 1);
      } else if (leafY || (!leafX && x.end - x.begin >= y.end - y.begin)) {
        push(rightOf(a), b), push(a + 1, b);
      } else {
        push(a, rightOf(b)), push(a, b + 1);
      }
    }
    flush(out);
    work[WorkCount::boxTests] += tests;
    work[WorkCount::nodeVisits] += visits;
  }

  void overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const override {
    visit(
        proxies, [&](const Aabb<D>& b) { return b.overlaps(box); }, [&](ProxyId i) { out.push_back(i); });
  }
  void ray(const Proxies<D>& proxies, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
           std::vector<RayHit<D>>& out) const override {
    RayHit<D> first{-1, maxT};
    Real t = 0;  // of the box of the last query
    const auto meets = [&](const Aabb<D>& b) {
      t = castRay(b, p, direction, maxT);
      return t >= 0 && !(firstOnly && t > first.t);
    };
    visit(proxies, meets, [&](ProxyId i) {
      if (!firstOnly) {
        out.push_back({i, t});
      } else if (first.proxy < 0 || t < first.t || i < first.proxy) {
        first = {i, t};
      }
    });
    if (first.proxy >= 0) out.push_back(first);
  }
  void sweep(const Proxies<D>& proxies, const Aabb<D>& box, const Vec<D>& displacement,
             std::vector<RayHit<D>>& out) const override {
    Real t = 0;
    const auto meets = [&](const Aabb<D>& b) { return (t = castBox(box, displacement, Real(1), b)) >= 0; };
    visit(proxies, meets, [&](ProxyId i) { out.push_back({i, t}); });
  }

  void structure(std::vector<StructureBox<D>>& out) const override {
    std::array<std::int32_t, kDeepest> past;  // ends of the nodes above
    std::size_t level = 0;
    for (std::int32_t at = 0; at < static_cast<std::int32_t>(m_nodes.size()); ++at) {
      const Node& node = m_nodes[at];
      while (level > 0 && past[level - 1] == at) --level;
      out.push_back({node.box(), static_cast<int>(level), isLeaf(at)});
      if (!isLeaf(at)) past[level++] = node.past;
    }
  }

 private:
  static constexpr int kMostInLeaf = 32, kMostBins = 64;
  static constexpr std::size_t kFlush = 1024;         // pairs collected before they are tested
  static constexpr int kCodeBits = D == 2 ? 16 : 11;  // of a Morton code, per axis
  static constexpr std::size_t kBySurface = 40;       // levels; deeper ranges are halved
  static constexpr std::size_t kDeepest = 80;         // levels: codes have 33 bits, numbers of boxes 31

  struct Node {
    IndexedArray<Real, D> lo, hi;
    std::int32_t begin, end;  // boxes below
    std::int32_t past;        // the next node after this subtree, in preorder
    std::uint8_t active;      // any box below
    PackedBox packed;         // the bounds of a leaf

    bool overlaps(const Node& other) const {
      bool yes = true;
      for (std::size_t d = 0; d < D; ++d) yes = yes & (lo[d] <= other.hi[d]) & (other.lo[d] <= hi[d]);
      return yes;
    }
    Aabb<D> box() const { return {Vec<D>(lo.data()), Vec<D>(hi.data())}; }
  };
  struct Item {
    IndexedArray<Real, D> center;
    ProxyId slot;
  };
  struct Range {
    std::int32_t begin, end;
    std::size_t depth;
  };

  bool isLeaf(std::int32_t at) const { return m_nodes[at].past == at + 1; }
  std::int32_t rightOf(std::int32_t at) const { return m_nodes[at + 1].past; }

  void build(const Proxies<D>& proxies) {
    const std::size_t n = m_slots.size();
    m_moves += n;
    m_nodes.reserve(2 * n), m_order.resize(n), m_items.resize(n);
    if (m_params.build == Build::morton) {
      sortByCode(proxies);
    } else {
      for (std::size_t k = 0; k < n; ++k) {
        const auto i = m_slots[k];
        for (std::size_t d = 0; d < D; ++d) m_items[k].center[d] = proxies.lo[d][i] / 2 + proxies.hi[d][i] / 2;
        m_items[k].slot = m_slots[k];
      }
    }
    // One range waits per level.
    std::array<Range, kDeepest> stack;
    std::size_t top = 0;
    stack[top++] = {0, static_cast<std::int32_t>(n), 0};
    while (top > 0) {
      const Range range = stack[--top];
      m_nodes.push_back({{}, {}, range.begin, range.end, 0, 0, {}});
      if (range.end - range.begin <= m_params.leaf) continue;
      const std::int32_t middle = divide(proxies, range);
      stack[top++] = {middle, range.end, range.depth + 1};
      stack[top++] = {range.begin, middle, range.depth + 1};
    }
    if (m_params.build != Build::morton) {
      for (std::size_t k = 0; k < n; ++k) m_order[k] = m_items[k].slot;
    }
    for (std::size_t at = m_nodes.size(); at-- > 0;) {
      Node& node = m_nodes[at];
      const bool leaf = node.end - node.begin <= m_params.leaf;
      node.past = static_cast<std::int32_t>(at) + 1;
      if (!leaf) node.past = m_nodes[m_nodes[at + 1].past].past;
    }
  }

  std::int32_t divide(const Proxies<D>& proxies, const Range& range) {
    switch (m_params.build) {
      case Build::morton:
        return divideByCode(range);
      case Build::sah:
        if (range.depth < kBySurface) return divideBySurface(proxies, range);
        return divideAtMedian(range);
      case Build::median:
        return divideAtMedian(range);
    }
    return range.begin;  // not reached
  }

  void sortByCode(const Proxies<D>& proxies) {
    const Window<D> window = findWindow(proxies, m_slots, m_sample);
    IndexedArray<Scale, D> scale;
    for (std::size_t d = 0; d < D; ++d) {
      scale[d] = Scale(window.lo[d], window.hi[d], static_cast<Real>((1 << kCodeBits) - 1));
    }
    m_codes.resize(m_slots.size());
    for (std::size_t k = 0; k < m_slots.size(); ++k) {
      const auto i = m_slots[k];
      std::uint64_t code = 0;
      for (std::size_t d = 0; d < D; ++d) {
        const Real center = proxies.lo[d][i] / 2 + proxies.hi[d][i] / 2;
        code |= spread(static_cast<std::uint64_t>(static_cast<std::int64_t>(scale[d](center)))) << d;
      }
      m_codes[k] = {code, m_slots[k]};
    }
    radixSort(m_codes, m_scratch, kCodeBits * D);
    for (std::size_t k = 0; k < m_slots.size(); ++k) m_order[k] = m_codes[k].index;
  }
  // Puts D - 1 zeros between the bits.
  static std::uint64_t spread(std::uint64_t x) {
    if constexpr (D == 2) {
      x = (x | (x << 8)) & 0x00ff00ff;
      x = (x | (x << 4)) & 0x0f0f0f0f;
      x = (x | (x << 2)) & 0x33333333;
      return (x | (x << 1)) & 0x55555555;
    } else {
      x = (x | (x << 16)) & 0x0000ff0000ff;
      x = (x | (x << 8)) & 0x00f00f00f00f;
      x = (x | (x << 4)) & 0x0c30c30c30c3;
      return (x | (x << 2)) & 0x249249249249;
    }
  }
  std::int32_t divideByCode(const Range& range) const {
    const auto code = [&](std::int32_t k) { return m_codes[k].key; };
    const std::uint64_t differ = code(range.begin) ^ code(range.end - 1);
    if (differ == 0) return range.begin + (range.end - range.begin) / 2;
    const std::uint64_t border = code(range.end - 1) & ~(std::bit_floor(differ) - 1);  // the first code on the right
    std::int32_t from = range.begin, to = range.end - 1;
    while (to - from > 1) {
      const std::int32_t middle = from + (to - from) / 2;
      (code(middle) < border ? from : to) = middle;
    }
    return to;
  }

  // The axis on which the centres spread most, and the spread; halved, since no difference of finite halves overflows.
  struct Spread {
    std::size_t axis = 0;
    Real from = 0, half = -1;
  };
  Spread widest(const Range& range) const {
    IndexedArray<Real, D> lo, hi;
    lo = hi = m_items[range.begin].center;
    for (std::int32_t k = range.begin + 1; k < range.end; ++k) {
      const Item& item = m_items[k];
      for (std::size_t d = 0; d < D; ++d) {
        lo[d] = std::min(lo[d], item.center[d]), hi[d] = std::max(hi[d], item.center[d]);
      }
    }
    Spread best;
    for (std::size_t d = 0; d < D; ++d) {
      if (hi[d] / 2 - lo[d] / 2 > best.half) best = {d, lo[d], hi[d] / 2 - lo[d] / 2};
    }
    return best;
  }
  std::int32_t divideAtMedian(const Range& range) { return halve(range, widest(range).axis); }
  std::int32_t halve(const Range& range, std::size_t axis) {
    const std::int32_t middle = range.begin + (range.end - range.begin) / 2;
    const auto from = m_items.begin();
    std::nth_element(from + range.begin, from + middle, from + range.end, [axis](const Item& a, const Item& b) {
      return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.slot < b.slot;
    });
    return middle;
  }

  struct Bin {
    Aabb<D> box;
    std::int32_t count = 0;
  };
  std::int32_t divideBySurface(const Proxies<D>& proxies, const Range& range) {
    const Spread spread = widest(range);
    const Real factor = static_cast<Real>(m_params.bins) / spread.half;
    if (!(factor < std::numeric_limits<Real>::max())) return halve(range, spread.axis);
    const auto binOf = [&](const Item& item) {
      const Real t = (item.center[spread.axis] / 2 - spread.from / 2) * factor;
      return std::min(static_cast<std::size_t>(t), static_cast<std::size_t>(m_params.bins - 1));
    };
    const auto bins = static_cast<std::size_t>(m_params.bins);
    std::array<Bin, kMostBins> bin;
    for (std::int32_t k = range.begin; k < range.end; ++k) {
      const Item& item = m_items[k];
      Bin& b = bin[binOf(item)];
      b.box = b.box.merged(proxies.box(item.slot)), ++b.count;
    }
    // Cumulated from the right, the cost right of each border; from the left, the total.
    std::array<Real, kMostBins> right;
    Bin sum;
    for (std::size_t b = bins; b-- > 1;) {
      sum.box = sum.box.merged(bin[b].box), sum.count += bin[b].count;
      right[b] = cost(sum);
    }
    sum = Bin{};
    Real least = std::numeric_limits<Real>::infinity();
    std::size_t border = 0;
    for (std::size_t b = 1; b < bins; ++b) {
      sum.box = sum.box.merged(bin[b - 1].box), sum.count += bin[b - 1].count;
      if (sum.count == 0 || sum.count == range.end - range.begin) continue;
      if (const Real total = cost(sum) + right[b]; total < least) least = total, border = b;
    }
    if (border == 0) return halve(range, spread.axis);  // surfaces beyond the numbers
    const auto from = m_items.begin();
    const auto middle =
        std::partition(from + range.begin, from + range.end, [&](const Item& item) { return binOf(item) < border; });
    return static_cast<std::int32_t>(middle - from);
  }
  static Real cost(const Bin& b) {
    if (b.count == 0) return 0;
    const Vec<D> size = b.box.hi - b.box.lo;
    Real border = size[0] + size[1];  // half of it
    if constexpr (D == 3) border = size[0] * size[1] + border * size[2];
    return static_cast<Real>(b.count) * border;
  }

  // Gathers the boxes in the order of the tree, and computes the bounds of the nodes from the leaves up.
  void fit(const Proxies<D>& proxies) {
    const Packing<D> packing(findWindow(proxies, m_slots, m_sample));
    m_boxes.resize(m_order.size()), m_packed.resize(m_order.size() + kListAhead);
    for (std::size_t k = 0; k < m_order.size(); ++k) {
      m_boxes[k] = GatheredBox<D>::of(proxies, m_order[k]);
      m_packed[k] = packing.pack(m_boxes[k].lo, m_boxes[k].hi);
    }
    for (std::size_t at = m_nodes.size(); at-- > 0;) {
      Node& node = m_nodes[at];
      if (node.past > static_cast<std::int32_t>(at) + 1) {
        const Node &left = m_nodes[at + 1], &right = m_nodes[left.past];
        for (std::size_t d = 0; d < D; ++d) {
          node.lo[d] = std::min(left.lo[d], right.lo[d]), node.hi[d] = std::max(left.hi[d], right.hi[d]);
        }
        node.active = left.active | right.active;
        continue;
      }
      const GatheredBox<D>& first = m_boxes[node.begin];
      node.lo = first.lo, node.hi = first.hi, node.active = first.active();
      for (std::int32_t k = node.begin + 1; k < node.end; ++k) {
        const GatheredBox<D>& box = m_boxes[k];
        for (std::size_t d = 0; d < D; ++d) {
          node.lo[d] = std::min(node.lo[d], box.lo[d]), node.hi[d] = std::max(node.hi[d], box.hi[d]);
        }
        node.active = node.active | static_cast<std::uint8_t>(box.active());
      }
      node.packed = packing.pack(node.lo, node.hi);
    }
  }

  // Collects overlapping pairs of packed boxes without a branch, and tests many at once: the ends of short lists are
  // unpredictable.
  std::uint64_t hitsInLeaf(const Node& x) {
    for (std::int32_t k = x.begin; k < x.end; ++k) note(k, k + 1, x.end);
    const auto n = static_cast<std::uint64_t>(x.end - x.begin);
    return n * (n - 1) / 2;
  }
  std::uint64_t hitsOfLeaves(const Node& x, const Node& y) {
    std::array<std::int32_t, kMostInLeaf + kListAhead> near;
    const std::int32_t* end = listOverlaps<D>(m_packed.data(), y.packed, x.begin, x.end, near.data());
    for (const std::int32_t* k = near.data(); k != end; ++k) note(*k, y.begin, y.end);
    return static_cast<std::uint64_t>(x.end - x.begin + (end - near.data()) * (y.end - y.begin));
  }
  void note(std::int32_t k, std::int32_t begin, std::int32_t end) {
    const PackedBox box = m_packed[k];
    std::array<std::int32_t, 2>* hit = m_hit.data() + m_hits;
    for (std::int32_t l = begin; l < end; ++l) {
      *hit = {k, l};
      hit += static_cast<int>(Packing<D>::overlap(m_packed[l], box));
    }
    m_hits = static_cast<std::size_t>(hit - m_hit.data());
  }
  void flush(std::vector<ProxyPair>& out) {
    for (std::size_t h = 0; h < m_hits; ++h) {
      const auto [k, l] = m_hit[h];
      emitIfPair(m_boxes[k], m_boxes[l], out);
    }
    m_hits = 0;
  }

  // Calls found(slot) for each box for which meets(box) holds. meets() of a box around others must hold if it holds for
  // one of them.
  template <class Meets, class Found>
  void visit(const Proxies<D>& proxies, const Meets& meets, const Found& found) const {
    for (std::size_t at = 0; at < m_nodes.size();) {
      const Node& node = m_nodes[at];
      if (!meets(node.box())) {
        at = static_cast<std::size_t>(node.past);
        continue;
      }
      if (++at == static_cast<std::size_t>(node.past)) {
        for (std::int32_t k = node.begin; k < node.end; ++k) {
          const ProxyId slot = m_order[k];
          if (meets(proxies.box(slot))) found(slot);
        }
      }
    }
  }

  Params m_params;
  int m_age = 0;                           // updates since the build
  std::uint64_t m_moves = 0;               // since the last findPairs
  std::vector<ProxyId> m_listed, m_slots;  // scratch; the slots in the tree, sorted
  IndexedVector<ProxyId> m_order;          // the same in the order of the tree
  std::vector<Real> m_sample;
  IndexedVector<KeyedIndex<std::uint64_t>> m_codes, m_scratch;
  IndexedVector<Item> m_items;
  IndexedVector<Node> m_nodes;            // in preorder
  IndexedVector<GatheredBox<D>> m_boxes;  // in the order of the tree
  IndexedVector<PackedBox> m_packed;      // the same
  std::size_t m_hits = 0;
  std::array<std::array<std::int32_t, 2>, kFlush + kMostInLeaf * kMostInLeaf + 1> m_hit;
};

}  // namespace

LPC_REGISTER(Broadphase, RebuiltBvh, 2, 3);

}}  // namespace lpc::LPC_PRECISION
