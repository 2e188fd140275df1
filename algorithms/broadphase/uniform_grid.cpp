// SPDX-License-Identifier: Zlib
#include <cmath>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/grid.h"
#include "algorithms/broadphase/packed_box.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// A grid rebuilt each step by one counting sort into a flat array. A box is entered once, in the cell of its lower
// corner, and spans at most two cells per axis. Overlapping boxes are therefore in neighbouring cells, and half of the
// neighbours of each cell give every pair once. Larger boxes are kept apart and search the cells that they cover.
//
// The grid wraps around: cells a multiple of its size apart share a place. The world is therefore unbounded and memory
// is proportional to the number of boxes; aliasing adds only false candidates.
template <int D>
class UniformGrid final : public Broadphase<D> {
 public:
  struct Params {
    Real cell = 0;
    void visit(ParamVisitor& v) {
      v.real("cell", cell, 0, Real(1e6), "m", "edge of a cell; 0: from the sizes of the boxes that are awake");
    }
  };
  explicit UniformGrid(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "uniform_grid",
            .summary = "one flat grid, rebuilt each step by counting sort; larger boxes apart",
            .paper = "",
            .complexity = "n + pairs in neighbouring cells + n per large box",
            .failures = {{.when = "many boxes are far larger than most",
                          .symptom = "tests every pair of the large ones",
                          .test = "grid_many_large_work"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    listSlots(proxies, m_slots);
    if (m_slots.size() < 2) return;
    const Window<D> window = findWindow(proxies, m_slots, m_sample);
    chooseGrid(proxies, window);
    fill(proxies, window);
    m_tests = 0;
    visitCells(out, work);
    for (std::size_t k = 0; k < m_large.size(); ++k) visitLarge(k, out, work);
    work[WorkCount::boxTests] += m_tests;
    work[WorkCount::sortMoves] += m_boxes.size();
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
  using Cell = IndexedArray<std::int32_t, D>;  // of the unbounded grid

  struct Range {
    int begin, end;  // in the flat array
  };
  struct Large {
    GatheredBox<D> box;
    PackedBox packed;
    Cell lo, hi;
  };

  // m; 0 if all boxes are points.
  Real chooseCell(const Proxies<D>& proxies) {
    if (m_params.cell > 0) return m_params.cell;
    constexpr std::size_t kSamples = 512;
    sampleSizes(proxies, m_slots, kSamples, m_sample);
    std::sort(m_sample.begin(), m_sample.end());
    // The largest box, if it is not far from the usual size. Slightly more than its size, so that rounding does not
    // make the largest boxes span three cells.
    const Real median = m_sample[m_sample.size() / 2];
    return std::min(m_sample.back(), kLargest * median) * Real(1.001);
  }

  // Numbers of cells per axis: powers of two, in total at most about four per box.
  void chooseGrid(const Proxies<D>& proxies, const Window<D>& window) {
    m_grid = Grid<D>(window.lo, chooseCell(proxies));
    double total = 1;
    IndexedArray<double, D> size{};
    for (std::size_t d = 0; d < D; ++d) {
      const double wanted = std::min(static_cast<double>((window.hi[d] - window.lo[d]) * m_grid.inverse()) + 2, 0x1p29);
      size[d] = 4;  // minimum: a neighbour must not be the same cell from the other side
      while (size[d] < wanted) size[d] *= 2;
      total *= size[d];
    }
    const double mostCells = std::max(64.0, 4.0 * static_cast<double>(m_slots.size()));
    while (total > mostCells) {
      double& longest = *std::max_element(size.begin(), size.end());
      if (longest <= 4) break;
      longest /= 2, total /= 2;
    }
    for (std::size_t d = 0; d < D; ++d) m_size[d] = static_cast<std::int32_t>(size[d]);
    m_cells = static_cast<std::size_t>(total);
  }

  std::size_t place(const Cell& cell) const {
    std::size_t at = 0;
    for (std::size_t d = D; d-- > 0;) {
      at = at * static_cast<std::size_t>(m_size[d]) + static_cast<std::size_t>(cell[d] & (m_size[d] - 1));
    }
    return at;
  }

  void fill(const Proxies<D>& proxies, const Window<D>& window) {
    const Packing<D> packing(window);
    m_start.assign(m_cells + 1, 0);
    m_placeOf.resize(m_slots.size());
    m_large.clear();
    for (std::size_t k = 0; k < m_slots.size(); ++k) {
      const auto i = m_slots[k];
      Cell lo, hi;
      bool small = true;
      for (std::size_t d = 0; d < D; ++d) {
        lo[d] = m_grid.coordinate(proxies.lo[d][i], d), hi[d] = m_grid.coordinate(proxies.hi[d][i], d);
        small = small && hi[d] - lo[d] <= 1;
      }
      m_placeOf[k] = small ? static_cast<std::int32_t>(place(lo)) : -1;
      if (small) {
        ++m_start[m_placeOf[k] + 1];
      } else {
        const GatheredBox<D> box = GatheredBox<D>::of(proxies, m_slots[k]);
        m_large.push_back({box, packing.pack(box.lo, box.hi), lo, hi});
      }
    }
    for (std::size_t c = 0; c < m_cells; ++c) m_start[c + 1] += m_start[c];
    m_boxes.resize(m_slots.size() - m_large.size());
    m_packed.resize(m_boxes.size() + kListAhead);
    m_next.assign(m_start.begin(), m_start.end() - 1);
    for (std::size_t k = 0; k < m_slots.size(); ++k) {
      if (m_placeOf[k] < 0) continue;
      const auto at = m_next[m_placeOf[k]]++;
      m_boxes[at] = GatheredBox<D>::of(proxies, m_slots[k]);
      m_packed[at] = packing.pack(m_boxes[at].lo, m_boxes[at].hi);
    }
  }

  // Writes the boxes of cells x .. x + count - 1 of a row, all coordinates wrapped: at most two ranges.
  Range* addRow(Range* out, std::size_t row, std::int32_t x, std::int32_t count) const {
    const std::int32_t width = m_size[0];
    const std::int32_t* start = m_start.data() + row * static_cast<std::size_t>(width);
    x &= width - 1;
    const std::int32_t first = std::min(count, width - x);
    *out++ = {start[x], start[x + first]};
    if (first < count) *out++ = {start[0], start[count - first]};
    return out;
  }

  void visitCells(std::vector<ProxyPair>& out, WorkDone& work) {
    const std::int32_t width = m_size[0];
    const std::size_t rows = m_cells / static_cast<std::size_t>(width);
    for (std::size_t row = 0; row < rows; ++row) {
      const std::int32_t* start = m_start.data() + row * static_cast<std::size_t>(width);
      const LaterRows later = laterRows(row);
      for (std::int32_t x = 0; x < width; ++x) {
        if (start[x] == start[x + 1]) continue;
        ++work[WorkCount::nodeVisits];
        std::array<Range, 2 + 2 * later.size()> ranges;
        // The rest of the cell itself, and its right neighbour: one range unless the row ends.
        Range* end = ranges.data() + 1;
        ranges[0] = {0, start[x + (x + 1 < width ? 2 : 1)]};
        if (x + 1 == width) end = addRow(end, row, 0, 1);
        for (std::size_t other : later) end = addRow(end, other, x - 1, 3);
        for (std::int32_t a = start[x]; a < start[x + 1]; ++a) {
          ranges[0].begin = a + 1;
          test(m_boxes[a], m_packed[a], {ranges.data(), end}, out);
        }
      }
    }
  }

  // Half of the neighbouring rows: those with a positive last nonzero offset.
  using LaterRows = std::array<std::size_t, D == 2 ? 1 : 4>;
  LaterRows laterRows(std::size_t row) const {
    const auto height = static_cast<std::size_t>(m_size[1]);
    const std::size_t y = row & (height - 1), up = (y + 1) & (height - 1), down = (y + height - 1) & (height - 1);
    if constexpr (D == 2) {
      return {up};
    } else {
      const std::size_t layer = row - y, next = (layer + height) & (height * static_cast<std::size_t>(m_size[2]) - 1);
      return {layer + up, next + down, next + y, next + up};
    }
  }

  // Tests a large box against the small ones in its cells and one cell before, and against the large ones after it in
  // the list.
  void visitLarge(std::size_t k, std::vector<ProxyPair>& out, WorkDone& work) {
    const Large& large = m_large[k];
    for (std::size_t other = k + 1; other < m_large.size(); ++other) {
      if (Packing<D>::overlap(large.packed, m_large[other].packed)) emitIfPair(large.box, m_large[other].box, out);
    }
    m_tests += m_large.size() - k - 1;
    Cell count;
    std::size_t rows = 1;
    for (std::size_t d = 0; d < D; ++d) {
      count[d] = std::min(large.hi[d] - large.lo[d] + 2, m_size[d]);
      if (d > 0) rows *= static_cast<std::size_t>(count[d]);
    }
    if (m_ranges.size() < 2 * rows) m_ranges.resize(2 * rows);
    Range* end = m_ranges.data();
    for (std::size_t r = 0; r < rows; ++r) {
      std::size_t rest = r, row = 0, stride = 1;
      for (std::size_t d = 1; d < D; ++d) {
        const auto step = static_cast<std::int32_t>(rest % static_cast<std::size_t>(count[d]));
        rest /= static_cast<std::size_t>(count[d]);
        row += static_cast<std::size_t>((large.lo[d] - 1 + step) & (m_size[d] - 1)) * stride;
        stride *= static_cast<std::size_t>(m_size[d]);
      }
      end = addRow(end, row, large.lo[0] - 1, count[0]);
    }
    work[WorkCount::nodeVisits] += rows;
    test(large.box, large.packed, {m_ranges.data(), end}, out);
  }

  // Tests box a against the boxes of some ranges, first packed, then exactly.
  void test(const GatheredBox<D>& a, const PackedBox& packed, std::span<const Range> ranges,
            std::vector<ProxyPair>& out) {
    std::size_t most = 0;
    for (const Range& range : ranges) most += static_cast<std::size_t>(range.end - range.begin);
    m_tests += most;
    if (m_hits.size() < most + kListAhead) m_hits.resize(most + kListAhead);
    std::int32_t* end = m_hits.data();
    for (const Range& range : ranges) end = listOverlaps<D>(m_packed.data(), packed, range.begin, range.end, end);
    for (const std::int32_t* hit = m_hits.data(); hit != end; ++hit) {
      emitIfPair(a, m_boxes[*hit], out);
    }
  }

  static constexpr Real kLargest = 8;  // times the median; larger boxes are kept apart

  Params m_params;
  Grid<D> m_grid;
  Cell m_size{};  // cells per axis
  std::size_t m_cells = 0;
  std::uint64_t m_tests = 0;
  std::vector<ProxyId> m_slots;
  std::vector<Real> m_sample;
  IndexedVector<std::int32_t> m_start, m_next, m_placeOf;  // by cell, by cell, by box
  IndexedVector<GatheredBox<D>> m_boxes;                   // sorted by cell
  IndexedVector<PackedBox> m_packed;                       // the same
  std::vector<Large> m_large;
  std::vector<Range> m_ranges;  // of a large box
  std::vector<std::int32_t> m_hits;
};

}  // namespace

LPC_REGISTER(Broadphase, UniformGrid, 2, 3);

}}  // namespace lpc::LPC_PRECISION
