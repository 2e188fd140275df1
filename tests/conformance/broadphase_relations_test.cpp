// SPDX-License-Identifier: Zlib
// Two runs of one broadphase on boxes that differ only by something that must not matter, or that may change the answer
// in one direction only. No second method needs to be right.
#include <map>
#include <numeric>
#include <set>
#include <type_traits>

#include "framework/math/tolerances.h"
#include "framework/stage/stage_narrowphase.h"
#include "tests/check_property.h"
#include "tests/conformance/broadphase_model.h"
#include "tests/conformance/broadphase_variants.h"
#include "tests/generators.h"
#include "tests/planted_bugs/broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace broadphase_relations_test {

template <int D>
struct Boxes {
  std::vector<Aabb<D>> box;
  std::vector<std::uint8_t> active;

  int size() const { return static_cast<int>(box.size()); }
};

template <int D>
Boxes<D> drawBoxes(int atMost = 60) {
  const auto family = anyFamily();
  const int count = RapidCheckDraw().below(atMost);
  Random random(drawSeed());
  Boxes<D> out;
  for (int i = 0; i < count; ++i) {
    out.box.push_back(drawBox<D>(random, family));
    out.active.push_back(random.below(4) > 0);
  }
  RC_LOG() << count << " boxes, family " << static_cast<int>(family) << '\n';
  return out;
}

Random drawRandom() { return Random(drawSeed()); }

std::vector<ProxyId> shuffled(int n, Random& random) {
  std::vector<ProxyId> out(static_cast<std::size_t>(n));
  std::iota(out.begin(), out.end(), 0);
  for (std::size_t i = out.size(); i > 1; --i) std::swap(out[i - 1], out[random.below(i)]);
  return out;
}

/// One broadphase and its proxies. `place` puts the boxes of a `Boxes` into given slots.
template <int D>
class Stand {
 public:
  explicit Stand(const BroadphaseFactory<D>& create) : m_broadphase(create()) {}

  void place(const Boxes<D>& boxes, const std::vector<ProxyId>& slots) {
    m_proxies.resize(boxes.size());
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const auto k = static_cast<std::size_t>(slots[i]);
      m_proxies.setBox(slots[i], boxes.box[i]);
      m_proxies.active[k] = boxes.active[i], m_proxies.body[k] = slots[i];
      m_proxies.category[k] = m_proxies.mask[k] = 1;
    }
  }
  void free(ProxyId i) {
    const auto k = static_cast<std::size_t>(i);
    m_proxies.setBox(i, Aabb<D>{});
    m_proxies.active[k] = 0, m_proxies.body[k] = -1, m_proxies.category[k] = m_proxies.mask[k] = 0;
  }
  void update(const ProxyChanges& changes) { m_broadphase->update(m_proxies, changes); }
  std::vector<ProxyPair> pairs() {
    std::vector<ProxyPair> out;
    m_work = {};
    m_broadphase->findPairs(m_proxies, out, m_work);
    std::sort(out.begin(), out.end());
    return out;
  }
  /// Pairs as indices of the boxes, which lie in `slots`.
  std::vector<ProxyPair> pairs(const std::vector<ProxyId>& slots) {
    std::vector<ProxyId> boxIn(slots.size());
    for (std::size_t i = 0; i < slots.size(); ++i) {
      boxIn[static_cast<std::size_t>(slots[i])] = static_cast<ProxyId>(i);
    }
    std::vector<ProxyPair> out = pairs();
    for (ProxyPair& p : out) {
      const ProxyId a = boxIn[static_cast<std::size_t>(p.a)], b = boxIn[static_cast<std::size_t>(p.b)];
      p = {std::min(a, b), std::max(a, b)};
    }
    std::sort(out.begin(), out.end());
    return out;
  }
  std::vector<ProxyId> overlap(const Aabb<D>& box) const {
    std::vector<ProxyId> out;
    m_broadphase->overlap(m_proxies, box, out);
    std::sort(out.begin(), out.end());
    return out;
  }
  std::uint64_t visits() const { return m_work[WorkCount::nodeVisits]; }  // of the last pairs()

 private:
  std::unique_ptr<Broadphase<D>> m_broadphase;
  Proxies<D> m_proxies;
  mutable WorkDone m_work;
};

