// SPDX-License-Identifier: Zlib
// The structure that broadphases report for debug drawing must be true after any history.
#include "tests/check_property.h"
#include "tests/conformance/broadphase_model.h"
#include "tests/conformance/broadphase_variants.h"
#include "tests/planted_bugs/broadphase_structures.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace broadphase_structure_test {

/// Boundaries of cells are rounded relative to the largest coordinate of their axis.
template <int D>
Aabb<D> grownByRounding(Aabb<D> box, const Vec<D>& largest) {
  const Vec<D> rounding = 16 * kEps * largest;
  box.lo -= rounding, box.hi += rounding;
  return box;
}

/// A corner, or a point of a face or of the interior.
template <int D>
Vec<D> pointOf(const Aabb<D>& box, Random& random) {
  Vec<D> p;
  for (int d = 0; d < D; ++d) {
    const Real t = static_cast<Real>(random.below(2) ? random.uniform() : static_cast<double>(random.below(2)));
    p[d] = std::clamp((1 - t) * box.lo[d] + t * box.hi[d], box.lo[d], box.hi[d]);
  }
  return p;
}

template <int D>
void judge(const Broadphase<D>& broadphase, const Proxies<D>& proxies, Random& random) {
  std::vector<StructureBox<D>> told = {{{}, -7, false}};
  broadphase.structure(told);
  RC_ASSERT(told[0].level == -7);  // results are appended
  told.erase(told.begin());

  std::vector<Aabb<D>> standing;
  Vec<D> largest = Vec<D>::Zero();
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    const Aabb<D> box = proxies.box(i);
    if (proxies.isFree(i) || !(box.lo[0] <= box.hi[0])) continue;
    standing.push_back(box);
    largest = largest.cwiseMax(box.lo.cwiseAbs()).cwiseMax(box.hi.cwiseAbs());
  }

  std::vector<Aabb<D>> above, holding;
  for (const StructureBox<D>& part : told) {
    RC_ASSERT((part.box.lo.array() <= part.box.hi.array()).all());
    RC_ASSERT(part.level >= 0);
    RC_ASSERT(static_cast<std::size_t>(part.level) <= above.size());
    above.resize(static_cast<std::size_t>(part.level));
    if (!above.empty()) RC_ASSERT(above.back().contains(part.box));
    above.push_back(part.box);
    if (part.holds) holding.push_back(grownByRounding<D>(part.box, largest));
  }
  for (const Aabb<D>& part : holding) {
    RC_ASSERT(std::any_of(standing.begin(), standing.end(), [&](const Aabb<D>& b) { return part.overlaps(b); }));
  }
  if (told.empty()) return;
  for (const Aabb<D>& box : standing) {
    const Vec<D> p = pointOf<D>(box, random);
    RC_ASSERT(std::any_of(holding.begin(), holding.end(), [&](const Aabb<D>& part) { return part.contains(p); }));
  }
}

template <int D>
void checkStructure(Broadphase<D>& broadphase, BoxFamily family, const std::vector<Command>& list, std::uint64_t seed) {
  BoxCrowd<D> crowd(family);
  Random random(seed);
  const auto pairs = [&] {
    std::vector<ProxyPair> out;
    WorkDone work;
    broadphase.findPairs(crowd.proxies(), out, work);
    std::sort(out.begin(), out.end());
    return out;
  };
  const auto look = [&] {
    crowd.update(broadphase);
    const auto before = pairs();
    judge<D>(broadphase, crowd.proxies(), random);
    RC_ASSERT(pairs() == before);  // reporting changes nothing
  };
  for (std::size_t k = 0; k < list.size(); ++k) {
    crowd.apply(list[k]);
    if (k % 256 == 255) look();
  }
  look();
  crowd.apply({Command::clear, 0});
  for (int boxes = 0; boxes < 4; ++boxes) {
    look();
    crowd.apply({Command::add, random.next()});
  }
}

