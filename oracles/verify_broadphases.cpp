// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <iterator>
#include <string_view>

#include "framework/random.h"
#include "oracles/verdict.h"
#include "oracles/verify.h"

namespace lpc::inline LPC_PRECISION {
namespace {

/// A family of boxes: what it makes of a box that was scattered, per axis.
struct Family {
  std::string_view name;
  void (*shape)(Random& random, int dimension, bool large, double& at, double& size);  // m; `large`: one box in six
};
constexpr Family kFamilies[] = {
    {"scattered", [](Random&, int, bool, double&, double&) {}},
    {"touching",  // whole numbers: most neighbours touch exactly
     [](Random& random, int, bool, double& at, double& size) {
       at = static_cast<double>(random.below(12)) - 6, size = static_cast<double>(random.below(4));
     }},
    {"zero_size",
     [](Random& random, int, bool, double& at, double& size) { at = static_cast<double>(random.below(4)), size = 0; }},
    {"identical", [](Random&, int, bool, double& at, double& size) { at = 1, size = 2; }},
    {"huge",
     [](Random&, int, bool large, double& at, double& size) {
       if (large) at = -5e6, size = 1e7;
     }},
    {"far_from_origin", [](Random&, int, bool large, double& at, double&) { at += large ? 3e7 : 1e5; }},
    {"thin", [](Random& random, int dimension, bool, double&,
                double& size) { size = random.below(static_cast<std::uint64_t>(dimension)) == 0 ? 15 : 1e-3; }},
};
constexpr std::string_view kMixed = "mixed";  // each box from another family
constexpr int kSteps = 6;

/// Boxes that come, move and go, as a broadphase is told about them.
template <int D>
class BoxSet {
 public:
  BoxSet(std::uint64_t seed, int index) : m_random(seed * 1000003 + static_cast<std::uint64_t>(index)) {
    m_random = Random(m_random.next());
    const auto family = m_random.below(std::size(kFamilies) + 1);
    m_family = family < std::size(kFamilies) ? &kFamilies[family] : nullptr;
    m_proxies.resize(static_cast<int>(2 + m_random.below(120)));
  }

  std::string_view family() const { return m_family ? m_family->name : kMixed; }
  const Proxies<D>& proxies() const { return m_proxies; }
  ProxyChanges changes() const { return {m_added, m_removed, m_moved}; }

  void advance(int step) {
    m_added.clear(), m_removed.clear(), m_moved.clear();
    for (ProxyId i = 0; i < m_proxies.size(); ++i) {
      if (m_proxies.isFree(i)) {
        if (step == 0 || m_random.below(4) == 0) add(i);
      } else if (const auto what = m_random.below(16); what == 0) {
        remove(i);
      } else if (what < 9) {
        move(i, what == 1);
      }
    }
  }

  /// By definition, without any algorithm; sorted.
  std::vector<ProxyPair> pairs() const {
    std::vector<ProxyPair> out;
    for (ProxyId a = 0; a < m_proxies.size(); ++a) {
      for (ProxyId b = a + 1; b < m_proxies.size(); ++b) {
        if (m_proxies.boxesOverlap(a, b) && m_proxies.mayCollide(a, b)) out.push_back({a, b});
      }
    }
    return out;
  }

 private:
  Aabb<D> drawBox() {
    Aabb<D> box;
    const Family& family = m_family ? *m_family : kFamilies[m_random.below(std::size(kFamilies))];
    const bool large = m_random.below(6) == 0;
    for (int d = 0; d < D; ++d) {
      double at = m_random.uniform(-12, 12), size = m_random.uniform(0.1, 3);
      family.shape(m_random, D, large, at, size);
      box.lo[d] = static_cast<Real>(at), box.hi[d] = static_cast<Real>(at + size);
    }
    return box;
  }

