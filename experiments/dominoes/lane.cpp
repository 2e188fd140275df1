// SPDX-License-Identifier: Zlib
// The game's own broadphase: dominoes stand in a row, so the order along it hardly changes from step to step, and
// insertion sort takes one pass. The game links this file; with plugin.cpp it is a library that `lpc` can test.
#include <lpc/stage_broadphase.h>

#include <numeric>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
class Lane final : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit Lane(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "lane",
            .summary = "last step's order along x, put right by insertion, then swept",
            .paper = "",
            .complexity = "n + swaps + pairs that overlap along x"};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    const auto n = static_cast<std::size_t>(proxies.size());
    if (m_order.size() != n) {
      m_order.resize(n);
      std::iota(m_order.begin(), m_order.end(), ProxyId{0});
    }
    const auto begin = [&](ProxyId i) { return proxies.lo[0][static_cast<std::size_t>(i)]; };
    for (std::size_t k = 1; k < n; ++k) {
      const ProxyId moved = m_order[k];
      std::size_t to = k;
      for (; to > 0 && begin(m_order[to - 1]) > begin(moved); --to) m_order[to] = m_order[to - 1];
      m_order[to] = moved;
      work[WorkCount::sortMoves] += k - to;
    }
    for (std::size_t k = 0; k < n; ++k) {  // free slots have empty boxes: they are last, and end before they begin
      const ProxyId a = m_order[k];
      const Real end = proxies.hi[0][static_cast<std::size_t>(a)];
      for (std::size_t l = k + 1; l < n && begin(m_order[l]) <= end; ++l) {
        const ProxyId b = m_order[l];
        ++work[WorkCount::boxTests];
        if (!proxies.boxesOverlap(a, b) || !proxies.mayCollide(a, b)) continue;
        out.push_back({std::min(a, b), std::max(a, b)});
      }
    }
  }

 private:
  std::vector<ProxyId> m_order;
};

}  // namespace

LPC_REGISTER(Broadphase, Lane, 2, 3);

}}  // namespace lpc::LPC_PRECISION
