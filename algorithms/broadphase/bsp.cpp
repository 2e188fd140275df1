// SPDX-License-Identifier: Zlib
#include <numeric>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/packed_box.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// Binary space partition by axis-aligned planes that adapts locally (Luque, Comba & Freitas 2005). Planes are kept from
// step to step, and all boxes are sorted through them anew. A plane that leaves too many boxes on one side, or cuts too
// many, is replaced, and its subtree is discarded: a new tree is the same at every node.
//
// A box that a plane cuts is listed on both sides. Stored at the plane's node instead, it would have to be tested
// against both whole subtrees. So there are only short lists in the leaves, compared without a branch. A pair counts in
// the leaf of the larger of its two lower corners, per axis: that point is in both boxes and in exactly one leaf.
template <int D>
class Bsp final : public Broadphase<D> {
 public:
  struct Params {
    int leaf = 16, depth = 24;
    Real balance = Real(0.8), cut = Real(0.3);
    void visit(ParamVisitor& v) {
      v.integer("leaf", leaf, 1, 1000, "boxes that a region holds before it is divided");
      v.integer("depth", depth, 0, 32, "divisions above a region at most");
      v.real("balance", balance, Real(0.625), Real(0.95), "1",
             "share of a region's boxes that stand on one side of its plane at most");
      v.real("cut", cut, 0, Real(0.75), "1", "share of a region's boxes that its plane cuts at most");
    }
  };
  explicit Bsp(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "bsp",
            .summary = "binary space partition whose planes are kept while they divide well",
            .paper = "luque2005",
            .complexity = "n log n + pairs in the same leaf; cut boxes stand in several",
            .failures = {{.when = "a crowd that goes far in a step",
                          .symptom = "leaves its planes behind: all are chosen anew",
                          .test = "bsp_flying_crowd_work"},
                         {.when = "every plane cuts many boxes, as in a lattice of long sticks",
                          .symptom = "nothing is divided, every pair is tested",
                          .test = "bsp_lattice_work"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    m_awake = static_cast<std::int32_t>(listActiveFirst(proxies, m_slots));
    if (m_slots.size() < 2) return;
    m_packing = Packing<D>(findWindow(proxies, m_slots, m_sample));
    const std::size_t n = m_slots.size();
    m_boxes.resize(n), m_packed.resize(n), m_items.resize(std::max(m_items.size(), n));
    for (std::size_t k = 0; k < n; ++k) {
      m_boxes[k] = GatheredBox<D>::of(proxies, m_slots[k]);
      m_packed[k] = m_packing.pack(m_boxes[k].lo, m_boxes[k].hi);
      m_items[k] = static_cast<std::int32_t>(k);
    }
    m_tests = m_visits = m_moves = m_found = 0;
    m_nodes.reserve(n);  // usually more than needed
    ++m_step;
    visit(0, {0, n, n, 0, 0});
    for (std::size_t k = 0; k < m_found; ++k) {
      emitIfPair(m_boxes[m_hits[k].a], m_boxes[m_hits[k].b], out);
    }
    work[WorkCount::boxTests] += m_tests;
    work[WorkCount::nodeVisits] += m_visits;
    work[WorkCount::sortMoves] += m_moves;
  }

  /// All of space, and the halves of each region that a plane divides.
  void structure(std::vector<StructureBox<D>>& out) const override {
    if (m_slots.size() < 2) return;
    std::vector<std::int32_t> items(m_packed.size());
    std::iota(items.begin(), items.end(), 0);
    Fields lo, hi;
    lo.fill(0), hi.fill(static_cast<double>(Packing<D>::kField) + 1);
    tell(0, lo, hi, 0, items, out);
  }

 private:
  using Fields = IndexedArray<double, D>;  // packed coordinates of a corner

  static constexpr int kBits = Packing<D>::kBits;
  static constexpr std::uint64_t kGuards = Packing<D>::kGuards;

  struct Plane {
    Real at = 0;    // m: the window, and with it the packed coordinate, changes from step to step
    int axis = -1;  // none
  };
  struct Node {
    Plane plane;
    std::int32_t child = -1;  // of the side below the plane; the other side is the next one
    std::int32_t whole = 0;   // number of boxes at the last attempt that found no plane
  };
  // Boxes of a region: m_items[begin .. end), awake ones first. From `top` on, m_items is free.
  struct Region {
    std::size_t begin, end, top;
    std::uint64_t lowest;  // corner, packed
    int depth;

    std::size_t count() const { return end - begin; }
  };
  struct Parts {
    std::size_t below, above;
  };
  struct LeafBox {
    PackedBox box;
    std::uint64_t begins;  // guard bits of the axes along which the box begins in this leaf
    std::int32_t item;
  };
  struct Hit {
    std::int32_t a, b;  // items
  };

  void visit(std::int32_t at, const Region& r) {
    ++m_visits;
    const auto most = static_cast<std::size_t>(m_params.leaf);
    if (r.count() <= most / 2)
      forget(at);  // only when half are gone; a box that moves to and fro would otherwise cost a plane each time
    if (r.count() < 2 || m_items[r.begin] >= m_awake) return;
    Parts parts;
    if (r.count() <= most || r.depth == m_params.depth || !divide(at, r, parts)) return pairsInLeaf(r);
    const Node node = m_nodes[at];
    const int shift = node.plane.axis * (kBits + 1);
    const std::uint64_t border = (r.lowest & ~(Packing<D>::kField << shift)) | packed(node.plane) << shift;
    const std::size_t above = r.top + r.count(), top = above + r.count();
    visit(node.child, {r.top, r.top + parts.below, top, r.lowest, r.depth + 1});
    visit(node.child + 1, {above, above + parts.above, top, border, r.depth + 1});
  }

  // Divides by the present plane if it still divides well, else by a new one. Returns false if there is none.
  bool divide(std::int32_t at, const Region& r, Parts& parts) {
    if (m_items.size() < r.top + 2 * r.count() + 1) m_items.resize(2 * (r.top + 2 * r.count() + 1));
    const Node node = m_nodes[at];
    if (node.plane.axis >= 0) {
      parts = split(node.plane, r);
      if (divideWell(parts, r)) return true;
      forget(at);
    } else if (r.count() <= 2 * static_cast<std::size_t>(node.whole) &&
               (m_step + static_cast<std::uint32_t>(at)) % kPatience != 0) {
      return false;
    }
    for (const Plane& plane : choosePlanes(r)) {
      parts = split(plane, r);
      if (!divideWell(parts, r)) continue;
      const std::int32_t child = newChildren();
      m_nodes[at] = {plane, child, 0};
      return true;
    }
    m_nodes[at].whole = static_cast<std::int32_t>(r.count());
    return false;
  }
  bool divideWell(const Parts& parts, const Region& r) const {
    const auto count = static_cast<Real>(r.count()), larger = static_cast<Real>(std::max(parts.below, parts.above));
    const auto cut = static_cast<Real>(parts.below + parts.above - r.count());
    return cut <= m_params.cut * count && larger <= m_params.balance * count && larger < count;
  }

  std::int32_t newChildren() {
    std::int32_t child = m_free;
    if (child >= 0) {
      m_free = m_nodes[child].child;
    } else {
      child = static_cast<std::int32_t>(m_nodes.size());
      m_nodes.resize(m_nodes.size() + 2);
    }
    m_nodes[child] = m_nodes[child + 1] = {};
    return child;
  }
  void forget(std::int32_t at) {
    const std::int32_t child = m_nodes[at].child;
    m_nodes[at] = {};
    if (child < 0) return;
    forget(child), forget(child + 1);
    m_nodes[child].child = m_free;
    m_free = child;
  }

  std::uint64_t packed(const Plane& plane) const {
    IndexedArray<Real, D> corner;
    corner.fill(plane.at);
    return Packing<D>::field(m_packing.pack(corner, corner).lo, plane.axis);
  }

  // Lists the boxes below the plane from r.top on, and those on or above the plane after them.
  Parts split(const Plane& plane, const Region& r) {
    const std::uint64_t border = packed(plane);
    const int shift = plane.axis * (kBits + 1);
    std::int32_t* const items = m_items.data();
    std::int32_t *below = items + r.top, *above = below + r.count();
    for (std::size_t k = r.begin; k < r.end; ++k) {
      const std::int32_t item = items[k];
      const PackedBox box = m_packed[item];
      *below = item, *above = item;
      below += static_cast<int>(((box.lo >> shift) & Packing<D>::kField) < border);
      above += static_cast<int>(((box.hi >> shift) & Packing<D>::kField) >= border);
    }
    m_moves += r.count();
    return {static_cast<std::size_t>(below - items) - r.top,
            static_cast<std::size_t>(above - items) - r.top - r.count()};
  }

  // Repeats the decisions that visit() made for these boxes.
  void tell(std::int32_t at, const Fields& lo, const Fields& hi, int level, const std::vector<std::int32_t>& items,
            std::vector<StructureBox<D>>& out) const {
    const Node& node = m_nodes[at];
    const bool kept = items.size() <= static_cast<std::size_t>(m_params.leaf);  // its plane is kept for later
    const bool leaf = node.plane.axis < 0 || kept || items.front() >= m_awake || level == m_params.depth;
    out.push_back({m_packing.region(lo, hi), level, leaf && !items.empty()});
    if (leaf) return;
    const std::uint64_t border = packed(node.plane);
    const auto axis = node.plane.axis;
    const auto part = [&](const auto& enters) {
      std::vector<std::int32_t> in(items.size());
      in.erase(
          std::copy_if(items.begin(), items.end(), in.begin(), [&](std::int32_t i) { return enters(m_packed[i]); }),
          in.end());
      return in;
    };
    const auto below = part([&](const PackedBox& b) { return Packing<D>::field(b.lo, node.plane.axis) < border; });
    const auto above = part([&](const PackedBox& b) { return Packing<D>::field(b.hi, node.plane.axis) >= border; });
    Fields middle = hi;
    middle[axis] = static_cast<double>(border);
    tell(node.child, lo, middle, level + 1, below, out);
    middle = lo, middle[axis] = static_cast<double>(border);
    tell(node.child + 1, middle, hi, level + 1, above, out);
  }

  // Through the median centre of a sample, first along the axis on which most boxes fit side by side.
  IndexedArray<Plane, D> choosePlanes(const Region& r) {
    const std::size_t samples = std::min(r.count(), kSamples);
    m_moves += D * samples;
    IndexedArray<IndexedArray<std::uint64_t, kSamples>, D> centers;
    IndexedArray<double, D> room;
    for (std::size_t d = 0; d < D; ++d) {
      std::uint64_t least = ~std::uint64_t{0}, most = 0, size = 0;
      for (std::size_t k = 0; k < samples; ++k) {
        const auto item = static_cast<std::size_t>(m_items[r.begin + k * r.count() / samples]);
        const std::uint64_t lo = Packing<D>::field(m_packed[item].lo, static_cast<int>(d));
        const std::uint64_t hi = Packing<D>::field(m_packed[item].hi, static_cast<int>(d));
        centers[d][k] = (lo + hi) << 31 | item;
        least = std::min(least, lo + hi), most = std::max(most, lo + hi), size += hi - lo;
      }
      room[d] = static_cast<double>(most - least) / static_cast<double>(size + 1);
    }
    IndexedArray<Plane, D> planes;
    for (Plane& plane : planes) {
      const auto d = static_cast<std::size_t>(std::max_element(room.begin(), room.end()) - room.begin());
      room[d] = -1;
      const auto middle = centers[d].begin() + static_cast<std::ptrdiff_t>(samples / 2);
      std::nth_element(centers[d].begin(), middle, centers[d].begin() + static_cast<std::ptrdiff_t>(samples));
      const GatheredBox<D>& box = m_boxes[*middle & 0x7fffffffu];
      plane = {box.lo[d] / 2 + box.hi[d] / 2, static_cast<int>(d)};
    }
    return planes;
  }

  void pairsInLeaf(const Region& r) {
    const auto count = static_cast<std::int32_t>(r.count());
    if (m_leaf.size() < r.count() + kListAhead) m_leaf.resize(2 * (r.count() + kListAhead));
    std::int32_t awake = 0;
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t item = m_items[r.begin + static_cast<std::size_t>(k)];
      const PackedBox& box = m_packed[item];
      m_leaf[k] = {box, (box.lo | kGuards) - r.lowest, item};
      awake += item < m_awake ? 1 : 0;
    }
    for (std::int32_t a = 0; a < awake; ++a) {
      if (m_hits.size() < m_found + r.count() + kListAhead) m_hits.resize(2 * (m_found + r.count() + kListAhead));
      m_found = static_cast<std::size_t>(listHits(a, count, m_hits.data() + m_found) - m_hits.data());
      m_tests += static_cast<std::uint64_t>(count - a - 1);
    }
  }

  // Like listOverlaps, for boxes that count here: on each axis one of the two begins in this leaf.
  Hit* listHits(std::int32_t a, std::int32_t end, Hit* hits) const {
    const LeafBox* boxes = m_leaf.data();
    const LeafBox first = boxes[a];
    for (std::int32_t begin = a + 1; begin < end; begin += kListAhead) {
      for (std::int32_t k = begin; k < begin + kListAhead; ++k) {
        const LeafBox& b = boxes[k];
        *hits = {first.item, b.item};
        const bool counts = (~(first.begins | b.begins) & kGuards) == 0;
        hits += static_cast<int>(counts) & static_cast<int>(Packing<D>::overlap(first.box, b.box)) &
                static_cast<int>(k < end);
      }
    }
    return hits;
  }

  static constexpr std::size_t kSamples = 32;
  static constexpr std::uint32_t kPatience = 8;  // steps before an undivided region is tried again

  Params m_params;
  Packing<D> m_packing;
  std::int32_t m_awake = 0;
  std::uint32_t m_step = 0;
  std::uint64_t m_tests = 0, m_visits = 0, m_moves = 0;
  std::size_t m_found = 0;  // in m_hits
  std::vector<ProxyId> m_slots;
  std::vector<Real> m_sample;
  IndexedVector<GatheredBox<D>> m_boxes;
  IndexedVector<PackedBox> m_packed;
  std::vector<std::int32_t> m_items;       // a stack of lists of boxes
  IndexedVector<Node> m_nodes = {Node{}};  // the root first, then pairs; kept from step to step
  std::int32_t m_free = -1;                // the first pair of unused nodes; its `child` is the next one
  IndexedVector<LeafBox> m_leaf;
  std::vector<Hit> m_hits;
};

}  // namespace

LPC_REGISTER(Broadphase, Bsp, 2, 3);

}}  // namespace lpc::LPC_PRECISION
