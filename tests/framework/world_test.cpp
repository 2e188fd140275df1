// SPDX-License-Identifier: Zlib
#include <gtest/gtest.h>

#include <sstream>

#include "framework/scene/director.h"
#include "framework/scene/recording.h"
#include "framework/world/invariants.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace world_test { namespace {

using test::addGround;
using test::addHeap;
using test::addRow;
using test::at;
using test::body;

constexpr Real kDt = Real(1) / 60;

std::string messageOf(auto&& f) {
  try {
    f();
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

template <class T>
class WorldTest : public testing::Test {};
template <int N>
struct Dim {
  static constexpr int D = N;
};
using Dims = testing::Types<Dim<2>, Dim<3>>;
TYPED_TEST_SUITE(WorldTest, Dims);

TYPED_TEST(WorldTest, HandlesOfRemovedBodiesAreInvalidAndSlotsAreReused) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle a = world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 0)));
  const BodyHandle b = world.add(body<D>(Shape<D>::sphere(1), at<D>(5, 0)));
  world.remove(a);
  EXPECT_FALSE(world.valid(a));
  EXPECT_TRUE(world.valid(b));
  const BodyHandle c = world.add(body<D>(Shape<D>::sphere(1), at<D>(9, 0)));
  EXPECT_EQ(c.slot, a.slot);
  EXPECT_NE(c, a);
  EXPECT_NE(messageOf([&] { world.pose(a); }), "");
  EXPECT_EQ(world.bodyCount(), 2);
}

TYPED_TEST(WorldTest, TheCentreOfMassIsInTheWorld) {
  constexpr int D = TypeParam::D;
  World<D> world;
  BodyDef<D> def;
  def.X_WB.p = at<D>(10, 0);
  def.shapes = {{.shape = Shape<D>::sphere(1), .X_BS = {at<D>(0, 2)}},
                {.shape = Shape<D>::sphere(1), .X_BS = {at<D>(0, 6)}}};
  const BodyHandle two = world.add(def);
  EXPECT_NEAR((world.centerOfMass(two) - at<D>(10, 4)).norm(), 0, 1e-5);
  world.remove(two);
  EXPECT_NE(messageOf([&] { world.centerOfMass(two); }), "");
}

TYPED_TEST(WorldTest, ASavedWorldMayEndInFreeSlots) {
  constexpr int D = TypeParam::D;
  World<D> saved, loaded;
  for (int i = 0; i < 40; ++i) saved.add(body<D>(Shape<D>::sphere(1), at<D>(3 * i, 0)));
  for (int i = 10; i < 40; ++i) saved.remove(saved.handle(i));
  std::stringstream bytes;
  saved.save(bytes);
  loaded.load(bytes);
  for (World<D>* w : {&saved, &loaded}) {
    w->step(kDt);
    EXPECT_EQ(w->proxies().size(), 40);
    EXPECT_EQ(w->add(body<D>(Shape<D>::sphere(1), at<D>(0, 3))).slot, 10);
    w->step(kDt);
  }
  EXPECT_EQ(loaded.hash(), saved.hash());
}

TYPED_TEST(WorldTest, AStepOfZeroSecondsChangesNothing) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addHeap(world, 5, 1);
  const std::uint64_t hash = world.hash();
  world.step(0);
  EXPECT_EQ(world.hash(), hash);
  EXPECT_EQ(world.stepCount(), 0);
}

TYPED_TEST(WorldTest, PoseIsOfTheBodyFrameAndMassFollowsFromShapes) {
  constexpr int D = TypeParam::D;
  World<D> world;
  BodyDef<D> def;
  def.X_WB.p = at<D>(1, 2);
  def.shapes.push_back({.shape = Shape<D>::box(Vec<D>::Constant(Real(0.5))), .density = 2});
  def.shapes.push_back({.shape = Shape<D>::box(Vec<D>::Constant(Real(0.5))), .X_BS = {at<D>(1, 0)}, .density = 6});
  const BodyHandle h = world.add(def);
  EXPECT_NEAR(world.mass(h), 8, 1e-5);
  EXPECT_NEAR(world.pose(h).p[0], 1, 1e-6);
  EXPECT_NEAR(world.bodies().pose[0].p[0], 1.75, 1e-6);  // 6 of 8 kg are 1 m away
}

