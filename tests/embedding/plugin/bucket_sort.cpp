// SPDX-License-Identifier: Zlib
// An algorithm outside the source tree.
#include <algorithm>

#include "framework/plugin.h"
#include "framework/stage_broadphase.h"

LPC_PLUGIN;

namespace lpc::inline LPC_PRECISION {
namespace {

// Boxes go into equal buckets along x by their lower end; a box is compared with the buckets that it reaches.
template <int D>
class BucketSort final : public Broadphase<D> {
 public:
  struct Params {
    int buckets = 64;
    void visit(ParamVisitor& v) { v.integer("buckets", buckets, 1, 65536, "number of buckets along x"); }
  };
  explicit BucketSort(const Params& params) : m_buckets(static_cast<std::size_t>(params.buckets)) {}

  static AlgorithmInfo info() {
    return {
        .name = "bucket_sort", .summary = "equal buckets along x", .paper = "", .complexity = "n + pairs in buckets"};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    Real lo = 0, hi = 0;
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      const Real x = proxies.lo[0][static_cast<std::size_t>(i)];
      if (proxies.isFree(i) || !std::isfinite(x)) continue;
      lo = std::min(lo, x), hi = std::max(hi, x);
    }
    const Real perBucket = std::max((hi - lo) / static_cast<Real>(m_buckets.size()), Real(1e-30));
    const auto bucketOf = [&](Real x) {
      const Real b = (x - lo) / perBucket;
      return b <= 0 ? std::size_t(0) : std::min(static_cast<std::size_t>(b), m_buckets.size() - 1);
    };
    for (auto& b : m_buckets) b.clear();
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      if (proxies.isFree(i) || proxies.lo[0][static_cast<std::size_t>(i)] > proxies.hi[0][static_cast<std::size_t>(i)])
        continue;
      m_buckets[bucketOf(proxies.lo[0][static_cast<std::size_t>(i)])].push_back(i);
    }
    for (std::size_t b = 0; b < m_buckets.size(); ++b) {
      for (std::size_t k = 0; k < m_buckets[b].size(); ++k) {
        const ProxyId i = m_buckets[b][k];
        const std::size_t last = bucketOf(proxies.hi[0][static_cast<std::size_t>(i)]);
        for (std::size_t c = b; c <= last; ++c) {
          for (std::size_t n = c == b ? k + 1 : 0; n < m_buckets[c].size(); ++n) {
            const ProxyId j = m_buckets[c][n];
            ++work[WorkCount::boxTests];
            if (!proxies.boxesOverlap(i, j) || !proxies.mayCollide(i, j)) continue;
            out.push_back({std::min(i, j), std::max(i, j)});
          }
        }
      }
    }
  }

 private:
  std::vector<std::vector<ProxyId>> m_buckets;
};

}  // namespace

LPC_REGISTER(Broadphase, BucketSort, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
