// SPDX-License-Identifier: Zlib
// Reading scene files: expressions, loops, scripts, and mistakes reported with file and line.
#include "experiments/trial/scene/scene_file.h"

#include <gtest/gtest.h>

#include "experiments/parse/expression.h"
#include "framework/math/check.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scene_file_test { namespace {

const std::string kHead = "name = \"t\"\nsummary = \"s\"\ndimensions = [2, 3]\n";  // lines 1 to 3

SceneSpec<2> flat(const std::string& text, const ParameterValues& values = {}) {
  return SceneFile::parse(kHead + text, "t.toml").build<2>(values, 1);
}

std::string messageOf(const std::string& text, const ParameterValues& values = {}, bool head = true) {
  try {
    SceneFile::parse((head ? kHead : "") + text, "t.toml").build<2>(values, 1);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Expression, computes) {
  Expressions e(1);
  e.setGlobal("base", 7);
  e.setLocal("i", 3);
  EXPECT_EQ(e.evaluate("base - i * 2"), 1);
  EXPECT_EQ(e.evaluate("mod(-1, 3)"), 2);
  EXPECT_EQ(e.evaluate("i == 3 ? 10 : 20"), 10);
  EXPECT_NEAR(e.evaluate("sin(pi / 6)"), 0.5, 1e-15);
  EXPECT_NEAR(e.evaluate("cos(pi / 3)"), 0.5, 1e-15);
  EXPECT_EQ(e.evaluate("harmonic(0)"), 0);
  EXPECT_NEAR(e.evaluate("harmonic(4)"), 25.0 / 12, 1e-15);
  e.setLocal("i", 4);
  EXPECT_EQ(e.evaluate("base - i * 2"), -1) << "a compiled text must see new values";
  e.forgetLocals();
  EXPECT_THROW(e.evaluate("i"), UserError);
}

TEST(Expression, randomNumbersFollowTheSeed) {
  Expressions a(5), b(5), c(6);
  const double first = a.evaluate("rand(2, 3)"), second = a.evaluate("rand(2, 3)");
  EXPECT_GE(first, 2);
  EXPECT_LT(first, 3);
  EXPECT_NE(first, second) << "rand was folded into a constant";
  EXPECT_EQ(b.evaluate("rand(2, 3)"), first);
  EXPECT_NE(c.evaluate("rand(2, 3)"), first);
}

TEST(Expression, refusesLibmAndNonsense) {
  Expressions e(1);
  e.setGlobal("height", 1);
  for (const char* text : {"exp(1)", "tanh(1)", "1 +", "nobody", "1 / 0", "sqrt(-1)", ""}) {
    EXPECT_THROW(e.evaluate(text), UserError) << text;
  }
  try {
    e.evaluate("heigt");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("height"), std::string::npos) << error.what();
  }
}

TEST(SceneFile, loopsNestInFileOrder) {
  const SceneSpec<2> scene = flat(R"(
[[body]]
repeat = { z = 2, a = "z + 1" }
position = ["z", "10 * a + k"]
shapes = [{ kind = "circle", radius = 1 }]
)");
  ASSERT_EQ(scene.spawns.size(), 3u);  // z=0: a=0; z=1: a=0, 1
  EXPECT_EQ(scene.spawns[0].body.X_WB.p, Vec<2>(0, 0));
  EXPECT_EQ(scene.spawns[1].body.X_WB.p, Vec<2>(1, 1));
  EXPECT_EQ(scene.spawns[2].body.X_WB.p, Vec<2>(1, 12));
}

