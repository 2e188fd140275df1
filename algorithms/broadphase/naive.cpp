// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Brute force: every pair of boxes. The reference for all other broadphases.
template <int D>
class Naive final : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit Naive(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "naive", .summary = "tests every pair of boxes", .paper = "", .complexity = "n^2/2 box tests"};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    const ProxyId n = proxies.size();
    for (ProxyId a = 0; a < n; ++a) {
      if (proxies.isFree(a)) continue;
      work[WorkCount::boxTests] += static_cast<std::uint64_t>(n - a - 1);
      for (ProxyId begin = a + 1; begin < n; begin += kBlock) {
        const ProxyId end = std::min(begin + kBlock, n);
        if (!findGaps(proxies, a, begin, end)) continue;
        for (ProxyId b = begin; b < end; ++b) {
          if (m_gap[b - begin] <= 0 && proxies.mayCollide(a, b)) out.push_back({a, b});
        }
      }
    }
  }

 private:
  static constexpr int kBlock = 32;

  // The gap between two boxes is the largest over the axes, and positive exactly if they are apart, because a
  // difference has the sign of the comparison. Without a branch inside, the compiler vectorises over boxes. Returns
  // whether any box touches.
  bool findGaps(const Proxies<D>& proxies, ProxyId a, ProxyId begin, ProxyId end) {
    IndexedArray<Real, D> lo, hi;
    IndexedArray<const Real*, D> los, his;
    for (std::size_t d = 0; d < D; ++d) {
      lo[d] = proxies.lo[d][a], hi[d] = proxies.hi[d][a];
      los[d] = proxies.lo[d].data() + begin, his[d] = proxies.hi[d].data() + begin;
    }
    const auto count = static_cast<std::size_t>(end - begin);
    for (std::size_t k = 0; k < count; ++k) {
      Real widest = los[0][k] - hi[0];
      for (std::size_t d = 0; d < D; ++d) {
        const Real above = los[d][k] - hi[d], below = lo[d] - his[d][k];
        widest = above > widest ? above : widest;
        widest = below > widest ? below : widest;
      }
      m_gap[k] = widest;
    }
    int any = 0;
    for (std::size_t k = 0; k < count; ++k) any |= m_gap[k] <= 0 ? 1 : 0;
    return any != 0;
  }

  IndexedArray<Real, kBlock> m_gap{};
};

}  // namespace

LPC_REGISTER(Broadphase, Naive, 2, 3);

}}  // namespace lpc::LPC_PRECISION
