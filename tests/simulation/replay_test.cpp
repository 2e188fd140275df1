// SPDX-License-Identifier: Zlib
// The same history gives the same bits (S1, S3, S4, S6, S7, S10, S11, S12), for every solver and every other stage.
// Each property returns whether it holds, so that planted stages can be shown to break it.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/scene/director.h"
#include "framework/scene/recording.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/planted_stages.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace replay_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr int kSteps = 75;  // enough to reach limits that disjoint scenes share

template <int D>
struct Run {
  World<D> world;
  std::vector<std::uint64_t> hashes;
  explicit Run(const std::string& pipeline) : world(Pipeline::parse(pipeline)) {}
  Run& steps(int n = kSteps) {
    for (int i = 0; i < n; ++i) {
      world.step(kDt);
      hashes.push_back(world.hash());
    }
    return *this;
  }
};

template <int D>
std::vector<std::uint64_t> heapHashes(const std::string& pipeline, std::uint64_t seed) {
  Run<D> run(pipeline);
  addHeap(run.world, 10, seed);
  return run.steps().hashes;
}

// S1: also after an unrelated world ran.
template <int D>
bool sameAgain(const std::string& pipeline) {
  const auto once = heapHashes<D>(pipeline, 3);
  heapHashes<D>(pipeline, 4);
  return heapHashes<D>(pipeline, 3) == once;
}

// S3: saved bytes are equal after every later step, and saving changes nothing. One removed and one added body leave a
// free and a reused slot.
template <int D>
bool savedIsContinued(const std::string& pipeline) {
  Run<D> a(pipeline), b(pipeline);
  addHeap(a.world, 8, 7);
  addJointed(a.world, at<D>(30, 5));
  a.steps(kSteps / 2);
  a.world.remove(a.world.handle(3));
  const std::string bytes = saved(a.world);
  if (saved(a.world) != bytes) return false;
  std::istringstream in(bytes);
  b.world.load(in);
  if (saved(b.world) != bytes) return false;
  for (World<D>* w : {&a.world, &b.world}) w->add(body<D>(Shape<D>::sphere(Real(0.3)), at<D>(0, 9)));
  for (int i = 0; i < kSteps / 2; ++i) {
    a.world.step(kDt), b.world.step(kDt);
    if (saved(a.world) != saved(b.world)) return false;
  }
  return true;
}

// S3 for forces: one of each kind, on one body or on all, and the free slot of a removed one. Early versions did not
// save forces.
template <int D>
bool forcesAreSaved(bool lost) {
  Run<D> a(""), b("");
  addHeap(a.world, 6, 7);
  const BodyHandle first = a.world.handle(1), second = a.world.handle(2);
  const ForceHandle gone = a.world.add(ForceDef<D>{.kind = "drag"});
  for (const Registered* r : Registry::instance().list(StageKind::force, D)) {
    ForceDef<D> def{.kind = r->info.name};
    const ForceEnds ends = createStage<ForceKind<D>>(Spec::parse(def.kind))->ends();
    if (ends.from) def.bodyA = first, def.bodyB = second;
    if (ends.anchors) def.anchorB = at<D>(0.1, 0.2);
    a.world.add(def);
  }
  a.world.remove(gone);
  a.steps(kSteps / 2);
  const std::string bytes = saved(a.world);
  std::istringstream in(bytes);
  b.world.load(in);
  if (saved(b.world) != bytes) return false;
  for (std::size_t i = 0; lost && i < b.world.forces().size(); ++i) {
    const ForceRecord<D>& f = b.world.forces()[i];
    if (f.kind) b.world.remove(ForceHandle{static_cast<std::int32_t>(i), f.generation});
  }
  const auto one = a.world.add(ForceDef<D>{.kind = "drag"}), other = b.world.add(ForceDef<D>{.kind = "drag"});
  a.steps(kSteps / 2), b.steps(kSteps / 2);
  return a.world.hash() == b.world.hash() && (lost || (one == other && saved(a.world) == saved(b.world)));
}
TEST(Replay, ForcesAreSaved) {
  EXPECT_TRUE(forcesAreSaved<2>(false) && forcesAreSaved<3>(false));
  expectCaught("Replay.ForcesAreSaved forces that nobody saves 2D", forcesAreSaved<2>(true));
  expectCaught("Replay.ForcesAreSaved forces that nobody saves 3D", forcesAreSaved<3>(true));
}

