// SPDX-License-Identifier: Zlib
// Every broadphase of the registry, in both dimensions: the right pairs after long histories, the right answers to
// queries, and the failures that it declares.
#include "tests/planted_bugs/broadphase.h"

#include <charconv>
#include <map>

#include "algorithms/broadphase/window.h"
#include "tests/check_property.h"
#include "tests/conformance/broadphase_model.h"
#include "tests/conformance/broadphase_variants.h"
#include "tests/run_property.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace broadphase_test {

constexpr int kRuns = 60;  // histories of each method, and of each planted bug

template <int D>
void checkAllPairs() {
  const auto list = Registry::instance().list(StageKind::broadphase, D);
  ASSERT_GE(list.size(), 5u);
  for (const Registered* algorithm : list) {
    if (algorithm->info.role != AlgorithmRole::competitor) continue;
    const std::vector<Spec> specs = variants(*algorithm);
    std::size_t runs = 0, total = 0;
    // Lengths grow with the number of the case. Half of the cases use the default parameters, so that these get long
    // histories.
    check(
        "pairs of " + algorithm->info.name + " are those of brute force, " + std::to_string(D) + "D",
        [&] {
          const auto commandList = drawCommands();
          const auto family = anyFamily();
          const int variant = RapidCheckDraw().below(2 * static_cast<int>(specs.size()));
          const Spec& spec = specs[static_cast<std::size_t>(std::max(0, variant - static_cast<int>(specs.size())))];
          ++runs, total += commandList.size();
          RC_LOG() << spec.text() << ", family " << static_cast<int>(family) << '\n';
          checkPairs<D>([&] { return createStage<Broadphase<D>>(spec); }, algorithm->info.guarantee, family,
                        commandList);
        },
        kRuns);
    if (!::testing::Test::HasFailure() && runs >= 50) {
      EXPECT_GE(total / runs, 1000u) << "sequences are too short to age a structure";
    }
  }
}
TEST(BroadphasePairs, TwoDimensions) { checkAllPairs<2>(); }
TEST(BroadphasePairs, ThreeDimensions) { checkAllPairs<3>(); }

// Tests the generator: every command and every family is drawn, and boxes both overlap and miss.
TEST(BroadphaseGenerator, DrawsEverything) {
  std::map<int, int> kinds, families;
  std::uint64_t pairs = 0, overlapping = 0;
  runProperty(
      "commands",
      [&] {
        const auto list = drawCommands();
        const auto family = anyFamily();
        ++families[static_cast<int>(family)];
        BoxCrowd<2> crowd(family);
        for (const Command& c : list) ++kinds[c.kind], crowd.apply(c);
        const Proxies<2>& proxies = crowd.proxies();
        for (ProxyId i = 0; i < proxies.size(); ++i) {
          for (ProxyId j = i + 1; j < proxies.size(); ++j) {
            if (proxies.isFree(i) || proxies.isFree(j)) continue;
            ++pairs, overlapping += proxies.boxesOverlap(i, j);
          }
        }
      },
      100);
  EXPECT_EQ(kinds.size(), 10u);
  for (const auto& [kind, count] : kinds) {
    std::ostringstream name;
    name << Command{static_cast<Command::Kind>(kind), 0};
    std::printf("%-16s %d drawn\n", name.str().c_str(), count);
    EXPECT_GE(count, 20) << name.str();
  }
  EXPECT_EQ(families.size(), std::size_t{kBoxFamilies});
  for (const auto& [family, count] : families) EXPECT_GE(count, 100 / kBoxFamilies / 4) << "family " << family;
  const double share = static_cast<double>(overlapping) / static_cast<double>(pairs);
  std::printf("%.1f %% of the pairs of boxes overlap\n", 100 * share);
  EXPECT_GE(share, 0.05);
  EXPECT_LE(share, 0.7);
}

// Cells are sized by the active boxes of the sample, if it has any.
TEST(BroadphaseSample, UsesAwakeBodies) {
  Proxies<2> proxies;
  proxies.resize(1000);
  std::vector<ProxyId> slots;
  for (ProxyId i = 0; i < 1000; ++i) {
    proxies.setBox(i, {at<2>(0, 0), at<2>(i % 2 ? 1 : 2, i % 2 ? 3 : 1)});
    proxies.active[static_cast<std::size_t>(i)] = i % 2 == 1;
    slots.push_back(i);
  }
  std::vector<Real> sizes;
  broadphase::sampleSizes(proxies, slots, 400, sizes);  // every second box: all asleep
  EXPECT_EQ(sizes, std::vector<Real>(500, 2));
  slots.erase(slots.begin());  // now all awake
  broadphase::sampleSizes(proxies, slots, 400, sizes);
  EXPECT_EQ(sizes, std::vector<Real>(500, 3));
  broadphase::sampleSizes(proxies, slots, 5000, sizes);  // all boxes: only the awake ones count
  EXPECT_EQ(sizes, std::vector<Real>(500, 3));
}

