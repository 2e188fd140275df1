// SPDX-License-Identifier: Zlib
#include <cstring>

#include "algorithms/broadphase/gathered_box.h"
#include "algorithms/broadphase/radix_sort.h"
#include "algorithms/broadphase/window.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// Sorts the boxes by their lower bounds on one axis and tests each against those that begin before it ends (Baraff
// 1992). Everything before the exact test works on integers of one monotone map (window.h): keys of 22 bits, sorted in
// two radix passes, and 16-bit bounds on the other axes, of which the compiler tests eight or more at once.
template <int D>
class SortAndSweep final : public Broadphase<D> {
 public:
  struct Params {
    int axis = -1;
    void visit(ParamVisitor& v) {
      v.integer("axis", axis, -1, D - 1, "axis of the sweep; -1: where the centres vary most");
    }
  };
  explicit SortAndSweep(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "sort_and_sweep",
            .summary = "full sort on one axis each step, then a sweep over the sorted boxes",
            .paper = "baraff1992",
            .complexity = "n log n + pairs that overlap on the axis",
            .failures = {{.when = "all boxes share an interval of the axis, as a tower swept along x",
                          .symptom = "tests every pair",
                          .test = "sweep_shared_interval_work"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    listSlots(proxies, m_slots);
    if (m_slots.size() < 2) return;
    m_axis = m_params.axis >= 0 ? static_cast<std::size_t>(m_params.axis) : widestAxis(proxies);
    arrange(proxies);
    work[WorkCount::sortMoves] += m_slots.size();
    work[WorkCount::boxTests] += sweep(out);
  }

  /// The interval of each box, in sweep order.
  void structure(std::vector<StructureBox<D>>& out) const override {
    if (m_slots.size() < 2) return;
    for (const GatheredBox<D>& b : m_boxes) {
      Aabb<D> slab = Aabb<D>::everywhere();
      slab.lo[static_cast<int>(m_axis)] = b.lo[m_axis], slab.hi[static_cast<int>(m_axis)] = b.hi[m_axis];
      out.push_back({slab, 0, true});
    }
  }

 private:
  static constexpr int kKeyBits = 22;
  static constexpr int kBlock =
      32;                      // more than the 16 iterations up to which g++ unrolls a loop instead of vectorising it
  using Small = std::int16_t;  // signed, because the oldest SIMD cannot compare unsigned

  // Bounds on the axes that are not swept, in sweep order.
  struct Lanes {
    IndexedVector<Small> lo, hi;
  };

  // Chosen from a sample: the choice affects only speed.
  std::size_t widestAxis(const Proxies<D>& proxies) const {
    const std::size_t stride = std::max<std::size_t>(1, m_slots.size() / 256);
    const Real count = static_cast<Real>((m_slots.size() + stride - 1) / stride);
    std::size_t best = 0;
    Real most = -1;
    for (std::size_t d = 0; d < D; ++d) {
      const auto twiceCenter = [&](std::size_t k) {
        const auto i = m_slots[k];
        return proxies.lo[d][i] + proxies.hi[d][i];
      };
      Real mean = 0, variance = 0;
      for (std::size_t k = 0; k < m_slots.size(); k += stride) mean += twiceCenter(k) / count;
      for (std::size_t k = 0; k < m_slots.size(); k += stride) {
        variance += (twiceCenter(k) - mean) * (twiceCenter(k) - mean);
      }
      if (variance > most) most = variance, best = d;
    }
    return best;
  }

  void arrange(const Proxies<D>& proxies) {
    const Window<D> window = findWindow(proxies, m_slots, m_sample);
    const std::size_t n = m_count = m_slots.size(), axis = m_axis;
    const Scale key(window.lo[axis], window.hi[axis], Real((1 << kKeyBits) - 1));
    m_order.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = m_slots[k];
      m_order[k] = {static_cast<std::uint32_t>(static_cast<std::int32_t>(key(proxies.lo[axis][i]))), m_slots[k]};
    }
    radixSort(m_order, m_scratch, kKeyBits);

    m_begin.resize(n), m_end.resize(n), m_boxes.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      m_boxes[k] = GatheredBox<D>::of(proxies, m_order[k].index);
      m_begin[k] = static_cast<std::int32_t>(m_order[k].key);
      m_end[k] = static_cast<std::int32_t>(key(m_boxes[k].hi[axis]));
    }
    m_begin.resize(n + kBlock, std::numeric_limits<std::int32_t>::max());  // sentinels: every sweep stops here
    std::size_t lane = 0;
    for (std::size_t d = 0; d < D; ++d) {
      if (d == axis) continue;
      Lanes& lanes = m_lanes[lane++];
      const Scale scale(window.lo[d], window.hi[d], Real(65535));
      lanes.lo.resize(n), lanes.hi.resize(n);
      for (std::size_t k = 0; k < n; ++k) {
        lanes.lo[k] = static_cast<Small>(static_cast<std::int32_t>(scale(m_boxes[k].lo[d])) - 32768);
        lanes.hi[k] = static_cast<Small>(static_cast<std::int32_t>(scale(m_boxes[k].hi[d])) - 32768);
      }
      lanes.lo.resize(n + kBlock, 32767), lanes.hi.resize(n + kBlock, -32768);
    }
  }