// S4: a frame of the recording equals the state of a run that stops there.
template <int D>
bool recordingIsTheRun(const std::string& pipeline) {
  std::ostringstream out;
  Run<D> recorded(pipeline);
  addHeap(recorded.world, 5, 2);
  Recorder<D> recorder(out);
  for (int i = 0; i < kSteps; ++i) recorded.steps(1), recorder.frame(recorded.world);
  std::istringstream in(out.str());
  const Recording<D> recording = Recording<D>::read(in);
  for (int k : {kSteps / 3, kSteps}) {
    Run<D> linear(pipeline);
    addHeap(linear.world, 5, 2);
    linear.steps(k);
    const auto& frame = recording.frames[static_cast<std::size_t>(k) - 1];
    if (frame.step != k || frame.bodies.size() != 8) return false;
    for (const auto& b : frame.bodies) {
      const Pose<D>& x = linear.world.bodies().pose[static_cast<std::size_t>(b.slot)];
      if (b.X_WC.p != x.p || b.X_WC.q.matrix() != x.q.matrix()) return false;
    }
  }
  return true;
}

template <int D>
bool sameBodies(const World<D>& a, std::size_t firstA, const World<D>& b, std::size_t firstB, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const Pose<D>&x = a.bodies().pose[firstA + i], &y = b.bodies().pose[firstB + i];
    const Motion<D>&v = a.bodies().motion[firstA + i], &w = b.bodies().motion[firstB + i];
    if (x.p != y.p || x.q.matrix() != y.q.matrix() || v.v != w.v || v.w != w.w) return false;
  }
  return true;
}

// S6: a body that falls a kilometre away changes nothing.
template <int D>
bool strangersDoNotMatter(const std::string& pipeline) {
  Run<D> alone(pipeline), watched(pipeline);
  addHeap(alone.world, 10, 5), addHeap(watched.world, 10, 5);
  watched.world.add(body<D>(Shape<D>::sphere(1), at<D>(1000, 1000)));
  alone.steps(), watched.steps();
  return sameBodies(alone.world, 0, watched.world, 0, 13);
}

// S7: two scenes that do not touch behave in one world as in two. With tolerance 0, `nonlinear` reaches its limit of
// moves in these heaps.
template <int D>
bool disjointScenesAreTwoWorlds(const std::string& pipeline) {
  const Vec<D> there = at<D>(200, 0);
  Run<D> one(pipeline), two(pipeline), both(pipeline);
  addHeap(one.world, 10, 9), addHeap(both.world, 10, 9);
  addHeap(two.world, 6, 10, there), addHeap(both.world, 6, 10, there);
  one.steps(), two.steps(), both.steps();
  return sameBodies(one.world, 0, both.world, 0, 13) && sameBodies(two.world, 0, both.world, 13, 9);
}

// S11
template <int D>
bool watchingDoesNotMatter(const std::string& pipeline) {
  Run<D> watched(pipeline);
  watched.world.profiler().keepFrames(true);
  addHeap(watched.world, 10, 3);
  return watched.steps().hashes == heapHashes<D>(pipeline, 3);
}

// A profile without its time columns.
std::string withoutTimes(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, out;
  std::vector<bool> keep;
  while (std::getline(lines, line)) {
    if (line[0] == '#') continue;
    std::istringstream cells(line);
    std::string cell;
    const bool header = keep.empty();
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (header) keep.push_back(!cell.starts_with("seconds"));
      if (keep[i]) out += cell + ',';
    }
    out += '\n';
  }
  return out;
}

// S12: a script that adds and removes bodies, run twice.
template <int D>
bool scriptIsTheSameAgain(const std::string& pipeline) {
  const auto play = [&] {
    SceneSpec<D> scene;
    scene.spawns.push_back({0, body<D>(Shape<D>::box(Vec<D>::Constant(2)), at<D>(0, -2), BodyType::fixed), -1});
    for (int i = 0; i < 6; ++i) {
      const long removeAt = i % 2 ? 5L * i + 20 : -1;
      scene.spawns.push_back({3L * i, body<D>(Shape<D>::sphere(Real(0.4)), at<D>(0.1 * i, 1)), removeAt});
    }
    Run<D> run(pipeline);
    run.world.profiler().keepFrames(true);
    Director<D> director(scene);
    for (int i = 0; i < kSteps; ++i) director.advance(run.world), run.steps(1);
    std::ostringstream csv;
    run.world.profiler().writeCsv(csv);
    return withoutTimes(csv.str());
  };
  const std::string once = play();
  return once.size() > 1000 && play() == once;
}