// --- planted bugs ----------------------------------------------------------------------------------------------------

template <template <int> class Bug>
void expectRefused(const std::string& name, Guarantee guarantee = Guarantee::exact) {
  expectFalsified(
      "planted bug: " + name,
      [&] {
        const auto commandList = drawCommands();
        const auto family = anyFamily();
        if (*rc::gen::arbitrary<bool>()) {
          checkPairs<2>([] { return std::make_unique<Bug<2>>(); }, guarantee, family, commandList);
        } else {
          checkPairs<3>([] { return std::make_unique<Bug<3>>(); }, guarantee, family, commandList);
        }
      },
      kRuns);
}
TEST(BroadphasePlantedBugs, OpenBoxes) { expectRefused<OpenBoxes>("open boxes"); }
TEST(BroadphasePlantedBugs, ForgetsCenterLine) { expectRefused<ForgetsCenterLine>("forgets the centre line"); }
TEST(BroadphasePlantedBugs, StaleSlot) { expectRefused<StaleSlot>("stale slot"); }
TEST(BroadphasePlantedBugs, Duplicates) { expectRefused<Duplicates>("duplicates"); }
TEST(BroadphasePlantedBugs, TruncatesCells) { expectRefused<TruncatesCells>("truncates cells"); }
TEST(BroadphasePlantedBugs, ForgetsTheCell) { expectRefused<ForgetsTheCell>("forgets the cell"); }
TEST(BroadphasePlantedBugs, OneSideOfPlane) { expectRefused<OneSideOfPlane>("one side of the plane"); }
TEST(BroadphasePlantedBugs, WakesTheDead) { expectRefused<WakesTheDead>("wakes the dead"); }
TEST(BroadphasePlantedBugs, MeetsTheLost) { expectRefused<MeetsTheLost>("meets the lost"); }
TEST(BroadphasePlantedBugs, ForgetsParent) { expectRefused<ForgetsParent>("forgets a parent"); }
TEST(BroadphasePlantedBugs, KeepsFatPairs) { expectRefused<KeepsFatPairs>("keeps pairs of fat boxes"); }
TEST(BroadphasePlantedBugs, InnerSpheres) { expectRefused<InnerSpheres>("inner spheres", Guarantee::conservative); }

// The correct base of the planted bugs passes, so each bug is caught for its own fault.
TEST(BroadphasePlantedBugs, CorrectBasePasses) {
  check(
      "twin without a mistake",
      [] {
        const auto family = anyFamily();
        checkPairs<3>([] { return std::make_unique<PlantedBug<3>>(); }, Guarantee::exact, family, drawCommands());
      },
      20);
}

// --- declared failures must happen -----------------------------------------------------------------------------------

template <int D>
class Boxes {
 public:
  void add(const Vec<D>& center, const Vec<D>& half) {
    const int i = m_proxies.size();
    m_proxies.resize(i + 1);
    const auto k = static_cast<std::size_t>(i);
    m_proxies.setBox(i, {center - half, center + half});
    m_proxies.active[k] = 1, m_proxies.body[k] = i, m_proxies.category[k] = 1, m_proxies.mask[k] = 1;
    m_all.push_back(i);
  }
  struct Outcome {
    std::uint64_t pairs, boxTests, visits, moves;
  };
  Vec<D> center(ProxyId i) const { return m_proxies.box(i).center(); }
  /// As a new structure.
  Outcome run(const char* spec) const {
    const auto broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
    return ask(*broadphase, {m_all, {}, {}});
  }
  /// The same boxes, after `steps` steps in which all of them were elsewhere.
  Outcome runAged(const char* spec, int steps, const std::function<Vec<D>(ProxyId)>& elsewhere) const {
    const auto broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
    Boxes other = *this;
    for (int step = 0; step < steps; ++step) {
      for (const ProxyId i : m_all) {
        const Aabb<D> box = m_proxies.box(i);
        const Vec<D> half = (box.hi - box.lo) / 2, center = elsewhere(i);
        other.m_proxies.setBox(i, {center - half, center + half});
      }
      other.ask(*broadphase, {step == 0 ? m_all : std::vector<ProxyId>{}, {}, m_all});
    }
    return ask(*broadphase, {{}, {}, m_all});
  }

