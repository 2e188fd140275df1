// SPDX-License-Identifier: Zlib
// The drawing of a simulation equals its content. Each check returns whether it holds, so that drawings with a bug
// (tests/planted_bugs/draw_bugs.h) can be shown to fail.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "tests/expect_caught.h"
#include "tests/planted_bugs/draw_bugs.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace draw_simulation_test { namespace {

constexpr Real kDt = Real(1) / 60;

DrawLayers none() {
  DrawLayers layers;
  for (const DrawLayer& layer : kDrawLayers) layers.*layer.on = false;
  return layers;
}
DrawLayers only(bool DrawLayers::*layer) {
  DrawLayers layers = none();
  layers.*layer = true;
  return layers;
}
DrawLayers allLayers() {
  DrawLayers layers;
  for (const DrawLayer& layer : kDrawLayers) layers.*layer.on = true;
  return layers;
}

template <int D>
HeardDrawing<D> heard(const Drawing<D>& drawing, const Simulation<D>& world, const DrawLayers& layers) {
  HeardDrawing<D> out;
  drawing(world, layers, out);
  return out;
}

template <int D>
bool near(const Vec<D>& a, const Vec<D>& b, double within = 1e-9) {
  return (a - b).norm() <= within;
}
int brightness(const DrawColour& c) { return c.red + c.green + c.blue; }

template <int D>
Shape<D> cube(double half = 0.5) {
  return Shape<D>::box(Vec<D>::Constant(Real(half)));
}

// A box that rests on the ground.
template <int D>
void addResting(World<D>& world) {
  addGround(world);
  world.add(body<D>(cube<D>(), at<D>(0, 0.5)));
  for (int i = 0; i < 120; ++i) world.step(kDt);
}

// The contacts lie at the box's corners on the ground and are loaded.
template <int D>
bool restingContactsAreTheCorners(const Drawing<D>& drawing) {
  World<D> world;
  addResting(world);
  const HeardDrawing<D> points = heard<D>(drawing, world, only(&DrawLayers::contacts));
  if (points.size() != (1u << (D - 1)) || points.dots.size() != points.size()) return false;
  for (const auto& dot : points.dots) {
    for (int d = 0; d < D; ++d) {
      if (d != 1 && std::abs(std::abs(dot.p[d]) - 0.5) > 1e-3) return false;
    }
    if (dot.p[1] > 0 || dot.p[1] < -0.01 || dot.colour != kDrawnBearing) return false;
  }
  return true;
}

// Each contact point of a heap is drawn midway between its two anchors, red if it is loaded.
template <int D>
bool contactsAreTheWorlds(const Drawing<D>& drawing) {
  World<D> world;
  addHeap(world, 12, 5);
  std::size_t seen = 0, idle = 0;
  for (int i = 0; i < 90; ++i) {
    world.step(kDt);
    const HeardDrawing<D> points = heard<D>(drawing, world, only(&DrawLayers::contacts));
    std::size_t at = 0;
    for (const Manifold<D>& m : world.manifolds()) {
      for (int k = 0; k < m.count; ++k, ++at) {
        if (at == points.dots.size()) return false;
        const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
        const auto& X = world.bodies().pose;
        const Vec<D> a = X[static_cast<std::size_t>(m.bodyA)] * c.localA,
                     b = X[static_cast<std::size_t>(m.bodyB)] * c.localB;
        if (!near<D>(points.dots[at].p, (a + b) / 2)) return false;
        if (points.dots[at].colour != (c.load > 0 ? kDrawnBearing : kDrawnIdle)) return false;
        idle += c.load <= 0;
      }
    }
    if (at != points.size()) return false;
    seen += at;
  }
  return seen > 500 && idle > 10;
}

// The impulses on the resting box sum to its weight times the step, upwards. Normals have their fixed length.
template <int D>
bool impulsesAreTheWeight(const Drawing<D>& drawing) {
  World<D> world;
  addResting(world);
  DrawLayers layers = only(&DrawLayers::impulses);
  layers.impulseLength = 3;
  Vec<D> sum = Vec<D>::Zero();
  const HeardDrawing<D> lines = heard<D>(drawing, world, layers);
  for (const auto& line : lines.strokes) sum += line.b - line.a;
  const double weight = world.mass(world.handle(1)) * 9.81 * kDt;
  if (!near<D>(sum, at<D>(0, 3 * weight), 1e-3) || lines.strokes.size() != lines.size()) return false;
  for (const auto& line : heard<D>(drawing, world, only(&DrawLayers::normals)).strokes) {
    if (!near<D>(line.b - line.a, at<D>(0, 0.25), 1e-6)) return false;
  }
  return true;
}

