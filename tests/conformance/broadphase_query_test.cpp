// SPDX-License-Identifier: Zlib
// Box queries of every broadphase. Overlap and point queries must equal brute force exactly. Ray and sweep queries must
// equal an oracle in long double, wherever the answer does not depend on the last bits.
#include <cmath>

#include "tests/check_property.h"
#include "tests/conformance/broadphase_model.h"
#include "tests/conformance/broadphase_variants.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace broadphase_query_test {

/// When the box moved by t * displacement touches the target, for t in [0, maxT], and whether that is certain.
struct SweepHit {
  bool hit = false, sure = true;
  long double t = 0;
};

// Slab test on the sum of both boxes, without any of the optimisations of the code under test.
template <int D>
SweepHit sweepHit(const Aabb<D>& box, const Vec<D>& displacement, Real maxT, const Aabb<D>& target) {
  long double enter = 0, leave = maxT;
  bool apart = false;
  for (int d = 0; d < D; ++d) {
    const long double lo = static_cast<long double>(target.lo[d]) - box.hi[d];
    const long double hi = static_cast<long double>(target.hi[d]) - box.lo[d];
    const long double v = displacement[d];
    if (v == 0) {
      apart = apart || lo > 0 || hi < 0;
    } else {
      enter = std::max(enter, std::min(lo / v, hi / v));
      leave = std::min(leave, std::max(lo / v, hi / v));
    }
  }
  if (apart) return {};
  const long double doubt = 64 * std::numeric_limits<Real>::epsilon() * (1 + std::abs(enter) + std::abs(leave));
  return {enter <= leave, std::abs(enter - leave) > doubt, enter};
}

template <int D>
struct Hall {
  Proxies<D> proxies;
  std::vector<ProxyId> added;

  explicit Hall(BoxFamily family, std::uint64_t seed, int count) {
    Random random(seed);
    proxies.resize(count);
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (random.below(5) == 0) continue;  // a free slot
      proxies.setBox(i, drawBox<D>(random, family));
      proxies.body[k] = i, proxies.active[k] = static_cast<std::uint8_t>(random.below(2));
      proxies.category[k] = proxies.mask[k] = 0;  // queries ignore filters
      added.push_back(i);
    }
  }
};

/// Occupied slots with finite boxes. The answer for a body that has become NaN is undefined.
template <int D>
std::vector<ProxyId> standing(const Proxies<D>& proxies) {
  std::vector<ProxyId> out;
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    if (!proxies.isFree(i) && proxies.box(i).lo.allFinite()) out.push_back(i);
  }
  return out;
}

template <int D>
void checkHits(const Proxies<D>& proxies, const std::vector<ProxyId>& standing, const Aabb<D>& box,
               const Vec<D>& displacement, Real maxT, std::vector<RayHit<D>> hits) {
  std::sort(hits.begin(), hits.end(), [](const auto& a, const auto& b) { return a.proxy < b.proxy; });
  std::size_t at = 0;
  for (ProxyId i : standing) {
    const SweepHit m = sweepHit<D>(box, displacement, maxT, proxies.box(i));
    const bool found = at < hits.size() && hits[at].proxy == i;
    if (m.sure) RC_ASSERT(found == m.hit);
    if (found) {
      const long double error = std::abs(hits[at].t - m.t);
      if (m.sure) RC_ASSERT(error <= 16 * std::numeric_limits<Real>::epsilon() * (1 + std::abs(m.t)));
      RC_ASSERT(hits[at].t >= 0);
      RC_ASSERT(hits[at].t <= maxT);
      ++at;
    }
  }
  RC_ASSERT(at == hits.size());  // no duplicate, no free slot
}