  /// Sort moves of the last step, after `steps` steps in each of which all boxes moved by `shift`.
  std::uint64_t movesAfter(const char* spec, const Vec<D>& shift, int steps) const {
    const auto broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
    Proxies<D> proxies = m_proxies;
    std::vector<ProxyPair> pairs;
    for (int step = 0;; ++step) {
      WorkDone work;
      if (step == 0) broadphase->update(proxies, {m_all, {}, {}});
      if (step > 0) broadphase->update(proxies, {{}, {}, m_all});
      pairs.clear();
      broadphase->findPairs(proxies, pairs, work);
      if (step == steps) return work[WorkCount::sortMoves];
      for (ProxyId i = 0; i < proxies.size(); ++i) {
        proxies.setBox(i, {proxies.box(i).lo + shift, proxies.box(i).hi + shift});
      }
    }
  }

 private:
  Outcome ask(Broadphase<D>& broadphase, const ProxyChanges& changes) const {
    std::vector<ProxyPair> pairs;
    WorkDone work;
    broadphase.update(m_proxies, changes);
    broadphase.findPairs(m_proxies, pairs, work);
    return {pairs.size(), work[WorkCount::boxTests], work[WorkCount::nodeVisits], work[WorkCount::sortMoves]};
  }

  Proxies<D> m_proxies;
  std::vector<ProxyId> m_all;
};

template <int D>
Vec<D> along(int axis, Real x) {
  Vec<D> v = Vec<D>::Zero();
  v[axis] = x;
  return v;
}

constexpr int kCount = 500;
constexpr std::uint64_t kAllPairs = std::uint64_t{kCount} * (kCount - 1) / 2;

// A random place in a region in which each of kCount unit boxes overlaps about one other.
template <int D>
Vec<D> anywhere(Random& random) {
  Vec<D> v;
  for (int d = 0; d < D; ++d) v[d] = static_cast<Real>(random.uniform(0, D == 2 ? 45 : 16));
  return v;
}
template <int D>
Boxes<D> scattered(Random& random) {
  Boxes<D> boxes;
  for (int i = 0; i < kCount; ++i) boxes.add(anywhere<D>(random), Vec<D>::Constant(Real(0.5)));
  return boxes;
}