  void add(ProxyId i) {
    const auto k = static_cast<std::size_t>(i);
    m_proxies.setBox(i, drawBox());
    m_proxies.body[k] = static_cast<std::int32_t>(m_random.below(4) == 0 ? m_random.below(8) : 100 + k);  // some share
    m_proxies.active[k] = m_random.below(4) > 0;
    m_proxies.category[k] = 1u << m_random.below(2), m_proxies.mask[k] = m_random.below(4) == 0 ? 1u : ~0u;
    m_added.push_back(i);
  }
  void remove(ProxyId i) {
    m_proxies.setBox(i, Aabb<D>{});
    m_proxies.body[static_cast<std::size_t>(i)] = -1, m_proxies.active[static_cast<std::size_t>(i)] = 0;
    m_removed.push_back(i);
  }
  void move(ProxyId i, bool far) {
    Aabb<D> box = m_proxies.box(i);
    if (far) {
      box = drawBox();
    } else {
      for (int d = 0; d < D; ++d) {
        const Real step = (box.hi[d] - box.lo[d]) * static_cast<Real>(m_random.uniform(-0.2, 0.2));
        box.lo[d] += step, box.hi[d] += step;
      }
    }
    m_proxies.setBox(i, box);
    m_moved.push_back(i);
  }

  Random m_random;
  const Family* m_family = nullptr;  // none: mixed
  Proxies<D> m_proxies;
  std::vector<ProxyId> m_added, m_removed, m_moved;
};

// Right pairs that are not found, then found ones that are wrong or found twice.
struct Difference {
  std::size_t missing = 0, extra = 0;
};

template <int D>
Difference compare(std::vector<ProxyPair>& found, const BoxSet<D>& boxes, Guarantee guarantee) {
  const std::vector<ProxyPair> right = boxes.pairs();
  std::vector<ProxyPair> missing, extra;
  std::sort(found.begin(), found.end());
  std::set_difference(right.begin(), right.end(), found.begin(), found.end(), std::back_inserter(missing));
  std::set_difference(found.begin(), found.end(), right.begin(), right.end(), std::back_inserter(extra));
  if (guarantee == Guarantee::conservative) {  // boxes that are apart are allowed, nothing else
    std::erase_if(extra, [&](const ProxyPair& p) { return p.a < p.b && boxes.proxies().mayCollide(p.a, p.b); });
    if (std::adjacent_find(found.begin(), found.end()) != found.end()) extra.push_back(found.front());
  }
  return {missing.size(), extra.size()};
}

}  // namespace

template <int D>
void verifyBroadphases(const VerifyRange& range, std::span<const Candidate<Broadphase<D>>> methods, Verified& out) {
  for (int index = range.first; index < range.first + range.count; ++index) {
    for (const Candidate<Broadphase<D>>& m : methods) {
      BoxSet<D> boxes(range.seed, index);
      const auto method = m.create();
      const LedgerKey subject = subjectOf(StageKind::broadphase, D, m.name);
      Verdict verdict;
      std::string what;
      double spent = 0;
      if (range.ended) verdict = withoutAnswer(*range.ended);
      for (int step = 0; step < kSteps && !range.ended; ++step) {
        boxes.advance(step);
        std::vector<ProxyPair> found;
        WorkDone work;
        const double before = threadNanoseconds();
        method->update(boxes.proxies(), boxes.changes());
        method->findPairs(boxes.proxies(), found, work);
        spent += threadNanoseconds() - before;
        const Difference d = compare(found, boxes, m.info.guarantee);
        if (d.missing + d.extra == 0 || verdict.end == Tally::wrong) continue;
        verdict.end = Tally::wrong, verdict.failure = "wrong_pairs";
        what = "{\"id\": \"" + inputName(subject, range.seed, index) + "\", \"step\": " + std::to_string(step) +
               ", \"missing\": " + std::to_string(d.missing) + ", \"extra\": " + std::to_string(d.extra) + "}";
      }
      book(out.ledger, subject, m.info.role, {{"family", std::string(boxes.family())}}, verdict, spent,
           [&] { return what; });
    }
  }
}

template void verifyBroadphases(const VerifyRange&, std::span<const Candidate<Broadphase<2>>>, Verified&);
template void verifyBroadphases(const VerifyRange&, std::span<const Candidate<Broadphase<3>>>, Verified&);

}  // namespace lpc::inline LPC_PRECISION