// A box slides on the ground: the drawn friction opposes the motion and has Coulomb's magnitude.
template <int D>
bool frictionBrakes(const Drawing<D>& drawing) {
  World<D> world;
  addResting(world);
  world.setMotion(world.handle(1), {at<D>(1, 0), Ang<D>::Zero()});
  world.step(kDt);
  Vec<D> sum = Vec<D>::Zero();
  for (const auto& line : heard<D>(drawing, world, only(&DrawLayers::friction)).strokes) sum += line.b - line.a;
  const double weight = world.mass(world.handle(1)) * 9.81 * kDt;
  return std::abs(sum[0] + 0.5 * weight) < 0.1 * weight && std::abs(sum[1]) < 1e-3 * weight;
}

// The same box awake and asleep, with and without the layer.
template <int D>
bool sleepersArePaler(const Drawing<D>& drawing) {
  DrawLayers asked = only(&DrawLayers::shapes);
  asked.sleep = true;
  std::vector<HeardDrawing<D>> all;
  for (const bool awake : {true, false}) {
    World<D> world;
    addGround(world);
    BodyDef<D> def = body<D>(cube<D>(), at<D>(0, 0.5));
    def.awake = awake;
    world.add(def);
    for (const DrawLayers& layers : {asked, only(&DrawLayers::shapes)}) all.push_back(heard<D>(drawing, world, layers));
  }
  for (const HeardDrawing<D>& h : all) {
    if (h.solids.size() != 2 || h.solids[0].look != all[0].solids[0].look) return false;
  }
  const Look awake = all[0].solids[1].look, asleep = all[2].solids[1].look;
  return brightness(asleep.fill) > brightness(awake.fill) + 20 && all[1].solids[1].look == awake &&
         all[3].solids[1].look == awake;
}

// Shapes of a body with two shapes and of a compound are drawn at their poses, whatever the centre of mass. Static
// bodies are grey.
template <int D>
bool shapesAreWhereTheyAre(const Drawing<D>& drawing) {
  World<D> world;
  world.add(body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed));
  BodyDef<D> two = body<D>(Shape<D>::sphere(1), at<D>(5, 7));
  two.shapes.push_back({.shape = Shape<D>::sphere(Real(0.5)), .X_BS = {at<D>(3, 0), {}}});
  world.add(two);
  const ShapePart<D> parts[] = {{cube<D>(), {at<D>(-1, 0), {}}}, {cube<D>(), {at<D>(1, 0), {}}}};
  world.add(body<D>(Shape<D>::compound(parts), at<D>(20, 3)));
  const HeardDrawing<D> all = heard<D>(drawing, world, only(&DrawLayers::shapes));
  if (all.solids.size() != 5 || all.size() != 5) return false;
  const Vec<D> places[] = {at<D>(0, 0), at<D>(5, 7), at<D>(8, 7), at<D>(19, 3), at<D>(21, 3)};
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& s = all.solids[i];
    if (!near<D>(s.X_WS.p, places[i]) || s.look.moves != (i > 0) || s.look.outline) return false;
    if ((s.look.fill == kDrawnFixed) != (i == 0)) return false;
  }
  return all.solids[1].look.fill == all.solids[2].look.fill && all.solids[2].look.fill != all.solids[3].look.fill;
}

// Two stacks of two boxes on one ground, and a ball jointed to the second stack: two islands.
template <int D>
bool islandsHaveOneColour(const Drawing<D>& drawing) {
  World<D> world;
  addGround(world);
  for (const double x : {-3, 3}) {
    for (const double y : {0.5, 1.5}) world.add(body<D>(cube<D>(), at<D>(x, y)));
  }
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(6, 5)));
  world.add(pivot<D>(world.handle(4), ball, at<D>(3, 5)));
  world.step(kDt);
  DrawLayers layers = only(&DrawLayers::shapes);
  layers.islands = true;
  const HeardDrawing<D> all = heard<D>(drawing, world, layers);
  if (all.solids.size() != 6) return false;
  const auto fill = [&](std::size_t i) { return all.solids[i].look.fill; };
  return fill(0) == kDrawnFixed && fill(1) == fill(2) && fill(3) == fill(4) && fill(4) == fill(5) &&
         fill(1) != fill(3) && fill(1) != kDrawnFixed;
}

