// SPDX-License-Identifier: Zlib
// No stage allocates once it is warm: it keeps the memory that it needs again. Allocations are counted by replacing the
// allocator of this program.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "framework/math/random.h"
#include "framework/world/world.h"
#include "tests/conformance/broadphase_variants.h"
#include "tests/every_solver.h"

namespace {
long allocations = 0;

void* counted(std::size_t size) {
  ++allocations;
  void* memory = std::malloc(size > 0 ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}
}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

// Allocations here and inside the library are counted.
TEST(Allocations, AreCounted) {
  long before = allocations;
  int* volatile one = new int(1);  // volatile: otherwise the compiler may omit it
  delete one;
  const std::vector<int> v(10);
  EXPECT_EQ(allocations - before, 2);
  before = allocations;
  const World<2> world;
  EXPECT_GT(allocations - before, 5);
}

// Boxes that oscillate: every frame differs, but no set of overlaps grows without bound.
template <int D>
long allocationsOfWarmFrames(Broadphase<D>& broadphase) {
  constexpr int kBoxes = 300;
  Random random(5);
  Proxies<D> proxies;
  proxies.resize(kBoxes);
  std::vector<ProxyId> all;
  std::vector<Aabb<D>> home;
  for (ProxyId i = 0; i < kBoxes; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Aabb<D> box;
    for (int d = 0; d < D; ++d) {
      box.lo[d] = static_cast<Real>(random.uniform(0, 12));
      box.hi[d] = box.lo[d] + static_cast<Real>(random.uniform(0.5, 1.5));
    }
    proxies.setBox(i, box);
    proxies.active[k] = 1, proxies.body[k] = i, proxies.category[k] = proxies.mask[k] = 1;
    all.push_back(i), home.push_back(box);
  }
  std::vector<ProxyPair> pairs;
  pairs.reserve(kBoxes * kBoxes / 2);
  WorkDone work;
  broadphase.update(proxies, {all, {}, {}});
  long warm = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const Real shift = static_cast<Real>(frame % 10) / 100;
    for (ProxyId i : all) {
      Aabb<D> box = home[static_cast<std::size_t>(i)];
      box.lo[i % D] += shift, box.hi[i % D] += shift;
      proxies.setBox(i, box);
    }
    pairs.clear();
    if (frame == 20) warm = allocations;
    broadphase.update(proxies, {{}, {}, all});
    broadphase.findPairs(proxies, pairs, work);
  }
  return allocations - warm;
}

template <int D>
void checkBroadphases() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    for (const Spec& spec : variants(*algorithm)) {
      const auto broadphase = createStage<Broadphase<D>>(spec);
      EXPECT_EQ(allocationsOfWarmFrames(*broadphase), 0) << spec.text();
    }
  }
}
TEST(Allocations, Broadphases2) { checkBroadphases<2>(); }
TEST(Allocations, Broadphases3) { checkBroadphases<3>(); }

// Planted bug: a list of candidates that is allocated anew in each frame.
class ForgetsItsMemory final : public Broadphase<2> {
 public:
  void findPairs(const Proxies<2>& proxies, std::vector<ProxyPair>&, WorkDone&) override {
    std::vector<ProxyId> candidates(static_cast<std::size_t>(proxies.size()));
    m_last = candidates.data();
  }
  const ProxyId* m_last = nullptr;
};
TEST(Allocations, PlantedBugIsCaught) {
  ForgetsItsMemory bug;
  EXPECT_EQ(allocationsOfWarmFrames<2>(bug), 20);
}

// Level at y = 0. The inner edge lies beside the bodies, so that creeping bodies make no new contacts.
template <int D>
Shape<D> twoParts() {
  if constexpr (D == 2) {
    return Shape<2>::chain(std::vector<Vec<2>>{{8, 0}, {5, 0}, {-2, 0}}, false);
  } else {
    const std::vector<Vec<3>> points = {{-2, 0, -7}, {-2, 0, 3}, {8, 0, 3}, {8, 0, -7}};
    return Shape<3>::mesh(points, std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}});
  }
}

// A pile at rest on a box and a surface. It consists of boxes and of boxes composed of halves; all stages are at work.
template <int D>
long allocationsOfWarmSteps(const Pipeline& pipeline, const std::vector<std::string>& forces = {}) {
  WorldSettings<D> settings;
  settings.model.sleeping = false;
  World<D> world(pipeline, settings);
  const auto add = [&](BodyType type, const Vec<D>& at, const Shape<D>& box) {
    BodyDef<D> body;
    body.type = type, body.X_WB.p = at;
    ShapeDef<D> shape;
    shape.shape = box;
    body.shapes.push_back(shape);
    world.add(body);
  };
  Vec<D> under = Vec<D>::Zero();
  under[1] = -5;
  add(BodyType::fixed, under, Shape<D>::box(Vec<D>::Constant(5)));
  add(BodyType::fixed, Vec<D>::Zero(), twoParts<D>());
  for (const std::string& kind : forces) world.add(ForceDef<D>{.kind = kind});
  Vec<D> half = Vec<D>::Constant(Real(0.5)), right = Vec<D>::Zero();
  const Shape<D> whole = Shape<D>::box(half);
  half[0] = right[0] = Real(0.25);
  const Shape<D> part = Shape<D>::box(half);
  const std::vector<ShapePart<D>> halves = {{part, {-right, {}}}, {part, {right, {}}}};
  const Shape<D> twoHalves = Shape<D>::compound(halves);
  for (int k = 0; k < 4; ++k) {
    Vec<D> at = Vec<D>::Zero();
    at[0] = Real(1.2) * static_cast<Real>(k % 2), at[1] = Real(0.5) + static_cast<Real>(k / 2);
    add(BodyType::dynamic, at, k % 2 == 0 ? whole : twoHalves);
  }
  // Long enough for a box on single points to have rocked both ways: each new contact needs memory.
  for (int k = 0; k < 120; ++k) world.step(Real(1) / 60);
  const long before = allocations;
  for (int k = 0; k < 10; ++k) world.step(Real(1) / 60);
  return allocations - before;
}

template <int D>
void checkWorlds() {
  for (const std::string& pipeline : everyPipeline<D>()) {
    EXPECT_EQ(allocationsOfWarmSteps<D>(Pipeline::parse(pipeline)), 0) << pipeline;
  }
}
TEST(Allocations, Worlds2) { checkWorlds<2>(); }
TEST(Allocations, Worlds3) { checkWorlds<3>(); }

// Planted bug: a list that is allocated anew at each call.
template <int D>
class Forgets final : public ForceKind<D> {
 public:
  using Params = NoParams;
  explicit Forgets(const Params&) {}
  static AlgorithmInfo info() { return {.name = "forgets", .summary = "bug", .paper = "", .complexity = ""}; }
  ForceEnds ends() const override { return {}; }
  void apply(const ForceRecord<D>&, const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    const std::vector<Real> list(state.pose.size(), 0);
    out[0].force[0] += list[0];
  }
};

// Kinds of force that act on all bodies without disturbing the pile.
template <int D>
void checkForces() {
  const Pipeline usual;
  EXPECT_EQ(allocationsOfWarmSteps<D>(usual, {"drag", "rolling_resistance", "torque{torque=0}", "wind{x=0}"}), 0);
  static const Registrar<ForceKind, Forgets, D> registrar(__FILE__);
  EXPECT_EQ(allocationsOfWarmSteps<D>(usual, {"forgets"}), 10);
}
TEST(Allocations, Forces) { checkForces<2>(), checkForces<3>(); }

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