TYPED_TEST(WorldTest, QueriesSeeShapesNotBoxesAndPresentPoses) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 0)));
  EXPECT_EQ(world.at(at<D>(0.5, 0.5)).size(), 1u);
  EXPECT_TRUE(world.at(at<D>(0.9, 0.9)).empty());  // in the bounding box, not in the ball
  EXPECT_EQ(world.overlap({at<D>(0.6, 0.6, -1), at<D>(2, 2, 1)}).size(), 1u);
  EXPECT_TRUE(world.overlap({at<D>(0.8, 0.8, -1), at<D>(2, 2, 1)}).empty());
  const auto hit = world.rayFirst(at<D>(-5, 0), at<D>(1, 0), 100);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 4, 1e-5);
  EXPECT_EQ(world.rayFirst(at<D>(-5, 0.99, 0.99), at<D>(1, 0), 100).has_value(), D == 2);
  world.setPose(ball, {at<D>(10, 0)});
  EXPECT_TRUE(world.at(at<D>(0.5, 0.5)).empty());
  EXPECT_EQ(world.at(at<D>(10.5, 0.5)).size(), 1u);
  world.remove(ball);
  EXPECT_TRUE(world.at(at<D>(10.5, 0.5)).empty());
}

template <int D>
class Diary final : public ContactListener<D> {
 public:
  std::string text;
  bool solve = true;
  bool begin(const World<D>&, const Manifold<D>&) override { return text += 'b', solve; }
  bool persist(const World<D>&, const Manifold<D>&) override { return text += 'p', solve; }
  void end(const World<D>&, const Manifold<D>&) override { text += 'e'; }
};

TYPED_TEST(WorldTest, ListenersHearBeginPersistEnd) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addGround(world);
  auto def = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0.6));
  def.shapes[0].restitution = 1;
  world.settings();
  world.add(def);
  Diary<D> diary;
  world.addListener(&diary);
  for (int i = 0; i < 60; ++i) world.step(kDt);
  EXPECT_EQ(diary.text.substr(0, 1), "b");
  EXPECT_NE(diary.text.find('e'), std::string::npos) << diary.text;
  // Begin and end alternate.
  std::string edges;
  for (char c : diary.text) {
    if (c != 'p') edges += c;
  }
  EXPECT_EQ(edges.find("bb"), std::string::npos) << diary.text;
  EXPECT_EQ(edges.find("ee"), std::string::npos) << diary.text;
}

TYPED_TEST(WorldTest, VetoLetsBodiesPass) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addGround(world);
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0.6)));
  Diary<D> diary;
  diary.solve = false;
  world.addListener(&diary);
  for (int i = 0; i < 120; ++i) world.step(kDt);
  EXPECT_LT(world.pose(ball).p[1], -5);
  EXPECT_EQ(diary.text.back(), 'e');
}

TYPED_TEST(WorldTest, RemovingASupportEndsTheContact) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle ground = addGround(world);
  world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0.5)));
  Diary<D> diary;
  world.addListener(&diary);
  for (int i = 0; i < 5; ++i) world.step(kDt);
  world.remove(ground);
  EXPECT_EQ(diary.text, "bppppe");
  world.step(kDt);
  EXPECT_EQ(diary.text, "bppppe");
}

TYPED_TEST(WorldTest, SpringHangsAtItsRestLengthPlusSag) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, -2)));
  const double m = double(world.mass(ball));
  const std::string stiffness = std::to_string(100 * m), damping = std::to_string(10 * m);
  world.add(
      ForceDef<D>{.kind = "spring{rest_length=1,stiffness=" + stiffness + ",damping=" + damping + "}", .bodyB = ball});
  for (int i = 0; i < 1200; ++i) world.step(kDt);
  EXPECT_NEAR(world.pose(ball).p[1], -(1 + 9.81 / 100), 1e-3);
}