std::vector<ProxyId> inOrder(int n) {
  std::vector<ProxyId> out(static_cast<std::size_t>(n));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

/// A new broadphase with box i in slot i.
template <int D>
Stand<D> fresh(const BroadphaseFactory<D>& create, const Boxes<D>& boxes) {
  Stand<D> stand(create);
  const auto slots = inOrder(boxes.size());
  stand.place(boxes, slots);
  stand.update({slots, {}, slots});
  return stand;
}

// --- the properties --------------------------------------------------------------------------------------------------

/// B2: slots and the order in which boxes are listed do not matter.
template <int D>
void orderIsNothing(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  Random random = drawRandom();
  const auto slots = shuffled(boxes.size(), random), named = shuffled(boxes.size(), random);
  Stand<D> other(create);
  other.place(boxes, slots);
  other.update({named, {}, named});
  RC_ASSERT(other.pairs(slots) == fresh(create, boxes).pairs());
}

/// The same boxes after eight steps in other places.
template <int D>
Stand<D> aged(const BroadphaseFactory<D>& create, const Boxes<D>& boxes) {
  Random random = drawRandom();
  const auto slots = inOrder(boxes.size());
  Stand<D> stand(create);
  for (int round = 0; round < 8; ++round) {
    Boxes<D> other = boxes;
    for (Aabb<D>& box : other.box) box = drawBox<D>(random, BoxFamily::mixed);
    stand.place(other, slots);
    stand.update({round == 0 ? slots : std::vector<ProxyId>{}, {}, slots});
    if (round % 2) stand.pairs();
  }
  stand.place(boxes, slots);
  stand.update({{}, {}, slots});
  return stand;
}

/// B2: earlier positions do not matter.
template <int D>
void historyIsNothing(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  RC_ASSERT(aged(create, boxes).pairs() == fresh(create, boxes).pairs());
}

/// B9: a tree does not degrade: an aged one visits as many nodes as a new one.
template <int D>
void wearIsNothing(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  auto old = aged(create, boxes), young = fresh(create, boxes);
  old.pairs(), young.pairs();
  RC_ASSERT(old.visits() == young.visits());
}

/// B9: a tree that is kept while it is good enough may differ from a new one, but visits at most twice as many nodes.
template <int D>
void wearIsBounded(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  auto old = aged(create, boxes), young = fresh(create, boxes);
  old.pairs(), young.pairs();
  RC_LOG() << old.visits() << " visits, " << young.visits() << " of a new one\n";
  RC_ASSERT(old.visits() <= 2 * young.visits() + 16);
}

/// B3: removing some boxes and adding them again, in the same update or the next, changes nothing.
template <int D>
void backAgain(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  Random random = drawRandom();
  const auto slots = inOrder(boxes.size());
  Stand<D> stand = fresh(create, boxes);
  const auto before = stand.pairs();
  std::vector<ProxyId> some = shuffled(boxes.size(), random);
  some.resize(some.size() / 3);
  stand.update({some, some, some});
  RC_ASSERT(stand.pairs() == before);
  for (const ProxyId i : some) stand.free(i);
  stand.update({{}, some, {}});
  stand.pairs();
  stand.place(boxes, slots);
  stand.update({some, {}, some});
  RC_ASSERT(stand.pairs() == before);
}

/// B4: pairs of touching shapes are among the pairs of their boxes, grown as in the world.
template <int D>
void touchingShapesAreFound(const BroadphaseFactory<D>& create) {
  RapidCheckDraw draw;
  std::vector<Shape<D>> shapes;
  std::vector<Pose<D>> poses;
  Boxes<D> boxes;
  for (int i = 0; i < 4; ++i) {
    const auto c = drawShapePair<D>(draw);
    shapes.insert(shapes.end(), {c.a, c.b});
    poses.insert(poses.end(), {c.X_WA, c.X_WB});
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    boxes.box.push_back(boundingBox(shapes[i].view(), poses[i]).grown(kContactMargin / 2));
    boxes.active.push_back(1);
  }
  const auto found = fresh(create, boxes).pairs();
  const auto exact = createStage<PairQuery<D>>(Spec{"sat", {}});
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      const Pose<D> X = poses[i].inverse() * poses[j];
      const auto answer = queryPair<D>(*exact, shapes[i].view(), shapes[j].view(), X, QueryNeed::distance);
      const ProxyPair pair{static_cast<ProxyId>(i), static_cast<ProxyId>(j)};
      if (answer.distance <= 0) RC_ASSERT(std::binary_search(found.begin(), found.end(), pair));
    }
  }
}

