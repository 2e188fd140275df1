// SPDX-License-Identifier: Zlib
#include <bit>
#include <cmath>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/grid.h"
#include "algorithms/broadphase/packed_box.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// Cells in an unbounded world, hashed into a table (Teschner et al. 2003) that a counting sort fills anew in each step.
// Levels of cells, each four times as large as the level below, take boxes of all sizes (Mirtich 1996; Eitz and Gu
// 2007). A box is entered in every cell that it covers on the level of its size, and it looks up the cells that it
// covers on each coarser level. A pair counts in the cell of the larger of its two lower corners, per axis, which both
// boxes cover, so no set of pairs is needed. Boxes that cover many cells are kept apart and compared with all.
//
// Two cells may share a slot of the table, so the cell is compared, too. It is stored modulo 2^30 per axis (2D) or 2^20
// (3D). Boxes that far apart do not overlap, and overlapping boxes cover too few cells to meet twice.
template <int D>
class SpatialHash final : public Broadphase<D> {
 public:
  struct Params {
    Real cell = 0, table = 2;
    int most = 16, levels = 16;
    void visit(ParamVisitor& v) {
      v.real("cell", cell, 0, Real(1e6), "m",
             "edge of a cell of the middle level; 0: derived from the sizes of the awake boxes");
      v.real("table", table, Real(0.0078125), 16, "1", "slots per box, before rounding up to a power of two");
      v.integer("most", most, 1, 1000, "cells that a box may cover; larger boxes are kept in a separate list");
      v.integer("levels", levels, 1, kMostLevels, "sizes of cells, each four times the one below; 1: one size");
    }
  };
  explicit SpatialHash(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "spatial_hash",
            .summary = "levels of cells hashed into a table, rebuilt each step by counting sort",
            .paper = "teschner2003",
            .complexity = "n per level + pairs in the same cell + n per large box",
            .failures = {{.when = "levels=1, and many boxes are far larger than most",
                          .symptom = "each large box is tested with all boxes",
                          .test = "hash_many_large_work"},
                         {.when = "levels=1, most boxes are large, and small ones lie close together",
                          .symptom = "the small boxes share a cell, so every pair of them is tested",
                          .test = "hash_crowded_cell_work"},
                         {.when = "boxes are long and thin",
                          .symptom = "a cell is as long as a box, so many boxes share it",
                          .test = "hash_planks_work"},
                         {.when = "table=0.0078125: far fewer slots than boxes",
                          .symptom = "unrelated cells share slots, and their boxes are tested with each other",
                          .test = "hash_collisions_work"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    const std::size_t awake = listActiveFirst(proxies, m_slots);
    if (m_slots.size() < 2) return;
    const Window<D> window = findWindow(proxies, m_slots, m_sample);
    m_tests = m_found = 0;
    gather(proxies, chooseCell(proxies));
    chooseLevels(window.lo);
    enter(Packing<D>(window), awake);
    sortEntries();
    visitSlots(work);
    visitCoarser(work);
    for (std::size_t k = 0; k < m_found; ++k) emitIfPair(m_boxes[m_hits[k].a], m_boxes[m_hits[k].b], out);
    for (std::size_t k = 0; k < m_large.size(); ++k) visitLarge(k, out);
    work[WorkCount::boxTests] += m_tests;
    work[WorkCount::sortMoves] += m_entries.size();
  }

  /// The cells that boxes reach, and the boxes that are kept apart.
  void structure(std::vector<StructureBox<D>>& out) const override {
    if (m_slots.size() < 2) return;
    const std::size_t before = out.size();
    for (std::size_t k = 0; k < m_boxes.size(); ++k) m_levels[m_level[k]].grid.tellCells(m_boxes[k], out);
    for (const Large& l : m_large) out.push_back({l.box.box(), 0, true});
    tellOnce(out, before);
  }

 private:
  static constexpr int kMostLevels = 16;
  static constexpr int kFewOnLevel = 64;              // boxes that are not worth a level that all smaller boxes look up
  static constexpr std::int8_t kApart = -1;           // the level of large boxes
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
  struct Level {
    Real edge;           // of its cells (m)
    std::int32_t count;  // boxes
    std::int8_t to;      // the level that takes its boxes
    std::int32_t first;  // slot of the table
    std::uint32_t mask;  // number of its slots - 1
    Grid<D> grid;
  };

  // m; 0 if the median box is a point.
  Real chooseCell(const Proxies<D>& proxies) {
    if (m_params.cell > 0) return m_params.cell;
    constexpr std::size_t kSamples = 128;
    sampleSizes(proxies, m_slots, kSamples, m_sample);
    const auto middle = m_sample.begin() + static_cast<std::ptrdiff_t>(m_sample.size() / 2);
    std::nth_element(m_sample.begin(), middle, m_sample.end());
    return kRoom * *middle;
  }

  // Boxes and the levels of their sizes. The middle level has boxes from half to twice the median size.
  void gather(const Proxies<D>& proxies, Real cell) {
    if (!(cell > 0)) cell = 1;
    const int below = (m_params.levels - 1) / 2;
    m_levels.clear(), m_boxes.clear(), m_level.clear();
    for (int k = 0; k < m_params.levels; ++k) {
      const Real edge = std::ldexp(cell, 2 * (k - below));
      m_levels.push_back({edge, 0, static_cast<std::int8_t>(k), 0, 0, {}});
    }
    for (const ProxyId i : m_slots) {
      m_boxes.push_back(GatheredBox<D>::of(proxies, i));
      const GatheredBox<D>& box = m_boxes.back();
      Real size = 0;
      for (std::size_t d = 0; d < D; ++d) size = std::max(size, box.hi[d] - box.lo[d]);
      int level = m_params.levels - 1;
      while (level > 0 && m_levels[level].edge / 2 > kRoom * size) --level;
      m_level.push_back(static_cast<std::int8_t>(level)), ++m_levels[level].count;
    }
  }
  // Few boxes go to the next coarser level. Few boxes on the coarsest level are kept apart: otherwise every other box
  // would look up that level.
  void chooseLevels(const IndexedArray<Real, D>& origin) {
    m_coarsest = m_params.levels - 1;
    while (m_coarsest > 0 && m_levels[m_coarsest].count == 0) --m_coarsest;
    bool any = false;
    for (int k = 0; k <= m_coarsest; ++k) {
      Level& level = m_levels[k];
      if (k == m_coarsest) {
        if (any && level.count < kFewOnLevel) level.to = kApart, level.count = 0;
      } else if (level.count < kFewOnLevel) {
        ++level.to, m_levels[k + 1].count += level.count, level.count = 0;
      }
      any = any || level.count > 0;
    }
    std::int32_t slots = 0;
    for (int k = m_coarsest; k >= 0; --k) {
      Level& level = m_levels[k];
      if (level.to > k) level.to = m_levels[k + 1].to;
      if (level.count == 0) continue;
      const double wanted = static_cast<double>(level.count) * static_cast<double>(m_params.table);
      level.grid = Grid<D>(origin, level.edge), level.first = slots;
      level.mask = (1u << std::bit_width(static_cast<std::uint32_t>(wanted))) - 1;
      slots += static_cast<std::int32_t>(level.mask) + 1;
    }
    m_start.assign(static_cast<std::size_t>(slots) + 1, 0);
  }

  // Awake boxes are entered first, and so come first in every slot.
  void enter(const Packing<D>& packing, std::size_t awake) {
    m_packed.clear(), m_large.clear(), m_entries.clear();
    m_awake = 0;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < m_boxes.size(); ++k) {
      const GatheredBox<D> box = m_boxes[k];
      const PackedBox packed = packing.pack(box.lo, box.hi);
      const std::int8_t level = m_levels[m_level[k]].to;
      Cell lo, count;
      std::int64_t cells = m_params.most + 1;
      if (level != kApart) cells = cover(m_levels[level].grid, box, lo, count);
      if (cells > m_params.most) {
        m_large.push_back({box, packed});
        continue;
      }
      forCells(m_levels[level], lo, count, [&](std::uint64_t cell, std::int32_t slot) {
        m_entries.push_back({packed, cell, static_cast<std::int32_t>(kept), slot});
        ++m_start[slot + 1];
      });
      m_boxes[kept] = box, m_level[kept] = level, m_packed.push_back(packed), ++kept;
      if (k < awake) m_awake = kept;
    }
    m_boxes.resize(kept), m_level.resize(kept);
  }
  // Returns the number of cells, or more than `most`.
  std::int64_t cover(const Grid<D>& grid, const GatheredBox<D>& box, Cell& lo, Cell& count) const {
    std::int64_t cells = 1;
    for (std::size_t d = 0; d < D; ++d) {
      lo[d] = grid.coordinate(box.lo[d], d), count[d] = grid.coordinate(box.hi[d], d) - lo[d] + 1;
      cells = std::min<std::int64_t>(cells * count[d], m_params.most + 1);
    }
    return cells;
  }

  // Calls found(cell with the axes on which the box begins there, slot).
  template <class Found>
  static void forCells(const Level& level, const Cell& lo, const Cell& count, const Found& found) {
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
          found(cell,
                level.first + static_cast<std::int32_t>((place + static_cast<std::uint32_t>(lo[0] + x)) & level.mask));
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

  void visitSlots(WorkDone& work) {
    const std::size_t slots = m_start.size() - 1;
    for (std::size_t s = 0; s < slots; ++s) {
      const std::int32_t begin = m_start[s], end = m_start[s + 1];
      if (end - begin < 2) continue;
      ++work[WorkCount::nodeVisits];
      for (std::int32_t a = begin; a + 1 < end && awake(a); ++a) listHits(Entry(m_sorted[a]), a + 1, end);
    }
  }
  // Each box looks up the cells that it covers on coarser levels.
  void visitCoarser(WorkDone& work) {
    for (std::size_t k = 0; k < m_boxes.size(); ++k) {
      for (int to = m_level[k] + 1; to <= m_coarsest; ++to) {
        const Level& level = m_levels[to];
        if (level.count == 0) continue;
        Cell lo, count;
        cover(level.grid, m_boxes[k], lo, count);
        forCells(level, lo, count, [&](std::uint64_t cell, std::int32_t slot) {
          const std::int32_t begin = m_start[slot];
          std::int32_t end = m_start[slot + 1];
          if (k >= m_awake) {
            while (end > begin && !awake(end - 1)) --end;
          }
          if (begin == end) return;
          ++work[WorkCount::nodeVisits];
          listHits({m_packed[k], cell, static_cast<std::int32_t>(k), slot}, begin, end);
        });
      }
    }
  }
  bool awake(std::int32_t entry) const { return static_cast<std::size_t>(m_sorted[entry].item) < m_awake; }

  // Like listOverlaps, for boxes in the same cell if the pair counts there: on each axis one of the two begins there.
  void listHits(const Entry& first, std::int32_t from, std::int32_t end) {
    const auto count = static_cast<std::size_t>(end - from);
    if (m_hits.size() < m_found + count + kListAhead) m_hits.resize(2 * (m_found + count + kListAhead));
    const Entry* entries = m_sorted.data();
    Hit* hits = m_hits.data() + m_found;
    for (std::int32_t begin = from; begin < end; begin += kListAhead) {
      for (std::int32_t k = begin; k < begin + kListAhead; ++k) {
        const Entry& e = entries[k];
        *hits = {first.item, e.item};
        const bool counts = (((first.cell ^ e.cell) & kCell) | (~(first.cell | e.cell) & kBegins)) == 0;
        hits += static_cast<int>(counts) & static_cast<int>(Packing<D>::overlap(first.box, e.box)) &
                static_cast<int>(k < end);
      }
    }
    m_found = static_cast<std::size_t>(hits - m_hits.data());
    m_tests += count;
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
  IndexedVector<Level> m_levels;  // from fine to coarse
  int m_coarsest = 0;             // level
  std::uint64_t m_tests = 0;
  std::size_t m_found = 0;  // of m_hits
  std::size_t m_awake = 0;  // of m_boxes
  std::vector<ProxyId> m_slots;
  std::vector<Real> m_sample;
  IndexedVector<std::int32_t> m_start, m_next;  // by slot
  IndexedVector<GatheredBox<D>> m_boxes;        // boxes in few cells
  IndexedVector<std::int8_t> m_level;           // the same
  IndexedVector<PackedBox> m_packed;            // the same
  std::vector<Large> m_large;
  IndexedVector<Entry> m_entries, m_sorted;
  std::vector<Hit> m_hits;
  std::vector<std::int32_t> m_list;  // of a large box
};

}  // namespace

LPC_REGISTER(Broadphase, SpatialHash, 2, 3);

}}  // namespace lpc::LPC_PRECISION