TYPED_TEST(WorldTest, UserForceActsForOneStep) {
  constexpr int D = TypeParam::D;
  WorldSettings<D> settings;
  settings.gravity = Vec<D>::Zero();
  World<D> world({}, settings);
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0)));
  world.applyForce(ball, at<D>(double(world.mass(ball)), 0), at<D>(0, 0));
  world.step(kDt);
  EXPECT_NEAR(world.motion(ball).v[0], kDt, 1e-6);
  world.step(kDt);
  EXPECT_NEAR(world.motion(ball).v[0], kDt, 1e-6);
}

// One visit of each body, event and contact: ten times the bodies cost ten times as much.
TYPED_TEST(WorldTest, UserForcesCostLinearTime) {
  constexpr int D = TypeParam::D;
  for (const int n : {1000, 10'000}) {
    World<D> world(Pipeline::parse("sleep=split_average"));
    const std::vector<BodyHandle> row = addRow(world, n);
    world.step(kDt);
    ASSERT_EQ(world.manifolds().size(), static_cast<std::size_t>(n));
    for (const BodyHandle& h : row) world.applyForce(h, at<D>(1, 0), world.pose(h).p);
    world.step(kDt);
    EXPECT_EQ(world.profiler().frame().work[WorkCount::eventVisits], static_cast<std::uint64_t>(3 * n));
  }
}

TYPED_TEST(WorldTest, FreeSlotsAreNotSearchedFor) {
  constexpr int D = TypeParam::D;
  World<D> world;
  std::vector<BodyHandle> row = addRow(world, 1000);
  for (std::size_t i = 1; i < row.size(); i += 2) world.remove(row[i]);
  world.step(kDt);
  for (std::size_t i = 1; i < row.size(); i += 2) {
    EXPECT_EQ(world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 5))).slot, row[i].slot);
  }
  world.step(kDt);
  // One slot for the body and one for its shape, each from a heap of at most 500.
  EXPECT_LT(world.profiler().frame().work[WorkCount::eventVisits], 500u * 2 * 2 * 10);
}

TYPED_TEST(WorldTest, PinnedTurnsNonRotatableSlidesKinematicObeys) {
  constexpr int D = TypeParam::D;
  World<D> world;
  auto pinned = body<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(0, 0));
  pinned.pinned = true;
  pinned.angularVelocity = Ang<D>::Constant(1);
  auto stiff = body<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(5, 0));
  stiff.rotatable = false;
  auto lift = body<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(10, 0), BodyType::kinematic);
  lift.velocity = at<D>(0, 2);
  const BodyHandle p = world.add(pinned), s = world.add(stiff), k = world.add(lift);
  world.applyTorque(s, Ang<D>::Constant(1000));
  for (int i = 0; i < 30; ++i) world.step(kDt);
  EXPECT_EQ(world.pose(p).p, at<D>(0, 0));
  EXPECT_GT(world.motion(p).w.norm(), 0.9);
  EXPECT_EQ(world.motion(s).w.norm(), 0);
  EXPECT_LT(world.pose(s).p[1], -1);
  EXPECT_NEAR(world.pose(k).p[1], 1, 1e-5);
}

TYPED_TEST(WorldTest, JointedBodiesCollideOnlyWhenAsked) {
  constexpr int D = TypeParam::D;
  for (bool collide : {false, true}) {
    World<D> world;
    const BodyHandle a = world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 0), BodyType::fixed));
    const BodyHandle b = world.add(body<D>(Shape<D>::sphere(1), at<D>(1, 0)));
    world.add(JointDef<D>{.bodyA = a, .bodyB = b, .X_WJ = {at<D>(0.5, 0), {}}, .collide = collide});
    world.step(kDt);
    EXPECT_EQ(world.manifolds().size(), collide ? 1u : 0u);
  }
}