// The broadphase's bounding boxes, with all edges.
template <int D>
bool boxesAreTheBroadphases(const Drawing<D>& drawing) {
  World<D> world;
  world.add(body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed));
  world.add(body<D>(Shape<D>::sphere(1), at<D>(3, 4)));
  world.add(body<D>(cube<D>(), at<D>(-3, 4)));
  const BodyHandle gone = world.add(body<D>(cube<D>(), at<D>(-9, 4)));
  world.step(kDt);
  world.remove(gone);
  const HeardDrawing<D> all = heard<D>(drawing, world, only(&DrawLayers::boxes));
  const std::size_t edges = D * (1u << (D - 1));
  if (all.strokes.size() != 2 * edges || all.size() != 2 * edges) return false;
  for (std::size_t i = 0; i < 2; ++i) {
    Aabb<D> hull;
    double length = 0;
    for (std::size_t e = i * edges; e < (i + 1) * edges; ++e) {
      const auto& line = all.strokes[e];
      hull.lo = hull.lo.cwiseMin(line.a).cwiseMin(line.b), hull.hi = hull.hi.cwiseMax(line.a).cwiseMax(line.b);
      length += (line.b - line.a).norm();
    }
    const Aabb<D> box = world.proxies().box(static_cast<ProxyId>(i + 1));
    if (!near<D>(hull.lo, box.lo) || !near<D>(hull.hi, box.hi)) return false;
    if (std::abs(length - (1 << (D - 1)) * (box.hi - box.lo).sum()) > 1e-9) return false;
  }
  return near<D>(world.proxies().box(1).center(), at<D>(3, 4), 0.1);
}

// As many lines as the step's profile counts pairs, from centre to centre; for a plane from its nearest point.
template <int D>
bool pairsAreTheSteps(const Drawing<D>& drawing) {
  World<D> world;
  world.add(body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed));
  world.add(body<D>(cube<D>(), at<D>(0, 0.5)));
  world.add(body<D>(cube<D>(), at<D>(0.9, 1.4)));
  world.add(body<D>(cube<D>(), at<D>(9, 9)));
  world.step(kDt);
  const HeardDrawing<D> all = heard<D>(drawing, world, only(&DrawLayers::pairs));
  if (all.strokes.size() != static_cast<std::size_t>(world.profiler().frame().pairs) || all.size() != 2) return false;
  return near<D>(all.strokes[0].a, at<D>(0, 0)) && near<D>(all.strokes[0].b, at<D>(0, 0.5)) &&
         near<D>(all.strokes[1].a, at<D>(0, 0.5)) && near<D>(all.strokes[1].b, at<D>(0.9, 1.4));
}

// A pivot with anchors pulled 0.3 m apart.
template <int D>
bool jointsAndTheirErrorsAreSeen(const Drawing<D>& drawing) {
  World<D> world;
  const BodyHandle a = world.add(body<D>(cube<D>(), at<D>(0, 0))), b = world.add(body<D>(cube<D>(), at<D>(2, 0)));
  world.add(pivot<D>(a, b, at<D>(1, 0)));
  if (!heard<D>(drawing, world, only(&DrawLayers::jointErrors)).words.empty()) return false;
  world.setPose(b, {at<D>(2, 0.3), {}});
  const HeardDrawing<D> joint = heard<D>(drawing, world, only(&DrawLayers::joints));
  if (joint.dots.size() != 2 || joint.strokes.size() != 3 || joint.size() != 5) return false;
  if (!near<D>(joint.dots[0].p, at<D>(1, 0)) || !near<D>(joint.dots[1].p, at<D>(1, 0.3))) return false;
  const HeardDrawing<D> error = heard<D>(drawing, world, only(&DrawLayers::jointErrors));
  return error.words.size() == 1 && error.words[0].text == "300 mm" && near<D>(error.words[0].p, at<D>(1, 0.3)) &&
         error.strokes.size() == 1 && near<D>(error.strokes[0].a, at<D>(1, 0)) &&
         near<D>(error.strokes[0].b, at<D>(1, 0.3));
}

