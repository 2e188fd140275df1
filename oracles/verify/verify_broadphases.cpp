// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <iterator>
#include <string_view>

#include "framework/math/random.h"
#include "oracles/corpus/box_script.h"
#include "oracles/verify/verdict.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// A family of boxes: how it changes a random box, per axis.
struct BoxFamily {
  std::string_view name;
  void (*shape)(Random& random, int dimension, bool large, double& at, double& size);  // m; `large`: one box in six
};
constexpr BoxFamily kBoxFamilies[] = {
    {"scattered", [](Random&, int, bool, double&, double&) {}},
    {"touching",  // integers: most neighbours touch exactly
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

/// Draws the changes, step by step.
template <int D>
class BoxDrawer {
 public:
  BoxDrawer(std::uint64_t seed, int index) : m_random(seed * 1000003 + static_cast<std::uint64_t>(index)), m_boxes(0) {
    m_random = Random(m_random.next());
    const auto family = m_random.below(std::size(kBoxFamilies) + 1);
    m_family = family < std::size(kBoxFamilies) ? &kBoxFamilies[family] : nullptr;
    m_slots = static_cast<int>(2 + m_random.below(120));
    m_boxes = BoxSet<D>(m_slots);
  }

  BoxScript<D> draw() {
    BoxScript<D> out{.family = std::string(m_family ? m_family->name : kMixed), .slots = m_slots, .steps = {}};
    for (int step = 0; step < kSteps; ++step) {
      m_boxes.apply(out.steps.emplace_back(drawStep(step)));
    }
    return out;
  }

 private:
  using What = typename BoxChange<D>::What;

  std::vector<BoxChange<D>> drawStep(int step) {
    std::vector<BoxChange<D>> out;
    for (ProxyId i = 0; i < m_slots; ++i) {
      if (m_boxes.proxies().isFree(i)) {
        if (step == 0 || m_random.below(4) == 0) out.push_back(added(i));
      } else if (const auto what = m_random.below(16); what == 0) {
        out.push_back({.what = What::removed, .slot = i});
      } else if (what < 9) {
        out.push_back({.what = What::moved, .slot = i, .box = what == 1 ? drawBox() : near(m_boxes.proxies().box(i))});
      }
    }
    return out;
  }

  Aabb<D> drawBox() {
    Aabb<D> box;
    const BoxFamily& family = m_family ? *m_family : kBoxFamilies[m_random.below(std::size(kBoxFamilies))];
    const bool large = m_random.below(6) == 0;
    for (int d = 0; d < D; ++d) {
      double at = m_random.uniform(-12, 12), size = m_random.uniform(0.1, 3);
      family.shape(m_random, D, large, at, size);
      box.lo[d] = static_cast<Real>(at), box.hi[d] = static_cast<Real>(at + size);
    }
    return box;
  }
  Aabb<D> near(Aabb<D> box) {
    for (int d = 0; d < D; ++d) {
      const Real step = (box.hi[d] - box.lo[d]) * static_cast<Real>(m_random.uniform(-0.2, 0.2));
      box.lo[d] += step, box.hi[d] += step;
    }
    return box;
  }
  BoxChange<D> added(ProxyId i) {
    BoxChange<D> c{.what = What::added, .slot = i, .box = drawBox()};
    c.body = m_random.below(4) == 0 ? static_cast<std::int32_t>(m_random.below(8)) : 100 + i;  // some share a body
    c.active = m_random.below(4) > 0;
    c.category = 1u << m_random.below(2), c.mask = m_random.below(4) == 0 ? 1u : ~0u;
    return c;
  }

  Random m_random;
  const BoxFamily* m_family = nullptr;  // null: mixed
  int m_slots = 0;
  BoxSet<D> m_boxes;
};

// Correct pairs that were not found; found pairs that are wrong or found twice.
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
  if (guarantee == Guarantee::conservative) {  // pairs of separated boxes are allowed, other errors are not
    std::erase_if(extra, [&](const ProxyPair& p) { return p.a < p.b && boxes.proxies().mayCollide(p.a, p.b); });
    if (std::adjacent_find(found.begin(), found.end()) != found.end()) extra.push_back(found.front());
  }
  return {missing.size(), extra.size()};
}

/// The first wrong step and its errors.
struct WrongStep {
  int number = -1;  // none
  Difference difference = {};
};

template <int D>
Verdict playScript(const BoxScript<D>& script, const Candidate<Broadphase<D>>& m, double& spent, WrongStep& wrong) {
  const auto method = m.create();
  BoxSet<D> boxes(script.slots);
  Verdict verdict;
  for (std::size_t step = 0; step < script.steps.size(); ++step) {
    boxes.apply(script.steps[step]);
    std::vector<ProxyPair> found;
    WorkDone work;
    const double before = threadNanoseconds();
    method->update(boxes.proxies(), boxes.changes());
    method->findPairs(boxes.proxies(), found, work);
    spent += threadNanoseconds() - before;
    const Difference d = compare(found, boxes, m.info.guarantee);
    if (d.missing + d.extra == 0 || verdict.end == Tally::wrong) continue;
    verdict.end = Tally::wrong, verdict.failure = "wrong_pairs";
    wrong = {static_cast<int>(step), d};
  }
  return verdict;
}

template <int D>
std::string scriptCaseText(const LedgerKey& subject, const VerifyRange& range, int index, const BoxScript<D>& script,
                           const Verdict& verdict, const WrongStep& wrong) {
  std::string text = "{\"id\": \"" + inputName(subject, range.seed, index) +
                     "\", \"source\": \"lpc verify\", \"dim\": " + std::to_string(D) +
                     ", \"query\": \"broadphase\", \"note\": \"" + script.family + "\", " + scriptText(script) +
                     findingText(subject, verdict, range.seed, index);
  if (wrong.number >= 0) {
    text += ", \"step\": " + std::to_string(wrong.number) +
            ", \"missing\": " + std::to_string(wrong.difference.missing) +
            ", \"extra\": " + std::to_string(wrong.difference.extra);
  }
  return text + ", \"expected\": {}}";
}

}  // namespace