TYPED_TEST(WorldTest, ProfilerCsvDescribesItself) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addHeap(world, 5, 1);
  world.profiler().keepFrames(true);
  for (int i = 0; i < 3; ++i) world.step(kDt);
  std::ostringstream csv;
  world.profiler().writeCsv(csv);
  std::istringstream in(csv.str());
  std::string line, header;
  std::size_t columns = 0, rows = 0;
  while (std::getline(in, line)) {
    if (line[0] == '#') continue;
    const auto n = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    if (header.empty()) {
      header = line, columns = n;
    } else {
      EXPECT_EQ(n, columns);
      ++rows;
    }
  }
  EXPECT_EQ(rows, 3u);
  EXPECT_NE(header.find("seconds_broadphase"), std::string::npos) << header;
  EXPECT_NE(header.find("row_updates"), std::string::npos);
}

// Bytes of a frame after its bodies: the number of links and the heap's pivot, a flag and four positions.
template <int D>
constexpr std::size_t kLinks = 4 + 1 + 4 * D * sizeof(double);

TYPED_TEST(WorldTest, RecordingReadsBackAndDropsATornFrame) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addHeap(world, 4, 1);
  std::ostringstream out;
  Recorder<D> recorder(out, "a title");
  for (int i = 0; i < 5; ++i) world.step(kDt), recorder.frame(world);
  std::istringstream in(out.str());
  const Recording<D> r = Recording<D>::read(in);
  EXPECT_EQ(r.title, "a title");
  ASSERT_EQ(r.frames.size(), 5u);
  EXPECT_EQ(r.frames[0].newBodies.size(), 7u);
  EXPECT_EQ(r.frames[4].newBodies.size(), 0u);
  EXPECT_EQ(r.frames[4].bodies.size(), 7u);
  EXPECT_EQ(r.frames[4].bodies[3].X_WC.p, world.bodies().pose[3].p);
  std::istringstream torn(out.str().substr(0, out.str().size() - 3));
  const Recording<D> rest = Recording<D>::read(torn);
  EXPECT_EQ(rest.frames.size(), 4u);
  EXPECT_TRUE(rest.torn);
  EXPECT_FALSE(r.torn);
  std::istringstream header(out.str().substr(0, 10));
  EXPECT_NE(messageOf([&] { Recording<D>::read(header); }).find("ends early"), std::string::npos);
  // The first format has no title and no links. A frame ends with their number and the heap's pivot.
  ASSERT_EQ(r.frames[4].links.size(), 1u);
  EXPECT_EQ(r.frames[4].links[0].to, world.bodies().pose[6].p);
  std::ostringstream untitled;
  Recorder<D>(untitled).frame(world);
  const std::string second = untitled.str(), dimension = second.substr(8, 4);
  std::istringstream first("LPCREC1" + second.substr(7, 1) + dimension +
                           second.substr(16, second.size() - 16 - kLinks<D>));
  EXPECT_EQ(Recording<D>::read(first).frames.at(0).bodies.size(), 7u);
  std::istringstream wrong("no recording at all");
  EXPECT_NE(messageOf([&] { Recording<D>::read(wrong); }), "");
}

// Any damaged byte gives a one-line message, or a recording with valid kinds and finite positions.
TYPED_TEST(WorldTest, ADamagedRecordingIsToldOrHarmless) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addHeap(world, 4, 1);
  std::ostringstream out;
  Recorder<D> recorder(out);
  for (int i = 0; i < 2; ++i) world.step(kDt), recorder.frame(world);
  int told = 0;
  for (std::size_t i = 16; i < out.str().size(); ++i) {
    std::string bytes = out.str();
    bytes[i] = static_cast<char>(bytes[i] ^ 0xf8);
    std::istringstream in(bytes);
    const std::string message = messageOf([&] {
      for (const auto& frame : Recording<D>::read(in).frames) {
        EXPECT_TRUE(std::isfinite(frame.time)) << i;
        for (const auto& newBody : frame.newBodies) {
          for (const auto& part : newBody.parts) {
            ASSERT_LT(static_cast<int>(part.kind), kShapeKinds) << i;
            ASSERT_TRUE(part.X_CS.p.allFinite()) << i;
          }
        }
      }
    });
    told += !message.empty();
    EXPECT_TRUE(message.empty() || message.starts_with("the recording is damaged (")) << message;
  }
  EXPECT_GT(told, 20);
  // The message names the frame and the fault. After the header, a step, a time and two numbers comes the first body's
  // slot and type.
  const auto toldOf = [&](std::size_t at, char byte) {
    std::string bytes = out.str();
    bytes[at] = byte;
    std::istringstream in(bytes);
    return messageOf([&] { Recording<D>::read(in); });
  };
  EXPECT_EQ(toldOf(40 + 3, '\x80'), "the recording is damaged (frame 1: a body with an invalid slot)");
  EXPECT_EQ(toldOf(40 + 8, '\x03'), "the recording is damaged (frame 1: a body of unknown type)");
  const std::size_t pose = (D + (D == 2 ? 2 : 4)) * sizeof(double), lastBody = out.str().size() - kLinks<D> - pose - 9;
  EXPECT_EQ(toldOf(lastBody + 3, '\x80'), "the recording is damaged (frame 2: a body with an invalid slot)");
  EXPECT_EQ(toldOf(lastBody + 8, '\x02'), "the recording is damaged (frame 2: a body's flag is neither 0 nor 1)");
  EXPECT_EQ(toldOf(lastBody + 9 + pose + 4, '\x02'),
            "the recording is damaged (frame 2: a link's flag is neither 0 nor 1)");
}