template <int D>
std::vector<ProxyId> sorted(std::vector<RayHit<D>> hits) {
  std::vector<ProxyId> ids;
  for (const auto& h : hits) ids.push_back(h.proxy);
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// Queries a broadphase that has seen these boxes in update().
template <int D>
void ask(const Broadphase<D>& broadphase, const Proxies<D>& proxies, BoxFamily family, Random& random) {
  const std::vector<ProxyId> there = standing(proxies);
  const Aabb<D> box = drawBox<D>(random, family);

  std::vector<ProxyId> found, truth;
  broadphase.overlap(proxies, box, found);
  for (ProxyId i : there) {
    if (box.overlaps(proxies.box(i))) truth.push_back(i);
  }
  std::sort(found.begin(), found.end());
  RC_ASSERT(found == truth);

  // A corner of a box of the crowd, if there is one: a point on the boundary is inside.
  Vec<D> point = box.lo;
  if (!there.empty() && random.below(2)) {
    const Aabb<D> other = proxies.box(there[random.below(there.size())]);
    for (int d = 0; d < D; ++d) point[d] = random.below(2) ? other.lo[d] : other.hi[d];
  }
  found.clear(), truth.clear();
  broadphase.at(proxies, point, found);
  for (ProxyId i : there) {
    if (proxies.box(i).contains(point)) truth.push_back(i);
  }
  std::sort(found.begin(), found.end());
  RC_ASSERT(found == truth);

  Vec<D> direction;
  for (int d = 0; d < D; ++d) direction[d] = static_cast<Real>(static_cast<int>(random.below(7)) - 3);
  const Real maxT = static_cast<Real>(random.below(4)) * 3;
  std::vector<RayHit<D>> hits, first;
  broadphase.ray(proxies, point, direction, maxT, false, hits);
  checkHits<D>(proxies, there, {point, point}, direction, maxT, hits);
  broadphase.ray(proxies, point, direction, maxT, true, first);
  RC_ASSERT(first.size() == std::min<std::size_t>(1, hits.size()));
  for (const auto& h : hits) RC_ASSERT(first[0].t <= h.t);

  hits.clear();
  const Vec<D> displacement = 3 * direction;
  broadphase.sweep(proxies, box, displacement, hits);
  checkHits<D>(proxies, there, box, displacement, Real(1), hits);

  // A sweep without motion hits exactly the boxes that it overlaps.
  hits.clear(), found.clear();
  broadphase.sweep(proxies, box, Vec<D>::Zero(), hits);
  broadphase.overlap(proxies, box, found);
  std::sort(found.begin(), found.end());
  RC_ASSERT(sorted<D>(hits) == found);
}

template <int D>
void checkQueries(Broadphase<D>& broadphase, BoxFamily family, std::uint64_t seed, int count) {
  const Hall<D> hall(family, seed, count);
  broadphase.update(hall.proxies, {hall.added, {}, hall.added});
  std::vector<ProxyPair> pairs;
  WorkDone work;
  broadphase.findPairs(hall.proxies, pairs, work);
  Random random(seed + 1);
  ask(broadphase, hall.proxies, family, random);
}

/// An aged structure: it is updated and queried after some commands, with or without findPairs() before.
template <int D>
void checkWorn(Broadphase<D>& broadphase, BoxFamily family, const std::vector<Command>& list, std::uint64_t seed) {
  BoxCrowd<D> crowd(family);
  std::vector<ProxyPair> pairs;
  WorkDone work;
  Random random(seed);
  for (std::size_t k = 0; k <= list.size(); ++k) {
    if (k % 64 == 63 || k == list.size()) {
      crowd.update(broadphase);
      pairs.clear();
      if (random.below(2)) broadphase.findPairs(crowd.proxies(), pairs, work);
      ask(broadphase, crowd.proxies(), family, random);
    }
    if (k < list.size()) crowd.apply(list[k]);
  }
}

// Families on which the oracle of rays and sweeps is certain of some answers.
constexpr std::array kFamilies = {BoxFamily::scattered, BoxFamily::touching, BoxFamily::identical,
                                  BoxFamily::huge,      BoxFamily::thin,     BoxFamily::centerLine};

template <int D>
void checkAllQueries() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    if (algorithm->info.role != AlgorithmRole::competitor) continue;
    check(
        "queries of " + algorithm->info.name + ", " + std::to_string(D) + "D",
        [&] {
          const auto family = kFamilies[drawIndex(kFamilies.size())];
          const auto seed = drawSeed();
          const int count = growingNumber(0, 80);
          const auto broadphase = createStage<Broadphase<D>>(Spec{algorithm->info.name, {}});
          checkQueries<D>(*broadphase, family, seed, count);
        },
        500);
  }
}
TEST(BroadphaseQueries, TwoDimensions) { checkAllQueries<2>(); }
TEST(BroadphaseQueries, ThreeDimensions) { checkAllQueries<3>(); }

// The sequences of broadphase_test.cpp, with every choice and both ends of every parameter.
template <int D>
void checkWornQueries() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    if (algorithm->info.role != AlgorithmRole::competitor) continue;
    const std::vector<Spec> specs = variants(*algorithm);
    check(
        "queries of a worn " + algorithm->info.name + ", " + std::to_string(D) + "D",
        [&] {
          const auto list = drawCommands();
          const auto family = kFamilies[drawIndex(kFamilies.size())];
          const Spec& spec = specs[drawIndex(specs.size())];
          RC_LOG() << spec.text() << ", family " << static_cast<int>(family) << '\n';
          const auto broadphase = createStage<Broadphase<D>>(spec);
          checkWorn<D>(*broadphase, family, list, drawSeed());
        },
        100);
  }
}
TEST(BroadphaseQueries, AgedTwoDimensions) { checkWornQueries<2>(); }
TEST(BroadphaseQueries, AgedThreeDimensions) { checkWornQueries<3>(); }