/// B5: axes permuted, and some of them mirrored.
template <int D>
void axesAreAlike(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  Random random = drawRandom();
  const auto axis = shuffled(D, random);
  const std::uint64_t mirrored = random.below(1 << D);
  Boxes<D> turned = boxes;
  for (std::size_t i = 0; i < boxes.box.size(); ++i) {
    for (int d = 0; d < D; ++d) {
      const int from = axis[static_cast<std::size_t>(d)];
      const Real lo = boxes.box[i].lo[from], hi = boxes.box[i].hi[from];
      const bool mirror = mirrored >> d & 1;
      turned.box[i].lo[d] = mirror ? -hi : lo, turned.box[i].hi[d] = mirror ? -lo : hi;
    }
  }
  RC_ASSERT(fresh(create, turned).pairs() == fresh(create, boxes).pairs());
}

/// B7: larger boxes overlap everything that smaller ones overlap, in pairs and in queries.
template <int D>
void growthLosesNothing(const BroadphaseFactory<D>& create) {
  const auto boxes = drawBoxes<D>();
  Random random = drawRandom();
  const auto grown = [&](Aabb<D> box) {
    for (int d = 0; d < D; ++d) {
      const Real size = box.hi[d] - box.lo[d];
      box.lo[d] -= size * static_cast<Real>(random.below(5)), box.hi[d] += size * static_cast<Real>(random.below(5));
    }
    return box;
  };
  Boxes<D> larger = boxes;
  for (Aabb<D>& box : larger.box) box = grown(box);
  Stand<D> stand = fresh(create, boxes);
  const auto less = stand.pairs(), more = fresh(create, larger).pairs();
  RC_ASSERT(std::includes(more.begin(), more.end(), less.begin(), less.end()));
  const Aabb<D> asked = drawBox<D>(random, BoxFamily::mixed);
  const auto few = stand.overlap(asked), many = stand.overlap(grown(asked));
  RC_ASSERT(std::includes(many.begin(), many.end(), few.begin(), few.end()));
}

/// B9: boxes that cannot be separated do not make a tree deeper than its limit.
template <int D>
void depthIsBounded(const BroadphaseFactory<D>& create) {
  Boxes<D> boxes;
  Random random = drawRandom();
  const Aabb<D> box = drawBox<D>(random, BoxFamily::mixed);
  for (int i = 0; i < 50; ++i) boxes.box.push_back(box), boxes.active.push_back(1);
  auto stand = fresh(create, boxes);
  RC_ASSERT(stand.pairs().size() == 50u * 49 / 2);
  constexpr std::uint64_t kDeepest = 16;
  RC_LOG() << stand.visits() << " visits\n";
  RC_ASSERT(stand.visits() <= (kDeepest << D) + 50);
}

enum class Of {
  all,
  exact,      // a conservative method may report pairs that nearly overlap
  forgetful,  // methods that declare a dependence on history are bounded by that failure's test, or by `kept`
  kept,       // a structure is kept from step to step while it is good enough
  regions     // trees that divide space, not boxes
};
const std::set<std::string> kKept = {"bsp"};