// A weld that was turned shows the angle.
template <int D>
bool turnsAreSeen(const Drawing<D>& drawing) {
  World<D> world;
  const BodyHandle a = world.add(body<D>(cube<D>(), at<D>(0, 0))), b = world.add(body<D>(cube<D>(), at<D>(2, 0)));
  JointDef<D> weld = pivot<D>(a, b, at<D>(2, 0));
  weld.kind = "weld";
  world.add(weld);
  Ang<D> turn = Ang<D>::Zero();
  turn[kAngDim<D> - 1] = Real(3.141592653589793 / 18);
  const auto said = [&](double right) {
    world.setPose(b, {at<D>(right, 0), integrateRotation(Rot<D>{}, turn)});
    const HeardDrawing<D> error = heard<D>(drawing, world, only(&DrawLayers::jointErrors));
    return error.words.size() == 1 ? error.words[0].text : "";
  };
  return said(2) == "10 deg" && said(4) == "2 m, 10 deg" && said(2.25) == "250 mm, 10 deg" && said(2.004) == "10 deg";
}

template <int D>
bool motionIsSeen(const Drawing<D>& drawing) {
  World<D> world;
  addGround(world);
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(5, 7));
  def.shapes.push_back({.shape = Shape<D>::sphere(1), .X_BS = {at<D>(3, 0), {}}});
  def.velocity = at<D>(-2, 4);
  world.add(def);
  DrawLayers layers = only(&DrawLayers::velocities);
  layers.velocityTime = Real(0.5);
  const HeardDrawing<D> v = heard<D>(drawing, world, layers);
  const HeardDrawing<D> c = heard<D>(drawing, world, only(&DrawLayers::centres));
  return v.strokes.size() == 1 && v.size() == 1 && near<D>(v.strokes[0].a, at<D>(6.5, 7)) &&
         near<D>(v.strokes[0].b, at<D>(5.5, 9)) && c.dots.size() == 1 && c.size() == 1 &&
         near<D>(c.dots[0].p, at<D>(6.5, 7));
}

// Drawing in every step changes no byte of the state.
template <int D>
bool nothingIsTouched(const Drawing<D>& drawing) {
  const std::string pipeline = "sleep=split_average";
  World<D> looked(Pipeline::parse(pipeline)), alone(Pipeline::parse(pipeline));
  for (World<D>* w : {&looked, &alone}) addHeap(*w, 8, 3), addJointed(*w, at<D>(30, 5));
  for (int i = 0; i < 90; ++i) {
    heard<D>(drawing, looked, allLayers());
    looked.step(kDt), alone.step(kDt);
    if (looked.hash() != alone.hash() || saved(looked) != saved(alone)) return false;
  }
  return true;
}

template <int D>
struct Check {
  const char* name;
  bool (*holds)(const Drawing<D>&);
  Drawing<D> bug;
  const char* bugName;
};

