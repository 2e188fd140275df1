// SPDX-License-Identifier: Zlib
#include <bit>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/grid.h"
#include "algorithms/broadphase/packed_box.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// Cells of one size in an unbounded world, hashed into a table (Teschner et al. 2003) that a counting sort fills anew
// in each step. A box is entered in every cell that it covers. A pair counts in the cell of the larger of its two lower
// corners, per axis, which both boxes cover, so no set of pairs is needed. Boxes that cover many cells are kept apart
// and compared with all.
//
// Two cells may share a slot of the table, so the cell is compared, too. It is stored modulo 2^30 per axis (2D) or 2^20
// (3D). Boxes that far apart do not overlap, and overlapping boxes cover too few cells to meet twice.
template <int D>
class SpatialHash final : public Broadphase<D> {
 public:
  struct Params {
    Real cell = 0, table = 2;
    int most = 16;
    void visit(ParamVisitor& v) {
      v.real("cell", cell, 0, Real(1e6), "m", "edge of a cell; 0: from the sizes of the boxes that are awake");
      v.real("table", table, Real(0.0078125), 16, "1", "slots per box, before rounding up to a power of two");
      v.integer("most", most, 1, 1000, "cells that a box may cover before it stands apart");
    }
  };
  explicit SpatialHash(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "spatial_hash",
            .summary = "cells of one size hashed into a table, rebuilt each step by counting sort",
            .paper = "teschner2003",
            .complexity = "n + pairs in the same cell + n per large box",
            .failures = {{.when = "many boxes are far larger than most",
                          .symptom = "each of them is tested with all boxes",
                          .test = "hash_many_large_work"},
                         {.when = "most boxes are large and small ones stand close together",
                          .symptom = "the small ones share a cell, every pair of them is tested",
                          .test = "hash_crowded_cell_work"},
                         {.when = "boxes are long and thin",
                          .symptom = "a cell is as long as they are, and many of them share it",
                          .test = "hash_planks_work"},
                         {.when = "table=0.0078125: far fewer slots than boxes",
                          .symptom = "cells share slots, and their boxes are tested",
                          .test = "hash_collisions_work"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    const std::size_t awake = listActiveFirst(proxies, m_slots);
    if (m_slots.size() < 2) return;
    const Window<D> window = findWindow(proxies, m_slots, m_sample);
    m_grid = Grid<D>(window.lo, chooseCell(proxies));
    enter(proxies, Packing<D>(window), awake);
    sortEntries();
    m_tests = 0;
    visitSlots(out, work);
    for (std::size_t k = 0; k < m_large.size(); ++k) visitLarge(k, out);
    work[WorkCount::boxTests] += m_tests;
    work[WorkCount::sortMoves] += m_entries.size();
  }

  /// The cells that boxes reach, and the boxes that are kept apart.
  void structure(std::vector<StructureBox<D>>& out) const override {
    if (m_slots.size() < 2) return;
    const std::size_t before = out.size();
    for (const GatheredBox<D>& b : m_boxes) m_grid.tellCells(b, out);
    for (const Large& l : m_large) out.push_back({l.box.box(), 0, true});
    tellOnce(out, before);
  }

 private:
  static constexpr int kCellBits = D == 2 ? 30 : 20;  // per axis; D more bits above: the box begins in this cell
  static constexpr std::uint64_t kCellField = (std::uint64_t{1} << kCellBits) - 1;
  static constexpr std::uint64_t kCell = (std::uint64_t{1} << (D * kCellBits)) - 1;
  static constexpr std::uint64_t kBegins = ((std::uint64_t{1} << D) - 1) << (D * kCellBits);
  // Edge of a cell, in sizes of the median box: larger cells cost tests, smaller ones cost entries.
  static constexpr Real kRoom = Real(2.5);

  using Cell = IndexedArray<std::int32_t, D>;

  struct Entry {  // one box in one cell
    PackedBox box;
    std::uint64_t cell;
    std::int32_t item, slot;
  };
  struct Large {
    GatheredBox<D> box;
    PackedBox packed;
  };
  struct Hit {
    std::int32_t a, b;  // items
  };

  // m; 0 if all boxes are points.
  Real chooseCell(const Proxies<D>& proxies) {
    if (m_params.cell > 0) return m_params.cell;
    constexpr std::size_t kSamples = 128;
    sampleSizes(proxies, m_slots, kSamples, m_sample);
    const auto middle = m_sample.begin() + static_cast<std::ptrdiff_t>(m_sample.size() / 2);
    std::nth_element(m_sample.begin(), middle, m_sample.end());
    return kRoom * *middle;
  }

  // Awake boxes are entered first, and so come first in every slot.
  void enter(const Proxies<D>& proxies, const Packing<D>& packing, std::size_t awake) {
    const std::size_t n = m_slots.size();
    const double wanted = static_cast<double>(n) * static_cast<double>(m_params.table);
    m_bits = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(wanted)));
    m_start.assign((std::size_t{1} << m_bits) + 1, 0);
    m_boxes.clear(), m_packed.clear(), m_large.clear(), m_entries.clear();
    m_awake = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const GatheredBox<D> box = GatheredBox<D>::of(proxies, m_slots[k]);
      const PackedBox packed = packing.pack(box.lo, box.hi);
      Cell lo, count;
      std::int64_t cells = 1;
      for (std::size_t d = 0; d < D; ++d) {
        lo[d] = m_grid.coordinate(box.lo[d], d), count[d] = m_grid.coordinate(box.hi[d], d) - lo[d] + 1;
        cells = std::min<std::int64_t>(cells * count[d], m_params.most + 1);
      }
      if (cells > m_params.most) {
        m_large.push_back({box, packed});
        continue;
      }
      addEntries(lo, count, packed, static_cast<std::int32_t>(m_boxes.size()));
      m_boxes.push_back(box), m_packed.push_back(packed);
      if (k < awake) m_awake = m_boxes.size();
    }
  }

  void addEntries(const Cell& lo, const Cell& count, const PackedBox& packed, std::int32_t item) {
    const std::int32_t layers = D == 3 ? count[D - 1] : 1;
    for (std::int32_t z = 0; z < layers; ++z) {
      for (std::int32_t y = 0; y < count[1]; ++y) {
        std::uint64_t row = field(lo[1] + y, 1);
        std::uint64_t begins = y == 0 ? 2 : 0;
        if constexpr (D == 3) row |= field(lo[2] + z, 2), begins |= z == 0 ? 4 : 0;
        // Rows are scattered; the cells of a row are adjacent.
        const std::uint64_t place = (row * 0x9e3779b97f4a7c15u) >> 32;
        for (std::int32_t x = 0; x < count[0]; ++x) {
          const std::uint64_t cell = row | field(lo[0] + x, 0) | (begins | (x == 0)) << (D * kCellBits);
          const auto slot =
              static_cast<std::int32_t>((place + static_cast<std::uint32_t>(lo[0] + x)) & ((1u << m_bits) - 1));
          m_entries.push_back({packed, cell, item, slot});
          ++m_start[slot + 1];
        }
      }
    }
  }
  static std::uint64_t field(std::int32_t coordinate, int d) {
    return (static_cast<std::uint64_t>(coordinate) & kCellField) << (d * kCellBits);
  }

  void sortEntries() {
    for (std::size_t s = 1; s < m_start.size(); ++s) m_start[s] += m_start[s - 1];
    m_next.assign(m_start.begin(), m_start.end() - 1);
    m_sorted.resize(m_entries.size());
    for (const Entry& e : m_entries) {
      m_sorted[m_next[e.slot]++] = e;
    }
    m_sorted.resize(m_entries.size() + kListAhead);
  }

  void visitSlots(std::vector<ProxyPair>& out, WorkDone& work) {
    std::size_t found = 0;
    const std::size_t slots = m_start.size() - 1;
    for (std::size_t s = 0; s < slots; ++s) {
      const std::int32_t begin = m_start[s], end = m_start[s + 1];
      if (end - begin < 2) continue;
      ++work[WorkCount::nodeVisits];
      const auto count = static_cast<std::size_t>(end - begin);
      for (std::int32_t a = begin; a + 1 < end && awake(a); ++a) {
        if (m_hits.size() < found + count + kListAhead) m_hits.resize(2 * (found + count + kListAhead));
        Hit* hit = listHits(a, end, m_hits.data() + found);
        found = static_cast<std::size_t>(hit - m_hits.data());
        m_tests += static_cast<std::uint64_t>(end - a - 1);
      }
    }
    for (std::size_t k = 0; k < found; ++k) {
      emitIfPair(m_boxes[m_hits[k].a], m_boxes[m_hits[k].b], out);
    }
  }
  bool awake(std::int32_t entry) const { return static_cast<std::size_t>(m_sorted[entry].item) < m_awake; }

  // Like listOverlaps, for boxes in the same cell if the pair counts there: on each axis one of the two begins there.
  Hit* listHits(std::int32_t a, std::int32_t end, Hit* hits) const {
    const Entry* entries = m_sorted.data();
    const Entry first = entries[a];
    for (std::int32_t begin = a + 1; begin < end; begin += kListAhead) {
      for (std::int32_t k = begin; k < begin + kListAhead; ++k) {
        const Entry& e = entries[k];
        *hits = {first.item, e.item};
        const bool counts = (((first.cell ^ e.cell) & kCell) | (~(first.cell | e.cell) & kBegins)) == 0;
        hits += static_cast<int>(counts) & static_cast<int>(Packing<D>::overlap(first.box, e.box)) &
                static_cast<int>(k < end);
      }
    }
    return hits;
  }

  // A large box is tested against the small ones and against the large ones after it. A sleeping one is tested against
  // awake boxes only; awake large boxes come before it.
  void visitLarge(std::size_t k, std::vector<ProxyPair>& out) {
    const Large& large = m_large[k];
    const std::size_t few = large.box.active() ? m_boxes.size() : m_awake;
    if (large.box.active()) {
      for (std::size_t other = k + 1; other < m_large.size(); ++other) {
        if (Packing<D>::overlap(large.packed, m_large[other].packed)) emitIfPair(large.box, m_large[other].box, out);
      }
      m_tests += m_large.size() - k - 1;
    }
    m_tests += few;
    if (few == 0) return;
    m_packed.resize(m_boxes.size() + kListAhead);
    m_list.resize(std::max(m_list.size(), few + kListAhead));
    const std::int32_t* end =
        listOverlaps<D>(m_packed.data(), large.packed, 0, static_cast<std::int32_t>(few), m_list.data());
    for (const std::int32_t* hit = m_list.data(); hit != end; ++hit) {
      emitIfPair(large.box, m_boxes[*hit], out);
    }
  }

  Params m_params;
  Grid<D> m_grid;
  int m_bits = 0;  // of a slot number
  std::uint64_t m_tests = 0;
  std::size_t m_awake = 0;  // of m_boxes
  std::vector<ProxyId> m_slots;
  std::vector<Real> m_sample;
  IndexedVector<std::int32_t> m_start, m_next;  // by slot
  IndexedVector<GatheredBox<D>> m_boxes;        // boxes in few cells
  std::vector<PackedBox> m_packed;              // the same
  std::vector<Large> m_large;
  IndexedVector<Entry> m_entries, m_sorted;
  std::vector<Hit> m_hits;
  std::vector<std::int32_t> m_list;  // of a large box
};

}  // namespace

LPC_REGISTER(Broadphase, SpatialHash, 2, 3);

}}  // namespace lpc::LPC_PRECISION