template <int D>
struct Named {
  const char* name;
  bool (*holds)(const std::string& pipeline);
  const char* bug;  // a planted stage that breaks it
};
template <int D>
std::vector<Named<D>> properties() {
  return {{"Replay.SameAgain", sameAgain<D>, "remembers_runs"},
          {"Replay.SavedIsContinued", savedIsContinued<D>, "remembers"},
          {"Replay.RecordingIsTheRun", recordingIsTheRun<D>, "remembers_runs"},
          {"Replay.StrangersDoNotMatter", strangersDoNotMatter<D>, "counts_bodies"},
          {"Replay.DisjointScenesAreTwoWorlds", disjointScenesAreTwoWorlds<D>, "counts_bodies"},
          {"Replay.WatchingDoesNotMatter", watchingDoesNotMatter<D>, "watches"},
          {"Replay.ScriptIsTheSameAgain", scriptIsTheSameAgain<D>, "remembers_runs"}};
}

template <int D>
void everyPipelineReplays() {
  for (const Named<D>& p : properties<D>()) {
    std::vector<std::string> pipelines = everyPipeline<D>();
    pipelines.push_back("sleep=split_average solver=soft_step");
    pipelines.push_back("sleep=split_average contacts=planted_children");
    pipelines.push_back("cache=recycling solver=soft_step{arms=as_made}");
    pipelines.push_back("sleep=split_average contacts=persistent_manifold cache=recycling");
    pipelines.push_back("solver=split_solver{position=nonlinear{tolerance=0}}");
    for (const std::string& pipeline : pipelines) {
      // One random draw per contact: another number of contacts changes the order.
      if (p.holds == disjointScenesAreTwoWorlds<D> && pipeline.find("order=random") != pipeline.npos) continue;
      const bool fails = declares<D>(Pipeline::parse(pipeline)[StageKind::solver].text(), p.name);
      EXPECT_EQ(p.holds(pipeline), !fails) << p.name << ' ' << pipeline << ' ' << D << 'D';
    }
    EXPECT_TRUE(p.holds("solver=planted_solver")) << p.name;
    EXPECT_TRUE(p.holds("solver=planted_solver{bug=writes_down}")) << p.name;
    const std::string bug = "solver=planted_solver{bug=" + std::string(p.bug) + "}";
    expectCaught(std::string(p.name) + ' ' + bug + ' ' + std::to_string(D) + 'D', p.holds(bug));
  }
}
TEST(Replay, EveryPipeline2) { everyPipelineReplays<2>(); }
TEST(Replay, EveryPipeline3) { everyPipelineReplays<3>(); }

// Points that a generator keeps from earlier steps must be part of the world's state.
TEST(Replay, KeptPointsAreSaved) {
  expectCaught("Replay.SavedIsContinued contacts=planted_keeper 2D", savedIsContinued<2>("contacts=planted_keeper"));
  expectCaught("Replay.SavedIsContinued contacts=planted_keeper 3D", savedIsContinued<3>("contacts=planted_keeper"));
}

// soft_step{arms=as_made} only matters for points that a cache has kept: it changes recycling and nothing else.
template <int D>
bool armsOfBeforeMatter(const std::string& cache) {
  Run<D> turning("cache=" + cache + " solver=soft_step"), asMade("cache=" + cache + " solver=soft_step{arms=as_made}");
  addHeap(turning.world, 10, 3), addHeap(asMade.world, 10, 3);
  turning.steps(), asMade.steps();
  return !sameBodies(turning.world, 0, asMade.world, 0, turning.world.bodies().pose.size());
}
TEST(Recycling, ArmsAsMadeMatterOnlyForKeptPoints) {
  EXPECT_TRUE(armsOfBeforeMatter<2>("recycling") && armsOfBeforeMatter<3>("recycling"));
  EXPECT_FALSE(armsOfBeforeMatter<2>("by_feature") || armsOfBeforeMatter<3>("by_feature"));
}