template <int D>
void everyCheck() {
  const std::vector<Check<D>> checks = {
      {"RestingContactsAreTheCorners", restingContactsAreTheCorners<D>, drawnUpsideDown<D>(), "upside down"},
      {"ContactsAreTheWorlds", contactsAreTheWorlds<D>, forgetsAPoint<D>(), "forgets a point"},
      {"ContactsAreTheWorlds", contactsAreTheWorlds<D>, allBear<D>(), "all bear"},
      {"ImpulsesAreTheWeight", impulsesAreTheWeight<D>, backwards<D>(), "backwards"},
      {"ImpulsesAreTheWeight", impulsesAreTheWeight<D>, forgetsAStroke<D>(), "forgets a line"},
      {"FrictionBrakes", frictionBrakes<D>, backwards<D>(), "backwards"},
      {"SleepersArePaler", sleepersArePaler<D>, deafTo<D>(&DrawLayers::sleep), "paler where it is not asked"},
      {"ShapesAreWhereTheyAre", shapesAreWhereTheyAre<D>, atTheCentre<D>(), "at the centre of mass"},
      {"IslandsHaveOneColour", islandsHaveOneColour<D>, oneColour<D>(), "one colour for all"},
      {"IslandsHaveOneColour", islandsHaveOneColour<D>, deafTo<D>(&DrawLayers::islands), "colours of bodies"},
      {"BoxesAreTheBroadphases", boxesAreTheBroadphases<D>, forgetsAStroke<D>(), "forgets a line"},
      {"PairsAreTheSteps", pairsAreTheSteps<D>, drawnUpsideDown<D>(), "upside down"},
      {"JointsAndTheirErrorsAreSeen", jointsAndTheirErrorsAreSeen<D>, forgetsAPoint<D>(), "forgets a point"},
      {"TurnsAreSeen", turnsAreSeen<D>, withoutWords<D>(), "without words"},
      {"MotionIsSeen", motionIsSeen<D>, backwards<D>(), "backwards"},
      {"NothingIsTouched", nothingIsTouched<D>, meddles<D>(), "pushes who is drawn"},
  };
  for (const Check<D>& c : checks) {
    EXPECT_TRUE(c.holds(drawSimulation<D>)) << c.name << ' ' << D << 'D';
    expectCaught("DrawSimulation." + std::string(c.name) + ' ' + c.bugName + ' ' + std::to_string(D) + 'D',
                 c.holds(c.bug));
  }
}
TEST(DrawSimulation, DrawsTheContentOfTheWorld2) { everyCheck<2>(); }
TEST(DrawSimulation, DrawsTheContentOfTheWorld3) { everyCheck<3>(); }

template <int D>
void nothingOfNobody() {
  World<D> world;
  EXPECT_EQ(heard<D>(drawSimulation<D>, world, allLayers()).size(), 0u);
  world.step(kDt);
  EXPECT_EQ(heard<D>(drawSimulation<D>, world, allLayers()).size(), 0u);
  addHeap(world, 6, 1);
  for (int i = 0; i < 60; ++i) world.step(kDt);
  const std::string bytes = saved(world);
  EXPECT_EQ(heard<D>(drawSimulation<D>, world, none()).size(), 0u);
  EXPECT_GT(heard<D>(drawSimulation<D>, world, only(&DrawLayers::pairs)).size(), 0u);
  world.clear();
  EXPECT_EQ(heard<D>(drawSimulation<D>, world, allLayers()).size(), 0u);
  EXPECT_TRUE(world.pairs().empty());
  // A world is loaded into one that had pairs of more shapes: none of those remain.
  addHeap(world, 20, 2);
  for (int i = 0; i < 60; ++i) world.step(kDt);
  std::istringstream in(bytes);
  world.load(in);
  EXPECT_TRUE(world.pairs().empty());
  EXPECT_GT(heard<D>(drawSimulation<D>, world, allLayers()).size(), 0u);
}
TEST(DrawSimulation, AnEmptyWorldDrawsNothing2) { nothingOfNobody<2>(); }
TEST(DrawSimulation, AnEmptyWorldDrawsNothing3) { nothingOfNobody<3>(); }

// Bodies, shapes and stages change between a step and its drawing.
template <int D>
void betweenSteps() {
  World<D> world;
  addHeap(world, 10, 4);
  for (int i = 0; i < 60; ++i) world.step(kDt);
  const std::size_t before = heard<D>(drawSimulation<D>, world, only(&DrawLayers::pairs)).size();
  world.remove(world.handle(2));
  EXPECT_LE(heard<D>(drawSimulation<D>, world, only(&DrawLayers::pairs)).size(), before);
  for (int i = 0; i < 3; ++i) world.add(body<D>(cube<D>(), at<D>(0, 20 + i)));
  heard<D>(drawSimulation<D>, world, allLayers());
  world.setPipeline(Pipeline::parse("broadphase=naive"));
  heard<D>(drawSimulation<D>, world, allLayers());
  // A body with NaN is omitted; the others are drawn.
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  std::vector<Pose<D>> poses = world.bodies().pose;
  poses[1].p[0] = nan;
  world.follow(poses, world.bodies().motion);
  const HeardDrawing<D> all = heard<D>(drawSimulation<D>, world, allLayers());
  EXPECT_EQ(all.solids.size(), static_cast<std::size_t>(world.bodyCount()) - 1);
  for (const auto& d : all.dots) EXPECT_TRUE(d.p.allFinite());
  for (const auto& l : all.strokes) EXPECT_TRUE(l.a.allFinite() && l.b.allFinite());
}
TEST(DrawSimulation, BetweenSteps2) { betweenSteps<2>(); }
TEST(DrawSimulation, BetweenSteps3) { betweenSteps<3>(); }