TYPED_TEST(WorldTest, DirectorBringsAndTakesBodiesAtStepNumbers) {
  constexpr int D = TypeParam::D;
  SceneSpec<D> scene;
  scene.spawns.push_back({0, body<D>(Shape<D>::sphere(1), at<D>(0, 0), BodyType::fixed), -1});
  scene.spawns.push_back({3, body<D>(Shape<D>::sphere(1), at<D>(4, 0)), 5});
  scene.joints.push_back({0, 1, {.X_WJ = {at<D>(0, 0), {}}}});
  World<D> world;
  Director<D> director(scene);
  std::vector<int> bodies, joints;
  for (int i = 0; i < 7; ++i) {
    director.advance(world);
    bodies.push_back(world.bodyCount());
    joints.push_back(static_cast<int>(std::count_if(world.joints().begin(), world.joints().end(),
                                                    [](const JointRecord<D>& j) { return j.active(); })));
    world.step(kDt);
  }
  EXPECT_EQ(bodies, (std::vector<int>{1, 1, 1, 2, 2, 1, 1}));
  EXPECT_EQ(joints, (std::vector<int>{0, 0, 0, 1, 1, 0, 0}));
}

TYPED_TEST(WorldTest, InvariantsOfAFreeBodyAreClosedForms) {
  constexpr int D = TypeParam::D;
  World<D> world;
  auto def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(3, 4));
  def.velocity = at<D>(1, 2);
  def.angularVelocity = Ang<D>::Zero();
  def.angularVelocity[kAngDim<D> - 1] = 3;
  world.add(def);
  const Invariants<D> inv = invariants(world);
  const double inertia = 1.0 / 6;  // unit square or cube of 1 kg
  EXPECT_NEAR(inv.kinetic, 0.5 * 5 + 0.5 * inertia * 9, 1e-5);
  EXPECT_NEAR(inv.potential, 9.81 * 4, 1e-4);
  EXPECT_NEAR(inv.angularMomentum[kAngDim<D> - 1], 3 * 2 - 4 * 1 + inertia * 3, 1e-5);
  EXPECT_NEAR(inv.maxSpeed, std::sqrt(5), 1e-5);
}

// For a body so small that the determinant of its inertia underflows a double.
TEST(Invariants, OfATinyBodyAreFinite) {
  World<3> world;
  auto def = body<3>(Shape<3>::sphere(Real(1e-100)), at<3>(0, 0));
  def.shapes[0].density = Real(1e300);
  def.angularVelocity = {0, 0, 2};
  world.add(def);
  const Invariants<3> inv = invariants(world);
  const double mass = 4.18879020478639;
  EXPECT_NEAR(inv.kinetic / (0.5 * 0.4 * mass * 1e-200 * 4), 1, 1e-12);
  EXPECT_NEAR(inv.angularMomentum[2] / (0.4 * mass * 1e-200 * 2), 1, 1e-12);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::world_test