template <int D>
void checkAll() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    if (algorithm->info.role != AlgorithmRole::competitor) continue;
    const std::vector<Spec> specs = variants(*algorithm);
    check("structure of " + algorithm->info.name + ", " + std::to_string(D) + "D", [&] {
      const auto list = drawCommands();
      const auto family = anyFamily();
      const Spec& spec = specs[drawIndex(specs.size())];
      RC_LOG() << spec.text() << ", family " << static_cast<int>(family) << '\n';
      const auto broadphase = createStage<Broadphase<D>>(spec);
      checkStructure<D>(*broadphase, family, list, drawSeed());
    });
  }
}
TEST(BroadphaseStructure, TwoDimensions) { checkAll<2>(); }
TEST(BroadphaseStructure, ThreeDimensions) { checkAll<3>(); }

// --- known answers ---------------------------------------------------------------------------------------------------

template <int D>
std::vector<StructureBox<D>> told(const char* spec, const std::vector<Aabb<D>>& boxes) {
  Proxies<D> proxies;
  proxies.resize(static_cast<int>(boxes.size()));
  std::vector<ProxyId> all;
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    proxies.setBox(i, boxes[k]);
    proxies.active[k] = 1, proxies.body[k] = i, proxies.category[k] = proxies.mask[k] = 1;
    all.push_back(i);
  }
  const auto broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
  std::vector<ProxyPair> pairs;
  WorkDone work;
  broadphase->update(proxies, {all, {}, {}});
  broadphase->findPairs(proxies, pairs, work);
  std::vector<StructureBox<D>> out;
  broadphase->structure(out);
  return out;
}

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Expected {
  double x0, y0, x1, y1;
  int level;
  bool holds;
};
void expectTold(const char* spec, const std::vector<Aabb<2>>& boxes, const std::vector<Expected>& expected) {
  const auto parts = told<2>(spec, boxes);
  ASSERT_EQ(parts.size(), expected.size()) << spec;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Expected& e = expected[k];
    const std::array<std::pair<Real, double>, 4> ends = {{{parts[k].box.lo[0], e.x0},
                                                          {parts[k].box.lo[1], e.y0},
                                                          {parts[k].box.hi[0], e.x1},
                                                          {parts[k].box.hi[1], e.y1}}};
    for (const auto& [is, shall] : ends) {
      const double far = std::isinf(shall) ? 0 : std::abs(is - shall);
      EXPECT_LE(far, sizeof(Real) == 8 ? 1e-8 : 1e-5) << spec << ", part " << k;
      EXPECT_EQ(std::isinf(is), std::isinf(shall)) << spec << ", part " << k;
    }
    EXPECT_EQ(parts[k].level, e.level) << spec << ", part " << k;
    EXPECT_EQ(parts[k].holds, e.holds) << spec << ", part " << k;
  }
}

// One box on either side of (2.5, 2.5), and one that crosses x = 2.5.
TEST(BroadphaseStructure, KnownAnswers) {
  const std::vector<Aabb<2>> two = {{at<2>(0, 0), at<2>(1, 1)}, {at<2>(4, 4), at<2>(5, 5)}};
  std::vector<Aabb<2>> three = two;
  three.push_back({at<2>(2, 0), at<2>(3, 1)});
  expectTold("naive", two, {});
  expectTold("naive_sphere", two, {});
  expectTold("dynamic_tree{margin=0.5}", two,
             {{-0.5, -0.5, 5.5, 5.5, 0, false}, {-0.5, -0.5, 1.5, 1.5, 1, true}, {3.5, 3.5, 5.5, 5.5, 1, true}});
  expectTold("rebuilt_bvh{leaf=1}", two, {{0, 0, 5, 5, 0, false}, {0, 0, 1, 1, 1, true}, {4, 4, 5, 5, 1, true}});
  expectTold("sort_and_sweep{axis=1}", two, {{-kFar, 0, kFar, 1, 0, true}, {-kFar, 4, kFar, 5, 0, true}});
  expectTold("uniform_grid{cell=2}", two, {{0, 0, 2, 2, 0, true}, {4, 4, 6, 6, 0, true}});
  expectTold("spatial_hash{cell=1.5}", three,
             {{0, 0, 1.5, 1.5, 0, true},
              {1.5, 0, 3, 1.5, 0, true},
              {3, 0, 4.5, 1.5, 0, true},
              {3, 3, 4.5, 4.5, 0, true},
              {4.5, 3, 6, 4.5, 0, true},
              {3, 4.5, 4.5, 6, 0, true},
              {4.5, 4.5, 6, 6, 0, true}});
  const std::vector<Expected> crosses = {
      {-kFar, -kFar, kFar, kFar, 0, true}, {-kFar, -kFar, 2.5, 2.5, 1, true}, {2.5, 2.5, kFar, kFar, 1, true}};
  expectTold("region_tree{mode=tight,capacity=1}", three, crosses);
  expectTold("region_tree{mode=multi,capacity=1,max_depth=1}", three,
             {{-kFar, -kFar, kFar, kFar, 0, false},
              {-kFar, -kFar, 2.5, 2.5, 1, true},
              {2.5, -kFar, kFar, 2.5, 1, true},
              {-kFar, 2.5, 2.5, kFar, 1, false},
              {2.5, 2.5, kFar, kFar, 1, true}});
  // Split at the middle of the third of four boxes, which is then on both sides.
  std::vector<Aabb<2>> row;
  for (int i = 0; i < 4; ++i) row.push_back({at<2>(2 * i, 0), at<2>(2 * i + 1, 1)});
  expectTold(
      "bsp{leaf=3}", row,
      {{-kFar, -kFar, kFar, kFar, 0, false}, {-kFar, -kFar, 4.5, kFar, 1, true}, {4.5, -kFar, kFar, kFar, 1, true}});
}