template <int D>
struct Named {
  const char* name;
  void (*holds)(const BroadphaseFactory<D>&);
  Of of = Of::all;

  bool concerns(const AlgorithmInfo& info) const {
    switch (of) {
      case Of::all:
        return true;
      case Of::exact:
        return info.guarantee == Guarantee::exact;
      case Of::forgetful:
        return !kKept.contains(info.name) &&
               std::none_of(info.failures.begin(), info.failures.end(), [](const FailureMode& failure) {
                 return failure.test == "tree_history_work" || failure.test == "refit_shuffled_work";
               });
      case Of::kept:
        return kKept.contains(info.name);
      case Of::regions:
        return info.name == "region_tree";
    }
    return false;
  }
};
template <int D>
std::vector<Named<D>> properties() {
  return {{"B2 order", orderIsNothing<D>},
          {"B2 history", historyIsNothing<D>},
          {"B3 back again", backAgain<D>},
          {"B4 shapes", touchingShapesAreFound<D>},
          {"B5 axes", axesAreAlike<D>, Of::exact},
          {"B7 growth", growthLosesNothing<D>, Of::exact},
          {"B9 wear", wearIsNothing<D>, Of::forgetful},
          {"B9 wear of what is kept", wearIsBounded<D>, Of::kept},
          {"B9 depth", depthIsBounded<D>, Of::regions}};
}

template <int D>
void everyBroadphase() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    if (algorithm->info.role != AlgorithmRole::competitor) continue;
    const std::vector<Spec> specs = variants(*algorithm);
    for (const Named<D>& p : properties<D>()) {
      if (!p.concerns(algorithm->info)) continue;
      check(std::string(p.name) + ", " + algorithm->info.name + ", " + std::to_string(D) + "D", [&] {
        const Spec& spec = specs[drawIndex(specs.size())];
        RC_LOG() << spec.text() << '\n';
        p.holds([&] { return createStage<Broadphase<D>>(spec); });
      });
    }
  }
}
TEST(BroadphaseRelations, TwoDimensions) { everyBroadphase<2>(); }
TEST(BroadphaseRelations, ThreeDimensions) { everyBroadphase<3>(); }

template <int D>
void bugsAreCaught() {
  const auto factory = []<class Bug>(std::type_identity<Bug>) -> BroadphaseFactory<D> {
    return [] { return std::make_unique<Bug>(); };
  };
  const std::map<std::string, BroadphaseFactory<D>> bugs = {
      {"B2 order", factory(std::type_identity<NearbySlots<D>>{})},
      {"B2 history", factory(std::type_identity<KeepsFirstBox<D>>{})},
      {"B3 back again", factory(std::type_identity<RemovesLast<D>>{})},
      {"B4 shapes", factory(std::type_identity<InnerSpheres<D>>{})},
      {"B5 axes", factory(std::type_identity<HalfOpenBoxes<D>>{})},
      {"B7 growth", factory(std::type_identity<CornersOnly<D>>{})},
      {"B9 wear", factory(std::type_identity<WearsOut<D>>{})},
      {"B9 wear of what is kept", factory(std::type_identity<OnlyGrows<D>>{})},
      {"B9 depth", factory(std::type_identity<Bottomless<D>>{})}};
  for (const Named<D>& p : properties<D>()) {
    const auto bug = bugs.find(p.name);
    ASSERT_NE(bug, bugs.end()) << p.name << " has no planted bug";
    expectFalsified(std::string(p.name) + ", " + std::to_string(D) + "D", [&] { p.holds(bug->second); });
    check(std::string(p.name) + " of the twin without a bug, " + std::to_string(D) + "D",
          [&] { p.holds(factory(std::type_identity<PlantedBug<D>>{})); });
  }
}
TEST(BroadphaseRelations, PlantedBugs2) { bugsAreCaught<2>(); }
TEST(BroadphaseRelations, PlantedBugs3) { bugsAreCaught<3>(); }

}  // namespace broadphase_relations_test
}}}  // namespace lpc::LPC_PRECISION::test