TEST(SceneFile, aTableLetIsKnownToAllBlocks) {
  const std::string text = R"(
gravity = [0, "-half"]
steps = "2 * wide"
[parameters]
n = { default = 8, min = 1, max = 90, meaning = "m" }
[let]
wide = "n / dimension"
half = "wide / 2"
[[body]]
repeat = { i = "half" }
let = { x = "wide + i" }
position = ["x", "half"]
shapes = [{ kind = "circle", radius = "half" }]
)";
  const SceneSpec<2> scene = flat(text), larger = flat(text, {{"n", 12.0}});
  EXPECT_EQ(scene.settings.gravity, Vec<2>(0, -2));
  EXPECT_EQ(scene.steps, 8);
  ASSERT_EQ(scene.spawns.size(), 2u);
  EXPECT_EQ(scene.spawns[1].body.X_WB.p, Vec<2>(5, 2));
  ASSERT_EQ(larger.spawns.size(), 3u);
  EXPECT_EQ(larger.spawns[2].body.X_WB.p, Vec<2>(8, 3));
}

// One draw, shared by all uses.
TEST(SceneFile, aTableLetDrawsOnce) {
  const SceneSpec<2> scene = flat(
      "[let]\nr = \"rand(1, 2)\"\n[[body]]\nrepeat = { i = 2 }\nposition = [\"r\", 0]\n"
      "shapes = [{ kind = \"circle\", radius = \"r\" }]\n");
  ASSERT_EQ(scene.spawns.size(), 2u);
  EXPECT_TRUE(scene.seeded);
  EXPECT_GT(scene.spawns[0].body.X_WB.p[0], 1);
  EXPECT_EQ(scene.spawns[0].body.X_WB.p, scene.spawns[1].body.X_WB.p);
}

TEST(SceneFile, scriptsSpawnAndRemove) {
  const SceneSpec<2> scene = flat(R"(
needs = ["joints"]
[[body]]
name = "late"
from = 40
position = [0, 0]
shapes = [{ kind = "circle", radius = 1 }]
[[body]]
name = "rain"
from = 10
every = 20
until = 71
remove = "step + 5"
position = ["step", "k"]
shapes = [{ kind = "circle", radius = 1 }]
[[joint]]
kind = "pivot"
a = "rain[2]"
b = "late"
anchor = [0, 0]
)");
  ASSERT_EQ(scene.spawns.size(), 5u);
  std::vector<long> steps, removals;
  for (const auto& s : scene.spawns) steps.push_back(s.step), removals.push_back(s.removeAt);
  EXPECT_EQ(steps, (std::vector<long>{10, 30, 40, 50, 70}));
  EXPECT_EQ(removals, (std::vector<long>{15, 35, -1, 55, 75}));
  EXPECT_EQ(scene.spawns[4].body.X_WB.p, Vec<2>(70, 3));
  ASSERT_EQ(scene.joints.size(), 1u);
  EXPECT_EQ(scene.joints[0].bodyA, 3);
  EXPECT_EQ(scene.joints[0].bodyB, 2);
}