/// Every structure that divides boxes or space reports parts; trees have more than one level.
template <int D>
void checkWhoTells() {
  Random random(1);
  std::vector<Aabb<D>> boxes;
  for (int i = 0; i < 100; ++i) boxes.push_back(drawBox<D>(random, BoxFamily::scattered));
  const std::vector<std::pair<const char*, bool>> methods = {{"bsp", true},
                                                             {"dynamic_tree", true},
                                                             {"rebuilt_bvh", true},
                                                             {"region_tree", true},
                                                             {"region_tree{mode=multi}", true},
                                                             {"region_tree{mode=loose}", true},
                                                             {"sort_and_sweep", false},
                                                             {"spatial_hash", false},
                                                             {"uniform_grid", false}};
  for (const auto& [spec, isTree] : methods) {
    int levels = 0, holding = 0;
    for (const StructureBox<D>& part : told<D>(spec, boxes)) {
      levels = std::max(levels, part.level + 1), holding += part.holds;
    }
    EXPECT_GT(holding, 1) << spec;
    EXPECT_EQ(levels > 1, isTree) << spec;
  }
}
TEST(BroadphaseStructure, EveryStructureReportsParts) {
  checkWhoTells<2>();
  checkWhoTells<3>();
}

// --- planted bugs ----------------------------------------------------------------------------------------------------

template <template <int> class Told>
void caseOf() {
  Told<3> broadphase;
  const auto list = drawCommands();
  checkStructure<3>(broadphase, BoxFamily::touching, list, drawSeed());
}
template <template <int> class Bug>
void expectRefused(const std::string& name) {
  expectFalsified("planted bug: " + name, caseOf<Bug>);
}
TEST(BroadphaseStructurePlantedBugs, CorrectBasesPass) {
  check("cells without a mistake", caseOf<TellsCells>, 20);
  check("a tree without a mistake", caseOf<TellsTree>, 20);
}
TEST(BroadphaseStructurePlantedBugs, Truncated) { expectRefused<TellsTruncated>("tells truncated cells"); }
TEST(BroadphaseStructurePlantedBugs, FirstCell) { expectRefused<TellsFirstCell>("tells the first cell alone"); }
TEST(BroadphaseStructurePlantedBugs, RemovedBoxes) { expectRefused<TellsTheGone>("tells who is gone"); }
TEST(BroadphaseStructurePlantedBugs, OldParents) { expectRefused<TellsOldParents>("tells parents as built"); }
TEST(BroadphaseStructurePlantedBugs, ByLevels) { expectRefused<TellsByLevels>("tells by levels"); }
TEST(BroadphaseStructurePlantedBugs, ReportingChangesTheNextStep) {
  expectRefused<TellingTouches>("telling touches a step");
}

}  // namespace broadphase_structure_test
}}}  // namespace lpc::LPC_PRECISION::test