template <int D>
Verdict verifyScript(const BoxScript<D>& script, const Candidate<Broadphase<D>>& method) {
  double ignored = 0;
  WrongStep wrong;
  return playScript(script, method, ignored, wrong);
}

template Verdict verifyScript(const BoxScript<2>&, const Candidate<Broadphase<2>>&);
template Verdict verifyScript(const BoxScript<3>&, const Candidate<Broadphase<3>>&);

template <int D>
void verifyBroadphases(const VerifyRange& range, std::span<const Candidate<Broadphase<D>>> methods, Verified& out) {
  for (int index = range.first; index < range.first + range.count; ++index) {
    const BoxScript<D> script = BoxDrawer<D>(range.seed, index).draw();
    for (const Candidate<Broadphase<D>>& m : methods) {
      const LedgerKey subject = subjectOf(StageKind::broadphase, D, m.name);
      double spent = 0;
      WrongStep wrong;
      const Verdict verdict = range.ended ? withoutAnswer(*range.ended) : playScript(script, m, spent, wrong);
      const auto text = [&] { return scriptCaseText(subject, range, index, script, verdict, wrong); };
      book(out.ledger, subject, m.info.role, {{"family", script.family}}, verdict, spent, text);
      if (!verdict.failure.empty()) out.keep({m.name, verdict.failure, script.slots, 0, text()});
    }
  }
}

template void verifyBroadphases(const VerifyRange&, std::span<const Candidate<Broadphase<2>>>, Verified&);
template void verifyBroadphases(const VerifyRange&, std::span<const Candidate<Broadphase<3>>>, Verified&);

}}  // namespace lpc::LPC_PRECISION
