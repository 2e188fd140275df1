// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "framework/stage_broadphase.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// Boxes are sorted by the bucket of their lower end along the axis on which they are spread widest, by counting. Each
// meets those after it, up to the bucket of its own upper end: of two boxes that overlap, the later one begins no later
// than the earlier one ends, and the map to buckets is monotone, rounded or not. The class is called as another file's:
// that must not matter.
template <int D>
class Naive final : public Broadphase<D> {
 public:
  struct Params {
    int buckets = 256;
    void visit(ParamVisitor& v) { v.integer("buckets", buckets, 1, 65536, "buckets along the widest axis"); }
  };
  explicit Naive(const Params& params) : m_first(static_cast<std::size_t>(params.buckets) + 1) {}

  static AlgorithmInfo info() {
    return {.name = "counting_buckets",
            .summary = "buckets along the widest axis, filled by counting sort",
            .paper = "",
            .complexity = "n + buckets + pairs that overlap along the axis"};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    m_boxes.clear();
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      if (!proxies.isFree(i) &&
          proxies.lo[0][static_cast<std::size_t>(i)] <= proxies.hi[0][static_cast<std::size_t>(i)])
        m_boxes.push_back(i);
    }
    chooseAxis(proxies);
    sort(proxies, work);
    for (std::size_t k = 0; k < m_sorted.size(); ++k) {
      const ProxyId a = m_sorted[k];
      const std::size_t last = bucketOf(proxies.hi[m_axis][static_cast<std::size_t>(a)]);
      for (std::size_t n = k + 1; n < m_sorted.size(); ++n) {
        const ProxyId b = m_sorted[n];
        if (m_bucket[static_cast<std::size_t>(b)] > last) break;
        ++work[WorkCount::boxTests];
        if (proxies.boxesOverlap(a, b) && proxies.mayCollide(a, b)) out.push_back({std::min(a, b), std::max(a, b)});
      }
    }
  }

 private:
  // Halves, so that no difference of finite numbers overflows.
  void chooseAxis(const Proxies<D>& proxies) {
    m_axis = 0, m_from = 0, m_half = 0;
    for (std::size_t d = 0; d < D; ++d) {
      Real from = 0, to = 0;
      for (std::size_t k = 0; k < m_boxes.size(); ++k) {
        const auto i = static_cast<std::size_t>(m_boxes[k]);
        from = k == 0 ? proxies.lo[d][i] : std::min(from, proxies.lo[d][i]);
        to = k == 0 ? proxies.hi[d][i] : std::max(to, proxies.hi[d][i]);
      }
      if (to / 2 - from / 2 > m_half) m_axis = d, m_from = from, m_half = to / 2 - from / 2;
    }
  }

  std::size_t bucketOf(Real x) const {
    const std::size_t last = m_first.size() - 2;
    if (!(m_half > 0)) return 0;
    return std::min(last, static_cast<std::size_t>((x / 2 - m_from / 2) / m_half * static_cast<Real>(last + 1)));
  }

  void sort(const Proxies<D>& proxies, WorkDone& work) {
    std::fill(m_first.begin(), m_first.end(), 0);
    m_bucket.resize(static_cast<std::size_t>(proxies.size()));
    for (const ProxyId i : m_boxes) {
      const auto n = static_cast<std::size_t>(i);
      m_bucket[n] = bucketOf(proxies.lo[m_axis][n]);
      ++m_first[m_bucket[n] + 1];
    }
    for (std::size_t b = 1; b < m_first.size(); ++b) m_first[b] += m_first[b - 1];
    m_sorted.resize(m_boxes.size());
    for (const ProxyId i : m_boxes) m_sorted[m_first[m_bucket[static_cast<std::size_t>(i)]]++] = i;
    work[WorkCount::sortMoves] += m_boxes.size();
  }

  std::vector<ProxyId> m_boxes, m_sorted;
  std::vector<std::size_t> m_bucket;  // of a box's lower end, by slot
  std::vector<std::size_t> m_first;   // place of a bucket's first box
  std::size_t m_axis = 0;
  Real m_from = 0, m_half = 0;  // lowest end and half the spread along the axis (m)
};

}  // namespace

LPC_REGISTER(Broadphase, Naive, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