  std::uint64_t sweep(std::vector<ProxyPair>& out) const {
    const auto n = static_cast<int>(m_count);
    std::uint64_t tests = 0;
    for (int a = 0; a < n; ++a) {
      const std::int32_t end = m_end[a];
      int b = a + 1;
      for (; m_begin[b] <= end; b += kBlock) testBlock(a, b, out);
      tests += static_cast<std::uint64_t>(std::min(b, n) - a - 1);
    }
    return tests;
  }

  // Tests box a against the boxes b .. b + kBlock in sweep order. Some of them may begin after a ends; the exact test
  // rejects those.
  void testBlock(int a, int b, std::vector<ProxyPair>& out) const {
    IndexedArray<Small, D - 1> lo, hi;
    IndexedArray<const Small*, D - 1> los, his;
    for (std::size_t l = 0; l < D - 1; ++l) {
      lo[l] = m_lanes[l].lo[a], hi[l] = m_lanes[l].hi[a];
      los[l] = m_lanes[l].lo.data() + b, his[l] = m_lanes[l].hi.data() + b;
    }
    std::array<Small, kBlock> miss;
    Small all = -1;
    for (std::size_t k = 0; k < kBlock; ++k) {
      Small apart = 0;
      for (std::size_t l = 0; l < D - 1; ++l) {
        apart = static_cast<Small>(apart | -static_cast<Small>((los[l][k] > hi[l]) | (lo[l] > his[l][k])));
      }
      miss[k] = apart;
      all = static_cast<Small>(all & apart);
    }
    if (all) return;
    // Tests four at once: most groups of four have no hit.
    constexpr std::size_t kQuartet = 4;
    std::array<std::uint64_t, kBlock / kQuartet> quartets;
    static_assert(sizeof quartets == sizeof miss);
    std::memcpy(quartets.data(), miss.data(), sizeof miss);
    for (std::size_t q = 0; q < quartets.size(); ++q) {
      if (quartets[q] == ~std::uint64_t{0}) continue;
      for (std::size_t k = q * kQuartet; k < (q + 1) * kQuartet; ++k) {
        const std::size_t at = static_cast<std::size_t>(b) + k;
        if (!miss[k] && at < m_count) emitIfPair(m_boxes[a], m_boxes[at], out);
      }
    }
  }

  Params m_params;
  std::size_t m_count = 0, m_axis = 0;
  std::vector<ProxyId> m_slots;
  std::vector<Real> m_sample;
  std::vector<KeyedIndex<std::uint32_t>> m_order, m_scratch;
  IndexedVector<std::int32_t> m_begin, m_end;  // on the axis, in sweep order
  IndexedArray<Lanes, D - 1> m_lanes;
  IndexedVector<GatheredBox<D>> m_boxes;
};

}  // namespace

LPC_REGISTER(Broadphase, SortAndSweep, 2, 3);

}}  // namespace lpc::LPC_PRECISION