TEST(SceneFile, shapesInBothDimensions) {
  const SceneFile file = SceneFile::parse(kHead + R"(
[defaults]
density = 3
[[body]]
position = [1, 2, 3]
angle = "pi / 2"
pinned = true
shapes = [
  { kind = "polytope", points = [[-1, -1], [1, -1], [0, 1]], depth = 0.5, rounding = 0.1, density = 2 },
  { kind = "capsule", half_length = 1, radius = 0.5, offset = [4, 5, 6], friction = 0.25 },
]
)",
                                          "t.toml");
  const auto flatScene = file.build<2>({}, 1);
  const auto solidScene = file.build<3>({}, 1);
  EXPECT_EQ(census(flatScene), (std::map<std::string, int>{
                                   {"dynamic", 1}, {"dynamic capsule", 1}, {"dynamic polytope", 1}, {"pinned", 1}}));
  const BodyDef<3>& body = solidScene.spawns.at(0).body;
  EXPECT_EQ(body.shapes[0].shape.view().hull->vertices.size(), 6u);
  EXPECT_EQ(body.shapes[0].density, 2);
  EXPECT_EQ(body.shapes[1].density, 3);
  EXPECT_EQ(body.shapes[1].X_BS.p, Vec<3>(4, 5, 6));
  EXPECT_LT((body.X_WB.q * Vec<3>(1, 0, 0) - Vec<3>(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((flatScene.spawns[0].body.X_WB.q * Vec<2>(1, 0) - Vec<2>(0, 1)).norm(), 1e-15);
}

// Both dimensions take every form: a number is the same about each axis, and 2D uses what is about z.
TEST(SceneFile, AnInertiaIsANumberAListOrRows) {
  const auto body = [](const std::string& inertia) {
    return SceneFile::parse(kHead + "[[body]]\nmass = 2\ninertia = " + inertia + "\n", "t.toml");
  };
  const std::vector<std::pair<std::string, Vec<3>>> right = {{"3", {3, 3, 3}},
                                                             {"\"1 + 2\"", {3, 3, 3}},
                                                             {"0", {0, 0, 0}},
                                                             {"[2, 3, 4]", {2, 3, 4}},
                                                             {"[[2, 0, 0], [0, 3, 0], [0, 0, 4]]", {2, 3, 4}}};
  for (const auto& [text, diagonal] : right) {
    EXPECT_EQ(body(text).build<2>({}, 1).spawns.at(0).body.mass->inertia(0, 0), diagonal[2]) << text;
    EXPECT_EQ(body(text).build<3>({}, 1).spawns.at(0).body.mass->inertia, Inertia<3>(diagonal.asDiagonal())) << text;
  }
  for (const std::string text : {"-1", "[2, 3, -1]", "[]", "[5]", "[2, 3]", "[[1, 0], [0, 1]]", "true",
                                 "[2, 3, [4, 0, 0]]", "[[2, 0, 0], 3, 4]"}) {
    EXPECT_THROW(body(text).build<2>({}, 1), UserError) << text;
    EXPECT_THROW(body(text).build<3>({}, 1), UserError) << text;
  }
  EXPECT_EQ(messageOf("[[body]]\nmass = 2\ninertia = [2, 3]\n"),
            "t.toml:6: 'inertia' is a list of 2; valid: a number, a list of three, or three rows of three");
}

// Every mistake is one line: where, what was found, what is valid. `part` counts within one entry of `parts` and is 0
// everywhere else.
TEST(SceneFile, partsRepeat) {
  const SceneFile file = SceneFile::parse(R"(
name = "ladder"
summary = "s"
dimensions = [2]
[[body]]
repeat = 2
position = ["part", "k"]
shapes = [
  { kind = "compound", offset = ["part", 0], parts = [
    { kind = "box", half = [0.1, 0.1], repeat = 3, offset = ["part", 0] },
    { kind = "circle", radius = 0.1, repeat = "part + 1", offset = ["part", 1] },
  ] },
  { kind = "circle", radius = "part + 0.5" },
]
)",
                                          "t.toml");
  const auto scene = file.build<2>({}, 1);
  ASSERT_EQ(scene.spawns.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const BodyDef<2>& body = scene.spawns[i].body;
    EXPECT_EQ(body.X_WB.p, Vec<2>(0, static_cast<Real>(i)));
    EXPECT_EQ(body.shapes[0].X_BS.p, Vec<2>(0, 0));
    const auto parts = body.shapes[0].shape.parts();
    ASSERT_EQ(parts.size(), 4u);
    for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(parts[p].X_SP.p, Vec<2>(static_cast<Real>(p), 0));
    EXPECT_EQ(parts[3].X_SP.p, Vec<2>(0, 1));
    EXPECT_EQ(body.shapes[1].shape.view().radius, Real(0.5));
  }
}

TEST(SceneFile, mistakesHaveFileAndLine) {
  struct Case {
    const char* text;
    std::vector<const char*> parts;
  };
  const std::string body = "[[body]]\nposition = [0, 0]\n";
  const Case cases[] = {
      {"gravity = [0, ", {"t.toml:"}},
      {"gravty = [0, -1]\n", {"t.toml:4: ", "'gravty'", "gravity"}},
      {"gravity = 3\n", {"t.toml:4: ", "the number 3", "list"}},
      {"needs = [\"wings\"]\n", {"t.toml:4: ", "'wings'", "friction"}},
      {"[parameters]\nn = 3\n", {"t.toml:5: ", "'n'", "table"}},
      {"[parameters]\nn = { default = 9, min = 0, max = 5, meaning = \"m\" }\n", {"t.toml:5: ", "min and max"}},
      {"[[body]]\nposition = [0, \"hi + 1\"]\nshapes = [{ kind = \"circle\", radius = 1 }]\n",
       {"t.toml:5: ", "'hi + 1'", "dimension"}},
      {"[[body]]\nshapes = [\n{ kind = \"blob\", radius = 1 }]\n", {"t.toml:6: ", "'blob'", "capsule"}},
      {"[[body]]\nshapes = [\n{ kind = \"circle\", radius = -1 }]\n", {"t.toml:6: ", "circle"}},
      {"[[body]]\nshapes = [\n{ kind = \"circle\" }]\n", {"t.toml:6: ", "'radius' is missing"}},
      {"[[body]]\nshapes = [\n{ kind = \"polytope\", corners = 2, radius = 1 }]\n",
       {"t.toml:6: ", "'corners' is 2", "3 to 1000"}},
      {"[[body]]\nshapes = [\n{ kind = \"polytope\", corners = 3.5, radius = 1 }]\n",
       {"t.toml:6: ", "'corners' is 3.5", "whole numbers"}},
      {"[[body]]\nshapes = [\n{ kind = \"polytope\", corners = 3 }]\n", {"t.toml:6: ", "'radius' is missing"}},
      {"[[body]]\nrepeat = { i = 0 }\nshapes = [\n{ kind = \"polytope\", corners = \"3 + j\", radius = 1 }]\n",
       {"t.toml:7: ", "'3 + j'"}},
      {"[[body]]\nshapes = [\n{ kind = \"compound\" }]\n", {"t.toml:6: ", "'parts' is missing"}},
      {"[[body]]\nshapes = [\n{ kind = \"compound\", parts = [] }]\n", {"t.toml:6: compound: no parts"}},
      {"[[body]]\nshapes = [{ kind = \"compound\", parts = [\n{ kind = \"plane\" }] }]\n",
       {"t.toml:6: a part is a plane", "convex"}},
      {"[[body]]\nshapes = [{ kind = \"compound\", parts = [\n{ kind = \"circle\", radius = 1, repeat = 0.5 }] }]\n",
       {"t.toml:6: ", "'repeat'", "whole numbers"}},
      {"[[body]]\nshapes = [{ kind = \"compound\", overlap = \"maybe\", parts = [{ kind = \"circle\", radius = 1 }] "
       "}]\n",
       {"t.toml:5: ", "'maybe'", "counted, refused"}},
      {"[[body]]\nshapes = [{ kind = \"compound\", overlap = \"refused\", parts = [{ kind = \"circle\", radius = 1, "
       "repeat = "
       "2 }] }]\n",
       {"t.toml:5: compound, part 1: overlaps part 0"}},
      {"[[body]]\ntype = \"soft\"\nshapes = [{ kind = \"circle\", radius = 1 }]\n",
       {"t.toml:5: ", "'soft'", "kinematic"}},
      {"[[body]]\nrepeat = { i = \"0 - 1\" }\nshapes = [{ kind = \"circle\", radius = 1 }]\n",
       {"t.toml:5: ", "whole number"}},
      {"[[body]]\nrepeat = { k = 3 }\nshapes = [{ kind = \"circle\", radius = 1 }]\n", {"t.toml:5: ", "'k'"}},
      {"[[body]]\nuntil = 5\nshapes = [{ kind = \"circle\", radius = 1 }]\n", {"t.toml:4: ", "'every'"}},
      {"needs = [\"joints\"]\n[[joint]]\nkind = \"pivot\"\na = \"nobody\"\nb = \"nobody\"\nanchor = [0, 0]\n",
       {"t.toml:7: ", "'nobody'"}},
      {"[defaults]\nfrictoin = 3\n", {"t.toml:5: ", "'frictoin'", "friction"}},
      {"[limits]\nspin = 3\n", {"t.toml:5: ", "'spin'", "drift"}},
  };
  for (const Case& c : cases) {
    const std::string message = messageOf(c.text);
    for (const char* part : c.parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "text: " << c.text << "\nmessage: " << message;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_NE(messageOf("", {{"n", 1}}).find("no parameter 'n'"), std::string::npos);
  EXPECT_NE(messageOf("name = 3", {}, false).find("t.toml:1: "), std::string::npos);
}

// Impossible joints: the message names the block or the number, and what is valid.
TEST(SceneFile, badJointsAreRefused) {
  const std::string bodies =
      "[[body]]\nname = \"a\"\nshapes = [{ kind = \"circle\", radius = 1 }]\n"
      "[[body]]\nname = \"fixed\"\ntype = \"fixed\"\nshapes = [{ kind = \"circle\", radius = 1 }]\n";
  struct Case {
    const char *a, *b, *rest;
    std::vector<const char*> parts;
  };
  const std::vector<Case> cases = {
      {"a", "a", "kind = \"pivot\"", {"between a body and itself", "world"}},
      {"world", "fixed", "kind = \"pivot\"", {"cannot move"}},
      {"fixed", "world", "kind = \"pivot\"", {"'world'", "a, fixed"}},
      {"fixed", "a", "kind = \"glue\"", {"'glue'", "valid: ", "pivot"}},
      {"fixed",
       "a",
       "kind = \"hinge\"\nparameters = { lower = 1, upper = 0 }",
       {"lower above upper", "lower <= upper"}},
      {"fixed", "a", "kind = \"hinge\"\nparameters = { speed = 1 }", {"'speed'", "motor_speed"}},
      {"fixed", "a", "kind = \"hinge\"\nparameters = { stiffness = 1e300 }", {"'stiffness'", "a number from 0"}},
      {"fixed", "a", "kind = \"distance\"", {"length 0", "a pivot"}},
      {"fixed", "a", "kind = \"distance\"\nparameters = { damping = 1 }", {"damping", "mode=spring"}},
      {"fixed", "a", "kind = \"distance\"\nparameters = { mode = \"glue\" }", {"'glue'", "rod, spring, rope"}},
      {"fixed", "a", "kind = \"pivot\"\nbreak_force = -1", {"breaks at -1", "> 0"}},
      {"fixed", "a", "kind = \"pivot\"\nbrake_force = 1", {"'brake_force'"}},
      {"fixed", "a", "kind = \"hinge\"\naxis = [0, 0, 0]", {"'axis'", "no length"}},
      {"fixed", "a", "kind = \"wheel\"\nalong = [0, 0]", {"'along'", "no length"}},
      {"fixed", "a", "kind = \"wheel\"\nalong = [1e-200, 0]", {"'along'", "no length"}},
      {"fixed", "a", "kind = \"wheel\"\nalong = [1e200, 0]", {"'along'", "too long", "[1, 0, 0]"}},
      {"fixed", "a", "kind = \"wheel\"\nalong = 1", {"numbers"}},
      {"fixed", "a", "kind = \"wheel\"\naxis = [0, 0, 1]\nalong = [0, 1, 0.1]", {"'along'", "not perpendicular"}},
  };
  for (const Case& c : cases) {
    const std::string text = "name = \"t\"\nsummary = \"t\"\ndimensions = [3]\nneeds = [\"joints\"]\n" + bodies +
                             "[[joint]]\na = \"" + c.a + "\"\nb = \"" + c.b + "\"\nanchor = [0, 0]\n" + c.rest + "\n";
    SCOPED_TRACE(text);
    try {
      SceneFile::parse(text, "t.toml").build<3>({}, 1);
      ADD_FAILURE() << "was taken";
    } catch (const UserError& e) {
      const std::string line = e.what();
      EXPECT_TRUE(line.starts_with("t.toml:1")) << line;  // within the block
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      for (const char* part : c.parts) EXPECT_NE(line.find(part), std::string::npos) << line;
    }
  }
}

TEST(SceneFile, jointsHaveParametersAxesAndEnds) {
  const SceneFile file = SceneFile::parse(R"(
name = "t"
summary = "t"
dimensions = [2, 3]
needs = ["joints"]
[parameters]
n = { default = 2, min = 0, max = 9, meaning = "turns" }
[[body]]
name = "a"
shapes = [{ kind = "circle", radius = 1 }]
[[joint]]
kind = "hinge"
a = "world"
b = "a"
anchor = [1, 2]
axis = [2, 0, 0]
parameters = { upper = "n * 2" }
break_torque = "n * 10"
[[joint]]
kind = "distance"
a = "world"
b = "a"
anchor = [0, 3]
anchor_b = [0, 1]
parameters = { mode = "rope" }
)",
                                          "t.toml");
  const SceneSpec<3> scene = file.build<3>({}, 1);
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.joints[0].bodyA, -1);
  EXPECT_EQ(scene.joints[0].def.kind, "hinge{upper=4}");
  EXPECT_NEAR((scene.joints[0].def.X_WJ.q * Vec<3>(0, 0, 1) - Vec<3>(1, 0, 0)).norm(), 0, 1e-6);
  EXPECT_EQ(scene.joints[0].def.breakTorque, 20);
  EXPECT_EQ(scene.joints[1].def.kind, "distance{mode=rope}");
  EXPECT_EQ(scene.joints[1].def.X_WJb->p, Vec<3>(0, 1, 0));
  EXPECT_EQ(file.build<2>({}, 1).joints[0].def.X_WJ.p, Vec<2>(1, 2));
}

// `along` is the frame's x axis, `axis` its z axis; an axis that is not given rotates as little as possible.
TEST(SceneFile, jointsHaveDirections) {
  const std::string head =
      "name = \"t\"\nsummary = \"t\"\ndimensions = [2, 3]\nneeds = [\"joints\"]\n[[body]]\nname = \"a\"\n"
      "shapes = [{ kind = \"circle\", radius = 1 }]\n[[joint]]\nkind = \"wheel\"\na = \"world\"\nb = \"a\"\n"
      "anchor = [0, 0]\n";
  const auto frame = [&](const std::string& keys) {
    return SceneFile::parse(head + keys, "t.toml").build<3>({}, 1).joints.at(0).def.X_WJ.q.matrix();
  };
  const auto flat = [&](const std::string& keys) {
    return SceneFile::parse(head + keys, "t.toml").build<2>({}, 1).joints.at(0).def.X_WJ.q.matrix();
  };
  using Columns = Eigen::Matrix<Real, 3, 3>;
  const auto same = [&](const std::string& keys, const Vec<3>& x, const Vec<3>& z) {
    Columns expected;
    expected << x.normalized(), cross(z, x).normalized(), z.normalized();
    EXPECT_LT((frame(keys) - expected).norm(), 1e-6) << keys << frame(keys);
  };
  same("", {1, 0, 0}, {0, 0, 1});
  same("along = [0, 2, 0]\n", {0, 1, 0}, {0, 0, 1});
  same("along = [-1, 0, 0]\n", {-1, 0, 0}, {0, 0, 1});
  same("along = [3, -4, 0]\n", {3, -4, 0}, {0, 0, 1});
  same("along = [0, 0, 1]\n", {0, 0, 1}, {-1, 0, 0});
  same("axis = [1, 0, 0]\n", {0, 0, -1}, {1, 0, 0});
  same("axis = [1, 0, 0]\nalong = [0, 1, 0]\n", {0, 1, 0}, {1, 0, 0});
  same("axis = [0, 0, -1]\nalong = [0, -1, 0]\n", {0, -1, 0}, {0, 0, -1});
  same("axis = [1, 2, 2]\nalong = [2, 1, -2]\n", {2, 1, -2}, {1, 2, 2});
  Eigen::Matrix<Real, 2, 2> turned;
  turned << Real(0.6), Real(0.8), Real(-0.8), Real(0.6);
  EXPECT_LT((flat("along = [3, -4, 9]\naxis = [1, 0, 0]\n") - turned).norm(), 1e-6);
  EXPECT_EQ(flat("axis = [1, 0, 0]\n"), (Eigen::Matrix<Real, 2, 2>::Identity()));
  EXPECT_THROW(flat("along = [0, 0, 1]\n"), UserError);
}

// A block with zero iterations has no values, so its directions are not checked.
TEST(SceneFile, directionsInABlockWithoutIterationsAreNotChecked) {
  const std::string text =
      "name = \"t\"\nsummary = \"t\"\ndimensions = [3]\nneeds = [\"joints\"]\n[[body]]\nname = \"a\"\n"
      "shapes = [{ kind = \"circle\", radius = 1 }]\n[[joint]]\nrepeat = { i = 0 }\nkind = \"wheel\"\na = \"world\"\n"
      "b = \"a\"\nanchor = [0, 0]\naxis = [\"cos(i)\", \"sin(i)\", 0]\nalong = [\"-sin(i)\", \"cos(i)\", 0]\n";
  EXPECT_NO_THROW(SceneFile::parse(text, "t.toml").build<3>({}, 1));
}

TEST(SceneFile, featuresAreText) {
  PhysicsModel f = modelFromText("rotation,cache");
  EXPECT_TRUE(f.rotation && f.cache);
  EXPECT_FALSE(f.friction || f.joints || f.sleeping || f.restitution);
  EXPECT_EQ(modelText(f), "cache,rotation");
  EXPECT_EQ(modelFromText(modelText(PhysicsModel{})), PhysicsModel{});
  EXPECT_THROW(modelFromText("cache,wings"), UserError);
}

TEST(SceneFile, CoefficientsMixAsItSays) {
  const auto mixed = [](const std::string& rules) {
    SceneSpec<2> scene = flat("needs = [\"friction\", \"restitution\"]\ngravity = [0, -10, 0]\n" + rules + R"(
[[body]]
type = "fixed"
shapes = [{ kind = "circle", radius = 1, friction = 0.9, restitution = 0.2 }]
[[body]]
position = [0, 1.99, 0]
shapes = [{ kind = "circle", radius = 1, friction = 0.1, restitution = 0.8 }]
)");
    World<2> world({}, scene.settings);
    Director<2> director(std::move(scene));
    director.advance(world);
    world.step(Real(0.01));
    return std::pair(world.manifolds().front().friction, world.manifolds().front().restitution);
  };
  const auto rule = [](const std::string& name) {
    return "[mixing]\nfriction = \"" + name + "\"\nrestitution = \"" + name + "\"\n";
  };
  const auto expect = [&](const std::string& rules, double friction, double restitution) {
    const auto [f, r] = mixed(rules);
    EXPECT_NEAR(f, friction, 1e-12) << rules;
    EXPECT_NEAR(r, restitution, 1e-12) << rules;
  };
  expect("", 0.3, 0.5);
  expect(rule("geometric_mean"), 0.3, 0.4);
  expect(rule("arithmetic_mean"), 0.5, 0.5);
  expect(rule("minimum"), 0.1, 0.2);
  expect(rule("maximum"), 0.9, 0.8);
  expect(rule("product"), 0.09, 0.16);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scene_file_test