template <int D>
std::map<std::string, std::function<void()>> declaredFailures() {
  return {{"sphere_planks_false_pairs",
           [] {
             Boxes<D> pile;
             Vec<D> plank = Vec<D>::Constant(Real(0.05));
             plank[0] = 5;
             for (int i = 0; i < kCount; ++i) pile.add(along<D>(1, Real(0.2) * static_cast<Real>(i)), plank);
             EXPECT_EQ(pile.run("naive").pairs, 0u);
             EXPECT_GT(pile.run("naive_sphere").pairs, 20u * kCount);
           }},
          {"sweep_shared_interval_work",
           [] {
             Boxes<D> tower;
             for (int i = 0; i < kCount; ++i) tower.add(along<D>(1, static_cast<Real>(i)), Vec<D>::Constant(Real(0.5)));
             EXPECT_GE(tower.run("sort_and_sweep{axis=0}").boxTests, kAllPairs);
             EXPECT_LT(tower.run("sort_and_sweep{axis=1}").boxTests, kAllPairs / 5);
             EXPECT_LT(tower.run("sort_and_sweep").boxTests, kAllPairs / 5);
           }},
          {"grid_many_large_work",
           [] {
             Boxes<D> row;  // no overlaps; 40 % are fifty times as large as the rest
             Real x = 0;
             for (int i = 0; i < kCount; ++i) {
               const Real half = i % 5 < 2 ? Real(25) : Real(0.5);
               row.add(along<D>(0, x + half), Vec<D>::Constant(half));
               x += 2 * half + 1;
             }
             EXPECT_GE(row.run("uniform_grid").boxTests, kAllPairs / 7);
             EXPECT_LT(row.run("sort_and_sweep").boxTests, kAllPairs / 10);
           }},
          {"hash_many_large_work",
           [] {
             Boxes<D> row;  // no overlaps; 40 % are fifty times as large as the rest
             Real x = 0;
             for (int i = 0; i < kCount; ++i) {
               const Real half = i % 5 < 2 ? Real(25) : Real(0.5);
               row.add(along<D>(0, x + half), Vec<D>::Constant(half));
               x += 2 * half + 1;
             }
             EXPECT_GE(row.run("spatial_hash{levels=1}").boxTests, kAllPairs / 2);
             EXPECT_LT(row.run("spatial_hash").boxTests, kAllPairs / 10);
             EXPECT_LT(row.run("sort_and_sweep").boxTests, kAllPairs / 10);
           }},
          {"hash_crowded_cell_work",
           [] {
             Boxes<D> row;  // no overlaps; 40 % are so small that all of them share one cell
             for (int i = 0; i < kCount; ++i) {
               const bool small = i % 5 < 2;
               row.add(along<D>(0, static_cast<Real>(i) * (small ? Real(0.002) : -2)),
                       Vec<D>::Constant(small ? Real(0.0005) : Real(0.5)));
             }
             EXPECT_GE(row.run("spatial_hash{levels=1}").boxTests, kAllPairs / 7);
             EXPECT_LT(row.run("spatial_hash").boxTests, kAllPairs / 10);
             EXPECT_LT(row.run("sort_and_sweep").boxTests, kAllPairs / 10);
           }},
          {"hash_planks_work",
           [] {
             Boxes<D> pile;
             Vec<D> plank = Vec<D>::Constant(Real(0.05));
             plank[0] = 5;
             for (int i = 0; i < kCount; ++i) pile.add(along<D>(1, Real(0.2) * static_cast<Real>(i)), plank);
             EXPECT_GE(pile.run("spatial_hash").boxTests, kAllPairs / 5);
             EXPECT_LT(pile.run("bsp").boxTests, kAllPairs / 20);
           }},
          {"hash_collisions_work",
           [] {
             Boxes<D> row;
             for (int i = 0; i < kCount; ++i)
               row.add(along<D>(0, static_cast<Real>(2 * i)), Vec<D>::Constant(Real(0.5)));
             EXPECT_GE(row.run("spatial_hash{table=0.0078125}").boxTests, kAllPairs / 5);
             EXPECT_LT(row.run("spatial_hash").boxTests, kAllPairs / 100);
           }},
          {"bsp_flying_crowd_work",
           [] {
             Boxes<D> row;
             for (int i = 0; i < kCount; ++i)
               row.add(along<D>(0, static_cast<Real>(2 * i)), Vec<D>::Constant(Real(0.5)));
             const std::uint64_t anew = row.movesAfter("bsp", Vec<D>::Zero(), 0);
             EXPECT_LT(row.movesAfter("bsp", along<D>(0, Real(0.1)), 1), anew * 2 / 3);
             EXPECT_GE(row.movesAfter("bsp", along<D>(0, Real(3000)), 1), anew);
           }},
          {"bsp_lattice_work",
           [] {
             Boxes<D> lattice;  // equally many rods along each axis; in 3D they pass each other
             constexpr int kSide = D == 2 ? 250 : 13;
             for (int axis = 0; axis < D; ++axis) {
               for (int i = 0; i < (D == 2 ? kSide : kSide * kSide); ++i) {
                 Vec<D> at = Vec<D>::Constant(Real(0.3) * static_cast<Real>(axis)), half = Vec<D>::Constant(Real(0.05));
                 at[(axis + 1) % D] += static_cast<Real>(i % kSide);
                 at[(axis + 2) % D] += static_cast<Real>(i / kSide);
                 at[axis] = 0, half[axis] = 500;
                 lattice.add(at, half);
               }
             }
             const auto n = static_cast<std::uint64_t>(D == 2 ? D * kSide : D * kSide * kSide);
             EXPECT_EQ(lattice.run("bsp").boxTests, n * (n - 1) / 2);
             EXPECT_EQ(lattice.run("bsp").pairs, D == 2 ? n * n / 4 : 0);
           }},
          {"tree_centre_line_work",
           [] {
             Boxes<D> tower;
             for (int i = 0; i < kCount; ++i) {
               tower.add(along<D>(1, static_cast<Real>(2 * i)), Vec<D>::Constant(Real(0.75)));
             }
             EXPECT_GE(tower.run("region_tree{mode=tight}").boxTests, kAllPairs * 9 / 10);
             EXPECT_LT(tower.run("region_tree{mode=loose}").boxTests, kAllPairs / 20);
             EXPECT_LT(tower.run("region_tree{mode=multi}").boxTests, kAllPairs / 20);
           }},
          {"morton_far_crowd_work",
           [] {
             for (const int far : {1, kCount / 10}) {
               Random random(3);
               Boxes<D> crowd;
               for (int i = 0; i < kCount; ++i) {
                 Vec<D> center = anywhere<D>(random);
                 if (i < far) center.array() += Real(1e7);
                 crowd.add(center, Vec<D>::Constant(Real(0.5)));
               }
               const std::uint64_t tests = crowd.run("rebuilt_bvh{build=morton,leaf=4}").boxTests;
               if (far == 1) {
                 EXPECT_LT(tests, kAllPairs / 5);
               } else {
                 EXPECT_GE(tests, kAllPairs / 2);
               }
               EXPECT_LT(crowd.run("rebuilt_bvh{build=median,leaf=4}").boxTests, kAllPairs / 5);
               EXPECT_LT(crowd.run("rebuilt_bvh{build=sah,leaf=4}").boxTests, kAllPairs / 5);
             }
           }},
          {"refit_shuffled_work",
           [] {
             Random random(4);
             const Boxes<D> boxes = scattered<D>(random);
             const auto elsewhere = [&](ProxyId) { return anywhere<D>(random); };
             const std::uint64_t anew = boxes.runAged("rebuilt_bvh", 10, elsewhere).boxTests;
             EXPECT_EQ(anew, boxes.run("rebuilt_bvh").boxTests);
             EXPECT_GE(boxes.runAged("rebuilt_bvh{refit=10}", 10, elsewhere).boxTests, 3 * anew);
             EXPECT_EQ(boxes.runAged("rebuilt_bvh{refit=9}", 10, elsewhere).boxTests, anew);
           }},
          {"tree_all_fast_work",
           [] {
             Random random(5);
             const Boxes<D> boxes = scattered<D>(random);
             const auto beyond = [&](ProxyId i) { return Vec<D>(boxes.center(i) + along<D>(0, 3)); };
             const auto fast = boxes.runAged("dynamic_tree", 1, beyond);
             EXPECT_EQ(fast.moves, std::uint64_t{kCount});
             EXPECT_GE(fast.visits, 2u * kCount);  // all nodes
             const auto single = boxes.runAged("dynamic_tree{bulk=1}", 1, beyond);
             EXPECT_EQ(single.moves, std::uint64_t{kCount});
             EXPECT_GE(single.visits, 20u * kCount);
             const auto resting = boxes.runAged("dynamic_tree", 10, [&](ProxyId i) { return boxes.center(i); });
             EXPECT_EQ(resting.moves, 0u);
             EXPECT_EQ(resting.visits, 0u);
           }},
          {"tree_sorted_insertion_work",
           [] {
             Boxes<D> row;
             for (int i = 0; i < kCount; ++i)
               row.add(along<D>(0, static_cast<Real>(2 * i)), Vec<D>::Constant(Real(0.5)));
             EXPECT_GE(row.run("dynamic_tree{rotate=false,bulk=1}").visits, kAllPairs);
             EXPECT_LT(row.run("dynamic_tree{bulk=1}").visits, kAllPairs / 4);
             EXPECT_LT(row.run("dynamic_tree{rotate=false}").visits, kAllPairs / 4);
           }},
          {"tree_history_work", [] {
             Random random(6);
             const Boxes<D> boxes = scattered<D>(random);
             const auto elsewhere = [&](ProxyId) { return anywhere<D>(random); };
             const std::uint64_t anew = boxes.run("dynamic_tree{bulk=1}").visits;
             const std::uint64_t aged = boxes.runAged("dynamic_tree{bulk=1}", 100, elsewhere).visits;
             EXPECT_GT(aged, anew);
             EXPECT_LT(aged, 2 * anew);
             // A top-down build forgets the history.
             const char* const bulk = "dynamic_tree{stretch=0}";
             EXPECT_EQ(boxes.runAged(bulk, 100, elsewhere).visits, boxes.run(bulk).visits);
           }}};
}

template <int D>
void checkDeclaredFailures() {
  const auto known = declaredFailures<D>();
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    for (const FailureMode& failure : algorithm->info.failures) {
      SCOPED_TRACE(algorithm->info.name + " declares: " + failure.when + " -> " + failure.symptom);
      const auto it = known.find(failure.test);
      if (it == known.end()) {
        ADD_FAILURE() << "there is no test '" << failure.test << "': add it to declaredFailures";
      } else {
        it->second();
      }
    }
  }
}
TEST(BroadphaseFailures, TwoDimensions) { checkDeclaredFailures<2>(); }
TEST(BroadphaseFailures, ThreeDimensions) { checkDeclaredFailures<3>(); }

}  // namespace broadphase_test
}}}  // namespace lpc::LPC_PRECISION::test