// A vetoed contact is kept but not solved: it shows no load, whatever it carried before.
template <int D>
void vetoedBearNothing() {
  struct Veto final : ContactListener<D> {
    bool persist(const World<D>&, const Manifold<D>&) override { return false; }
  } veto;
  World<D> world;
  addResting(world);
  world.addListener(&veto);
  world.step(kDt);
  const HeardDrawing<D> points = heard<D>(drawSimulation<D>, world, only(&DrawLayers::contacts));
  ASSERT_FALSE(points.dots.empty());
  for (const auto& d : points.dots) EXPECT_EQ(d.colour, kDrawnIdle);
  DrawLayers impulses = only(&DrawLayers::impulses);
  impulses.friction = true;
  EXPECT_EQ(heard<D>(drawSimulation<D>, world, impulses).size(), 0u);
}
TEST(DrawSimulation, VetoedContactsShowNoLoad2) { vetoedBearNothing<2>(); }
TEST(DrawSimulation, VetoedContactsShowNoLoad3) { vetoedBearNothing<3>(); }

// Drawn over another world: one colour, and bodies behind others are visible.
template <int D>
void tintIsAll() {
  World<D> world;
  addHeap(world, 8, 3);
  addJointed(world, at<D>(30, 5));
  for (int i = 0; i < 60; ++i) world.step(kDt);
  DrawLayers layers = allLayers();
  layers.tint = DrawColour{1, 2, 3, 200};
  const HeardDrawing<D> all = heard<D>(drawSimulation<D>, world, layers);
  EXPECT_GT(all.dots.size(), 0u);
  for (const auto& d : all.dots) EXPECT_EQ(d.colour, *layers.tint);
  for (const auto& l : all.strokes) EXPECT_EQ(l.colour, *layers.tint);
  for (const auto& w : all.words) EXPECT_EQ(w.colour, *layers.tint);
  for (const auto& s : all.solids) {
    EXPECT_TRUE(s.look.outline);
    EXPECT_TRUE(s.look.fill == *layers.tint && s.look.edge == *layers.tint);
  }
}
TEST(DrawSimulation, TintColoursEverything2) { tintIsAll<2>(); }
TEST(DrawSimulation, TintColoursEverything3) { tintIsAll<3>(); }

// The table lists every switch. Each layer alone draws something in a world that has everything, except two that only
// change how shapes look.
template <int D>
void everyLayerIsInTheTable() {
  DrawLayers bytes;
  EXPECT_EQ(kDrawLayers.size(), static_cast<std::size_t>(reinterpret_cast<const char*>(&bytes.velocities) -
                                                         reinterpret_cast<const char*>(&bytes.shapes)) +
                                    1);
  World<D> world;
  addHeap(world, 8, 3);
  addJointed(world, at<D>(30, 5));
  for (int i = 0; i < 70; ++i) world.step(kDt);
  world.setPose(world.handle(world.bodies().size() - 1), {at<D>(0, 30), {}});  // away from its joint
  std::set<std::string_view> names;
  for (const DrawLayer& layer : kDrawLayers) {
    EXPECT_TRUE(names.insert(layer.name).second && !layer.meaning.empty()) << layer.name;
    const bool looks = layer.on == &DrawLayers::sleep || layer.on == &DrawLayers::islands;
    EXPECT_EQ(heard<D>(drawSimulation<D>, world, only(layer.on)).size() > 0, !looks) << layer.name;
  }
}
TEST(DrawSimulation, EveryLayerIsInTheTable2) { everyLayerIsInTheTable<2>(); }
TEST(DrawSimulation, EveryLayerIsInTheTable3) { everyLayerIsInTheTable<3>(); }

TEST(DrawSimulation, TheManualHasEveryLayer) {
  std::ostringstream page;
  page << std::ifstream(LPC_SOURCE_DIR "/docs/reference_world.md").rdbuf();
  for (const DrawLayer& l : kDrawLayers) {
    const std::string row = "\n| " + std::string(l.name) + " | " + std::string(l.meaning) + " |\n";
    EXPECT_NE(page.str().find(row), std::string::npos) << row;
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::draw_simulation_test
