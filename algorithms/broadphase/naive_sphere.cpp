// SPDX-License-Identifier: Zlib
#include <limits>

#include "algorithms/broadphase/gathered_box.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace broadphase;

// Every pair of circles (spheres) around the boxes: one comparison instead of D axes, and no update when a body turns.
// The 2009 team wanted it besides the boxes. It also reports pairs of separate boxes, and is the only method that may.
template <int D>
class NaiveSphere final : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit NaiveSphere(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "naive_sphere",
            .summary = "tests every pair of circles or spheres around the boxes",
            .paper = "",
            .complexity = "n^2/2 distance tests",
            .guarantee = Guarantee::conservative,
            .failures = {{.when = "long thin shapes: a plank fills a small part of its sphere",
                          .symptom = "most of the pairs that it reports are false",
                          .test = "sphere_planks_false_pairs"}}};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    gather(proxies);
    const std::size_t n = m_radius.size();
    for (std::size_t a = 0; a + 1 < n; ++a) {
      work[WorkCount::boxTests] += n - a - 1;
      for (std::size_t block = a + 1; block < n; block += kBlock) {
        const std::size_t end = std::min(n, block + kBlock);
        std::size_t hits = 0;
        std::array<std::size_t, kBlock> hit;
        for (std::size_t b = block; b < end; ++b) {
          Real distance2 = 0;
          for (std::size_t d = 0; d < D; ++d) {
            const Real apart = m_center[d][b] - m_center[d][a];
            distance2 += apart * apart;
          }
          const Real reach = m_radius[a] + m_radius[b];
          hit[hits] = b;
          hits += distance2 <= reach * reach + kTiny ? 1 : 0;
        }
        for (std::size_t k = 0; k < hits; ++k) {
          if (proxies.mayCollide(m_slot[a], m_slot[hit[k]])) out.push_back({m_slot[a], m_slot[hit[k]]});
        }
      }
    }
  }

 private:
  static constexpr std::size_t kBlock = 128;
  // Squares of sizes below 1e-154 m (float: 1e-19 m) lose their digits; this exceeds the loss.
  static constexpr Real kTiny = std::numeric_limits<Real>::min();

  void gather(const Proxies<D>& proxies) {
    listSlots(proxies, m_slot);
    m_radius.clear();
    for (auto& c : m_center) c.clear();
    for (ProxyId i : m_slot) {
      Real radius2 = 0;
      for (std::size_t d = 0; d < D; ++d) {
        const Real lo = proxies.lo[d][i], hi = proxies.hi[d][i];
        const Real center = Real(0.5) * lo + Real(0.5) * hi;
        const Real half = std::max(
            hi - center, center - lo);  // from the rounded centre; far from the origin this is not half the size
        radius2 += half * half;
        m_center[d].push_back(center);
      }
      // Enlarged by more than the roundings here and in the test, so that no overlap is missed.
      m_radius.push_back(std::sqrt(radius2 + kTiny) * (1 + 16 * std::numeric_limits<Real>::epsilon()));
    }
  }

  IndexedArray<std::vector<Real>, D> m_center;
  std::vector<Real> m_radius;
  std::vector<ProxyId> m_slot;
};

}  // namespace

LPC_REGISTER(Broadphase, NaiveSphere, 2, 3);

}}  // namespace lpc::LPC_PRECISION