// --- planted bugs ----------------------------------------------------------------------------------------------------

/// A box query that excludes its boundary.
template <int D>
class OpenQuery final : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, WorkDone&) override {}
  void overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const override {
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      const Aabb<D> b = proxies.box(i);
      if ((box.lo.array() < b.hi.array()).all() && (b.lo.array() < box.hi.array()).all()) out.push_back(i);
    }
  }
};

/// A tree that answers with its fat boxes.
template <int D>
class FatAnswers final : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, WorkDone&) override {}
  void overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const override {
    Broadphase<D>::overlap(proxies, box.grown(Real(1)), out);
  }
};

/// A ray that also hits boxes behind its origin.
template <int D>
class LooksBack final : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, WorkDone&) override {}
  void ray(const Proxies<D>& proxies, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
           std::vector<RayHit<D>>& out) const override {
    Broadphase<D>::ray(proxies, p, direction, maxT, firstOnly, out);
    if (out.empty()) Broadphase<D>::ray(proxies, p, -direction, maxT, firstOnly, out);
  }
};

/// A tree that answers with the boxes that were added, not with the moved ones: right only while it is fresh.
template <int D>
class AsAdded final : public Broadphase<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_boxes.resize(proxies.size());
    for (ProxyId i : changes.removed) m_boxes.setBox(i, Aabb<D>{}), m_boxes.body[static_cast<std::size_t>(i)] = -1;
    for (ProxyId i : changes.added) m_boxes.setBox(i, proxies.box(i)), m_boxes.body[static_cast<std::size_t>(i)] = i;
  }
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, WorkDone&) override {}
  void overlap(const Proxies<D>&, const Aabb<D>& box, std::vector<ProxyId>& out) const override {
    Broadphase<D>::overlap(m_boxes, box, out);
  }

 private:
  Proxies<D> m_boxes;
};

/// A tree that keeps removed proxies in its leaves and skips them only in the search for pairs.
template <int D>
class KeepsTheGone final : public Broadphase<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_boxes.resize(proxies.size());
    for (const auto& list : {changes.added, changes.moved}) {
      for (ProxyId i : list) m_boxes.setBox(i, proxies.box(i)), m_boxes.body[static_cast<std::size_t>(i)] = i;
    }
  }
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, WorkDone&) override {}
  void ray(const Proxies<D>&, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
           std::vector<RayHit<D>>& out) const override {
    Broadphase<D>::ray(m_boxes, p, direction, maxT, firstOnly, out);
  }

 private:
  Proxies<D> m_boxes;
};

template <template <int> class Bug>
void expectRefused(const std::string& name) {
  expectFalsified(
      "planted bug: " + name,
      [] {
        Bug<2> bug;
        checkQueries<2>(bug, BoxFamily::touching, drawSeed(), growingNumber(0, 80));
      },
      500);
}
TEST(BroadphasePlantedBugs, OpenQuery) { expectRefused<OpenQuery>("open query"); }
TEST(BroadphasePlantedBugs, FatAnswers) { expectRefused<FatAnswers>("fat answers"); }
template <template <int> class Bug>
void expectWornOut(const std::string& name) {
  check(
      "fresh twin: " + name,
      [] {
        Bug<3> fresh;
        checkQueries<3>(fresh, BoxFamily::touching, drawSeed(), growingNumber(0, 80));
      },
      50);
  expectFalsified(
      "planted bug: " + name,
      [] {
        Bug<3> bug;
        const auto list = drawCommands();
        checkWorn<3>(bug, BoxFamily::touching, list, drawSeed());
      },
      100);
}
TEST(BroadphasePlantedBugs, AnswersWithAddedBoxes) { expectWornOut<AsAdded>("answers with the boxes that were added"); }
TEST(BroadphasePlantedBugs, KeepsRemovedProxies) { expectWornOut<KeepsTheGone>("keeps who was removed"); }
TEST(BroadphasePlantedBugs, RayHitsBehindItsOrigin) { expectRefused<LooksBack>("looks back"); }

}  // namespace broadphase_query_test
}}}  // namespace lpc::LPC_PRECISION::test