// Points that were made while a listener vetoed them have valid arms once it allows them. The ground is rotated by 90
// degrees: arms computed for an unrotated body would be wrong by a quarter turn.
template <int D>
struct ForbidsTheFirst final : ContactListener<D> {
  bool begin(const World<D>&, const Manifold<D>&) override { return false; }
};
template <int D>
Real spinOfWhatWasForbidden(const std::string& arms) {
  Run<D> run("cache=recycling solver=soft_step{arms=" + arms + "}");
  ForbidsTheFirst<D> listener;
  run.world.addListener(&listener);
  BodyDef<D> ground = body<D>(Shape<D>::box(Vec<D>::Constant(2)), at<D>(0, -2), BodyType::fixed);
  Ang<D> turn = Ang<D>::Zero();
  turn[kAngDim<D> - 1] = Real(1.5707963);
  ground.X_WB.q = integrateRotation(Rot<D>{}, turn);
  run.world.add(ground);
  run.world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(1, 0.5)));
  Real most = 0;
  for (int i = 0; i < 20; ++i) most = std::max(most, run.steps(1).world.bodies().motion[1].w.norm());
  return most;
}
TEST(Recycling, VetoedPointsKeepTheirArms) {
  for (const char* arms : {"as_made", "turning"}) {
    EXPECT_LT(spinOfWhatWasForbidden<2>(arms), Real(0.01)) << arms;
    EXPECT_LT(spinOfWhatWasForbidden<3>(arms), Real(0.01)) << arms;
  }
}

// S10: a broadphase may find pairs in any order, and contacts are sorted. So every exact broadphase gives the same
// trajectory.
template <int D>
void sameForAllBroadphases() {
  for (const Registered* cache : Registry::instance().list(StageKind::cache, D)) {
    const std::string with = " cache=" + cache->info.name;
    const auto expected = heapHashes<D>("broadphase=naive" + with, 3);
    for (const Registered* r : Registry::instance().list(StageKind::broadphase, D)) {
      const bool right = !r->info.name.starts_with("planted");  // witnesses that a build may contain are right, too
      EXPECT_EQ(heapHashes<D>("broadphase=" + r->info.name + with, 3) == expected, right) << r->info.name << with << D;
    }
  }
}
TEST(Replay, EveryBroadphaseGivesTheSameTrajectory) { sameForAllBroadphases<2>(), sameForAllBroadphases<3>(); }

// The 2009 engine lost mass and centre of a body with a light and a heavy shape.
template <int D>
void lightAndHeavy() {
  World<D> world, loaded;
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(1, 2));
  def.shapes[0].density = Real(0.01), def.shapes[0].X_BS.p = at<D>(-3, 0);
  def.shapes.push_back({.shape = Shape<D>::sphere(Real(0.5)), .X_BS = {at<D>(2, 0)}, .density = 100});
  const BodyHandle whole = world.add(def);
  std::stringstream file(saved(world));
  loaded.load(file);
  EXPECT_EQ(loaded.bodies().center[0], world.bodies().center[0]);
  EXPECT_GT(loaded.bodies().center[0][0], 1.9);  // at the heavy sphere
  EXPECT_EQ(loaded.mass(whole), world.mass(whole));
  world.at(Vec<D>::Zero()), loaded.at(Vec<D>::Zero());  // updates the bounding boxes
  for (const ProxyId i : {0, 1}) {
    EXPECT_EQ(loaded.proxies().box(i).lo, world.proxies().box(i).lo);
    EXPECT_EQ(loaded.proxies().box(i).hi, world.proxies().box(i).hi);
  }
  const BodyDef<D> again = loaded.definition(whole);
  EXPECT_EQ(again.shapes[0].density, Real(0.01));
  EXPECT_EQ(again.shapes[1].density, 100);
}
TEST(Replay, ALightAndAHeavyShapeKeepTheirCentre) { lightAndHeavy<2>(), lightAndHeavy<3>(); }

TEST(Replay, DamagedSavesAreRefusedAndChangeNothing) {
  World<2> world;
  addHeap(world, 3, 7);
  const std::string bytes = saved(world);
  const std::uint64_t hash = world.hash();
  for (const std::string& wrong : {std::string("nonsense"), std::string(), bytes.substr(0, bytes.size() / 2)}) {
    std::istringstream in(wrong);
    EXPECT_THROW(world.load(in), UserError);
    EXPECT_EQ(world.hash(), hash);
  }
  // The error for a save of another format names that format.
  std::string old = bytes;
  old.replace(0, 10, "LPCWORLD4", 10);  // with its final zero
  try {
    std::istringstream in(old);
    world.load(in);
    ADD_FAILURE() << "an old save was read";
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(), "load: the saved world has the format LPCWORLD4; this program reads LPCWORLD10");
  }
  EXPECT_EQ(world.hash(), hash);
  World<3> space;
  std::istringstream in(bytes);
  EXPECT_THROW(space.load(in), UserError);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::replay_test
